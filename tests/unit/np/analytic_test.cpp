// The ground truth checked against itself: increments are differences of places, F is the gradient of places.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include "pivnp/np/analytic.hpp"

namespace pivnp::np {
namespace {

std::vector<std::shared_ptr<AnalyticMotion>> motions() {
  return {std::make_shared<AffineMotion>(AffineMotion::extension(0.016, 0.3)),
          std::make_shared<AffineMotion>(AffineMotion::shear(0.2, -0.5)),
          std::make_shared<AffineMotion>(AffineMotion::rotation(0.1, {0.2, 0.4}, {0.05, -0.02})),
          std::make_shared<ReversingVortex>(Vec2(0.5, 0.5), 0.4, 2.0, 12),
          std::make_shared<ShearBand>(0.1, 0.45, 0.2)};
}

TEST(Analytic, IncrementsBelongToTheirAnchor) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const auto& motion : motions())
    for (int trial = 0; trial < 200; ++trial) {
      const Vec2 X(unit(random), unit(random));
      const double t0 = 10 * unit(random), t1 = t0 + unit(random);
      const Vec2 x0 = motion->position(X, t0), x1 = motion->position(X, t1);
      EXPECT_LT((motion->forward_increment(x0, t0, t1) - (x1 - x0)).norm(), 1e-13);
      EXPECT_LT((motion->central_increment((x0 + x1) / 2, t0, t1) - (x1 - x0)).norm(), 1e-13);
    }
}

TEST(Analytic, DeformationIsTheGradientOfPlaces) {
  constexpr double h = 1e-5;
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const auto& motion : motions())
    for (int trial = 0; trial < 100; ++trial) {
      const Vec2 X(unit(random), unit(random));
      const double t = 12 * unit(random);
      Mat2 numeric;
      numeric.col(0) = (motion->position(X + Vec2(h, 0), t) - motion->position(X - Vec2(h, 0), t)) / (2 * h);
      numeric.col(1) = (motion->position(X + Vec2(0, h), t) - motion->position(X - Vec2(0, h), t)) / (2 * h);
      EXPECT_LT((motion->deformation(X, t) - numeric).norm(), 1e-7);
    }
}

TEST(Analytic, TheVortexReturnsAndKeepsAreas) {
  const ReversingVortex vortex({0.5, 0.5}, 0.4, 2.0, 12);
  for (const double t : {2.0, 6.0, 11.0}) {
    const Mat2 F = vortex.deformation({0.7, 0.6}, t);
    EXPECT_NEAR(F(0, 0) * F(1, 1) - F(0, 1) * F(1, 0), 1, 1e-14);
  }
  EXPECT_LT((vortex.position({0.7, 0.6}, 12) - Vec2(0.7, 0.6)).norm(), 1e-15);
  EXPECT_GT((vortex.position({0.7, 0.6}, 6) - Vec2(0.7, 0.6)).norm(), 0.1);
}

TEST(Analytic, FieldsAreSampledAtNodesInOrder) {
  const Grid grid{{1, 2}, {0.5, 0.25}, 4, 3};
  const AffineMotion shear = AffineMotion::shear(0.1, 2);
  const NodalIncrements d = sample_increments(shear, grid, Anchor::forward, 0, 1);
  ASSERT_EQ(d.displacement.size(), 12u);
  EXPECT_NEAR(d.displacement[grid.node(3, 2)][0], 0.1 * 0.5, 1e-15);
  EXPECT_EQ(d.displacement[grid.node(3, 2)][1], 0);
  NodalIncrements lossy = d;
  lossy.status[2] = VectorStatus::failed;
  const VectorField single = vector_field(lossy, {3, 5});
  EXPECT_EQ(single.pair[1], 5);
  EXPECT_EQ(single.anchor, Anchor::forward);
  EXPECT_NEAR(single.displacement[grid.node(3, 2)][0], 0.05f, 1e-8);
  EXPECT_TRUE(std::isnan(single.score[2]));
  EXPECT_EQ(single.score[3], 1.0f);
}

}  // namespace
}  // namespace pivnp::np
