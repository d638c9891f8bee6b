// Slope angle, run-out and crest height of figures whose values are known.
#include "compare/shapes/slope.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

// Particles of a lattice below a line y < height(x).
template <class Height>
std::vector<Vec2> heap(double width, double height_limit, double spacing, Height&& height) {
  std::vector<Vec2> points;
  for (const Vec2& x : square_lattice(int(width / spacing), int(height_limit / spacing) + 2, spacing))
    if (x.y() < height(x.x())) points.push_back(x);
  return points;
}

SlopeShape shape_of(const std::vector<Vec2>& points, double spacing, double base = 0) {
  const MaterialMesh mesh(points, std::vector<double>(points.size(), spacing));
  const Lattice lattice = lattice_around(mesh, mesh, spacing / 4, spacing / 2, base);
  return slope_shape(cover(mesh, spacing / 2, lattice), base, spacing);
}

double tan_deg(double angle) { return std::tan(angle * M_PI / 180); }

class Triangle : public testing::TestWithParam<double> {};

// Criterion: a triangle of particles on a base gives its own angle within 0.5 degrees, whichever way it faces.
TEST_P(Triangle, AngleAndSide) {
  const double angle = GetParam(), height = 0.25, width = height / tan_deg(angle), h = 0.005;
  const auto right = heap(width, height, h, [&](double x) { return (width - x) * tan_deg(angle); });
  const SlopeShape r = shape_of(right, h);
  EXPECT_NEAR(r.angle_deg, angle, 0.5);
  EXPECT_LT(r.angle_uncertainty_deg, 0.5);
  EXPECT_EQ(r.faces, 1);
  // 99.5 % of a triangle's area lies below height (1 - sqrt(0.005)), and as far out.
  // The lattice holds no particle in the last few millimetres of a sharp tip.
  EXPECT_NEAR(r.crest_height, height * (1 - std::sqrt(0.005)), h);
  EXPECT_NEAR(r.run_out_x, width * (1 - std::sqrt(0.005)), h);

  std::vector<Vec2> left;
  for (const Vec2& x : right) left.emplace_back(-x.x(), x.y());
  const SlopeShape l = shape_of(left, h);
  EXPECT_EQ(l.faces, -1);
  EXPECT_NEAR(l.angle_deg, r.angle_deg, 0.1);  // cells fall otherwise
  EXPECT_NEAR(l.run_out_x, -r.run_out_x, h / 2);
}
INSTANTIATE_TEST_SUITE_P(Angles, Triangle, testing::Values(26.0, 30.0, 43.0, 60.0));

TEST(Slope, PlateauAndFace) {
  // The sand slope of the cases: 60 degrees, 250 mm high, 330 mm long, wall on the left.
  const double h = 0.005;
  const auto points = heap(0.33, 0.25, h, [](double x) { return std::min(0.25, (0.33 - x) * tan_deg(60)); });
  const SlopeShape s = shape_of(points, h);
  EXPECT_EQ(s.faces, 1);
  EXPECT_NEAR(s.angle_deg, 60, 0.7);
  EXPECT_NEAR(s.crest_height, 0.249, 0.002);
}

TEST(Slope, OnlyWhatIsAboveTheBaseCounts) {
  const double h = 0.005;
  std::vector<Vec2> points = heap(0.4, 0.2, h, [](double x) { return (0.4 - x) * tan_deg(25); });
  for (Vec2& x : points) x.y() += 0.1;
  for (const Vec2& x : square_lattice(120, 20, h)) points.push_back(x);  // a bed below the base, wider than the heap
  const SlopeShape s = shape_of(points, h, 0.1);
  EXPECT_NEAR(s.angle_deg, 25, 0.5);
  EXPECT_NEAR(s.run_out_x, 0.4 * (1 - std::sqrt(0.005)), 2 * h);
  EXPECT_EQ(shape_of(points, h, 5).faces, 0);
}

TEST(Slope, OfAProfileByHand) {
  // Columns 1 wide: 10 10 10 8.5 7 5.5 4 2.5 1 0: line of slope -1.5 through those between 1 and 9.
  const Profile profile{0.5, 1, {10, 10, 10, 8.5, 7, 5.5, 4, 2.5, 1, 0}};
  SlopeShape shape;
  fit_slope(profile, 10, 1, shape);
  EXPECT_EQ(shape.faces, 1);
  EXPECT_NEAR(shape.angle_deg, std::atan(1.5) * 180 / M_PI, 1e-12);
  EXPECT_NEAR(shape.angle_uncertainty_deg, 0, 1e-6);

  // A vertical face has no columns to fit.
  fit_slope({0.5, 1, {10, 10, 10, 0, 0}}, 10, 1, shape);
  EXPECT_TRUE(std::isnan(shape.angle_deg));
}

TEST(Slope, ScatterGivesTheUncertaintyOfTheLine) {
  const std::vector<double> e{0.5, -0.5, -0.5, 0.5, 0.5, -0.5, -0.5, 0.5};
  Profile profile{0, 1, {20}};
  for (std::size_t k = 0; k < e.size(); ++k) profile.height.push_back(16 - double(k) + e[k]);
  SlopeShape shape;
  fit_slope(profile, 20, 1, shape);
  // e is symmetric about the middle, so the fitted slope is -1 and the residuals are e: sum 2, s^2 = 2/6, Sxx = 42.
  EXPECT_NEAR(shape.angle_deg, 45, 1e-12);
  EXPECT_NEAR(shape.angle_uncertainty_deg, std::sqrt(2.0 / 6 / 42) / 2 * 180 / M_PI, 1e-12);
}

TEST(Slope, MetricsOfBothSidesAndTheirDifference) {
  const double h = 0.01;
  const auto at = [&](double angle) {
    return particles_at(heap(0.6, 0.4, h, [=](double x) { return (0.6 - x) * tan_deg(angle); }), h);
  };
  const DisplacementLaw none = [](const Vec2&, double) { return Vec2(0, 0); };
  const MotionMemory a = motion_of("a", at(33), {0, 1}, none), b = motion_of("b", at(27), {0, 1}, none);
  CompareOptions options;
  EXPECT_FALSE(has_metric(compared(a, b, options), "slope_angle_first"));
  options.slope_base_m = 0;
  const Comparison c = compared(a, b, options);
  EXPECT_NEAR(metric(c, "slope_angle_first").value, 33, 0.5);
  EXPECT_NEAR(metric(c, "slope_angle_second").value, 27, 0.5);
  EXPECT_NEAR(metric(c, "slope_angle_difference").value, -6, 0.7);
  EXPECT_EQ(metric(c, "slope_angle_difference").unit, "deg");
  EXPECT_TRUE(metric(c, "slope_angle_difference").told_apart());
  EXPECT_NEAR(metric(c, "outline_iou").value, tan_deg(27) / tan_deg(33), 0.02);
  EXPECT_FALSE(c.outlines[0].empty());
  const Comparison same = compared(a, a, options);
  EXPECT_EQ(metric(same, "slope_angle_difference").value, 0);
  EXPECT_EQ(metric(same, "crest_height_difference").value, 0);
  EXPECT_EQ(metric(same, "run_out_x_difference").value, 0);
}

}  // namespace
}  // namespace pivnp::compare
