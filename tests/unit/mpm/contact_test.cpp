// Contact between deformable bodies: whole runs, bits, what is refused.
#include <gtest/gtest.h>

#include <cmath>

#include "mpm/solver/frames.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/contact.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

Scene two_discs(double offset, double density) {
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 61, 41}, {disc("a", {0.15, 0.2}, 0.06), disc("b", {0.4, 0.2 + offset}, 0.06)},
                  {elastic(1e6, 0.3, 1000), elastic(1e6, 0.3, density)});
  for (const std::int32_t label : s.particles.label) s.v0.emplace_back(label == 0 ? 1.0 : -1.0, 0.0);
  s.contacts = {{"discs", between({"a"}, 0.3)}};
  return s;
}

Vec2 mean_velocity(const Solver& solver, int label) {
  const MotionFrame frame = solver.frame();
  Vec2 sum(0, 0);
  double n = 0;
  for (std::size_t k = 0; k < frame.v.size(); ++k)
    if (solver.particles().label[k] == label) {
      sum += Vec2(double(frame.v[k][0]), double(frame.v[k][1]));
      ++n;
    }
  return sum / n;
}

TEST(Contact, DiscsMeetBounceAndPart) {
  for (const bool flip : {false, true})
    for (const double offset : {0.0, 0.05}) {
      SCOPED_TRACE(std::string(flip ? "flip" : "default") + ", offset " + std::to_string(offset));
      MpmOptions o = flip ? conservative() : options();
      if (flip) o.shape = ShapeKind::bspline;
      Solver solver(o, two_discs(offset, 1500), 1);
      const Vec2 before = solver.momentum();
      solver.advance_to(0.06, silent);
      EXPECT_NEAR(mean_velocity(solver, 0).x(), 1, 1e-6);  // before they touch
      solver.advance_to(0.14, silent);
      const double mass = 2500 * 0.0113;
      EXPECT_LT((solver.momentum() - before).norm(), 1e-12 * mass);
      const Vec2 a = mean_velocity(solver, 0), b = mean_velocity(solver, 1);
      EXPECT_LT(a.x(), b.x());  // apart
      if (offset == 0) {
        EXPECT_LT(std::abs(a.y()) + std::abs(b.y()), 0.02);
        EXPECT_LT(a.x(), flip ? -1.2 : -0.9);  // -1.4 without loss, 0.2 at the least
      }
      const EnergyRow e = solver.energy();
      EXPECT_GE(e.contact, 0);
      EXPECT_LT(std::abs(e.residual), 0.05 * 14.1);
    }
}

// Points of one body see no other body's nodes: they pass at a cell's distance without a trace.
TEST(Contact, BodiesThatDoNotTouchDoNotFeelEachOther) {
  Scene s = scene(contact_box, {rectangle("low", 0.1, 0.05, 0.2, 0.1), rectangle("high", 0.1, 0.11, 0.2, 0.16)},
                  {elastic(1e6, 0.3, 1000), elastic(1e6, 0.3, 1000)});
  for (const std::int32_t label : s.particles.label) s.v0.emplace_back(label == 0 ? 0.5 : -0.5, 0.0);
  s.contacts = {{"pass", between({"low"}, std::nullopt)}};
  Solver solver(options(), s, 1);
  solver.advance_to(0.05, silent);
  EXPECT_NEAR(mean_velocity(solver, 0).x(), 0.5, 1e-12);
  EXPECT_EQ(solver.energy().contact, 0);
  s.contacts.clear();  // by common nodes they stick
  Solver one(options(), s, 1);
  one.advance_to(0.05, silent);
  EXPECT_LT(mean_velocity(one, 0).x(), 0.45);
}

TEST(Contact, BitsDoNotDependOnThreadsOrARestart) {
  for (const bool flip : {false, true}) {
    Scene s = pile(0.3);
    s.boundaries = {{"base", line({0.05, 0.05}, {0.35, 0.05}, "fixed")}};
    const MpmOptions o = flip ? conservative({3, -9.81}) : options({3, -9.81});
    Solver one(o, s, 1), two(o, s, 2), again(o, s, 1);
    one.advance_to(0.006, silent);
    two.advance_to(0.006, silent);
    EXPECT_TRUE(one.save() == two.save());
    again.load(one.save());
    one.advance_to(0.012, silent);
    again.advance_to(0.012, silent);
    EXPECT_TRUE(one.save() == again.save());
    EXPECT_GT(one.energy().contact, 0);
    EXPECT_EQ(one.ended(), 0u);
  }
}

