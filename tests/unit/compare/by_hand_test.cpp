// Metrics of small comparisons against values worked by hand: twenty particles whose differences are 1, 2 ... 20 units.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

// Of 1 ... 20: mean, root mean square (20 21 41/6 / 20), 95th percentile by nearest rank, greatest.
constexpr double mean = 10.5, p95 = 19, most = 20;
const double rms = std::sqrt(143.5);

ParticleSet twenty() { return particles_at(square_lattice(5, 4, 1), 1); }
double number_of(const Vec2& X) { return 1 + std::floor(X.x()) + 5 * std::floor(X.y()); }

const DisplacementLaw none = [](const Vec2&, double) { return Vec2(0, 0); };

// F = diag(exp(v/2 + a), exp(v/2 - a)): ln J = v, deviatoric strain sqrt(4/3 a^2 + v^2/9).
GradientLaw stretch(double a, double v) {
  return [=](const Vec2& X, double t) -> Mat2 {
    const double k = number_of(X) * t;
    return Vec2(std::exp(k * (v / 2 + a)), std::exp(k * (v / 2 - a))).asDiagonal().toDenseMatrix();
  };
}

void expect_statistics(const Comparison& c, const std::string& name, double unit, double u) {
  const auto at = [&](const char* what) { return metric(c, name + "_" + what + "_final"); };
  EXPECT_NEAR(at("bias").value, mean * unit, 1e-5) << name;
  EXPECT_NEAR(at("rms").value, rms * std::abs(unit), 1e-5) << name;
  EXPECT_NEAR(at("p95").value, p95 * std::abs(unit), 1e-5) << name;
  EXPECT_NEAR(at("max").value, most * std::abs(unit), 1e-5) << name;
  for (const auto& [what, value] : {std::pair{"bias", mean * unit},
                                    {"rms", rms * std::abs(unit)},
                                    {"p95", p95 * std::abs(unit)},
                                    {"max", most * std::abs(unit)}}) {
    EXPECT_EQ(at(what).uncertainty, u) << name << ' ' << what;
    EXPECT_EQ(at(what).unit, "1");
    EXPECT_NEAR(metric(c, name + "_" + what + "_final_over_u").value, value / u, 1e-4) << name << ' ' << what;
  }
}

TEST(ByHand, StatisticsOfTheStrains) {
  StrainNote note;
  note.floor_dev = 0.05, note.floor_vol = 0.04, note.floor_path = 0.03;
  SilentProgress progress;
  const auto of = [&](double a, double v) {
    return compare(motion_of("a", twenty(), {0, 1}, none), motion_of("b", twenty(), {0, 1}, none, stretch(a, v)), {},
                   {}, progress, {}, {note, {}});
  };
  expect_statistics(of(0.01, 0), "strain_dev", 2 / std::sqrt(3.0) * 0.01, 0.05);
  expect_statistics(of(0, -0.01), "strain_vol", -0.01, 0.04);
  // In one step the central increment of exp(k a) is 2 tanh(k a/2): within 1e-5 of k a at so small an a.
  expect_statistics(of(0.0002, 0), "strain_dev_path", 2 / std::sqrt(3.0) * 0.0002, 0.03);
}

