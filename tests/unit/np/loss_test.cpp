// How particles are lost, and how they are not: borders, holes, replaced vectors, folded material.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/verification/np_testing.hpp"

namespace pivnp::np {
namespace {

using namespace testing;

const Grid grid{{0, 0}, {1, 1}, 9, 9};

NodalIncrements shift(double dx, double dy, Anchor anchor = Anchor::central) {
  return sample_increments(AffineMotion::rotation(0, Vec2::Zero(), {dx, dy}), grid, anchor, 0, 1);
}

void lose(NodalIncrements& d, int i, int j, VectorStatus status) {
  d.status[d.grid.node(i, j)] = status;
  if (status == VectorStatus::failed) d.displacement[d.grid.node(i, j)].fill(std::nan(""));
  if (status == VectorStatus::rejected) d.displacement[d.grid.node(i, j)] = {1e3, -1e3};
}

TEST(Loss, AParticleThatLeavesEndsAtItsLastGoodTime) {
  for (const Anchor anchor : {Anchor::forward, Anchor::central}) {
    Tracker tracker(bilinear(), particles_at({{7.5, 4}, {4, 4}}), 10);
    const auto step = [&](double t) { tracker.step(shift(0.4, 0, anchor), t); };
    step(11);  // 7.9
    EXPECT_EQ(tracker.state()[0].status, ParticleStatus::active);
    step(12);  // forward: read at 7.9, now at 8.3; central: the mid-point 8.1 is out
    if (anchor == Anchor::forward) {
      EXPECT_EQ(tracker.state()[0].status, ParticleStatus::active);
      EXPECT_NEAR(tracker.state()[0].x.x(), 8.3, 1e-14);
      step(13);
    }
    const double last = anchor == Anchor::forward ? 12 : 11;
    EXPECT_EQ(tracker.state()[0].status, ParticleStatus::ended);
    EXPECT_EQ(tracker.particles().end_reason[0], EndReason::left_grid);
    EXPECT_EQ(tracker.particles().end[0], last);
    const double x = tracker.state()[0].x.x();
    step(14);
    EXPECT_EQ(tracker.state()[0].x.x(), x);  // keeps its last good place
    EXPECT_EQ(tracker.particles().end[0], last);
    EXPECT_NEAR(tracker.frame().u[0][0], x - 7.5, 1e-6);
    EXPECT_EQ(tracker.state()[1].status, ParticleStatus::active);
    EXPECT_TRUE(std::isnan(tracker.particles().end[1]));
    EXPECT_EQ(tracker.particles().end_reason[1], EndReason::none);
  }
}

TEST(Loss, OnTheBorderIsInside) {
  Tracker tracker(bilinear(), particles_at({{8, 8}, {0, 0}, {8, 3}}), 0);
  tracker.step(shift(0, 0), 1);
  for (std::size_t p = 0; p < 3; ++p) EXPECT_EQ(tracker.state()[p].status, ParticleStatus::active);
  Tracker outside(bilinear(), particles_at({{8.001, 8}}), 0);
  outside.step(shift(0, 0), 1);
  EXPECT_EQ(outside.particles().end_reason[0], EndReason::left_grid);
  EXPECT_EQ(outside.particles().end[0], 0);
}

TEST(Loss, AHoleInAnAffineFieldIsBridgedExactly) {
  const AffineMotion motion([](double t) {
    AffineMap map;
    map.A << 1 + 0.03 * t, 0.02 * t, -0.05 * t, 1 - 0.01 * t;
    map.b = Vec2(0.1, -0.2) * t;
    return map;
  });
  for (const VectorStatus lost : {VectorStatus::masked, VectorStatus::rejected, VectorStatus::failed})
    for (const Anchor anchor : {Anchor::forward, Anchor::central}) {
      NodalIncrements d = sample_increments(motion, grid, anchor, 0, 1);
      for (int j : {4, 5})
        for (int i : {4, 5}) lose(d, i, j, lost);
      Tracker tracker(bilinear(), block(grid, {1, 1}, {7, 7}, 9), 0);
      tracker.step(d, 1);
      std::size_t flagged = 0;
      for (std::size_t p = 0; p < tracker.state().size(); ++p) {
        const auto now = tracker.state()[p];
        const Vec2& X = tracker.particles().x0[p];
        ASSERT_NE(now.status, ParticleStatus::ended);
        flagged += now.status == ParticleStatus::flagged;
        EXPECT_LT((now.x - motion.position(X, 1)).norm(), 1e-13);
        EXPECT_LT((now.F - motion.deformation(X, 1)).norm(), 1e-13);
        const Vec2 at = anchor == Anchor::forward ? X : Vec2((X + now.x) / 2);
        const bool in_hole = (at.array() > 3).all() && (at.array() < 6).all();
        EXPECT_EQ(now.status, in_hole ? ParticleStatus::flagged : ParticleStatus::active) << at.transpose();
      }
      EXPECT_GT(flagged, 50u);
    }
}

TEST(Loss, AValidVectorThatIsNoNumberIsNotUsed) {
  NodalIncrements d = shift(0.1, 0);
  d.displacement[grid.node(4, 4)] = {std::nan(""), 0};
  d.displacement[grid.node(5, 4)] = {0, INFINITY};
  Tracker tracker(bilinear(), particles_at({{4.5, 4.5}}), 0);
  tracker.step(d, 1);
  EXPECT_EQ(tracker.state()[0].status, ParticleStatus::flagged);
  EXPECT_NEAR(tracker.state()[0].x.x(), 4.6, 1e-14);
}

TEST(Loss, TooFewNodesEndTheParticle) {
  for (const Anchor anchor : {Anchor::forward, Anchor::central}) {
    Tracker tracker(bilinear(), particles_at({{4.5, 4.5}, {2.5, 4.5}, {1.5, 4.5}, {0.5, 4.5}}), 0);
    tracker.step(shift(0.01, 0, anchor), 1);
    NodalIncrements d = shift(0.01, 0, anchor);
    for (int j = 0; j < 9; ++j)
      for (int i = 2; i < 9; ++i) lose(d, i, j, VectorStatus::failed);
    tracker.step(d, 2);
    // Nodes are left at x = 0 and 1: by 4.5 there is none; from 2.5 only the line x = 1 is seen; 1.5 rests on a fit.
    for (const std::size_t p : {0u, 1u}) {
      EXPECT_EQ(tracker.state()[p].status, ParticleStatus::ended);
      EXPECT_EQ(tracker.particles().end_reason[p], EndReason::no_vectors);
      EXPECT_EQ(tracker.particles().end[p], 1);
      EXPECT_NEAR(tracker.state()[p].x.x(), tracker.particles().x0[p].x() + 0.01, 1e-14);
    }
    EXPECT_EQ(tracker.state()[2].status, ParticleStatus::flagged);
    EXPECT_NEAR(tracker.state()[2].x.x(), 1.52, 1e-14);
    EXPECT_EQ(tracker.state()[3].status, ParticleStatus::active);
  }
}

TEST(Loss, ExtrapolationIsBounded) {
  // Two rows are left below the particle's element, none in it: near them yes, a diagonal away no.
  NodalIncrements d = shift(0, 0);
  for (int j = 4; j < 9; ++j)
    for (int i = 0; i < 9; ++i) lose(d, i, j, VectorStatus::masked);
  Tracker tracker(bilinear(), particles_at({{4.5, 3.2}, {4.0, 3.95}, {4.5, 4.3}, {4.5, 4.9}}), 0);
  tracker.step(d, 1);
  EXPECT_EQ(tracker.state()[0].status, ParticleStatus::flagged);
  EXPECT_EQ(tracker.state()[1].status, ParticleStatus::flagged);
  EXPECT_EQ(tracker.particles().end_reason[2], EndReason::no_vectors);  // sees a single row: no gradient across it
  EXPECT_EQ(tracker.particles().end_reason[3], EndReason::no_vectors);
}

TEST(Loss, ReplacedVectorsFlagThatStep) {
  NodalIncrements replaced = shift(0.01, 0);
  lose(replaced, 4, 4, VectorStatus::replaced);
  Tracker tracker(bilinear(), particles_at({{4.5, 4.5}, {6.5, 4.5}}), 0);
  tracker.step(replaced, 1);
  EXPECT_EQ(tracker.state()[0].status, ParticleStatus::flagged);
  EXPECT_EQ(tracker.state()[1].status, ParticleStatus::active);
  tracker.step(shift(0.01, 0), 2);
  EXPECT_EQ(tracker.state()[0].status, ParticleStatus::active);
}

TEST(Loss, FoldedMaterialEnds) {
  // Forward: 1 + G_xx = -0.2. Central: I - G/2 turns over at G = 2.
  const auto stretched = [](double g, Anchor anchor) {
    NodalIncrements d = shift(0, 0, anchor);
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) d.displacement[grid.node(i, j)] = {g * (i - 4.0), 0};
    return d;
  };
  for (const auto& [g, anchor] : {std::pair{-1.2, Anchor::forward}, std::pair{-1.0, Anchor::forward},
                                  std::pair{2.5, Anchor::central}, std::pair{-2.5, Anchor::central}}) {
    SCOPED_TRACE(g);
    Tracker tracker(bilinear(), particles_at({{4.1, 4.5}}), 0);
    tracker.step(shift(0, 0.1), 1);
    tracker.step(stretched(g, anchor), 2);
    EXPECT_EQ(tracker.state()[0].status, ParticleStatus::ended);
    EXPECT_EQ(tracker.particles().end_reason[0], EndReason::bad_state);
    EXPECT_EQ(tracker.particles().end[0], 1);
    EXPECT_EQ(tracker.state()[0].F, Mat2::Identity());
    EXPECT_NEAR(tracker.state()[0].x.y(), 4.6, 1e-14);
  }
}

TEST(Loss, AHugeVectorDoesNoHarm) {
  for (const Anchor anchor : {Anchor::forward, Anchor::central})
    for (const double size : {1e30, -1e300, 1.7e308}) {
      NodalIncrements d = shift(0, 0, anchor);
      d.displacement[grid.node(4, 4)] = {size, -size};
      Tracker tracker(bilinear(), block(grid, {0, 0}, {8, 8}, 4), 0);
      tracker.step(d, 1);
      for (std::size_t p = 0; p < tracker.state().size(); ++p) {
        const auto now = tracker.state()[p];
        EXPECT_TRUE(now.x.allFinite() && now.F.allFinite());
        EXPECT_GT(J(now.F), 0);
      }
      EXPECT_EQ(tracker.state()[0].status, ParticleStatus::active);  // far away
    }
}

TEST(Loss, AlreadyEndedParticlesStayEnded) {
  ParticleSet set = particles_at({{4, 4}});
  set.end[0] = -1;
  set.end_reason[0] = EndReason::left_image;
  Tracker tracker(bilinear(), set, 0);
  tracker.step(shift(0.1, 0), 1);
  EXPECT_EQ(tracker.state()[0].status, ParticleStatus::ended);
  EXPECT_EQ(tracker.particles().end[0], -1);
  EXPECT_EQ(tracker.state()[0].x, Vec2(4, 4));
}

}  // namespace
}  // namespace pivnp::np
