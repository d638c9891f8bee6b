// Regions and seeding: counts, ids, areas; polygons that must be refused.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/particles/seeding.hpp"

namespace pivnp {
namespace {

const std::vector<Vec2> triangle = {{0, 0}, {2, 0}, {0, 2}};

TEST(Polygon, AreaBothSenses) {
  EXPECT_DOUBLE_EQ(Polygon(triangle, "t").area(), 2.0);
  EXPECT_DOUBLE_EQ(Polygon({{0, 0}, {0, 2}, {2, 0}}, "t").area(), 2.0);
}

TEST(Polygon, BoundaryIsInside) {
  const Polygon p(triangle, "t");
  EXPECT_TRUE(p.contains({1, 1}));
  EXPECT_TRUE(p.contains({0, 0}));
  EXPECT_FALSE(p.contains({1.001, 1.001}));
}

TEST(Polygon, RefusesWhatIsNoRegion) {
  EXPECT_THROW(Polygon({{0, 0}, {1, 1}, {1, 0}, {0, 1}}, "bow tie"), InputError);
  EXPECT_THROW(Polygon({{0, 0}, {1, 1}}, "two points"), InputError);
  EXPECT_THROW(Polygon({{0, 0}, {1, 1}, {2, 2}}, "a line"), InputError);
  EXPECT_THROW(Polygon({{0, 0}, {1, NAN}, {2, 2}}, "nan"), InputError);
}

TEST(Polygon, OverlapWithBoxes) {
  const Polygon p(triangle, "t");
  EXPECT_DOUBLE_EQ(p.overlap({0, 0}, {1, 1}), 1.0);
  EXPECT_DOUBLE_EQ(p.overlap({1, 1}, {2, 2}), 0.0);
  EXPECT_NEAR(p.overlap({1, 0}, {2, 1}), 0.5, 1e-15);
  EXPECT_NEAR(p.overlap({-5, -5}, {5, 5}), 2.0, 1e-14);
}

TEST(Polygon, DistanceAndOutwardNormal) {
  Vec2 n;
  EXPECT_NEAR(Polygon(triangle, "t").distance({0.5, -0.25}, n), 0.25, 1e-15);
  EXPECT_NEAR(n.y(), -1, 1e-15);
}

TEST(Seeding, CountsIdsAndAreas) {
  const Grid grid{{0, 0}, {0.5, 0.5}, 5, 5};
  const std::vector<Region> regions = {{"all", Polygon({{0, 0}, {2, 0}, {2, 2}, {0, 2}}, "r")}};
  for (int n : {1, 4, 9, 16}) {
    for (SeedPattern pattern : {SeedPattern::even, SeedPattern::gauss}) {
      const ParticleSet set = seed(grid, regions, n, pattern, 0, "np.per_element");
      ASSERT_EQ(set.size(), 16u * n);
      double area = 0;
      Vec2 centroid = Vec2::Zero();
      for (std::size_t p = 0; p < set.size(); ++p) {
        area += double(set.area[p]);
        centroid += set.x0[p] / double(set.size());
      }
      EXPECT_NEAR(area, 4.0, 1e-6);
      EXPECT_NEAR(centroid.x(), 1.0, 1e-12);
      EXPECT_NEAR(centroid.y(), 1.0, 1e-12);
      EXPECT_EQ(std::set<std::int64_t>(set.id.begin(), set.id.end()).size(), set.size());
    }
  }
}

TEST(Seeding, GaussPointsAreGauss) {
  const Grid grid{{0, 0}, {1, 1}, 2, 2};
  const std::vector<Region> regions = {{"all", Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, "r")}};
  const ParticleSet set = seed(grid, regions, 4, SeedPattern::gauss, 0, "n");
  EXPECT_NEAR(set.x0[0].x(), 0.5 - 0.5 / std::sqrt(3.0), 1e-14);
  const ParticleSet nine = seed(grid, regions, 9, SeedPattern::gauss, 0, "n");
  EXPECT_NEAR(nine.x0[0].x(), 0.5 - 0.5 * std::sqrt(0.6), 1e-14);
  EXPECT_NEAR(nine.x0[4].x(), 0.5, 1e-14);
}

TEST(Seeding, RefusesBadCountsAndEmptyRegions) {
  const Grid grid{{0, 0}, {1, 1}, 2, 2};
  const std::vector<Region> outside = {{"far", Polygon({{5, 5}, {6, 5}, {6, 6}}, "r")}};
  EXPECT_THROW(seed(grid, outside, 4, SeedPattern::even, 0, "n"), InputError);
  const std::vector<Region> all = {{"all", Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, "r")}};
  EXPECT_THROW(seed(grid, all, 5, SeedPattern::even, 0, "n"), InputError);
}

}  // namespace
}  // namespace pivnp