// u2 - u1 = 0.1 k t along x: at t = 2 the differences are 0.2 k, the velocities' 0.1 k. Every component is known to
// 0.3.
TEST(ByHand, StatisticsOfDisplacementVelocityAndIncrements) {
  const DisplacementLaw apart = [](const Vec2& X, double t) -> Vec2 { return Vec2(0.1 * number_of(X) * t, 0); };
  const DisplacementLaw common = [](const Vec2&, double t) -> Vec2 { return Vec2(0, 0.5 * t); };
  CompareOptions options;
  options.measurement_uncertainty_m = 0.3;
  const MotionMemory a = motion_of("a", twenty(), {0, 1, 2}, common);
  const MotionMemory b =
      motion_of("b", twenty(), {0, 1, 2}, [&](const Vec2& X, double t) -> Vec2 { return common(X, t) + apart(X, t); });
  const Comparison c = compared(a, b, options);
  const double u = 0.3 * std::sqrt(2.0);  // both components
  EXPECT_NEAR(metric(c, "displacement_bias_x_final").value, 0.2 * mean, 1e-5);
  EXPECT_NEAR(metric(c, "displacement_rms_final").value, 0.2 * rms, 1e-5);
  EXPECT_NEAR(metric(c, "displacement_p95_final").value, 0.2 * p95, 1e-5);
  EXPECT_NEAR(metric(c, "displacement_p95_final").uncertainty, u, 1e-9);
  EXPECT_NEAR(metric(c, "displacement_p95_final_over_u").value, 0.2 * p95 / u, 1e-5);
  EXPECT_NEAR(metric(c, "displacement_max_final_over_u").value, 0.2 * most / u, 1e-5);
  EXPECT_NEAR(metric(c, "displacement_p95_final_relative").value, 0.2 * p95 / 1.0, 1e-5);  // the first moves by 1
  // (u(2) - u(0))/2: variance of a component 2 * 0.09/4, of both 0.09.
  EXPECT_NEAR(metric(c, "velocity_bias_x").value, 0.1 * mean, 1e-5);
  EXPECT_NEAR(metric(c, "velocity_rms").value, 0.1 * rms, 1e-5);
  EXPECT_NEAR(metric(c, "velocity_p95").value, 0.1 * p95, 1e-5);
  EXPECT_NEAR(metric(c, "velocity_max").value, 0.1 * most, 1e-5);
  EXPECT_NEAR(metric(c, "velocity_rms").uncertainty, 0.3, 1e-9);
  EXPECT_NEAR(metric(c, "velocity_p95_over_u").value, 0.1 * p95 / 0.3, 1e-5);
  // Forty increments, two of each size: the 20th is 1.0, the 38th 1.9.
  EXPECT_NEAR(metric(c, "increment_median").value, 1.0, 1e-5);
  EXPECT_NEAR(metric(c, "increment_p95").value, 1.9, 1e-5);

  // Without the upper two rows (k = 11 ... 20), relative to what the reference row (k = 1 ... 5) moves by on the first
  // side in a step: 0.5. Its mean difference (k = 3) is taken off.
  options.increments_outside_m = {2.5, 4, 2.6};
  options.reference_m = {{0, 0}, {5, 0}, {5, 1}, {0, 1}};
  const Comparison r = compared(a, b, options);
  // |k - 3| of 1 ... 10, but for k = 8 (its distance from the circle's centre is 2.5): 2 1 0 1 2 3 4 6 7, twice: the
  // ninth of eighteen in order is 2 (0 0 1 1 1 1 2 2 2 2 3 ...).
  EXPECT_NEAR(metric(r, "increment_median").value, 0.2, 1e-5);
  EXPECT_NEAR(metric(r, "increment_p95").value, 0.7, 1e-5);
  EXPECT_NEAR(metric(r, "increment_median_relative").value, 0.2 / 0.5, 1e-5);
}

// The areas between the distributions of 1 ... 20 units and of nothing are the means.
TEST(ByHand, AreaMetrics) {
  const MotionMemory a = motion_of("a", twenty(), {0, 1}, none);
  const MotionMemory b = motion_of(
      "b", twenty(), {0, 1}, [](const Vec2& X, double t) -> Vec2 { return Vec2(0, -0.1 * number_of(X) * t); },
      stretch(0.01, 0));
  for (const Comparison& c : {compared(a, b), compared(b, a)}) {
    EXPECT_NEAR(metric(c, "area_metric_displacement").value, 0.1 * mean, 1e-5);
    EXPECT_NEAR(metric(c, "area_metric_strain_dev").value, 2 / std::sqrt(3.0) * 0.01 * mean, 1e-5);
  }
}

