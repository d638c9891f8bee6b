// Boundaries that move, and rough bodies, hold the material that they have taken, pull or push; tables of motion and force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr double bar_cell = 0.04, bar_height = 0.64, bar_width = 0.24;

MaterialOptions rubber() {
  MaterialOptions m = elastic(2e5, 0.25, 1200);
  m.model = "neo_hookean";
  return m;
}

Scene bar() {
  Scene s = scene(Grid{{0, 0}, {bar_cell, bar_cell}, 15, 32}, {rectangle("bar", 0.16, 0, 0.16 + bar_width, bar_height)}, {rubber()});
  s.boundaries = {{"base", line({0, 0}, {0.56, 0}, "fixed")}};
  return s;
}

Scene walled_bar() {
  Scene s = scene(Grid{{0, 0}, {bar_cell, bar_cell}, 7, 32}, {rectangle("bar", 0, 0, bar_width, bar_height)}, {rubber()});
  s.boundaries = {{"base", line({0, 0}, {bar_width, 0}, "fixed")},
                  {"left", line({0, 0}, {0, 1.24}, "roller")},
                  {"right", line({bar_width, 0}, {bar_width, 1.24}, "roller")}};
  return s;
}

MpmOptions slowly(ShapeKind shape) {
  MpmOptions o = options();
  o.shape = shape;
  o.damping = 0.1;
  if (shape == ShapeKind::bilinear) o.transfer = TransferKind::flip, o.stress_update = StressUpdate::musl;
  o.initial_equilibrium = false;
  o.end_at_rest = false;
  return o;
}

// The face of the material at its top: the mean of the top row, and half a point further.
double top_moved(const Solver& solver) {
  const MotionFrame frame = solver.frame();
  double sum = 0, n = 0;
  for (std::size_t k = 0; k < frame.u.size(); ++k)
    if (solver.particles().x0[k].y() > bar_height - 0.5 * bar_cell) {
      sum += double(frame.u[k][1]) + 0.25 * bar_cell * (double(frame.F[k][3]) - 1);
      ++n;
    }
  return sum / n;
}

// Mean F_yy of the rows at mid-height.
double stretch_of(const Solver& solver) {
  const MotionFrame frame = solver.frame();
  double sum = 0, n = 0;
  for (std::size_t k = 0; k < frame.u.size(); ++k)
    if (std::abs(solver.particles().x0[k].y() - 0.5 * bar_height) < bar_cell) sum += double(frame.F[k][3]), ++n;
  return sum / n;
}

constexpr double bar_speed = 0.4;

BoundaryOptions moving_top(double sign, double x0 = 0.16) {
  BoundaryOptions top = line({x0, bar_height}, {x0 + bar_width, bar_height}, "fixed");
  top.velocity_m_s = Pair{0, sign * bar_speed};
  return top;
}

RigidOptions rough_plate(double sign, double x0 = 0.16) {
  RigidOptions plate;
  plate.polygon_m = {{x0 - 0.08, bar_height}, {x0 + bar_width + 0.08, bar_height}, {x0 + bar_width + 0.08, bar_height + 0.1}, {x0 - 0.08, bar_height + 0.1}};
  plate.velocity_m_s = {0, sign * bar_speed};
  return plate;
}

struct Held {
  double off = 0;  // greatest distance between the face and what holds it, cells
  double stretch = 0, force = 0, before = 0;  // at the end and a tenth of the strain before
};

Held moved_to_sixty_percent(ShapeKind shape, bool by_body, double sign, bool between_walls) {
  Scene s = between_walls ? walled_bar() : bar();
  const double x0 = between_walls ? 0 : 0.16;
  if (by_body) s.bodies = {{"top", rough_plate(sign, x0)}};
  else s.boundaries.push_back({"top", moving_top(sign, x0)});
  Solver solver(slowly(shape), s, 1);
  const std::vector<std::string> names = solver.reaction_names();
  const auto top = std::size_t(std::find(names.begin(), names.end(), by_body ? "body.top" : "boundary.top") - names.begin());
  Held held;
  double impulse = 0;
  const double end = 0.6 * bar_height / bar_speed;
  for (int k = 1; k <= 6; ++k) {
    const double time = end * k / 6;
    solver.advance_to(time, silent);
    held.off = std::max(held.off, std::abs(top_moved(solver) - sign * bar_speed * time) / bar_cell);
    held.before = held.force;
    held.force = (solver.reactions().of[top].impulse.y() - impulse) / (end / 6);
    impulse = solver.reactions().of[top].impulse.y();
  }
  held.stretch = stretch_of(solver);
  return held;
}

