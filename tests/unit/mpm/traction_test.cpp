// Loads on faces, and what boundaries, loads and bodies do to the material.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

BoundaryOptions load_on(Pair from, Pair to, Pair traction, double rise) {
  BoundaryOptions o = line(from, to, "traction");
  o.traction_pa = traction;
  o.rise_s = rise;
  return o;
}

TEST(Tractions, ATractionIsTheStressUnderIt) {
  Scene s = column(0.2, elastic(1e6, 0.3, 1000));
  s.boundaries.push_back({"load", load_on({0, 0.2}, {0.1, 0.2}, {0, -500}, 0.2)});
  MpmOptions o = options();
  o.damping = 0.3;
  Solver solver(o, s, 1);
  solver.advance_to(0.1, silent);
  EXPECT_NEAR(mean_stress(solver, 1, 0.15), -250, 20);  // half-way up its ramp
  solver.advance_to(0.5, silent);
  EXPECT_NEAR(mean_stress(solver, 1, 0.15), -500, 5);
  const EnergyRow e = solver.energy();
  EXPECT_LT(std::abs(e.residual), 0.02 * e.external);
}

// Rows of stress under a load q: each bears q, not what is left between the points' centres and the face.
TEST(Tractions, EveryRowBearsTheTraction) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline}) {
    Scene s = column(0.1, elastic(1e6, 0.3, 1000));
    s.boundaries.push_back({"load", load_on({0, 0.1}, {0.1, 0.1}, {0, -500}, 0.05)});
    MpmOptions o = options();
    o.damping = 0.3;
    o.shape = shape;
    Solver solver(o, s, 1);
    solver.advance_to(0.3, silent);
    for (int row = 0; row < 20; ++row) {
      const double y = 0.1 - 0.005 * (row + 0.5);
      const double q = -mean_stress(solver, 1, y + 0.002, y - 0.002);
      EXPECT_NEAR(q, 500, 0.012 * 500) << "row " << row << " of shape " << int(shape);
    }
  }
}

// A specimen in a cell: its pressure on all free faces, which meet at a corner, while it is pressed by a fifth.
TEST(Tractions, ACellPressureStaysWhileTheSpecimenStrains) {
  for (const ShapeKind shape : {ShapeKind::gimp, ShapeKind::bspline}) {
    Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 17, 15}, {rectangle("specimen", 0, 0, 0.1, 0.1)}, {elastic(1e6, 0.3, 1000)});
    s.boundaries = {{"base", line({0, 0}, {0.16, 0}, "roller")}, {"left", line({0, 0}, {0, 0.14}, "roller")}};
    const auto load = [&](const char* name, Pair from, Pair to, Pair q, double rise) {
      BoundaryOptions t = load_on(from, to, q, rise);
      t.follows_face = true;
      s.boundaries.push_back({name, t});
    };
    load("top", {0, 0.1}, {0.1, 0.1}, {0, -2.9e5}, 0.4);
    load("side", {0.1, 0}, {0.1, 0.1}, {-2e4, 0}, 0.1);
    MpmOptions o = options();
    o.damping = 0.3;
    o.shape = shape;
    Solver solver(o, s, 1);
    solver.advance_to(0.6, silent);
    const MotionFrame frame = solver.frame();
    double shortest = 1;
    for (std::size_t k = 0; k < frame.u.size(); ++k) shortest = std::min(shortest, 1 + double(frame.u[k][1]) / solver.particles().x0[k].y());
    EXPECT_LT(shortest, 0.8);
    EXPECT_NEAR(mean_stress(solver, 0, 1), -2e4, 0.01 * 2e4) << int(shape);
    EXPECT_NEAR(mean_stress(solver, 1, 1), -2.9e5, 0.01 * 2.9e5) << int(shape);
    EXPECT_LT(std::abs(solver.energy().residual), 0.02 * solver.energy().external) << int(shape);
  }
}

