// The affine fit that stands in where an element has lost nodes.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "pivnp/np/local_fit.hpp"

namespace pivnp::np {
namespace {

std::uint16_t nodes_of(std::initializer_list<int> list) {
  std::uint16_t bits = 0;
  for (int k : list) bits = std::uint16_t(bits | 1u << k);
  return bits;
}

std::array<std::array<double, 2>, 16> values_of(const auto& field) {
  std::array<std::array<double, 2>, 16> values;
  for (int k = 0; k < 16; ++k) {
    const Vec2 v = field(LocalFit::place(k));
    values[std::size_t(k)] = {v.x(), v.y()};
  }
  return values;
}

TEST(LocalFit, AffineFieldsAreExactWhicheverNodesAreLeft) {
  Mat2 G;
  G << 0.1, -0.3, 0.2, 0.05;
  const Vec2 at_corner(3, -2);
  const auto field = [&](const Vec2& x) { return Vec2(at_corner + G * x); };
  const auto values = values_of(field);
  int fitted = 0;
  for (int bits = 0; bits < 65536; bits += 7) {
    const auto fit = LocalFit::of(std::uint16_t(bits), values);
    if (!fit) continue;
    ++fitted;
    const Vec2 x(0.3, 0.8);
    ASSERT_LT((fit->slope - G).norm(), 1e-12) << bits;
    ASSERT_LT((fit->value + fit->slope * (x - fit->centroid) - field(x)).norm(), 1e-12) << bits;
    ASSERT_LT(fit->misfit[0] + fit->misfit[1], 1e-24) << bits;
    double sum = 0;
    Vec2 gathered = Vec2::Zero();
    for (int k = 0; k < 16; ++k) {
      sum += fit->influence(k, x.x(), x.y());
      gathered += fit->influence(k, x.x(), x.y()) * Vec2(values[std::size_t(k)][0], values[std::size_t(k)][1]);
    }
    ASSERT_NEAR(sum, 1, 1e-12) << bits;
    ASSERT_LT((gathered - field(x)).norm(), 1e-11) << bits;
  }
  EXPECT_GT(fitted, 9000);
}

TEST(LocalFit, UnusedValuesAreNotRead) {
  auto values = values_of([](const Vec2& x) { return x; });
  for (int k : {5, 6, 9, 10}) values[std::size_t(k)].fill(std::nan(""));
  const auto fit = LocalFit::of(std::uint16_t(0xffff & ~nodes_of({5, 6, 9, 10})), values);
  ASSERT_TRUE(fit);
  EXPECT_LT((fit->slope - Mat2::Identity()).norm(), 1e-13);
}

TEST(LocalFit, NeedsThreeNodesOffALine) {
  const auto values = values_of([](const Vec2& x) { return x; });
  EXPECT_FALSE(LocalFit::of(0, values));
  EXPECT_FALSE(LocalFit::of(nodes_of({5, 6}), values));
  EXPECT_FALSE(LocalFit::of(nodes_of({4, 5, 6, 7}), values));    // a row
  EXPECT_FALSE(LocalFit::of(nodes_of({0, 5, 10, 15}), values));  // a diagonal
  EXPECT_TRUE(LocalFit::of(nodes_of({5, 6, 9}), values));
  EXPECT_TRUE(LocalFit::of(nodes_of({0, 5, 11}), values));
}

TEST(LocalFit, ReachesItsHullAndADiagonalBeyond) {
  const auto values = values_of([](const Vec2& x) { return x; });
  // The ring around a lost element: the middle is more than a diagonal from every node, but inside.
  const auto ring = LocalFit::of(std::uint16_t(0xffff & ~nodes_of({5, 6, 9, 10})), values);
  ASSERT_TRUE(ring);
  EXPECT_TRUE(ring->reaches(0.5, 0.5));
  // The row below the element and the one below that: the far side of the element is out of reach.
  const auto below = LocalFit::of(nodes_of({0, 1, 2, 3, 5}), values);
  ASSERT_TRUE(below);
  EXPECT_TRUE(below->reaches(0.9, 0.9));  // 1.27 from (0, 0)
  const auto row_below = LocalFit::of(nodes_of({0, 1, 2, 3, 4}), values);
  ASSERT_TRUE(row_below);
  EXPECT_TRUE(row_below->reaches(0.5, 0.1));
  EXPECT_FALSE(row_below->reaches(0.9, 0.9));
  // On an edge of the hull.
  EXPECT_TRUE(ring->reaches(-1, 0.5));
}

// With all sixteen nodes the fit at the element's centre is their mean with weights 1/(1 + r^2)^2, r^2 = 1/2 of its own
// four, 5/2 of the ring's eight, 9/2 of its corners.
TEST(LocalFit, NearNodesCountMore) {
  const auto fit = LocalFit::of(0xffff, {});
  ASSERT_TRUE(fit);
  const double sum = 4 / 2.25 + 8 / 12.25 + 4 / 30.25;
  for (const int own : {5, 6, 9, 10}) EXPECT_NEAR(fit->influence(own, 0.5, 0.5), 1 / 2.25 / sum, 1e-12);
  for (const int ring : {1, 4, 7, 14}) EXPECT_NEAR(fit->influence(ring, 0.5, 0.5), 1 / 12.25 / sum, 1e-12);
  for (const int corner : {0, 3, 12, 15}) EXPECT_NEAR(fit->influence(corner, 0.5, 0.5), 1 / 30.25 / sum, 1e-12);
}

TEST(LocalFit, MisfitMeasuresWhatIsNotAffine) {
  const double curvature = 0.01;
  const auto fit = LocalFit::of(0xffff, values_of([&](const Vec2& x) {
                                  return Vec2(curvature / 2 * x.x() * x.x(), 0);
                                }));
  ASSERT_TRUE(fit);
  const double at_centre = (fit->value + fit->slope * (Vec2(0.5, 0.5) - fit->centroid)).x() - curvature / 8;
  EXPECT_GT(fit->misfit[0], 0);
  EXPECT_LT(std::abs(at_centre), 4 * std::sqrt(fit->misfit[0]));
  EXPECT_GT(std::abs(at_centre), 0.25 * std::sqrt(fit->misfit[0]));
  EXPECT_LT(fit->misfit[1], 1e-30);
}

}  // namespace
}  // namespace pivnp::np
