// How far a bent displacement is from what an affine subset says of it.
#include <gtest/gtest.h>

#include <random>

#include "apps/study/methods/paths/subset_bend.hpp"

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

}  // namespace
}  // namespace pivnp::app
