// Angles of heaps whose angle is known.
#include <gtest/gtest.h>

#include <cmath>

#include "compare/shapes/slope_angles.hpp"
#include "pivnp/core/particles/seeding.hpp"

namespace pivnp::compare {
namespace {

SlopeAngles angles_of(double crest, double toe, double height, Vec2 shift = {0, 0}) {
  const double h = 0.0075;
  std::vector<Vec2> ring{{0, 0}, {toe, 0}, {crest, height}};
  if (crest > 0) ring.push_back({0, height});
  const ParticleSet set = seed(Grid{{0, 0}, {h, h}, 134, 41}, {Region{"sand", Polygon(ring, "sand")}}, 16,
                               SeedPattern::even, 0, "per_element");
  MotionFrame frame;
  frame.u.assign(set.size(), {float(shift.x()), float(shift.y())});
  frame.status.assign(set.size(), ParticleStatus::active);
  return slope_angles(set, frame, shift.x(), shift.y(), h, h / 4);
}

TEST(SlopeAngles, OfATrapezoidAreThoseOfItsFace) {
  for (const double run : {0.144, 0.3, 0.5}) {
    const double exact = std::atan(0.25 / run) * 180 / M_PI;
    const SlopeAngles found = angles_of(0.186, 0.186 + run, 0.25);
    EXPECT_NEAR(found.cen, exact, 0.3);
    EXPECT_NEAR(found.fit, exact, 0.5);
    EXPECT_NEAR(found.tc, exact, 1);
    EXPECT_NEAR(found.height, 0.25, 0.003);
  }
}

TEST(SlopeAngles, OfATriangleAndOfOneThatIsShifted) {
  const SlopeAngles found = angles_of(0, 0.5, 0.25);
  EXPECT_NEAR(found.cen, std::atan(0.5) * 180 / M_PI, 0.3);
  const SlopeAngles shifted = angles_of(0, 0.5, 0.25, {0.125, -0.25});
  EXPECT_NEAR(shifted.cen, found.cen, 1e-3);
  EXPECT_NEAR(shifted.toe_x, found.toe_x + 0.125, 1e-6);
}

TEST(SlopeAngles, WithoutMaterialAreNotKnown) {
  EXPECT_TRUE(std::isnan(slope_angles({}, {}, 0, 0, 1, 1).cen));
}

}  // namespace
}  // namespace pivnp::compare