// A block laid on a bed sinks by its weight in the initial equilibrium, and stays: no gap, no creep.
TEST(Contact, ABlockSettlesOnItsBed) {
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 31, 16}, {rectangle("bed", 0, 0, 0.3, 0.05), rectangle("block", 0.1, 0.05, 0.2, 0.1)},
                  {elastic(5e6, 0.3, 2000), elastic(2e6, 0.3, 2000)});
  s.boundaries = {{"base", line({0, 0}, {0.3, 0}, "fixed")}};
  s.contacts = {{"block", between({"block"}, 0.3)}};
  MpmOptions o = options({0.5, -9.81});  // less than friction holds
  o.end_at_rest = false;
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  solver.advance_to(0.05, silent);
  const MotionFrame frame = solver.frame();
  double carried = 0;
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    EXPECT_LT(std::abs(frame.u[k][0]) + std::abs(frame.u[k][1]), 1e-5);
    if (std::abs(s.particles.x0[k].y() - 0.0375) < 1e-3) carried += 0.005 * double(frame.field("stress")(k, 1));
  }
  const double weight = 2000 * 9.81 * (0.1 * 0.05 + 0.3 * 0.0125);  // of what lies above
  EXPECT_NEAR(carried, -weight, 0.02 * weight);
  // What the bed does to the block is in the record.
  std::vector<ReactionRow> rows{solver.reactions()};
  solver.advance_to(0.1, silent);
  rows.push_back(solver.reactions());
  const Reactions reactions = reactions_of(solver.reaction_names(), rows);
  ASSERT_EQ(reactions.series.back().name, "contact.block");
  const double mass = 2000 * 0.1 * 0.05;
  const Vec2 force = reactions.series.back().force.back();
  EXPECT_NEAR(force.x(), -0.5 * mass, 1e-3 * 9.81 * mass);
  EXPECT_NEAR(force.y(), 9.81 * mass, 1e-3 * 9.81 * mass);
  // As much back onto the bed, which its base holds.
  EXPECT_NEAR(reactions.series.front().force.back().y(), 9.81 * 2000 * (0.1 * 0.05 + 0.3 * 0.05), 0.01 * weight);
}

// A rigid plate pushes a deformable block over its bed and feels mu times its weight; without friction the block,
// struck once, flies ahead of it.
TEST(Contact, ARigidPlatePushesABlockOverItsBed) {
  for (const double friction : {0.0, 0.3}) {
    Scene s = scene(Grid{{0, 0}, {0.02, 0.02}, 16, 8},
                    {rectangle("bed", 0, 0, 0.3, 0.04), rectangle("block", 0.06, 0.04, 0.16, 0.1)},
                    {elastic(5e5, 0.3, 2000), elastic(5e5, 0.3, 2000)});
    s.boundaries = {{"base", line({0, 0}, {0.3, 0}, "fixed")}};
    s.contacts = {{"face", between({"block"}, friction)}};
    RigidOptions plate;
    plate.polygon_m = {{0.01, 0.045}, {0.057, 0.045}, {0.057, 0.095}, {0.01, 0.095}};
    plate.friction = 0;
    plate.velocity_m_s = {0.2, 0};
    s.bodies = {{"plate", plate}};
    MpmOptions o = options({0, -9.81});
    o.end_at_rest = false;
    Solver solver(o, s, 1);
    solver.find_initial_equilibrium(silent);
    solver.advance_to(0.08, silent);
    const double mass = 2000 * 0.1 * 0.06, first = solver.body_impulse(0).x();
    const auto place = [&] {
      const MotionFrame frame = solver.frame();
      double sum = 0, n = 0;
      for (std::size_t k = 0; k < frame.u.size(); ++k)
        if (s.particles.label[k] == 1) sum += double(frame.u[k][0]), ++n;
      return sum / n;
    };
    const double before = place();
    solver.advance_to(0.2, silent);
    // Between two times at which it moves alike: friction alone.
    const double force = (solver.body_impulse(0).x() - first) / 0.12;
    EXPECT_NEAR(std::abs(force), friction * mass * 9.81, 0.05 * mass * 9.81) << friction;
    const double v = (place() - before) / 0.12;  // (it is struck again and again)
    EXPECT_GT(v, friction > 0 ? 0.18 : 0.25);
    EXPECT_LT(v, friction > 0 ? 0.22 : 0.4);
  }
}

TEST(Contact, BadOnesNameTheirKey) {
  const auto message = [](std::vector<std::pair<std::string, ContactOptions>> contacts) -> std::string {
    Scene s = pile(0.3);
    s.contacts = std::move(contacts);
    try {
      Solver solver(options(), std::move(s), 1);
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      return e.what();
    }
    return "";
  };
  const auto expect = [&](const std::string& found, const std::string& text) {
    EXPECT_NE(found.find(text), std::string::npos) << found;
  };
  EXPECT_EQ(message({{"all", between({"left"}, 0.3)}}), "");
  EXPECT_EQ(message({{"all", between({"left", "right"}, 0.3, {"bed"})}}), "");
  expect(message({{"c", between({}, 0.3)}}), "contact.c.regions");
  expect(message({{"c", between({"lefft"}, 0.3)}}), "did you mean 'left'");
  expect(message({{"c", between({"left"}, -1.0)}}), "contact.c.friction");
  expect(message({{"c", between({"left"}, 0.3, {"left"})}}), "contact.c.against");
  expect(message({{"c", between({"left", "left"}, 0.3)}}), "twice");
  expect(message({{"c", between({"left", "right", "bed"}, 0.3)}}), "no other region");
  expect(message({{"c", between({"left"}, 0.3, {"bed"})}, {"d", between({"left", "right"}, 0.3)}}), "another body");
  expect(message({{"c", between({"left"}, 0.3, {"bed"})}}), "no law");
  expect(message({{"c", between({"left"}, 0.3)}, {"d", between({"right"}, 0.3)}}), "one law");
}

}  // namespace
}  // namespace pivnp::mpm