// A block that is pressed from above and below, free at its sides: the faces of both lie on lines of the grid, beyond which nodes have next to no mass.
// It swings as it is loaded and stays as even as it was. (Where such nodes strained points by what they would do with more mass, while the points were moved by what
// they did, uGIMP with stress last gained energy there at each step: points off by twice the load, and more energy than that had given.)
TEST(Tractions, FreeSidesBesideALoadStayQuiet) {
  constexpr double h = 0.005, q = 2e4;
  for (const ShapeKind shape : {ShapeKind::gimp, ShapeKind::bspline}) {
    Scene s = scene(Grid{{-4 * h, -4 * h}, {h, h}, 29, 29}, {rectangle("block", 0, 0, 0.1, 0.1)}, {elastic(1e6, 0.3, 1000)});
    for (const auto& [name, y, push] : {std::tuple("top", 0.1, -q), std::tuple("base", 0.0, q)}) {
      BoundaryOptions o = load_on({0, y}, {0.1, y}, {0, push}, 0.2);
      o.follows_face = true;
      s.boundaries.push_back({name, o});
    }
    MpmOptions o = options();
    o.shape = shape;
    o.end_at_rest = false;
    Solver solver(o, s, 1);
    solver.advance_to(0.12, silent);
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      EXPECT_NEAR(double(f.field("stress")(k, 1)), -0.6 * q, 0.03 * q) << solver.particles().x0[k].transpose();
      EXPECT_NEAR(double(f.field("stress")(k, 0)), 0, 0.03 * q) << solver.particles().x0[k].transpose();
    }
    EXPECT_LT(std::abs(solver.energy().residual), 0.002 * solver.energy().external) << int(shape);
  }
}

// Two opposite loads on a block that nothing else holds, wherever its faces lie in their cells: as dead loads they add
// up to nothing, by the shape functions' partition of unity, and the block stays where it is. (Faces that leave out a
// row of points, so that the next is up to a side inside, were refused.)
TEST(Tractions, OppositeLoadsDoNotMoveAFreeBlock) {
  constexpr double h = 0.01, q = 5e4;
  for (const double lift : {0.1, 0.3, 0.4}) {
    const double low = lift * h, high = 0.1 + lift * h;
    Scene s = scene(Grid{{-4 * h, -4 * h}, {h, h}, 19, 19}, {rectangle("block", 0, low, 0.1, high)},
                    {elastic(1e6, 0.3, 1000)});
    s.boundaries = {{"top", load_on({0, high}, {0.1, high}, {0, -q}, 0.05)},
                    {"base", load_on({0, low}, {0.1, low}, {0, q}, 0.05)}};
    MpmOptions o = options();
    o.end_at_rest = false;
    Solver solver(o, s, 1);
    solver.advance_to(0.08, silent);
    EXPECT_LT(solver.momentum().norm(), 1e-10 * q * 0.1 * 0.08) << lift;
    EXPECT_NEAR(mean_stress(solver, 1, 0.06, 0.04), -q, 0.02 * q) << lift;
  }
}

// Loads on all four faces of a specimen of 0.1 m: q from above and below within 0.2 s, p from the sides within 0.05 s.
void confine(Scene& s, double q, double p) {
  const auto load = [&](const char* name, Pair from, Pair to, Pair t, double rise) {
    BoundaryOptions o = load_on(from, to, t, rise);
    o.follows_face = true;
    s.boundaries.push_back({name, o});
  };
  load("top", {0, 0.1}, {0.1, 0.1}, {0, -q}, 0.2);
  load("base", {0, 0}, {0.1, 0}, {0, q}, 0.2);
  load("left", {0, 0}, {0, 0.1}, {p, 0}, 0.05);
  load("right", {0.1, 0}, {0.1, 0.1}, {-p, 0}, 0.05);
}

