// Criterion: a wall along the grid holds material alike wherever it lies between lines of nodes, and so do corners.
// Linear fields are exact to round-off. Stresses of rows, 2.5 cells and more below the surface, within 3 % of the
// weight above or a tenth more than with walls on lines; settlement within 2 %; sliding as g (sin t - mu cos t) within
// 1 %; rest stays rest.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "mpm/constraint/restraints.hpp"
#include "mpm/grid/grid_state.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

constexpr double h = 0.02;  // cell, m

// A box of `wide` x `high` cells, its lower left corner off a node by `shift` (cells), on a base of this type.
Scene box_on(const Vec2& shift, int wide, int high, const MaterialOptions& soil, const char* base, double friction) {
  const double x0 = (3 + shift.x()) * h, y0 = (3 + shift.y()) * h;
  Scene s = test::scene(Grid{{0, 0}, {h, h}, wide + 11, high + 8},
                        {test::rectangle("soil", x0, y0, x0 + wide * h, y0 + high * h)}, {soil});
  s.boundaries = {{"base", test::line({0, y0}, {(wide + 10) * h, y0}, base, friction)}};
  return s;
}

void add_sides(Scene& s, const Vec2& shift, double wide, int high) {
  for (const double side : {0.0, wide}) {
    const double x = (3 + shift.x() + side) * h, y0 = (3 + shift.y()) * h;
    s.boundaries.push_back({side == 0 ? "left" : "right", test::line({x, y0}, {x, y0 + (high + 2) * h}, "roller")});
  }
}

// The greatest error of a vertical stress over the weight above, and how far the uppermost row settled.
struct Rows {
  double error = 0, settled = 0, height = 0;
};

Rows rows_of(const Solver& solver, double unit_weight, double bottom) {
  const MotionFrame frame = solver.frame();
  const ParticleSet& p = solver.particles();
  double top = 0, count = 0;
  for (const Vec2& x : p.x0) top = std::max(top, x.y());
  Rows out{0, 0, top + 0.25 * h - bottom};
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    const double depth = bottom + out.height - p.x0[k].y();
    if (depth > 2.5 * h)
      out.error = std::max(out.error, std::abs(-double(frame.field("stress")(k, 1)) / (unit_weight * depth) - 1));
    if (p.x0[k].y() < top - 0.1 * h) continue;
    out.settled -= double(frame.u[k][1]);
    ++count;
  }
  out.settled /= count;
  return out;
}

MpmOptions by(ShapeKind shape, Pair gravity) {
  MpmOptions o = test::options(gravity);
  o.shape = shape;
  o.initial_equilibrium = false;
  return o;
}

TEST(Walls, KeepLinearFieldsWhereverTheyLie) {
  for (const ShapeKind shape : {ShapeKind::bspline, ShapeKind::gimp})
    for (const double s : {-0.49, -0.31, -0.04, 0.17, 0.33, 0.5}) {
      const double left = 3 + s, right = 9 - s, base = 2 - 0.7 * s, top = 8 + 0.6 * s;
      Scene scene =
          test::scene(Grid{{0, 0}, {h, 2 * h}, 13, 11}, {test::rectangle("soil", 4 * h, 8 * h, 5 * h, 10 * h)},
                      {test::elastic(1e6, 0.2, 1700)});
      const auto along = [](double x, double y, double x2, double y2) {
        return test::line({x * h, 2 * y * h}, {x2 * h, 2 * y2 * h}, "roller");
      };
      GridState g(scene.grid, shape);
      const Restraints walls({{"left", along(left, base, left, top)},
                              {"right", along(right, base, right, top)},
                              {"base", along(left, base, right, base)},
                              {"top", along(left, top, right, top)}},
                             g, Vec2(5 * h, 10 * h), [](const Vec2&) { return std::array<double, 2>{}; });
      const std::vector<std::uint8_t> sides = walls.wall_sides(0, g.grid, true);
      g.set_walls(sides, sides, walls.node_shifts(0, g.grid));
      for (double x = left; x <= right; x += (right - left) / 37)
        for (double y = base; y <= top; y += (top - base) / 41) {
          std::int32_t cell = 0;
          double xi = 0, eta = 0, weight[most_stencil_nodes], sum = 0, least = 1;
          std::size_t at[most_stencil_nodes];
          ASSERT_TRUE(g.find(x * h, 2 * y * h, cell, xi, eta));
          g.weights_at(cell, xi, eta, at, weight);
          Vec2 mean(0, 0);
          for (int c = 0; c < g.stencil; ++c) {
            sum += weight[c];
            mean += weight[c] * g.place(at[c]);
            least = std::min(least, weight[c]);
          }
          ASSERT_NEAR(sum, 1, 1e-12);
          ASSERT_LT((mean - Vec2(x * h, 2 * y * h)).norm(), 1e-12)
              << name_of(shape) << " " << s << " at " << x << ", " << y;
          ASSERT_GT(least, -1e-12);
        }
    }
}

