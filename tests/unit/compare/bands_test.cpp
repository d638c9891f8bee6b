// Shear bands drawn by formula come out where, how inclined and how thick they were drawn.
#include "compare/shapes/ridges.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

constexpr double deg = std::numbers::pi / 180;

// A Gaussian ridge through `through` at `angle`, of standard deviation s, over a uniform strain.
struct Ridge {
  Vec2 through;
  double angle, s, height;
  double at(const Vec2& x) const {
    const Vec2 n(-std::sin(angle), std::cos(angle));
    const double d = (x - through).dot(n) / s;
    return height * std::exp(-0.5 * d * d);
  }
};

ScatteredField field_of(const std::vector<Ridge>& ridges, double spacing) {
  ScatteredField f;
  for (const Vec2& x : square_lattice(int(60 / spacing), int(40 / spacing), spacing)) {
    double v = 0.01;
    for (const Ridge& r : ridges) v += r.at(x);
    f.x.push_back(x);
    f.value.push_back(v);
    f.spacing.push_back(spacing);
    f.onset.push_back(x.x() < 30 ? 1 : 2);
  }
  return f;
}

class Inclined : public testing::TestWithParam<double> {};

// Criterion: inclination within 1 degree, place within a quarter of a spacing (beside the body's edge the
// smoothing is one-sided), width at half height (2.355 s) within 10 %.
TEST_P(Inclined, PlaceAngleAndThickness) {
  const Ridge r{Vec2(30, 20), GetParam() * deg, 2.5, 0.4};
  const std::vector<ShearBand> bands = find_bands(field_of({r}, 1), 1, 0.05);
  ASSERT_EQ(bands.size(), 1U);
  const ShearBand& b = bands[0];
  EXPECT_NEAR(b.inclination_deg, GetParam(), 1);
  EXPECT_NEAR(b.thickness, 2.355 * 2.5, 0.1 * 2.355 * 2.5);
  EXPECT_NEAR(b.strain, 0.41, 0.01);
  const Vec2 n(-std::sin(r.angle), std::cos(r.angle));
  for (const Vec2& x : b.ridge) EXPECT_NEAR((x - r.through).dot(n), 0, 0.25);
  EXPECT_GT(b.length, 30);
}
INSTANTIATE_TEST_SUITE_P(Angles, Inclined, testing::Values(-60.0, -20.0, 0.0, 33.0, 90.0));

TEST(Bands, NumberAndOrder) {
  const Ridge strong{Vec2(15, 20), 60 * deg, 2, 0.5}, weak{Vec2(45, 20), 75 * deg, 2, 0.2};
  const std::vector<ShearBand> bands = find_bands(field_of({weak, strong}, 1), 1, 0.05);
  ASSERT_EQ(bands.size(), 2U);
  EXPECT_NEAR(bands[0].centre.x(), 15, 1);
  EXPECT_NEAR(bands[1].inclination_deg, 75, 1);
  EXPECT_EQ(bands[0].onset, 1);
  EXPECT_EQ(bands[1].onset, 2);
  EXPECT_EQ(find_bands(field_of({weak, strong}, 1), 1, 0.3).size(), 1U);  // the weak one is below the threshold
}

TEST(Bands, NoneInUniformOrLinearStrain) {
  EXPECT_TRUE(find_bands(field_of({}, 1), 1, 0.005).empty());
  ScatteredField ramp = field_of({}, 1);
  for (std::size_t p = 0; p < ramp.x.size(); ++p) ramp.value[p] = 0.02 * ramp.x[p].x();
  EXPECT_TRUE(find_bands(ramp, 1, 0.05).empty());
}

