// The motion that points at rest share.
//   criterion: exact without noise; with a third of the points moving otherwise, off by less than 4 standard errors that it
//     states; a standard error that holds (200 trials, within 25 %).
#include "pivnp/image/camera/similarity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pivnp::image {
namespace similarity_tests {

const Vec2 centre(255.5, 239.5);

CameraMotion truth() { return {centre, {{Vec2(3.2, -1.7), 0.0035, 1.002, 0, 0, 0, 0, 0}}}; }

std::vector<RestPoint> points(const CameraMotion& motion, double noise, int outliers, int seed) {
  std::mt19937 random{std::uint32_t(seed)};
  std::normal_distribution<double> n(0, noise > 0 ? noise : 1);
  std::vector<RestPoint> out;
  for (int k = 0; k < 60; ++k) {
    const Vec2 p(40 + 20 * (k % 6), 20 + 44 * (k / 6));
    Vec2 q = (motion.matrix(0) * Eigen::Vector3d(p.x(), p.y(), 1)).head<2>();
    if (noise > 0) q += Vec2(n(random), n(random));
    if (k % 3 == 0 && k / 3 < outliers) q += Vec2(2.5, 1.0 + 0.1 * k);
    out.push_back({p, q, noise * noise});
  }
  return out;
}

TEST(Similarity, IsExactWithoutNoise) {
  const RestFit fit = fit_rest(points(truth(), 0, 0, 1), MotionModel::similarity, centre, 0.5);
  ASSERT_TRUE(fit.found);
  EXPECT_LT((fit.place.shift - Vec2(3.2, -1.7)).norm(), 1e-10);
  EXPECT_NEAR(fit.place.turn, 0.0035, 1e-12);
  EXPECT_NEAR(fit.place.scale, 1.002, 1e-12);
  const RestFit rigid = fit_rest(points({centre, {{Vec2(1, 2), 0.01, 1}}}, 0, 0, 1), MotionModel::rigid, centre, 0.5);
  EXPECT_EQ(rigid.place.scale, 1.0);
  EXPECT_NEAR(rigid.place.turn, 0.01, 1e-12);
  const RestFit shift = fit_rest(points({centre, {{Vec2(1, 2), 0, 1}}}, 0, 0, 1), MotionModel::shift, centre, 0.5);
  EXPECT_LT((shift.place.shift - Vec2(1, 2)).norm(), 1e-12);
}

TEST(Similarity, LeavesOutWhatMovesOtherwise) {
  const RestFit fit = fit_rest(points(truth(), 0.01, 20, 3), MotionModel::similarity, centre, 0.5);
  ASSERT_TRUE(fit.found);
  EXPECT_EQ(fit.place.agree, 40);
  EXPECT_EQ(fit.place.points, 60);
  EXPECT_LT((fit.place.shift - Vec2(3.2, -1.7)).norm(), 4 * std::sqrt(2 * fit.place.var_shift));
  EXPECT_LT(std::abs(fit.place.turn - 0.0035), 4 * std::sqrt(fit.place.var_turn));
}

TEST(Similarity, StatesItsError) {
  double shift = 0, turn = 0, stated_shift = 0, stated_turn = 0;
  const int trials = 200;
  for (int k = 0; k < trials; ++k) {
    const RestFit fit = fit_rest(points(truth(), 0.02, 0, 100 + k), MotionModel::similarity, centre, 0.5);
    shift += (fit.place.shift - Vec2(3.2, -1.7)).squaredNorm() / 2 / trials;
    turn += std::pow(fit.place.turn - 0.0035, 2) / trials;
    stated_shift += fit.place.var_shift / trials;
    stated_turn += fit.place.var_turn / trials;
  }
  EXPECT_NEAR(std::sqrt(stated_shift / shift), 1, 0.25);
  EXPECT_NEAR(std::sqrt(stated_turn / turn), 1, 0.25);
}

TEST(Similarity, NeedsPoints) {
  const std::vector<RestPoint> one = {{Vec2(1, 1), Vec2(2, 2), 0}};
  EXPECT_FALSE(fit_rest(one, MotionModel::similarity, centre, 0.5).found);
  EXPECT_TRUE(fit_rest(one, MotionModel::shift, centre, 0.5).found);
  EXPECT_FALSE(fit_rest({}, MotionModel::shift, centre, 0.5).found);
}

}  // namespace similarity_tests
}  // namespace pivnp::image