// u_x = x in the first data set, x + 0.05 (1 + 4 y') in the second, y' the coordinate with mean 0 and mean square 1:
// linear, so three coefficients hold it; two of them differ, by 0.05 and 0.2.
TEST(ByHand, Decomposition) {
  const ParticleSet set = particles_at(square_lattice(10, 10, 1), 1);
  const double spread = std::sqrt(99.0 / 12);  // of ten evenly spaced values
  const auto law = [=](double more) {
    return DisplacementLaw(
        [=](const Vec2& X, double t) -> Vec2 { return Vec2(t * (X.x() + more * (1 + 4 * (X.y() - 5) / spread)), 0); });
  };
  CompareOptions options;
  options.measurement_uncertainty_m = 0.05;
  const Comparison c = compared(motion_of("a", set, {0, 1}, law(0)), motion_of("b", set, {0, 1}, law(0.05)), options);
  const auto value = [&](const std::string& what) { return metric(c, "decomposition_displacement_x_" + what); };
  EXPECT_EQ(value("terms").value, 3);
  EXPECT_NEAR(value("distance").value, 0.05 * std::sqrt(17.0), 1e-5);
  EXPECT_NEAR(value("distance").uncertainty, 0.05, 1e-6);
  // Band of 2 u = 0.1: one of three leaves it. At its edge u less or more: still that one (0.2 > 0.15; 0.05 touches
  // 0.05).
  EXPECT_NEAR(value("outside").value, 1.0 / 3, 1e-9);
  EXPECT_LE(value("outside").uncertainty, 1.0 / 6 + 1e-9);
  EXPECT_NEAR(value("residual_first").value, 0, 1e-5);
  EXPECT_NEAR(value("residual_second").value, 0, 1e-5);
  EXPECT_EQ(value("cluster_first").value, 0);
  EXPECT_EQ(value("cluster_second").value, 0);
  options.measurement_uncertainty_m = 0.08;  // bands of 0.08, 0.16, 0.24: one, one and none
  const Comparison wide =
      compared(motion_of("a", set, {0, 1}, law(0)), motion_of("b", set, {0, 1}, law(0.05)), options);
  EXPECT_NEAR(metric(wide, "decomposition_displacement_x_outside").uncertainty, 1.0 / 6, 1e-9);
}

// Three particles near the threshold of 1, at 0.93, 1.02 and 1.2; error of |u| 0.1.
TEST(ByHand, MobilisedArea) {
  const ParticleSet set = twenty();
  const auto law = [](const Vec2& X, double t) -> Vec2 {
    const double k = number_of(X);
    return Vec2(t * (k == 1 ? 0.93 : k == 2 ? 1.02 : k == 3 ? 1.2 : k < 12 ? 0 : 5), 0);
  };
  const double sigma = 0.1;
  MotionMemory a("a", "m", "s", set);
  for (const double t : {0.0, 1.0}) {
    MotionFrame f = frame_of(set, t, law, rigid);
    f.cov_u.assign(set.size(), {float(sigma * sigma / 2), float(sigma * sigma / 2), 0});
    a.add(f);
  }
  CompareOptions options;
  options.mobilised_m = 1;
  const Comparison c = compared(a, motion_of("b", set, {0, 1}, none), options);
  const Metric m = metric(c, "mobilised_area_first");
  EXPECT_EQ(m.value, 11);  // 12 ... 20, and 2 and 3
  // Above 0.9: 12, above 1.1: 10. Each by itself: Phi(-0.7) = 0.24196, Phi(0.2) = 0.57926, Phi(2) = 0.97725.
  const double scatter = 0.24196 * 0.75804 + 0.57926 * 0.42074 + 0.97725 * 0.02275;
  EXPECT_NEAR(m.uncertainty, std::sqrt(1 + scatter), 1e-4);
  EXPECT_EQ(metric(c, "mobilised_area_second").value, 0);
  EXPECT_TRUE(std::isnan(metric(c, "mobilised_area_second").uncertainty));
  EXPECT_EQ(metric(c, "mobilised_area_difference").value, -11);
  EXPECT_NEAR(metric(c, "mobilised_area_difference").uncertainty, m.uncertainty, 1e-12);
}

// Of twenty particles eight move, six by (3, -1) and two by (-1, -5): their centre by (2, -2). One goes by 0.5, less
// than counts. In the second data set all go by (-2, -2 sqrt(3)), and nothing is known of their errors.
TEST(ByHand, TravelAngle) {
  const ParticleSet set = twenty();
  const auto law = [](const Vec2& X, double t) -> Vec2 {
    const double k = number_of(X);
    return t * (k <= 6 ? Vec2(3, -1) : k <= 8 ? Vec2(-1, -5) : k == 9 ? Vec2(0, 0.5) : Vec2(0, 0));
  };
  const double sigma = 0.1;
  MotionMemory a("a", "m", "s", set);
  for (const double t : {0.0, 1.0}) {
    MotionFrame f = frame_of(set, t, law, rigid);
    f.cov_u.assign(set.size(), {float(sigma * sigma), float(sigma * sigma), 0});
    a.add(f);
  }
  const auto goes = [&](const Vec2& u) {
    return motion_of("b", set, {0, 1}, [=](const Vec2&, double t) -> Vec2 { return t * u; });
  };
  CompareOptions options;
  options.mobilised_m = 1;
  const Comparison c = compared(a, goes({-2, -2 * std::sqrt(3.0)}), options);
  const Metric first = metric(c, "travel_angle_first"), apart = metric(c, "travel_angle_difference");
  EXPECT_NEAR(first.value, 45, 1e-4);
  EXPECT_NEAR(first.uncertainty, sigma / std::sqrt(8.0) * 180 / std::numbers::pi, 1e-4);
  EXPECT_EQ(first.unit, "deg");
  EXPECT_NEAR(metric(c, "travel_angle_second").value, 60, 1e-4);
  EXPECT_TRUE(std::isnan(metric(c, "travel_angle_second").uncertainty));
  EXPECT_NEAR(apart.value, 15, 1e-4);
  EXPECT_NEAR(apart.uncertainty, first.uncertainty, 1e-12);
  EXPECT_TRUE(apart.told_apart());
  EXPECT_TRUE(metric(compared(a, a, options), "travel_angle_difference").lost());
  EXPECT_NEAR(metric(compared(a, goes({0, 2}), options), "travel_angle_second").value, -90, 1e-9);  // it rises

  const Comparison still = compared(a, goes({0, 0}), options);
  EXPECT_TRUE(std::isnan(metric(still, "travel_angle_second").value));
  EXPECT_FALSE(has_metric(still, "travel_angle_difference"));
}

