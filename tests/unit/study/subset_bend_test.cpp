// How far a bent displacement is from what an affine subset says of it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "apps/study/methods/paths/subset_bend.hpp"
#include "apps/study/methods/paths/unseen_error.hpp"

namespace pivnp::app {
namespace {

namespace subset_bend {

constexpr double half_side = 16.5;

// Places so far apart and where they go: u = bend x^2 / 2 along x, on top of an affine motion.
struct Bent {
  std::vector<Vec2> from, to;
  std::vector<Mat2> A;
};
Bent bent(double bend, double noise, int apart) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 1);
  Bent out;
  for (double y = 0; y < 120; y += apart)
    for (double x = 0; x < 120; x += apart) {
      const Vec2 place(x + 300, y + 200);
      Mat2 A;
      A << 1.05 + bend * (x - 60), .1, -.02, .97;
      out.from.push_back(place);
      const double u = .05 * x + .1 * y + bend * (x - 60) * (x - 60) / 2;
      out.to.push_back(place + Vec2(u, -.02 * x - .03 * y) + noise * Vec2(normal(random), normal(random)));
      out.A.push_back(A);
    }
  return out;
}

}  // namespace subset_bend

// a^2/6 times the Laplacian, a half the side of an evenly filled subset.
TEST(SubsetBend, IsASixthOfTheSquareOfHalfTheSideTimesTheLaplacian) {
  using namespace subset_bend;
  const Bent b = bent(.01, 0, 1);
  const std::vector<SubsetBend> bends = subset_bends(b.from, b.to, b.A, half_side, 2);
  const std::size_t middle = 60 * 120 + 60;
  const double expected = half_side * half_side / 6 * .01;
  EXPECT_NEAR(bends[middle].place.x(), expected, .02 * expected);
  EXPECT_NEAR(bends[middle].place.y(), 0, 1e-9);
  EXPECT_NEAR(bends[middle].gradient, 0, 1e-9);  // even about the centre
  EXPECT_NEAR(bends[middle].bend(0, 0), .005, 1e-9);  // half the curvature, on x^2
  EXPECT_NEAR(bends[middle].bend.norm(), .005, 1e-9);
  EXPECT_NEAR(bends[middle].left.norm(), 0, 1e-6);
  // At the rim the subset is half empty, and its fit is bent the more in its gradient.
  EXPECT_GT(bends[60 * 120].gradient, .02);
}

TEST(SubsetBend, NoiseOfPredictionsIsNoBend) {
  using namespace subset_bend;
  const Bent b = bent(0, .05, 4);
  double square = 0;
  const std::vector<SubsetBend> bends = subset_bends(b.from, b.to, b.A, half_side, 1);
  std::size_t count = 0;
  double left = 0;
  for (std::size_t j = 6; j < 24; ++j)
    for (std::size_t i = 6; i < 24; ++i)
      square += bends[j * 30 + i].place.squaredNorm() / 2, left += bends[j * 30 + i].left.squaredNorm() / 2, ++count;
  EXPECT_LT(std::sqrt(square / double(count)), .02);
  EXPECT_NEAR(std::sqrt(left / double(count)), .05, .005);
}

TEST(SubsetBend, TooFewSayNothing) {
  const std::vector<Vec2> from = {{0, 0}, {4, 0}, {8, 0}}, to = {{0, 0}, {4, 9}, {8, 0}};
  for (const SubsetBend& b : subset_bends(from, to, {3, Mat2::Identity()}, 16, 1)) EXPECT_EQ(b.place.norm(), 0);
  EXPECT_TRUE(subset_bends({}, {}, {}, 16, 1).empty());
}

// Fits to drawn errors of known correlation miss what unseen_shares() says of them: variances of the quadratic fit less
// the affine one and of the error less the quadratic fit, and their covariance. Of eight fields of 200 px, to a few
// hundredths.
TEST(UnseenShares, AreWhatFitsMissOfDrawnErrors) {
  constexpr int waves = 150, fields = 4;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1);
  for (const double alike : {5.0, 7.2, 12.0}) {
    UnseenShares found;
    double count = 0;
    for (int n = 0; n < fields; ++n) {
      std::array<std::vector<std::array<double, 3>>, 2> modes;
      for (auto& of : modes)
        for (int k = 0; k < waves; ++k)
          of.push_back(
              {normal(random) / alike, normal(random) / alike, 2 * M_PI * std::generate_canonical<double, 53>(random)});
      std::vector<Vec2> from, to;
      for (double y = 0; y < 200; y += 4)
        for (double x = 0; x < 200; x += 4) {
          Vec2 e(0, 0);
          for (int c = 0; c < 2; ++c)
            for (const auto& [p, q, phase] : modes[std::size_t(c)]) e[c] += std::cos(p * x + q * y + phase);
          from.emplace_back(x, y), to.push_back(Vec2(x, y) + std::sqrt(2.0 / waves) * e);
        }
      const std::vector<SubsetBend> bends =
          subset_bends(from, to, std::vector<Mat2>(from.size(), Mat2::Identity()), 16.5, 2);
      for (std::size_t k = 0; k < from.size(); ++k) {
        if (!((from[k] - Vec2(100, 100)).cwiseAbs().maxCoeff() < 82)) continue;
        found.bend += bends[k].place.squaredNorm(), found.mixed += bends[k].place.dot(bends[k].centre),
            found.beyond += bends[k].centre.squaredNorm(), count += 2;
      }
    }
    const UnseenShares shares = unseen_shares(16.5, alike);
    EXPECT_NEAR(found.bend / count, shares.bend, .03) << alike;
    EXPECT_NEAR(found.mixed / count, shares.mixed, .03) << alike;
    EXPECT_NEAR(found.beyond / count, shares.beyond, .07) << alike;  // places 4 px apart
    EXPECT_GT(shares.bend + 2 * shares.mixed + shares.beyond, alike < 8 ? .5 : .2) << alike;
  }
  EXPECT_EQ(unseen_shares(16.5, 0).bend, 0);       // not known
  EXPECT_LT(unseen_shares(16.5, 200).bend, 1e-4);  // as good as affine
}

}  // namespace
}  // namespace pivnp::app