// A free block under pressure from all sides spins on as it was: nodes too light to be unknowns neither turn it nor
// give it energy (with lumped masses of what goes on linearly: 8 % of L and 17 % of the energy in half a turn).
TEST(Tractions, ABlockUnderPressureKeepsItsSpin) {
  constexpr double omega = 20, q = 100;
  Scene s = scene(Grid{{-0.05, -0.05}, {0.01, 0.01}, 21, 21}, {rectangle("block", 0, 0, 0.1, 0.1)},
                  {elastic(1e6, 0.3, 1000)});
  confine(s, q, q);
  for (auto& [name, load] : s.boundaries) load.rise_s = 0.01;
  for (const Vec2& x : s.particles.x0) s.v0.push_back(omega * Vec2(0.05 - x.y(), x.x() - 0.05));
  MpmOptions o = options();
  o.end_at_rest = false;
  o.initial_equilibrium = false;
  Solver solver(o, s, 1);
  const auto moment = [&] {
    const MotionFrame frame = solver.frame();
    double sum = 0;
    for (std::size_t k = 0; k < frame.u.size(); ++k)
      sum += (s.particles.x0[k].x() + double(frame.u[k][0]) - 0.05) * double(frame.v[k][1]) -
             (s.particles.x0[k].y() + double(frame.u[k][1]) - 0.05) * double(frame.v[k][0]);
    return sum;
  };
  solver.advance_to(0.01, silent);
  const double start = moment(), kinetic = solver.energy().kinetic;
  solver.advance_to(0.01 + M_PI / omega, silent);
  EXPECT_NEAR(moment() / start, 1, 2e-3);
  EXPECT_NEAR(solver.energy().kinetic / kinetic, 1, 5e-3);
}

// A specimen that nothing but its cell pressures hold, all around, meeting at its four corners, pressed by a fifth: it stands, and its corners
// bear what its middle bears. (With nodes of next to no mass beyond its faces they wrinkle as it is pressed: 38 % of shear at the corners.)
TEST(Tractions, ASpecimenStaysConfinedOnAllSides) {
  constexpr double h = 0.005, q = 2.9e5, p = 2e4;
  Scene s = scene(Grid{{-5 * h, -5 * h}, {h, h}, 33, 33}, {rectangle("specimen", 0, 0, 0.1, 0.1)}, {elastic(1e6, 0.3, 1000)});
  confine(s, q, p);
  MpmOptions o = options();
  o.damping = 0.3;
  o.end_at_rest = false;
  Solver solver(o, s, 1);
  solver.advance_to(0.32, silent);
  const MotionFrame f = solver.frame();
  double low = 0, high = 0, across = 0, down = 0, shear = 0, across_corner = 0, down_corner = 0, corner = 0;
  const auto n = double(f.u.size());
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const Vec2 X = solver.particles().x0[k];
    const double xx = double(f.field("stress")(k, 0)), yy = double(f.field("stress")(k, 1));
    (X.y() < 0.05 ? low : high) += double(f.u[k][1]) / (n / 2);
    across += xx / n;
    down += yy / n;
    shear = std::max(shear, std::abs(double(f.field("stress")(k, 3))));
    if (std::max(std::abs(X.x() - 0.05), std::abs(X.y() - 0.05)) > 0.05 - h && std::min(std::abs(X.x() - 0.05), std::abs(X.y() - 0.05)) > 0.05 - h) {
      across_corner += xx;
      down_corner += yy;
      ++corner;
      EXPECT_NEAR(yy, -q, 0.03 * q) << X.transpose();
      EXPECT_NEAR(xx, -p, 0.03 * q) << X.transpose();
    }
  }
  EXPECT_EQ(corner, 16);
  EXPECT_GT((low - high) / 0.05, 0.195);
  EXPECT_NEAR(across, -p, 0.01 * p);
  EXPECT_NEAR(down, -q, 0.01 * q);
  EXPECT_NEAR(across_corner / corner, -p, 0.05 * p);
  EXPECT_NEAR(down_corner / corner, -q, 0.01 * q);
  EXPECT_LT(shear, 0.02 * q);
  EXPECT_LT(std::abs(solver.energy().residual), 1e-3 * solver.energy().external);
}