// Simple shear across a band: gamma = g(y), so that |strain_dev| peaks at the band's middle, in both data sets.
TEST(Bands, OfTwoMotions) {
  const ParticleSet set = particles_at(square_lattice(40, 30, 1), 1);
  const auto sheared = [&](const std::string& name, double y0, double start) {
    const auto amount = [=](double t) { return std::max(0.0, t - start); };
    return motion_of(name, set, {0, 1, 2, 3, 4, 5, 6},
        [=](const Vec2& x, double t) { return Vec2(amount(t) * 0.5 * (1 + std::tanh((x.y() - y0) / 2)), 0); },
        [=](const Vec2& x, double t) -> Mat2 {
          Mat2 F = Mat2::Identity();
          F(0, 1) = amount(t) * 0.25 / std::pow(std::cosh((x.y() - y0) / 2), 2);
          return F;
        });
  };
  const MotionMemory a = sheared("a", 14, 0), b = sheared("b", 17, 2);
  const Comparison c = compared(a, b);
  EXPECT_EQ(metric(c, "band_number_first").value, 1);
  EXPECT_EQ(metric(c, "band_number_difference").value, 0);
  EXPECT_NEAR(metric(c, "band_offset").value, 3, 0.1);
  EXPECT_NEAR(metric(c, "band_inclination_difference").value, 0, 0.5);
  EXPECT_NEAR(metric(c, "band_onset_difference").value, 2, 1e-9);
  // A threshold just below the second's band, uncertain by more: it may be there or not.
  CompareOptions high;
  const auto table =
      std::find_if(c.tables.begin(), c.tables.end(), [](const ComparisonTable& t) { return t.name == "bands_second"; });
  ASSERT_NE(table, c.tables.end());
  ASSERT_EQ(table->columns[5].name, "strain_dev");
  high.band_strain = 0.95 * table->columns[5].values[0];
  StrainNote note;
  note.floor_dev = 0.1 * high.band_strain;
  SilentProgress progress;
  const Comparison near = compare(a, b, high, {}, progress, {}, {note, {}});
  EXPECT_EQ(metric(near, "band_number_second").value, 1);
  EXPECT_EQ(metric(near, "band_number_first").uncertainty, 0);
  EXPECT_EQ(metric(near, "band_number_second").uncertainty, 0.5);
  EXPECT_EQ(metric(near, "band_number_difference").uncertainty, 0.5);
  const Comparison same = compared(a, a);
  EXPECT_TRUE(std::isnan(metric(same, "band_number_first").uncertainty));
  EXPECT_EQ(metric(same, "band_offset").value, 0);
  EXPECT_EQ(metric(same, "band_thickness_difference").value, 0);
}

// A band that bends by 40 degrees, of which the second shows the first half: over what both show they are the same.
TEST(Bands, AreComparedOverWhatBothShow) {
  const ParticleSet set = particles_at(square_lattice(70, 50, 1), 1);
  const auto bent = [&](const std::string& name, double until) {
    return motion_of(name, set, {0, 1, 2}, [](const Vec2&, double) { return Vec2(0, 0); },
        [=](const Vec2& x, double t) -> Mat2 {
          const double line = 10 + (x.x() > 35 ? .84 * (x.x() - 35) : 0), s = (x.y() - line) / 2;
          Mat2 F = Mat2::Identity();
          F(0, 1) = x.x() < until ? .25 * t * (1 - .012 * x.x()) * std::exp(-.5 * s * s) : 0;
          return F;
        });
  };
  const Comparison c = compared(bent("a", 100), bent("b", 36));
  EXPECT_NEAR(metric(c, "band_inclination_difference").value, 0, 1.5);
  EXPECT_NEAR(metric(c, "band_peak_difference").value, 0, .01);
  // Side by side without a common stretch they are two bands.
  const auto half = [&](const std::string& name, double from, double to) {
    return motion_of(name, set, {0, 1}, [](const Vec2&, double) { return Vec2(0, 0); },
        [=](const Vec2& x, double t) -> Mat2 {
          Mat2 F = Mat2::Identity();
          if (x.x() > from && x.x() < to) F(0, 1) = .3 * t * std::exp(-.5 * std::pow((x.y() - 20) / 2, 2));
          return F;
        });
  };
  const Comparison apart = compared(half("a", 0, 30), half("b", 40, 70));
  EXPECT_EQ(find(apart.metrics, "band_inclination_difference"), nullptr);
}

}  // namespace
}  // namespace pivnp::compare