TEST(Walls, HoldAColumnWhereverTheyLie) {
  const double density = 1700, young = 2e6, poisson = 0.25, unit = density * 9.81;
  const int high = 12;
  const double modulus = young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson));
  for (const ShapeKind shape : {ShapeKind::bspline, ShapeKind::gimp}) {
    double on_lines = 0;
    for (int tenth = 0; tenth < 10; ++tenth) {
      const Vec2 shift(0.1 * (3 * tenth % 10), 0.1 * tenth);
      MpmOptions o = by(shape, {0, -9.81});
      o.damping = 0.3;
      Scene s = box_on(shift, 3, high, test::elastic(young, poisson, density), tenth % 2 ? "fixed" : "frictional", 0.4);
      add_sides(s, shift, 3, high);
      Solver solver(o, s, 1);
      solver.advance_to(0.25, silent);
      const Rows rows = rows_of(solver, unit, (3 + shift.y()) * h);
      const double exact = 0.5 * unit * std::pow(rows.height, 2) / modulus;
      if (tenth == 0) on_lines = rows.error;
      EXPECT_LT(rows.error, std::max(0.03, 1.1 * on_lines)) << name_of(shape) << " " << tenth;
      EXPECT_NEAR(rows.settled / exact, 1, 0.02) << name_of(shape) << " " << tenth;
    }
  }
}

TEST(Walls, LetABlockSlideByCoulombsLawWhereverTheyLie) {
  const double slope = 0.5, friction = 0.3, g = 9.81, time = 0.12;
  for (const ShapeKind shape : {ShapeKind::bspline, ShapeKind::gimp})
    for (const double shift : {0.0, 0.23, 0.5, 0.81}) {
      Scene s = box_on({0.4, shift}, 6, 3, test::elastic(2e7, 0.25, 1700), "frictional", friction);
      Solver solver(by(shape, {g * std::sin(slope), -g * std::cos(slope)}), s, 1);
      solver.advance_to(time, silent);
      const MotionFrame frame = solver.frame();
      double mean = 0;
      for (std::size_t k = 0; k < frame.u.size(); ++k) mean += double(frame.u[k][0]) / double(frame.u.size());
      EXPECT_NEAR(mean / (0.5 * g * (std::sin(slope) - friction * std::cos(slope)) * time * time), 1, 0.01)
          << name_of(shape) << " " << shift;
    }
}

// From its initial equilibrium.
TEST(Walls, LeaveMaterialAtRestWhereverTheyLie) {
  for (const Vec2& shift : {Vec2(0, 0), Vec2(0.3, 0.3), Vec2(0.65, 0.5), Vec2(0.5, 0.5)}) {
    const int wide = 6, high = 6;
    Scene s = box_on(shift, wide, high, test::sand(34), "fixed", 0);
    add_sides(s, shift, wide, high);
    MpmOptions o = by(ShapeKind::bspline, {0, -9.81});
    o.initial_equilibrium = true;
    Solver solver(o, s, 1);
    solver.find_initial_equilibrium(silent);
    const Rows start = rows_of(solver, 1600 * 9.81, (3 + shift.y()) * h);
    EXPECT_LT(start.error, 0.03) << shift.transpose();
    solver.advance_to(0.05, silent);
    const MotionFrame frame = solver.frame();
    double most = 0;
    for (const auto& u : frame.u) most = std::max(most, std::hypot(double(u[0]), double(u[1])));
    EXPECT_LT(most, 2e-4 * h) << shift.transpose();
  }
}

// These would move nodes that are next to each other, or the same: they stay, and hold the material where they are.
TEST(Walls, WithNoRowOfNodesBetweenThemMoveNone) {
  for (const double wide : {0.6, 1.1, 1.4, 2.3}) {
    Scene s = box_on({0.3, 0}, 1, 3, test::elastic(1e6, 0.2, 1700), "roller", 0);
    add_sides(s, {0.3, 0}, wide, 3);
    GridState g(s.grid, ShapeKind::bspline);
    const Restraints walls(s.boundaries, g, Vec2(3.5 * h, 4 * h), [](const Vec2&) { return std::array<double, 2>{}; });
    EXPECT_EQ(walls.node_shifts(0, g.grid).empty(), wide < 1.2) << wide;
  }
}

}  // namespace
}  // namespace pivnp::mpm