// Nominal stress of the material whose sides do not give, P = mu (F - 1/F) + lambda ln F/F.
double confined_stress(double F) {
  const double lambda = 2e5 * 0.25 / (1.25 * 0.5), mu = 2e5 / 2.5;
  return mu * (F - 1 / F) + lambda * std::log(F) / F;
}

// Between smooth walls the bar stays uniform; the force is the mean over the last tenth of the strain.
TEST(Grips, HoldToStrainsOfSixtyPercent) {
  for (const ShapeKind shape : {ShapeKind::bspline, ShapeKind::gimp})
    for (const bool by_body : {false, true})
      for (const double sign : {1.0, -1.0}) {
        const Held held = moved_to_sixty_percent(shape, by_body, sign, true);
        const std::string what = std::to_string(int(shape)) + (by_body ? " body " : " boundary ") + std::to_string(sign);
        EXPECT_LT(held.off, 0.15) << what;
        EXPECT_NEAR(held.stretch, 1 + sign * 0.6, 0.06) << what;
        double exact = 0;
        for (int k = 0; k < 100; ++k) exact += bar_width * confined_stress(1 + sign * (0.5 + 0.001 * (k + 0.5))) / 100;
        EXPECT_GT(held.force / exact, 0.95) << what;
        EXPECT_LT(held.force / exact, 1.1 * 1.05) << what;  // (local damping of 0.1 adds up to a tenth where nodes are held)
      }
}

// Cells and steps of bilinear functions disturb a bar that is pulled; pressed, it is held as well.
TEST(Grips, HoldWhatIsPressedUnderBilinearFunctions) {
  const Held held = moved_to_sixty_percent(ShapeKind::bilinear, false, -1, true);
  EXPECT_LT(held.off, 0.15);
  EXPECT_NEAR(held.stretch, 0.4, 0.06);
}

// With free sides the corners bear singular stresses; the bar stays held, and its force goes on rising.
TEST(Grips, HoldABarWithFreeSides) {
  for (const ShapeKind shape : {ShapeKind::bspline, ShapeKind::gimp})
    for (const bool by_body : {false, true}) {
      const Held held = moved_to_sixty_percent(shape, by_body, 1, false);
      EXPECT_LT(held.off, 0.3) << int(shape) << by_body;
      EXPECT_NEAR(held.stretch, 1.6, 0.06) << int(shape) << by_body;
      EXPECT_GT(held.force, held.before) << int(shape) << by_body;
    }
}

MotionTable course(const std::vector<double>& time, int component, const std::vector<double>& rows, bool rates) {
  MotionTable table;
  table.time = time;
  table.courses[std::size_t(component)] = {rows, rates, {}};
  return table;
}

// A roller pulls and pushes along its normal and lets the material slide along itself.
TEST(Grips, AMovingRollerHoldsItsNormalAlone) {
  Scene s = bar();
  BoundaryOptions top = moving_top(1);
  top.type = BoundaryType::roller;
  s.boundaries.push_back({"top", top});
  s.boundaries[0].second.type = BoundaryType::roller;
  s.boundaries.push_back({"foot", line({0.16, 0}, {0.17, 0}, "fixed")});
  Solver solver(slowly(ShapeKind::bspline), s, 1);
  const double end = 0.4 * bar_height / bar_speed;
  solver.advance_to(end, silent);
  EXPECT_NEAR(top_moved(solver), bar_speed * end, 0.1 * bar_cell);
  const MotionFrame frame = solver.frame();
  double left = 0, right = 0;
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    const Vec2 x = solver.particles().x0[k];
    if (x.y() < bar_height - bar_cell) continue;
    if (x.x() < 0.16 + 0.5 * bar_cell) left = double(frame.u[k][0]);
    if (x.x() > 0.16 + bar_width - 0.5 * bar_cell) right = double(frame.u[k][0]);
  }
  EXPECT_LT(right - left, -0.03 * bar_width);  // it narrows there as well
}