// Its pores full of (soft) water, which stands under no pressure outside: quiet too. (2.6 kPa of shear and growing with
// nodes of next to no mass of their own.)
TEST(Tractions, AWetSpecimenStaysConfinedOnAllSides) {
  constexpr double h = 0.01, q = 2.9e5, p = 2e4;
  MaterialOptions soil = elastic(1e6, 0.3, 0);
  soil.porosity = 0.4;
  soil.grain_density_kg_m3 = 1667;
  soil.permeability_m_s = 1e-4;
  Scene s = scene(Grid{{-4 * h, -4 * h}, {h, h}, 19, 19}, {rectangle("specimen", 0, 0, 0.1, 0.1)}, {soil});
  s.water.emplace();
  s.water->bulk_modulus_pa = 4e6;
  confine(s, q, p);
  MpmOptions o = options();
  o.damping = 0.3;
  o.end_at_rest = false;
  Solver solver(o, s, 1);
  solver.advance_to(0.3, silent);
  const MotionFrame f = solver.frame();
  double shortest = 1, shear = 0;
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    shortest = std::min(shortest, double(f.F[k][3]));
    shear = std::max(shear, std::abs(double(f.field("stress")(k, 3))));
  }
  EXPECT_LT(shortest, 0.87);
  EXPECT_LT(shear, 0.003 * q);
}

// A loaded column on its base between smooth walls: what each does to it, in force and moment.
TEST(Reactions, AreWhatBoundariesBear) {
  Scene s = column(0.1, elastic(1e6, 0.3, 2000));
  s.boundaries[0].second.type = BoundaryType::roller;
  s.boundaries.push_back({"load", load_on({0, 0.1}, {0.1, 0.1}, {0, -500}, 0.2)});
  Solver solver(options({0, -10}), s, 1);
  solver.find_initial_equilibrium(silent);
  const std::vector<std::string> names = solver.reaction_names();
  EXPECT_EQ(names, (std::vector<std::string>{"boundary.base", "boundary.left", "boundary.right", "boundary.load"}));
  std::vector<ReactionRow> rows{solver.reactions()};
  solver.advance_to(0.3, silent);
  rows.push_back(solver.reactions());
  solver.advance_to(0.5, silent);
  rows.push_back(solver.reactions());
  const Reactions r = reactions_of(names, rows);
  const double weight = 2000 * 10 * 0.01, q = 50;
  const auto force = [&](std::size_t k) { return r.series[k].force.back(); };
  EXPECT_NEAR(force(3).y(), -q, 1e-6);
  EXPECT_NEAR(r.series[3].moment.back(), -q * 0.05, 1e-4);
  EXPECT_NEAR(force(0).y(), weight + q, 0.01 * (weight + q));
  EXPECT_NEAR(force(0).x(), 0, 1e-6);
  EXPECT_NEAR(r.series[0].moment.back(), (weight + q) * 0.05, 0.01 * (weight + q) * 0.05);
  const double k0 = 0.3 / 0.7;  // lateral over vertical stress
  EXPECT_NEAR(force(1).x(), k0 * (0.5 * weight + q), 0.03 * k0 * (0.5 * weight + q));
  EXPECT_NEAR(force(1).x() + force(2).x(), 0, 1e-3 * force(1).x());
  EXPECT_NEAR(force(1).y(), 0, 1e-6);
}

// A load on a thin slab that lies on another in contact: the slab bears it, and passes it on. On its first row of points, on a
// line a little off its face, and on a lift that goes, it is neither lost nor kept.
TEST(Tractions, ALoadStaysWithTheBodyThatHasItsFace) {
  const auto base_force = [](double line_y, double removed, bool contact) {
    Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 11, 15}, {rectangle("soil", 0, 0, 0.1, 0.08), rectangle("slab", 0, 0.08, 0.1, 0.1)},
                    {elastic(1e6, 0.3, 1000), elastic(1e6, 0.3, 1000)});
    s.boundaries = column(0.1, s.materials[0]).boundaries;
    s.boundaries.push_back({"load", load_on({0, line_y}, {0.1, line_y}, {0, -500}, 0.05)});
    if (removed > 0) s.materials[1].removed_s = removed;
    if (contact) {
      ContactOptions smooth;
      smooth.regions = {"slab"};
      smooth.friction = 0;
      s.contacts = {{"face", smooth}};
    }
    MpmOptions o = options();
    o.damping = 0.2;
    o.end_at_rest = false;
    Solver solver(o, s, 1);
    solver.advance_to(0.25, silent);
    std::vector<ReactionRow> rows{solver.reactions()};
    solver.advance_to(0.45, silent);
    rows.push_back(solver.reactions());
    double slab = 0, n = 0;
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k)
      if (solver.particles().label[k] == 1) slab += double(f.field("stress")(k, 1)), ++n;
    const Reactions r = reactions_of(solver.reaction_names(), rows);
    return std::array{r.series[0].force.back().y(), r.series.back().force.back().y(), slab / n};
  };
  for (const double off : {0.0, 0.001, -0.001, -0.0025}) {
    const auto [base, load, slab] = base_force(0.1 + off, 0, false);
    EXPECT_NEAR(load, -50, 1e-6) << off;
    EXPECT_NEAR(base, 50, 1) << off;
    EXPECT_NEAR(slab, -500, 100) << off;
  }
  const auto [base, load, slab] = base_force(0.1, 0, true);
  EXPECT_NEAR(base, 50, 1.5);
  EXPECT_NEAR(slab, -500, 50);
  const auto gone = base_force(0.1, 0.1, false);
  EXPECT_NEAR(gone[0], 0, 1);
  EXPECT_NEAR(gone[1], 0, 1e-6);
}

