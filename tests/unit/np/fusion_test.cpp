// Fusion by least variance, and corrections of a tracker's state.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pivnp/core/error.hpp"
#include "pivnp/np/errors/fusion.hpp"
#include "tests/verification/np_testing.hpp"

namespace pivnp::np {
namespace {

TEST(Fusion, LeastVarianceAndItsOwnEstimateOfIt) {
  const Estimate a{{1, 2}, {4e-4, 1e-4, 5e-5}}, b{{1.01, 1.99}, {1e-4, 9e-4, -1e-4}};
  const Estimate ab = fuse(a, b), ba = fuse(b, a);
  EXPECT_LT((ab.value - ba.value).norm(), 1e-15);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(ab.cov[k], ba.cov[k], 1e-18);
  EXPECT_LT(ab.cov[0], std::min(a.cov[0], b.cov[0]));
  EXPECT_LT(ab.cov[1], std::min(a.cov[1], b.cov[1]));

  std::mt19937 random(4);
  RecordProperty("seed", 4);
  std::normal_distribution<double> normal;
  const auto draw = [&](const std::array<double, 3>& c) {
    const double l = std::sqrt(c[0]), m = c[2] / l, n = std::sqrt(c[1] - m * m), s = normal(random), t = normal(random);
    return Vec2(l * s, m * s + n * t);
  };
  std::array<double, 3> seen{0, 0, 0};
  constexpr int runs = 20000;
  for (int k = 0; k < runs; ++k) {
    const Vec2 e = fuse({draw(a.cov), a.cov}, {draw(b.cov), b.cov}).value;
    seen[0] += e.x() * e.x() / runs, seen[1] += e.y() * e.y() / runs, seen[2] += e.x() * e.y() / runs;
  }
  EXPECT_NEAR(seen[0], ab.cov[0], 0.05 * ab.cov[0]);
  EXPECT_NEAR(seen[1], ab.cov[1], 0.05 * ab.cov[1]);
  EXPECT_NEAR(seen[2], ab.cov[2], 0.05 * std::sqrt(ab.cov[0] * ab.cov[1]));
}

TEST(Fusion, TheSurerOneWins) {
  const Estimate vague{{5, 5}, {1, 1, 0}}, sure{{1, 2}, {1e-12, 1e-12, 0}};
  EXPECT_LT((fuse(vague, sure).value - sure.value).norm(), 1e-10);
  EXPECT_LT((fuse(sure, vague).value - sure.value).norm(), 1e-10);
  const Estimate certain{{3, 4}, {0, 0, 0}};
  EXPECT_EQ(fuse(certain, certain).value, certain.value);
  const Weighted w = fuse(3.0, 1.0);
  EXPECT_DOUBLE_EQ(w.weight, 0.75);
  EXPECT_DOUBLE_EQ(w.variance, 0.75);
  EXPECT_DOUBLE_EQ(fuse(0.0, 0.0).weight, 1);
}

TEST(Fusion, DisagreementIsChiSquared) {
  EXPECT_DOUBLE_EQ(disagreement({{0, 0}, {1, 1, 0}}, {{2, 0}, {3, 1, 0}}), 1);
  EXPECT_EQ(disagreement({{1, 1}, {0, 0, 0}}, {{1, 1}, {0, 0, 0}}), 0);
  EXPECT_TRUE(std::isinf(disagreement({{1, 1}, {0, 0, 0}}, {{1, 2}, {0, 0, 0}})));
}

TEST(Correction, MovesLivingParticlesOnlyAndRefusesWhatIsNoState) {
  const Grid grid{{0, 0}, {1, 1}, 5, 5};
  Tracker tracker({}, testing::particles_at({{2, 2}, {3.9, 2}}), 0);
  const NodalIncrements right = sample_increments(AffineMotion::rotation(0, {0, 0}, {0.3, 0}), grid, Anchor::central, 0, 1);
  tracker.step(right, 1);  // the second one's mid-point is outside
  tracker.correct(0, {{2.5, 2.1}, 1.1 * Mat2::Identity(), {1, 2, 0.5}});
  tracker.correct(1, {{1, 1}, Mat2::Identity()});
  EXPECT_EQ(tracker.state()[0].x, Vec2(2.5, 2.1));
  EXPECT_EQ(tracker.state()[0].cov[1], 2);
  EXPECT_EQ(tracker.state()[1].x, Vec2(3.9, 2));
  EXPECT_EQ(tracker.state()[0].status, ParticleStatus::active);
  tracker.flag(0);
  EXPECT_EQ(tracker.state()[0].status, ParticleStatus::flagged);
  EXPECT_THROW(tracker.correct(0, {{std::nan(""), 0}, Mat2::Identity()}), InputError);
  Mat2 inside_out = Mat2::Identity();
  inside_out(0, 0) = -1;
  EXPECT_THROW(tracker.correct(0, {{1, 1}, inside_out}), InputError);
  EXPECT_EQ(tracker.state()[0].x, Vec2(2.5, 2.1));
}

}  // namespace
}  // namespace pivnp::np