// A table of displacements, and that of their rates, are one motion; both end where they say, and stay there.
TEST(MotionTables, DisplacementsAndVelocitiesAreOneMotion) {
  std::vector<double> force;
  for (const bool rates : {false, true}) {
    Scene s = bar();
    BoundaryOptions top = line({0.12, bar_height}, {0.44, bar_height}, "fixed");
    top.motion_table = rates ? course({0, 0.2, 0.2001, 0.4, 0.4001, 0.5}, 1, {-0.3, -0.3, 0.1, 0.1, 0, 0}, true)
                             : course({0, 0.2, 0.4, 0.5}, 1, {0.7, 0.64, 0.66, 0.66}, false);
    s.boundaries.push_back({"top", top});
    Solver solver(slowly(ShapeKind::bspline), s, 1);
    for (const auto& [time, at] : {std::pair{0.1, -0.03}, {0.2, -0.06}, {0.3, -0.05}, {0.45, -0.04}, {0.6, -0.04}}) {
      solver.advance_to(time, silent);
      EXPECT_NEAR(top_moved(solver), at, 0.05 * bar_cell) << time << rates;
      EXPECT_NEAR(solver.reactions().of[1].displacement.y(), at, 3e-5) << time << rates;
    }
    force.push_back(solver.reactions().of[1].impulse.y());
  }
  EXPECT_NEAR(force[0], force[1], 0.02 * std::abs(force[0]));
}

// A block gripped by a body that turns about a pivot outside it goes round with it: places after three quarters of a turn.
TEST(MotionTables, ABodyTurnsAboutItsPivot) {
  for (const bool by_table : {false, true}) {
    const Vec2 pivot(0.5, 0.5);
    Scene s = scene(Grid{{0, 0}, {0.025, 0.025}, 41, 41}, {rectangle("block", 0.7, 0.45, 0.8, 0.55)}, {rubber()});
    RigidOptions arm;
    arm.polygon_m = {{0.5, 0.4}, {0.7, 0.4}, {0.7, 0.6}, {0.5, 0.6}};
    arm.pivot_m = Pair{pivot.x(), pivot.y()};
    if (by_table) arm.motion_table = course({0, 2}, 2, {0.1, 0.1 + 1.5 * M_PI}, false);
    else arm.angular_velocity_rad_s = 0.75 * M_PI;
    s.bodies = {{"arm", arm}};
    Solver solver(slowly(ShapeKind::bspline), s, 1);
    solver.advance_to(2, silent);
    const MotionFrame frame = solver.frame();
    double most = 0;
    for (std::size_t k = 0; k < frame.u.size(); ++k) {
      const Vec2 d = solver.particles().x0[k] - pivot, exact(d.y(), -d.x());
      most = std::max(most, (d + Vec2(double(frame.u[k][0]), double(frame.u[k][1])) - exact).norm());
    }
    EXPECT_LT(most, 0.3 * 0.025) << by_table;
    EXPECT_NEAR(solver.reactions().of[0].turn, 1.5 * M_PI, 1e-9) << by_table;
  }
}

