// Tied sides: a piece of an endless slope between two sides that move as one.
#include <gtest/gtest.h>

#include <cmath>

#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

BoundaryOptions tied(Pair a, Pair b, Pair across) {
  BoundaryOptions o = line(a, b, "tied");
  o.across_m = across;
  return o;
}

// A layer that flies sideways between tied sides goes on for ever: nothing strains it, displacements count on.
TEST(TiedSides, CarryMaterialOver) {
  for (const bool flip : {false, true}) {
    Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 7, 12}, {rectangle("layer", 0.01, 0.02, 0.05, 0.08)},
                    {elastic(1e5, 0.3, 1500)});
    s.v0.assign(s.particles.size(), Vec2(0.8, 0.1));
    s.boundaries = {{"sides", tied({0.01, 0}, {0.01, 0.11}, {0.04, 0})}};
    MpmOptions o = flip ? conservative() : options();
    if (flip) o.shape = ShapeKind::bspline;
    Solver solver(o, s, 1);
    solver.advance_to(0.04, silent);
    const std::vector<std::byte> half = solver.save();
    solver.advance_to(0.08, silent);
    const MotionFrame frame = solver.frame();
    for (std::size_t k = 0; k < frame.u.size(); ++k) {
      ASSERT_NEAR(frame.u[k][0], 0.064, 1e-5);
      ASSERT_NEAR(frame.u[k][1], 0.008, 1e-5);
      ASSERT_LT(std::abs(frame.field("stress")(k, 0)), 1.0);  // rho c v: 9e3
    }
    Solver again(o, s, 2);
    again.load(half);
    again.advance_to(0.08, silent);
    EXPECT_TRUE(again.save() == solver.save());
  }
}

TEST(TiedSides, HoldTheStressesOfAnEndlessSlope) {
  const double t = 20 * M_PI / 180, height = 0.1;
  Scene s =
      scene(Grid{{0, 0}, {0.01, 0.01}, 5, 14}, {rectangle("soil", 0, 0, 0.04, height)}, {elastic(5e6, 0.3, 1600)});
  s.boundaries = {{"base", line({0, 0}, {0.04, 0}, "fixed")}, {"sides", tied({0, 0}, {0, 0.12}, {0.04, 0})}};
  Solver solver(options({9.81 * std::sin(t), -9.81 * std::cos(t)}), s, 1);
  solver.find_initial_equilibrium(silent);
  const MotionFrame frame = solver.frame();
  const double weight = 1600 * 9.81 * height;
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    const double above = 1 - s.particles.x0[k].y() / height;
    EXPECT_NEAR(frame.field("stress")(k, 1), -weight * above * std::cos(t), 0.02 * weight);
    EXPECT_NEAR(frame.field("stress")(k, 3), weight * above * std::sin(t), 0.02 * weight);
    EXPECT_NEAR(frame.field("stress")(k, 0), -weight * above * std::cos(t) * 0.3 / 0.7, 0.02 * weight);
  }
}

