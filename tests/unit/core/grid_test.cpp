// The shared grid: index rules, locate at the edges, partition of unity.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "pivnp/core/grid/grid.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/shape.hpp"

namespace pivnp {
namespace {

const Grid grid{{0.5, -1.0}, {0.25, 0.5}, 5, 4};

TEST(Grid, NodesRunAlongXFirst) {
  EXPECT_EQ(grid.node(2, 3), 3u * 5u + 2u);
  EXPECT_EQ(grid.element(1, 2), 2u * 4u + 1u);
  EXPECT_EQ(grid.position(2, 3), Vec2(1.0, 0.5));
  EXPECT_EQ(grid.element_count(), 12u);
}

TEST(Grid, PointsOnTheBorderAndRoundOffOutsideAreInside) {
  ElementPoint p;
  ASSERT_TRUE(locate(grid, grid.upper(), p));
  EXPECT_EQ(p.i, 3);
  EXPECT_EQ(p.j, 2);
  EXPECT_DOUBLE_EQ(p.xi, 1.0);
  EXPECT_DOUBLE_EQ(p.eta, 1.0);
  ASSERT_TRUE(locate(grid, grid.origin - Vec2(1e-18, 1e-18), p));
  EXPECT_DOUBLE_EQ(p.xi, 0.0);
  EXPECT_FALSE(locate(grid, grid.origin - Vec2(1e-6, 0), p));
  EXPECT_FALSE(locate(grid, {std::numeric_limits<double>::quiet_NaN(), 0}, p));
}

TEST(Grid, PaddedAndRefinedKeepTheNodes) {
  EXPECT_EQ(padded(grid, 3).position(2 + 3, 1 + 3), grid.position(2, 1));
  EXPECT_EQ(refined(grid, 4).position(4 * 3, 4 * 2), grid.position(3, 2));
  EXPECT_EQ(refined(grid, 4).upper(), grid.upper());
}

TEST(Bilinear, PartitionOfUnityAndLinearReproduction) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec2 x = grid.origin + (grid.upper() - grid.origin).cwiseProduct(Vec2(unit(random), unit(random)));
    ElementPoint p;
    ASSERT_TRUE(locate(grid, x, p));
    const BilinearWeights w = bilinear(grid, p);
    double sum = 0, value = 0, dx = 0, dy = 0;
    for (int k = 0; k < 4; ++k) {
      const double f = 3 + 2 * grid.position(p.i + k % 2, p.j + k / 2).x() - 7 * grid.position(p.i + k % 2, p.j + k / 2).y();
      sum += w.value[k];
      value += w.value[k] * f;
      dx += w.dx[k] * f;
      dy += w.dy[k] * f;
    }
    EXPECT_NEAR(sum, 1, 1e-14);
    EXPECT_NEAR(value, 3 + 2 * x.x() - 7 * x.y(), 1e-12);
    EXPECT_NEAR(dx, 2, 1e-12);
    EXPECT_NEAR(dy, -7, 1e-12);
  }
}

TEST(Text, NamesTheNearest) {
  const std::vector<std::string> known = {"window_px", "method", "passes"};
  EXPECT_EQ(did_you_mean("windw_px", known), "; did you mean 'window_px'?");
  EXPECT_EQ(did_you_mean("window", known), "; did you mean 'window_px'?");
  EXPECT_EQ(did_you_mean("zzzzzz", known), "; known: window_px, method, passes");
}

}  // namespace
}  // namespace pivnp