// Servo: a plate of given mass on a column between smooth walls, its weight taken off and its force given, with its motion along x
// prescribed: the material's reaction follows the table.
TEST(MotionTables, AForceIsWhatTheMaterialBears) {
  Scene s = scene(Grid{{0, 0}, {bar_cell, bar_cell}, 7, 24}, {rectangle("soil", 0, 0, 0.24, 0.64)}, {rubber()});
  s.boundaries = {{"base", line({0, 0}, {0.24, 0}, "fixed")},
                  {"left", line({0, 0}, {0, 0.9}, "roller")},
                  {"right", line({0.24, 0}, {0.24, 0.9}, "roller")}};
  RigidOptions plate;
  plate.polygon_m = {{-0.04, 0.64}, {0.28, 0.64}, {0.28, 0.76}, {-0.04, 0.76}};
  plate.friction = 0;
  plate.mass_kg_m = 5;
  plate.turns = false;
  plate.motion_table = course({0, 10}, 0, {0, 0.01}, false);
  plate.force_table.time = {0, 1, 2};
  plate.force_table.rows[1] = {0, -1500, -900};
  s.bodies = {{"plate", plate}};
  Solver solver(slowly(ShapeKind::bspline), s, 1);
  const auto force_over = [&](double from, double to) {
    solver.advance_to(from, silent);
    const double before = solver.body_impulse(0).y();
    solver.advance_to(to, silent);
    return (solver.body_impulse(0).y() - before) / (to - from);
  };
  EXPECT_NEAR(force_over(0.9, 1.1), -1500 + 0.25 * 150 - 0.25 * -60, 60);
  EXPECT_NEAR(force_over(2.4, 2.6), -900, 30);
  EXPECT_NEAR(solver.body_displacement(0).x(), 0.0026, 1e-9);
}

TEST(MotionTables, RefuseWhatDoesNotGoTogether) {
  const auto says = [](const auto& change) {
    Scene s = bar();
    s.boundaries.push_back({"top", moving_top(1)});
    s.bodies = {{"plate", rough_plate(1)}};
    change(s.boundaries[1].second, s.bodies[0].second);
    try {
      Solver solver(slowly(ShapeKind::bspline), s, 1);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const MotionTable down = course({0, 1}, 1, {0, -0.1}, false);
  const auto starts = [&](const std::string& text, const std::string& key) { EXPECT_TRUE(text.starts_with(key)) << text; };
  starts(says([&](BoundaryOptions& b, RigidOptions&) { b.motion_table = down; }), "boundary.top.motion: ");
  starts(says([&](BoundaryOptions& b, RigidOptions&) { b.type = BoundaryType::frictional; }), "boundary.top.velocity_m_s: ");
  starts(says([&](BoundaryOptions&, RigidOptions& p) { p.motion_table = down; }), "body.plate.motion: ");
  starts(says([&](BoundaryOptions&, RigidOptions& p) { p.force_table = {{0, 1}, {}}; }), "body.plate.force: ");
  starts(says([&](BoundaryOptions&, RigidOptions& p) { p.mass_kg_m = 3, p.angular_velocity_rad_s = 1; }), "body.plate.angular_velocity_rad_s: ");
}

// What is held is part of the state.
TEST(Grips, GoOnFromACheckpointBitForBit) {
  Scene s = bar();
  s.boundaries.push_back({"top", moving_top(1)});
  Solver one(slowly(ShapeKind::bspline), s, 1), two(slowly(ShapeKind::bspline), s, 2);
  one.advance_to(0.2, silent);
  two.load(one.save());
  one.advance_to(0.3, silent);
  two.advance_to(0.3, silent);
  EXPECT_TRUE(one.save() == two.save());
}

// A point that is crushed to less than a tenth of its volume ends, with its time.
TEST(BadState, EndsWhatIsCrushed) {
  Scene s = walled_bar();
  BoundaryOptions top = line({0, bar_height}, {bar_width, bar_height}, "fixed");
  top.velocity_m_s = Pair{0, -1};
  s.boundaries.push_back({"top", top});
  MpmOptions o = slowly(ShapeKind::bspline);
  o.energy_limit = 1e9;
  Solver solver(o, s, 1);
  solver.advance_to(0.85 * bar_height, silent);
  EXPECT_EQ(solver.ended(), 0u);
  std::size_t crushed = 0;
  for (double to = 0.86; to < 0.97 && crushed == 0; to += 0.01) {
    solver.advance_to(to * bar_height, silent);
    for (std::size_t k = 0; k < solver.particles().size(); ++k)
      if (solver.particles().end_reason[k] == EndReason::bad_state) {
        ++crushed;
        EXPECT_GT(solver.particles().end[k], 0.85 * bar_height);
      }
  }
  EXPECT_GT(crushed, 0u);
}

}  // namespace
}  // namespace pivnp::mpm