// A column under its weight, carried along at constant speed: it stays as it is wherever its points lie between the nodes. (Where three-node
// shapes end at the sides, its rows part by tens of percent before their points have crossed a cell.)
TEST(TiedSides, CarriedSoilKeepsItsStress) {
  const double gravity = 10, density = 2000, height = 8;
  for (const ShapeKind shape : {ShapeKind::gimp, ShapeKind::bspline})
    for (const TransferKind transfer : {TransferKind::apic, TransferKind::flip})
      for (const int wide : {1, 2, 3}) {
        Scene s = scene(Grid{{0, 0}, {1, 1}, wide + 1, 11}, {rectangle("soil", 0, 0, wide, height)}, {elastic(4e8, 0.3, density)});
        s.boundaries = {{"floor", line({0, 0}, {double(wide), 0}, "roller")}, {"sides", tied({0, 0}, {0, 10}, {double(wide), 0})}};
        for (const Vec2& x : s.particles.x0) {
          const double over = density * gravity * (height - x.y());
          s.stress0.push_back({-over, -over, -over, 0});
        }
        s.v0.assign(s.particles.size(), Vec2(1, 0));
        MpmOptions o = options({0, -gravity});
        o.initial_equilibrium = o.end_at_rest = false;
        o.shape = shape;
        o.transfer = transfer;
        Solver solver(o, s, 1);
        solver.advance_to(0.6, silent);
        const MotionFrame frame = solver.frame();
        for (std::size_t k = 0; k < frame.u.size(); ++k) {
          ASSERT_NEAR(frame.u[k][0], 0.6, 1e-4);
          double mean[2] = {}, row = 0;
          for (std::size_t other = 0; other < frame.u.size(); ++other) {
            if (std::abs(s.particles.x0[other].y() - s.particles.x0[k].y()) > 0.1) continue;
            for (const std::size_t c : {0, 1}) mean[c] += frame.field("stress")(other, c);
            ++row;
          }
          for (const std::size_t c : {0, 1})
            ASSERT_NEAR(frame.field("stress")(k, c), mean[c] / row, 2e-3 * density * gravity * height)
                << name_of(shape) << ' ' << name_of(transfer) << ", " << wide << " cells, point " << k;
        }
      }
}

// A layer inclined to the grid, whose opposite side is shifted by as much as it rises: it flies along itself, and nothing strains it.
TEST(TiedSides, ShiftedOnesCarryWhatIsInclined) {
  const int along = 4, up = 1;
  const Vec2 direction = Vec2(along, up).normalized();
  for (const ShapeKind shape : {ShapeKind::gimp, ShapeKind::bspline})
    for (const TransferKind transfer : {TransferKind::apic, TransferKind::flip}) {
      const double high = 8;
      Scene s = scene(Grid{{0, 0}, {1, 1}, along + 1, 16}, {{"soil", Polygon({{0, 3}, {along, 3 + up}, {along, high + up}, {0, high}}, "soil")}}, {elastic(4e8, 0.3, 2000)});
      s.boundaries = {{"sides", tied({0, 0}, {0, 13}, {along, up})}};
      s.v0.assign(s.particles.size(), direction);
      MpmOptions o = options({0, 0});
      o.initial_equilibrium = o.end_at_rest = false;
      o.shape = shape;
      o.transfer = transfer;
      Solver solver(o, s, 1);
      solver.advance_to(1.5, silent);
      const MotionFrame frame = solver.frame();
      for (std::size_t k = 0; k < frame.u.size(); ++k) {
        ASSERT_NEAR(frame.u[k][0], 1.5 * direction.x(), 1e-6) << name_of(shape) << ' ' << name_of(transfer);
        ASSERT_NEAR(frame.u[k][1], 1.5 * direction.y(), 1e-6);
        for (const std::size_t c : {0, 1, 3}) ASSERT_LT(std::abs(frame.field("stress")(k, c)), 1e-3);  // rho c v: 1e6
      }
    }
}

TEST(TiedSides, BadOnesNameTheirKey) {
  const auto message = [](const BoundaryOptions& sides) -> std::string {
    Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 5, 14}, {rectangle("soil", 0, 0, 0.04, 0.1)}, {elastic(5e6, 0.3, 1600)});
    s.boundaries = {{"sides", sides}};
    try {
      Solver solver(options(), s, 1);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const auto expect = [&](const BoundaryOptions& sides, const std::string& text) {
    EXPECT_NE(message(sides).find(text), std::string::npos) << message(sides);
  };
  EXPECT_EQ(message(tied({0, 0}, {0, 0.12}, {0.04, 0})), "");
  expect(line({0, 0}, {0, 0.12}, "tied"), "across_m: missing");
  BoundaryOptions roller = tied({0, 0}, {0, 0.12}, {0.04, 0});
  roller.type = BoundaryType::roller;
  expect(roller, "expected type = \"tied\"");
  expect(tied({0, 0}, {0, 0.12}, {0.033, 0}), "along the grid");
  expect(tied({0, 0}, {0.01, 0.12}, {0.04, 0}), "along the grid");
}

}  // namespace
}  // namespace pivnp::mpm