// A block of 20 x 10 that sinks by 2 (J = 0.8) or spreads by a quarter: crest and run-out to half a percent of the
// area.
TEST(ByHand, CrestAndRunOut) {
  const ParticleSet set = particles_at(square_lattice(40, 20, 0.5), 0.5);
  const auto made = [&](const char* name, double fx, double fy) {
    return motion_of(
        name, set, {0, 1},
        [=](const Vec2& X, double t) -> Vec2 { return t * Vec2((fx - 1) * X.x(), (fy - 1) * X.y()); },
        [=](const Vec2&, double t) -> Mat2 {
          return Vec2(1 + t * (fx - 1), 1 + t * (fy - 1)).asDiagonal().toDenseMatrix();
        });
  };
  CompareOptions options;
  options.slope_base_m = 0;
  const Comparison c = compared(made("a", 1, 1), made("b", 1.25, 0.8), options);
  EXPECT_NEAR(metric(c, "crest_height_first").value, 0.995 * 10, 0.1);
  EXPECT_NEAR(metric(c, "crest_height_second").value, 0.995 * 8, 0.15);
  EXPECT_NEAR(metric(c, "crest_height_difference").value, -2, 0.1);
  EXPECT_NEAR(metric(c, "crest_height_difference").uncertainty, std::sqrt(2.0) * 0.5 / std::sqrt(12.0), 1e-9);
  EXPECT_NEAR(std::abs(metric(c, "run_out_x_difference").value), 5, 0.2);
  // Common 20 x 8; either 25 x 8 and 20 x 2 above it.
  EXPECT_NEAR(metric(c, "outline_iou").value, 160.0 / 240, 0.02);
}

// A point between particles: in the first data set it moves by t, in the second by t and 0.5 t across.
TEST(ByHand, PointHistories) {
  CompareOptions options;
  options.points_m = {{2.2, 1.7}};
  options.measurement_uncertainty_m = 0.1;
  const std::vector<double> times{0, 1, 2, 3, 4};
  const MotionMemory a = motion_of("a", twenty(), times, [](const Vec2&, double t) -> Vec2 { return Vec2(t, 0); });
  const MotionMemory b =
      motion_of("b", twenty(), times, [](const Vec2&, double t) -> Vec2 { return t * Vec2(1, 0.75); });
  const Comparison c = compared(a, b, options);
  // |u|: t and 1.25 t; distance 0.75 t.
  EXPECT_NEAR(metric(c, "point_1_bias").value, 0.25 * 2, 1e-5);
  EXPECT_NEAR(metric(c, "point_1_rms").value, 0.25 * std::sqrt(6.0), 1e-5);
  EXPECT_NEAR(metric(c, "point_1_p95").value, 1, 1e-5);
  EXPECT_NEAR(metric(c, "point_1_max").value, 1, 1e-5);
  EXPECT_NEAR(metric(c, "point_1_distance_rms").value, 0.75 * std::sqrt(6.0), 1e-5);
  EXPECT_NEAR(metric(c, "point_1_distance_rms").uncertainty, 0.1 * std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(metric(c, "point_1_peak_rate_difference").value, 0.25, 1e-5);
}

}  // namespace
}  // namespace pivnp::compare
