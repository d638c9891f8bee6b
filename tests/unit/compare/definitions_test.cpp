// Numbers that definitions name (shares, thresholds, signs), each where another number would give another result.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "compare/measures/history.hpp"
#include "compare/metrics/significance.hpp"
#include "compare/alignment/onset.hpp"
#include "compare/data/rigid.hpp"
#include "compare/measures/shapes.hpp"
#include "compare/data/transformed.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "tests/unit/compare/motions.hpp"
#include "tests/support/added.hpp"

namespace pivnp::compare {
namespace {

const DisplacementLaw none = [](const Vec2&, double) { return Vec2(0, 0); };

// A plateau 10 wide and high with a face of 1:1, drawn out to 2:1: the place at 90 % of the height goes from 11 to 12 (at
// 80 % it would go from 12 to 14).
TEST(Definitions, TheCrestsEdgeIsAtNineTenthsOfTheHeight) {
  const double h = 0.5;
  std::vector<Vec2> x;
  for (const Vec2& p : square_lattice(40, 20, h))
    if (p.x() + p.y() < 20) x.push_back(p);
  const ParticleSet set = particles_at(x, h);
  const DisplacementLaw drawn = [](const Vec2& X, double t) { return Vec2(X.x() > 10 ? t * (X.x() - 10) : 0, 0); };
  const GradientLaw drawn_F = [](const Vec2& X, double t) -> Mat2 {
    return Vec2(X.x() > 10 ? 1 + t : 1, 1).asDiagonal().toDenseMatrix();
  };
  CompareOptions options;
  options.slope_base_m = 0;
  const Comparison c = compared(motion_of("a", set, {0, 1}, none), motion_of("b", set, {0, 1}, drawn, drawn_F), options);
  EXPECT_NEAR(metric(c, "crest_retreat_first").value, 0, 1e-9);
  EXPECT_NEAR(metric(c, "crest_retreat_second").value, -1, 0.4);
}

// A ring far off that is 7 % of its data set's outline counts, one of 3 % does not.
TEST(Definitions, HausdorffLeavesTheFurthestTwentiethOut) {
  const auto square = [](const Vec2& corner, double side) {
    return std::vector<Vec2>{corner, corner + Vec2(side, 0), corner + Vec2(side, side), corner + Vec2(0, side), corner};
  };
  const auto with = [&](double side) {
    return std::vector<std::vector<Vec2>>{square(Vec2(0, 0), 4), square(Vec2(14, 0), side)};
  };
  const std::vector<std::vector<Vec2>> alone{square(Vec2(0, 0), 4)};
  EXPECT_NEAR(hausdorff_95(alone, with(0.3), 0.01), 10, 0.4);
  EXPECT_NEAR(hausdorff_95(with(0.3), alone, 0.01), 10, 0.4);
  EXPECT_EQ(hausdorff_95(alone, with(0.12), 0.01), 0);
}

// A term of fourth degree of a tenth of the field's amplitude is written, one of a hundredth is left to the residual.
TEST(Definitions, DecompositionGoesOnToTwoHundredths) {
  const auto terms = [](double amplitude) {
    const ParticleSet set = particles_at(square_lattice(24, 24, 1), 1);
    const MotionMemory a = motion_of("a", set, {0, 1}, [=](const Vec2& X, double t) -> Vec2 {
      const double x = (X.x() - 12) / 11.5;
      return t * Vec2(x + amplitude * (8 * std::pow(x, 4) - 8 * x * x + 1), 0);
    });
    return metric(compared(a, a), "decomposition_displacement_x_terms").value;
  };
  EXPECT_EQ(terms(0.1), 15);
  EXPECT_EQ(terms(0.01), 3);
}

TEST(Definitions, AnUncertainTurnCountsWithTheDistance) {
  RigidFit fit;
  fit.motion.centre = Vec2(3, 4);
  fit.sigma_shift = Vec2(0.1, 0.2);
  fit.sigma_angle = 0.01;
  const Vec2 v = fit.variance_at(Vec2(13, 24));
  EXPECT_NEAR(v.x(), 0.01 + 0.04, 1e-12);  // 20 up
  EXPECT_NEAR(v.y(), 0.04 + 0.01, 1e-12);  // 10 aside
}

// Read between particles, a uniform covariance is itself.
TEST(Definitions, CovarianceBetweenParticlesIsTheirMean) {
  const double sigma = 0.3;
  const MotionMemory a = motion_of("a", particles_at(square_lattice(11, 9, 0.9), 0.9), {0, 1}, none);
  const ParticleSet set = particles_at(square_lattice(10, 8, 1), 1);
  MotionMemory b("b", "m", "s", set);
  for (const double t : {0.0, 1.0}) {
    MotionFrame f = frame_of(set, t, none, rigid);
    f.cov_u.assign(set.size(), {float(sigma * sigma), float(sigma * sigma), 0});
    b.add(f);
  }
  const Comparison c = compared(a, b);
  EXPECT_NEAR(metric(c, "u_val").value, sigma * std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(metric(c, "displacement_bias_x_final").uncertainty, sigma, 1e-6);
}

TEST(Definitions, TheGaugesShareOfAPointIsOfItsGreatestDisplacement) {
  const ParticleSet set = particles_at(square_lattice(6, 6, 1), 1);
  const MotionMemory a = motion_of("a", set, {0, 1, 2}, [](const Vec2&, double t) { return Vec2(0, -t); });
  CompareOptions options;
  options.points_m = {{3, 3}};
  options.gauge_uncertainty = 0.1;
  EXPECT_NEAR(metric(compared(a, a, options), "point_1_distance_rms").uncertainty, 0.2, 1e-6);
}

// The slope of the parabola through three uneven times: of t^2 at 1, between 0 and 3.
TEST(Definitions, RatesHoldAtUnevenTimes) {
  EXPECT_NEAR(peak_rate(TimeHistory{{0, 1, 3}, {0, 1, 9}}, std::nan("")).value, 2, 1e-12);
  // Weights -2/3, 1/2, 1/6.
  EXPECT_NEAR(peak_rate(TimeHistory{{0, 1, 3}, {0, 1, 9}}, 0.6).uncertainty, 0.6 * std::sqrt(16.0 + 9 + 1) / 6, 1e-12);
}

TEST(Definitions, RelativeValuesAreKnownRelatively) {
  const ParticleSet set = particles_at(square_lattice(6, 6, 1), 1);
  const MotionMemory a = motion_of("a", set, {0, 1}, [](const Vec2&, double t) { return Vec2(4 * t, 0); });
  const MotionMemory b = motion_of("b", set, {0, 1}, [](const Vec2&, double t) { return Vec2(5 * t, 0); });
  CompareOptions options;
  options.measurement_uncertainty_m = 0.1;
  const Metric m = metric(compared(a, b, options), "displacement_rms_final_relative");
  EXPECT_NEAR(m.value, 0.25, 1e-6);
  EXPECT_NEAR(m.uncertainty, 0.1 * std::sqrt(2.0) / 4, 1e-6);
}

TEST(Definitions, APercentileIsHeldToTheGreatestOfTwenty) {
  EXPECT_EQ(percentile_factor(100000), greatest_factor(20));
  EXPECT_EQ(percentile_factor(7), greatest_factor(7));
}

TEST(Definitions, OverTheTimesTheGreatestNoiseFloorCounts) {
  const ParticleSet set = particles_at(square_lattice(8, 8, 1), 1);
  MotionMemory a("np", "m", "s", set);
  for (const double t : {0.0, 1.0, 2.0}) {
    MotionFrame f = frame_of(set, t, none, rigid);
    f.cov_u.assign(set.size(), {1e-4f, 1e-4f, 0});
    for (std::size_t p = 0; p < set.size() && t > 0; ++p) f.F[p][1] = float((p % 2 == 0 ? 1 : -1) * (t < 1.5 ? 0.004 : 0.002));
    a.add(f);
  }
  CompareOptions options;
  options.reference_m = {{-1, -1}, {9, -1}, {9, 9}, {-1, 9}};
  const Comparison c = compared(a, motion_of("mpm", set, {0, 1, 2}, none), options);
  EXPECT_NEAR(metric(c, "strain_dev_rms").uncertainty, 0.004 / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(metric(c, "strain_dev_rms_final").uncertainty, 0.002 / std::sqrt(3.0), 1e-6);
}

TEST(Definitions, AMotionInOtherCoordinatesByHand) {
  const ParticleSet set = particles_at({Vec2(1, 2)}, 1);
  MotionMemory motion("a", "m", "s", set);
  MotionFrame f = frame_of(set, 3, [](const Vec2&, double) { return Vec2(0.5, 0.25); }, rigid);
  f.F[0] = {1.2f, 0.3f, 0, 0.9f};
  f.v = {{4, 0}};
  f.cov_u = {{0.04f, 0.09f, 0.01f}};
  std::ranges::copy(std::array{-1.0f, -2.0f, -3.0f, 0.5f}, f.add("stress", 1).begin());
  const test::Added flux(motion_fields(), {.name = "flux", .unit = "L/T", .form = FieldForm::vector});
  const test::Added width(motion_fields(), {.name = "width", .unit = "L"});
  std::ranges::copy(std::array{4.0f, 0.0f}, f.add("flux", 1).begin());
  f.add("width", 1)[0] = 3;
  motion.add(f);
  Transform by;
  by.scale = 2;
  by.angle = std::numbers::pi / 2;  // x becomes y, y becomes -x
  by.shift = Vec2(10, 0);
  by.time_scale = 4;
  by.time_offset = 1;
  const TransformedMotion seen(motion, by);
  const MotionFrame g = seen.frame(0);
  EXPECT_EQ(g.time, 13);
  EXPECT_NEAR((seen.particles().x0[0] - Vec2(6, 2)).norm(), 0, 1e-12);
  const auto near = [](const auto& found, std::initializer_list<double> expected) {
    std::size_t k = 0;
    for (const double e : expected) {
      EXPECT_NEAR(double(found[k]), e, 1e-6) << k;
      ++k;
    }
  };
  near(g.u[0], {-0.5, 1});
  near(g.v[0], {0, 2});
  near(g.F[0], {0.9, 0, -0.3, 1.2});  // F of the turned axes: dx'/dY' of the old shear is -dy'/dX'
  near(g.cov_u[0], {0.36, 0.16, -0.04});
  near(g.field("stress").values, {-2, -1, -3, -0.5});
  near(g.field("flux").values, {0, 2});  // as v
  near(g.field("width").values, {6});
}

// What slows down later is read off its beginning: over 2 to 25 % of a smooth step the line's zero is early by .03 in a
// duration of two seconds, over 2 to 60 % it would be by .09.
TEST(Definitions, AnOnsetIsReadOffTheFirstQuarter) {
  std::vector<double> t, s;
  for (int k = 0; k < 150; ++k) {
    const double x = std::clamp((0.02 * k - 0.5) / 2, 0.0, 1.0);
    t.push_back(0.02 * k);
    s.push_back(3 * x * x - 2 * x * x * x);
  }
  EXPECT_NEAR(find_onset(t, s, 2).time, 0.5, 0.04);
}

// Criterion: the stated uncertainty of an onset is its scatter, within a factor of two.
TEST(Definitions, AnOnsetScattersAsStated) {
  const unsigned seed = 12;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (const int power : {1, 2}) {
    std::normal_distribution<double> noise(0, 0.01);
    const int runs = 300;
    double square = 0, stated = 0;
    for (int run = 0; run < runs; ++run) {
      std::vector<double> t, s;
      for (int k = 0; k <= 60; ++k) {
        const double x = std::max(0.0, (0.05 * k - 0.5) / 2.5);
        t.push_back(0.05 * k);
        s.push_back(std::pow(x, power) + (x > 0 ? noise(random) : 0));
      }
      const Onset onset = find_onset(t, s, power);
      square += (onset.time - 0.5) * (onset.time - 0.5) / runs;
      stated += onset.sigma * onset.sigma / runs;
    }
    EXPECT_LT(std::sqrt(square), 2 * std::sqrt(stated)) << power;
    EXPECT_GT(std::sqrt(square), std::sqrt(stated) / 2) << power;
  }
}

TEST(Definitions, IdentityIsToAMillionthOfTheSpacing) {
  const ParticleSet set = particles_at(square_lattice(8, 8, 1), 1);
  ParticleSet moved = set;
  for (Vec2& x : moved.x0) x += Vec2(0.01, 0);
  const DisplacementLaw u = [](const Vec2& x, double t) -> Vec2 { return Vec2(t * x.x(), 0); };
  const GradientLaw F = [](const Vec2&, double t) -> Mat2 { return Vec2(1 + t, 1).asDiagonal().toDenseMatrix(); };
  const Comparison c = compared(motion_of("a", set, {0, 1}, u, F), motion_of("b", moved, {0, 1}, u, F));
  EXPECT_LT(metric(c, "displacement_max").value, 1e-5);  // by id the difference would be 0.01
}

// Bands drawn as simple shear, the second's turned by 10 degrees and half as wide again.
TEST(Definitions, BandsAreSubtractedSecondMinusFirst) {
  const ParticleSet set = particles_at(square_lattice(50, 36, 1), 1);
  const auto banded = [&](const std::string& name, double angle, double s) {
    return motion_of(name, set, {0, 1}, none, [=](const Vec2& x, double t) -> Mat2 {
      const double across = (x - Vec2(25, 18)).dot(Vec2(-std::sin(angle), std::cos(angle))) / s;
      Mat2 F = Mat2::Identity();
      F(0, 1) = 0.5 * t * std::exp(-0.5 * across * across);
      return F;
    });
  };
  const Comparison c = compared(banded("a", 0, 2), banded("b", 10 * std::numbers::pi / 180, 3));
  EXPECT_NEAR(metric(c, "band_inclination_difference").value, 10, 1);
  EXPECT_NEAR(metric(c, "band_thickness_difference").value, 2.355, 0.4);  // of a Gaussian: 2.355 s
}

}  // namespace
}  // namespace pivnp::compare
