// What bends lose along paths: l^2 times the Laplacian of every increment, carried as the material turns, flagged where
// it matters.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "pivnp/core/error.hpp"
#include "pivnp/np/errors/bend_loss.hpp"
#include "tests/verification/np_testing.hpp"

namespace pivnp::np {
namespace {

namespace bending {

using testing::particles_at;

constexpr double length = 2;  // px

VectorField field(const std::function<Vec2(const Vec2&)>& d, float sigma) {
  VectorField out;
  out.grid = Grid{{0, 0}, {8, 8}, 33, 33};
  for (int j = 0; j < out.grid.ny; ++j)
    for (int i = 0; i < out.grid.nx; ++i) {
      const Vec2 u = d(out.grid.position(i, j));
      out.displacement.push_back({float(u.x()), float(u.y())});
    }
  out.status.assign(out.grid.node_count(), VectorStatus::valid);
  out.cov.assign(out.grid.node_count(), {sigma * sigma, sigma * sigma, 0});
  return out;
}

Vec2 parabola(const Vec2& x) { return {5e-4 * (x.y() - 128) * (x.y() - 128), 0}; }
Vec2 shear(const Vec2& x) { return {0.05 * (x.y() - 128), 0}; }

struct Run {
  Tracker tracker;
  BendLoss lost;
  explicit Run(const std::vector<Vec2>& places) : tracker(NpOptions{}, particles_at(places), 0), lost(places.size()) {}
  void step(const VectorField& field) {
    lost.before_step(tracker);
    tracker.step(field, tracker.time() + 1);
    lost.after_step(tracker, field, length);
  }
  void steps(const VectorField& field, int count) {
    for (int n = 0; n < count; ++n) step(field);
  }
};

}  // namespace bending

TEST(BendLoss, AddsUpAsTheLaplacianDoes) {
  for (const Anchor anchor : {Anchor::forward, Anchor::central}) {
    VectorField field = bending::field(bending::parabola, 0.01f);
    field.anchor = anchor;
    bending::Run run({{60, 100.5}, {60, 128}, {61, 2}});  // the last one beside the border
    run.steps(field, 10);
    for (std::size_t p = 0; p < 3; ++p) {
      EXPECT_NEAR(run.lost.lost(p).x(), 10 * 4 * 1e-3, 1e-5) << p;
      EXPECT_NEAR(run.lost.lost(p).y(), 0, 1e-9) << p;
    }
  }
}

// Those that wait for their time of birth, and those that join: from their birth on.
TEST(BendLoss, KnowsParticlesThatAreBornLater) {
  const VectorField field = bending::field(bending::parabola, 0.01f);
  ParticleSet set = testing::particles_at({{60, 100}, {70, 90}});
  set.born[1] = 4;
  Tracker tracker(NpOptions{}, set, 0);
  BendLoss lost(set.size());
  for (int n = 1; n <= 12; ++n) {
    if (n == 8) tracker.add(testing::particles_at({{80, 110}}));
    lost.before_step(tracker);
    tracker.step(field, n);
    lost.after_step(tracker, field, bending::length);
  }
  const double a_step = 4 * 1e-3;
  EXPECT_NEAR(lost.lost(0).x(), 12 * a_step, 1e-5);
  EXPECT_NEAR(lost.lost(1).x(), 8 * a_step, 1e-5);
  EXPECT_NEAR(lost.lost(2).x(), 5 * a_step, 1e-5);
  std::vector<std::byte> bytes;
  lost.save(bytes);
  BendLoss same(3);
  same.load(bytes);
  EXPECT_EQ(same.lost(2), lost.lost(2));
}

TEST(BendLoss, TurnsWithTheMaterial) {
  const double angle = 1 * M_PI / 180;
  const auto rotation = [&](const Vec2& x) {
    const Vec2 r = x - Vec2(128, 128);
    return Vec2(2 * std::tan(angle / 2) * Vec2(-r.y(), r.x()));
  };
  bending::Run run({{150, 128}});
  run.lost.correct(0, {0.5, 0});
  run.steps(bending::field(rotation, 0.01f), 30);
  EXPECT_NEAR(run.lost.lost(0).x(), 0.5 * std::cos(30 * angle), 0.01);
  EXPECT_NEAR(run.lost.lost(0).y(), 0.5 * std::sin(30 * angle), 0.01);
}

// From c/64 = .125 px on where it is more than half of what is stated; never in even or noisy motion.
TEST(BendLoss, FlagsWhereItPrevails) {
  bending::Run bent({{60, 100}}), noisy({{60, 100}}), even({{60, 100}});
  for (int n = 1; n <= 40; ++n) {
    bent.step(bending::field(bending::parabola, 0.01f));
    noisy.step(bending::field(bending::parabola, 0.1f));
    even.step(bending::field(bending::shear, 0.01f));
    EXPECT_EQ(bent.tracker.state()[0].status, n * 0.004 > 0.125 ? ParticleStatus::flagged : ParticleStatus::active)
        << n;
    EXPECT_EQ(noisy.tracker.state()[0].status, ParticleStatus::active) << n;
    EXPECT_EQ(even.tracker.state()[0].status, ParticleStatus::active) << n;
  }
}

// A cubic y^3 bends evenly more from row to row: F loses l^2 times its third derivative a step, and cov_F gains the square
// of that; where the field bends evenly, nothing, though F turns as material does.
TEST(BendLoss, StatesWhatTheGradientLoses) {
  const auto cubic = [](const Vec2& x) { return Vec2(1e-5 * std::pow(x.y() - 128, 3), 0); };
  const auto gained = [](const std::function<Vec2(const Vec2&)>& d, Anchor anchor, int steps) {
    VectorField field = bending::field(d, 0.01f);
    field.anchor = anchor;
    bending::Run run({{130, 121}});
    Tracker bare(NpOptions{}, testing::particles_at({{130, 121}}), 0);
    run.steps(field, steps);
    for (int n = 1; n <= steps; ++n) bare.step(field, n);
    return run.tracker.state()[0].cov_F[1] - bare.state()[0].cov_F[1];
  };
  for (const Anchor anchor : {Anchor::forward, Anchor::central}) {
    const double a_step = bending::length * bending::length * 6e-5;
    EXPECT_NEAR(std::sqrt(gained(cubic, anchor, 1)), a_step, 0.03 * a_step);
    EXPECT_NEAR(std::sqrt(gained(cubic, anchor, 12)), 12 * a_step, 0.03 * 12 * a_step);
    EXPECT_NEAR(gained(bending::parabola, anchor, 12), 0, 1e-3 * a_step * a_step);
    EXPECT_NEAR(gained(bending::shear, anchor, 12), 0, 1e-3 * a_step * a_step);
  }
}

TEST(BendLoss, GapsAndUnknownErrorsAddNothingThatIsNoNumber) {
  VectorField field = bending::field(bending::parabola, 0.01f);
  const std::size_t hole = field.grid.node(8, 12);
  field.displacement[hole] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::quiet_NaN()};
  field.status[hole] = VectorStatus::rejected;
  bending::Run run({{62, 95}, {70, 97}, {75, 95}});
  run.steps(field, 5);
  for (std::size_t p = 0; p < 3; ++p) EXPECT_NEAR(run.lost.lost(p).x(), 5 * 0.004, 1e-5) << p;
  field.cov.clear();
  bending::Run unknown({{60, 100}});
  unknown.steps(field, 5);
  EXPECT_EQ(unknown.lost.lost(0), Vec2(0, 0));
}

TEST(BendLoss, GoesOnFromItsBytes) {
  bending::Run run({{60, 100}, {70, 90}});
  run.steps(bending::field(bending::parabola, 0.01f), 3);
  std::vector<std::byte> bytes(7);
  run.lost.save(bytes);
  BendLoss same(2), other(3);
  std::vector<std::byte> copy = bytes, none(5);
  same.load(copy);
  EXPECT_EQ(copy.size(), 7u);
  for (std::size_t p = 0; p < 2; ++p) EXPECT_EQ(same.lost(p), run.lost.lost(p));
  EXPECT_THROW(other.load(bytes), InputError);
  EXPECT_THROW(same.load(none), InputError);
}

}  // namespace
}  // namespace pivnp::np