// A strip beyond what softening soil bears: it sinks on, and the sums of its load stay what they are told.
TEST(Tractions, ALoadBeyondTheCapacityRunsOn) {
  MaterialOptions soil = elastic(1.924e6, 0.3, 1996);
  soil.model = "mohr_coulomb";
  soil.friction_deg = 20;
  soil.cohesion_pa = 3000;
  soil.cohesion_residual_pa = 500;
  soil.softening_shape = 5;
  soil.softening_length_m = 0.05;
  soil.softening_average = SofteningAverage::nonlocal;
  Scene s = scene(Grid{{0, 0}, {0.02, 0.02}, 61, 31}, {rectangle("lower", 0.18, 0, 0.76, 0.38)}, {soil});
  s.boundaries = {{"base", line({0, 0}, {1.2, 0}, "fixed")}, {"top", load_on({0.3, 0.38}, {0.5, 0.38}, {0, -15000}, 0)}};
  MpmOptions o = options({0, -9.81});
  o.transfer = TransferKind::xpic;
  o.energy_limit = 10;
  Solver solver(o, s, 1);
  ASSERT_NO_THROW(solver.advance_to(0.4, silent));
  const ReactionRow row = solver.reactions();
  EXPECT_NEAR(row.of[1].impulse.y(), -15000 * 0.2 * row.stepped, 0.02 * 15000 * 0.2 * row.stepped);
}

TEST(Reactions, StayOnceARunHasComeToRest) {
  std::vector<ReactionRow> rows;
  for (const auto& [time, stepped, impulse] : {std::array{0.0, 0.0, 0.0}, {1.0, 1.0, 5.0}, {2.0, 1.5, 8.0}, {3.0, 1.5, 8.0}})
    rows.push_back({time, stepped, {{{0, impulse}, 0, {0, 0}, 0}}});
  const ReactionSeries s = reactions_of({"boundary.base"}, rows).series[0];
  EXPECT_TRUE(std::isnan(s.force[0].y()));
  EXPECT_EQ(s.force[1].y(), 5);
  EXPECT_EQ(s.force[2].y(), 6);
  EXPECT_EQ(s.force[3].y(), 6);
}

// Stress first maps the velocity twice; a wall acts once.
TEST(Reactions, AWallIsCountedOnceByEveryStressUpdate) {
  for (const StressUpdate stress : {StressUpdate::usf, StressUpdate::musl, StressUpdate::usl}) {
    Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 31, 8}, {rectangle("bar", 0, 0, 0.2, 0.05)}, {elastic(1e6, 0.0, 1000)});
    s.boundaries = {{"push", line({0, 0}, {0, 0.06}, "fixed")}};
    s.boundaries[0].second.velocity_m_s = Pair{0.1, 0};
    MpmOptions o = conservative();
    o.stress_update = stress;
    o.energy_limit = 10;
    Solver solver(o, s, 1);
    solver.advance_to(0.008, silent);
    EXPECT_NEAR(solver.reactions().of[0].impulse.x(), solver.momentum().x(), 0.02 * solver.momentum().x()) << int(stress);
  }
}

}  // namespace
}  // namespace pivnp::mpm
