// Metrics against small cases worked by hand: velocities, strain along the path, statistics over time, shape,
// distributions, decomposition, points; and what swapping the data sets does to every metric.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "compare/measures/decomposition.hpp"
#include "compare/measures/distribution.hpp"
#include "compare/measures/history.hpp"
#include "compare/measures/shapes.hpp"
#include "compare/metrics/rows.hpp"
#include "compare/data/statistics.hpp"
#include "pivnp/core/error.hpp"
#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

const DisplacementLaw none = [](const Vec2&, double) { return Vec2(0, 0); };

std::vector<float> over_time(const Comparison& c, const std::string& name) {
  const ComparisonField* field = c.field("over_time_" + name);
  return field == nullptr ? std::vector<float>() : field->values;
}

TEST(Velocity, OfTwoAccelerationsByHand) {
  const ParticleSet set = particles_at(square_lattice(4, 3, 1), 1);
  const std::vector<double> times{0, 0.5, 0.7, 1.6, 2};  // uneven: the parabola is exact all the same
  const auto falling = [&](double a) {
    return motion_of("a", set, times, [=](const Vec2&, double t) { return Vec2(0, -0.5 * a * t * t); });
  };
  const Comparison c = compared(falling(2), falling(3));
  // v2 - v1 = -t at 0.5, 0.7, 1.6.
  EXPECT_NEAR(metric(c, "velocity_bias_y").value, -(0.5 + 0.7 + 1.6) / 3, 1e-5);
  EXPECT_NEAR(metric(c, "velocity_rms").value, std::sqrt((0.25 + 0.49 + 2.56) / 3), 1e-5);
  EXPECT_NEAR(metric(c, "velocity_max").value, 1.6, 1e-5);
  EXPECT_EQ(metric(c, "velocity_rms").unit, "m/s");
  EXPECT_NEAR(metric(c, "velocity_peak_first").value, 2 * 1.6, 1e-5);
  const std::vector<double>& bias = series(c, "velocity_bias_y");
  ASSERT_EQ(bias.size(), 5U);
  EXPECT_TRUE(std::isnan(bias.front()) && std::isnan(bias.back()));
  EXPECT_NEAR(bias[3], -1.6, 1e-5);
}

TEST(StrainAlongThePath, KeepsWhatTheTotalForgets) {
  const ParticleSet set = particles_at(square_lattice(4, 3, 1), 1);
  // Stretched to ln 1.1 and back in both directions of time; incompressible, so dev = 2/sqrt(3) |e| a step.
  const GradientLaw there_and_back = [](const Vec2&, double t) -> Mat2 {
    const double stretch = t < 1.5 && t > 0.5 ? 1.1 : 1.0;
    return Vec2(stretch, 1 / stretch).asDiagonal().toDenseMatrix();
  };
  const Comparison c =
      compared(motion_of("a", set, {0, 1, 2}, none), motion_of("b", set, {0, 1, 2}, none, there_and_back));
  EXPECT_NEAR(metric(c, "strain_dev_bias_final").value, 0, 1e-6);
  // The central increment of a stretch f is 2 (f - 1)/(f + 1) a direction.
  const double x = 2 * 0.1 / 2.1, y = 2 * (1 / 1.1 - 1) / (1 / 1.1 + 1), mean = (x + y) / 3;
  const double step = std::sqrt(2.0 / 3 * ((x - mean) * (x - mean) + (y - mean) * (y - mean) + mean * mean));
  EXPECT_NEAR(metric(c, "strain_dev_path_bias_final").value, 2 * step, 1e-5);
  EXPECT_NEAR(series(c, "strain_dev_path_rms")[1], step, 1e-5);
}

TEST(OverTime, ByHand) {
  OverTime o(2, 40);
  EXPECT_TRUE(std::isnan(o.p95(0)));
  for (int k = 1; k <= 40; ++k) o.add(0, Vec2(k % 2 ? k : -k, 0));
  EXPECT_EQ(o.p95(0), 38);  // nearest rank: 38 of 40 are at most 38
  EXPECT_EQ(o.max(0), 40);
  EXPECT_NEAR(o.bias(0).x(), -0.5, 1e-12);
  EXPECT_NEAR(o.rms(0), std::sqrt(40.0 * 41 * 81 / 6 / 40), 1e-12);
  EXPECT_EQ(o.count(1), 0U);
  for (int k = 0; k < 7; ++k) o.add(1, Vec2(0, 3));
  EXPECT_EQ(o.p95(1), 3);
}

TEST(OverTime, OfEachParticleOfAComparison) {
  const ParticleSet set = particles_at(square_lattice(3, 2, 1), 1);
  const MotionMemory a = motion_of("a", set, {0, 1, 2}, none);
  const MotionMemory b = motion_of("b", set, {0, 1, 2}, [](const Vec2& x, double t) { return Vec2(0, t * x.x()); });
  const Comparison c = compared(a, b);
  const std::vector<float> bias = over_time(c, "displacement_bias_y"), rms = over_time(c, "displacement_rms"),
                           speed = over_time(c, "velocity_max");
  ASSERT_EQ(bias.size(), 6U);
  for (std::size_t p = 0; p < 6; ++p) {
    const double x = set.x0[p].x();
    EXPECT_NEAR(double(bias[p]), x, 1e-6);  // of 0, x, 2x
    EXPECT_NEAR(double(rms[p]), x * std::sqrt(5.0 / 3), 1e-6);
    EXPECT_NEAR(double(speed[p]), x, 1e-6);
  }
}

// Two motions different in everything that is measured.
struct Pair2 {
  ParticleSet set = particles_at(square_lattice(24, 12, 1), 1);
  CompareOptions options;
  MotionMemory one() const {
    return motion_of("one", set, {0, 1, 2, 3}, [](const Vec2& x, double t) -> Vec2 {
      return 0.02 * t * t * Vec2(x.y(), -0.3 * x.x());
    }, [](const Vec2& x, double t) -> Mat2 { return stretched(t * (0.02 + 0.1 * std::exp(-std::pow(x.x() - 9, 2)))); });
  }
  MotionMemory two() const {
    return motion_of(
        "two", set, {0, 1, 2, 3},
        [](const Vec2& x, double t) -> Vec2 { return 0.03 * t * Vec2(x.y() + 0.1 * x.x(), 0.2 * x.y()); },
        [](const Vec2& x, double t) -> Mat2 {
          return stretched(t * (0.01 + 0.2 * std::exp(-std::pow(x.x() - 15, 2))));
        });
  }
  static Mat2 stretched(double e) { return Vec2(std::exp(e), std::exp(-e)).asDiagonal().toDenseMatrix(); }
  Pair2() {
    options.slope_base_m = -3;
    options.points_m = {{3, 3}, {20, 8}};
    options.mobilised_m = 0.4;
    options.measurement_uncertainty_m = 0.01;
  }
};

// Signed metrics change their sign, those of one data set change places, the rest stays; those normalised by one, and
// histories at the first's times, aside.
TEST(Swap, ChangesTheSignsOfSignedMetricsAlone) {
  const Pair2 pair;
  const Comparison ab = compared(pair.one(), pair.two(), pair.options),
                   ba = compared(pair.two(), pair.one(), pair.options);
  int signed_ones = 0, swapped = 0, same = 0;
  for (const Metric& m : ab.metrics) {
    const auto has = [&](const char* part) { return m.name.find(part) != std::string::npos; };
    if (has("relative") || has("decomposition") || has("velocity_peak")) continue;
    std::string other = m.name;
    double sign = 1;
    if (const std::size_t at = other.find("_first"); at != std::string::npos) {
      other.replace(at, 6, "_second");
      ++swapped;
    } else if (const std::size_t at2 = other.find("_second"); at2 != std::string::npos) {
      other.replace(at2, 7, "_first");
    } else if (has("_bias") || has("_difference")) {
      sign = -1;
      ++signed_ones;
    } else {
      ++same;
    }
    if (other.starts_with("coverage_second_final")) continue;  // stated for the first only
    const Metric b = metric(ba, other);
    if (std::isnan(m.value)) {
      EXPECT_TRUE(std::isnan(b.value)) << m.name;
      continue;
    }
    EXPECT_NEAR(m.value, sign * b.value, 1e-9 * std::max(1.0, std::abs(m.value))) << m.name;
  }
  EXPECT_GT(signed_ones, 25);
  EXPECT_GE(swapped, 15);
  EXPECT_GT(same, 25);
}

TEST(Hausdorff, OfTwoSquaresByHand) {
  const auto square = [](const Vec2& corner) {
    return std::vector<std::vector<Vec2>>{
        {corner, corner + Vec2(4, 0), corner + Vec2(4, 4), corner + Vec2(0, 4), corner}};
  };
  // Shifted by 1 along x: the upright sides are 1 away, the level ones on each other but for the last unit.
  EXPECT_NEAR(hausdorff_95(square(Vec2(0, 0)), square(Vec2(1, 0)), 0.01), 1, 1e-9);
  EXPECT_EQ(hausdorff_95(square(Vec2(0, 0)), square(Vec2(0, 0)), 0.01), 0);
  EXPECT_TRUE(std::isnan(hausdorff_95({}, square(Vec2(0, 0)), 0.1)));
}

TEST(Shapes, CrestRetreatAndMobilisedAreaByHand) {
  // A block 20 wide and 10 high; in the second data set the columns beyond x = 14 drop by 4.
  const ParticleSet set = particles_at(square_lattice(20, 10, 1), 1);
  const DisplacementLaw drop = [](const Vec2& x, double t) {
    return x.x() > 14 && x.y() > 6 ? Vec2(20 * t, -x.y() * t) : Vec2(0, 0);
  };
  CompareOptions options;
  options.slope_base_m = 0;
  options.mobilised_m = 1;
  const Comparison c = compared(motion_of("a", set, {0, 1}, none), motion_of("b", set, {0, 1}, drop), options);
  EXPECT_NEAR(metric(c, "crest_retreat_first").value, 0, 1e-9);
  EXPECT_NEAR(metric(c, "crest_retreat_second").value, 6, 0.3);  // from 20 to 14, to a column of the lattice
  EXPECT_EQ(metric(c, "mobilised_area_first").value, 0);
  EXPECT_NEAR(metric(c, "mobilised_area_difference").value, 6 * 4, 1e-6);
  EXPECT_EQ(metric(c, "mobilised_area_difference").unit, "m^2");
  EXPECT_GT(metric(c, "outline_hausdorff_95").value, 1);
}

TEST(AreaMetric, ByHand) {
  EXPECT_NEAR(area_metric({1, 2, 3, 4}, {1.5, 2.5, 3.5, 4.5}), 0.5, 1e-12);  // a shift
  EXPECT_NEAR(area_metric({0, 10}, {5}), 5, 1e-12);                           // 5/2 on each side
  EXPECT_NEAR(area_metric({0, 0, 0, 1}, {0, 1, 1, 1}), 0.5, 1e-12);
  EXPECT_EQ(area_metric({3, 1, 2}, {2, 3, 1}), 0);
  EXPECT_TRUE(std::isnan(area_metric({std::nan("")}, {1})));
}

TEST(Decomposition, RecoversPolynomialsOnAnOddShape) {
  std::vector<Vec2> x;
  for (const Vec2& p : square_lattice(40, 30, 0.1))
    if (p.y() < 3 - 0.6 * p.x() && (p - Vec2(1, 1)).norm() > 0.4) x.push_back(p);  // a slope with a hole
  const OrthonormalBasis basis(x);
  EXPECT_GT(basis.size(), 60U);
  for (std::size_t a = 0; a < basis.size(); a += 7)
    for (std::size_t b = 0; b < basis.size(); ++b) {
      double dot = 0;
      for (std::size_t k = 0; k < x.size(); ++k) dot += basis.term(a)[k] * basis.term(b)[k] / double(x.size());
      EXPECT_NEAR(dot, a == b ? 1 : 0, 1e-9);
    }
  std::vector<double> first, second;
  for (const Vec2& p : x) {
    first.push_back(1 + p.x() * p.x() - p.x() * p.y() * p.y());
    second.push_back(first.back() + 0.25);
  }
  const Decomposition d = decompose(basis, x, first, second, 0.01, 1e-9);
  EXPECT_EQ(d.first.size(), 10U);  // all of degree three
  EXPECT_LT(d.residual_first, 1e-9);
  EXPECT_TRUE(d.adequate);
  EXPECT_NEAR(d.second[0] - d.first[0], 0.25, 1e-9);  // the mean
  for (std::size_t k = 1; k < 10; ++k) EXPECT_NEAR(d.second[k] - d.first[k], 0, 1e-9);
  EXPECT_NEAR(d.outside(), 0.1, 1e-12);
  EXPECT_NEAR(d.uncertainty, 0.01, 1e-9);
}

TEST(Decomposition, SaysWhenWhatIsLocalIsLost) {
  const std::vector<Vec2> x = square_lattice(60, 60, 1);
  std::vector<double> first;
  for (const Vec2& p : x) first.push_back(p.x() / 60 + ((p - Vec2(30, 30)).norm() < 3 ? 5 : 0));
  const Decomposition d = decompose(OrthonormalBasis(x), x, first, first, 0, 1e-9);
  EXPECT_FALSE(d.adequate);
  EXPECT_GT(d.cluster_first, 0.003);
  EXPECT_EQ(d.outside(), 0);
}

TEST(TimeHistory, ByHand) {
  const TimeHistory h{{0, 1, 2, 3, 4}, {0, 0, 10, 20, 20}};
  const double unknown = std::nan("");
  EXPECT_NEAR(onset(h, unknown).value, 1.1, 1e-12);  // 5 % of 20
  EXPECT_NEAR(rest(h, unknown).value, 2.9, 1e-12);   // 19
  EXPECT_NEAR(peak_rate(h, unknown).value, 10, 1e-12);
  // The interval alone: 1 / sqrt(12). With errors of .1: the slope between 2.5 and 10 % is 10.
  EXPECT_NEAR(onset(h, unknown).uncertainty, 1 / std::sqrt(12.0), 1e-12);
  EXPECT_NEAR(onset(h, 0.1).uncertainty, std::sqrt(1 / 12.0 + 2 * 0.01 * 0.01), 1e-12);
  EXPECT_NEAR(rest(h, 0.1).uncertainty, onset(h, 0.1).uncertainty, 1e-12);
  EXPECT_NEAR(peak_rate(h, 0.1).uncertainty, 0.1 * std::sqrt(0.5), 1e-12);
  EXPECT_TRUE(std::isnan(onset(h, 1).uncertainty));  // noise of sqrt(2) at a threshold of 1
  EXPECT_NEAR(value_at(h, 2.25), 12.5, 1e-12);
  EXPECT_TRUE(std::isnan(value_at(h, 4.1)));
  EXPECT_TRUE(std::isnan(onset(TimeHistory{{0, 1}, {2, 2}}, unknown).value));
  const auto measures = measure_histories("point_7", "the front", h, TimeHistory{{1, 5}, {1, 25}}, {}, "m", "s");
  ASSERT_TRUE(measures);
  const std::vector<Metric> metrics = metrics_of(*measures);
  // Second minus first at 1, 2, 3, 4: 1, -3, -7, -1.
  const auto value = [&](const std::string& name) { return find(metrics, "point_7_" + name)->value; };
  EXPECT_NEAR(value("bias"), -2.5, 1e-12);
  EXPECT_NEAR(value("rms"), std::sqrt(60.0 / 4), 1e-12);
  EXPECT_NEAR(value("max"), 7, 1e-12);
  EXPECT_NEAR(value("onset_difference"), 1.2 - 1.1, 1e-12);
  EXPECT_FALSE(measure_histories("x", "x", h, TimeHistory{{7, 8}, {1, 2}}, {}, "m", "s"));
}

// Criterion: onset and time to rest of noisy histories scatter as stated (a factor 1.5 either way), sampled finely: the
// part of the interval, which a straight rise does not need, is small then.
TEST(TimeHistory, OnsetAndRestScatterAsStated) {
  const unsigned seed = 42;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const double sigma = 0.004;
  std::normal_distribution<double> noise(0, sigma);
  const int runs = 400;
  double square_onset = 0, square_rest = 0, stated = 0;
  for (int run = 0; run < runs; ++run) {
    TimeHistory h;
    for (int k = 0; k <= 200; ++k) {
      const double t = 0.02 * k;
      h.time.push_back(t);
      h.value.push_back(std::clamp(t - 1, 0.0, 2.0) / 2 + noise(random));
    }
    const Estimate a = onset(h, sigma), b = rest(h, sigma);
    square_onset += (a.value - 1.1) * (a.value - 1.1) / runs;
    square_rest += (b.value - 2.9) * (b.value - 2.9) / runs;
    stated += a.uncertainty / runs;
  }
  EXPECT_LT(std::sqrt(square_onset), 1.5 * stated);
  EXPECT_GT(std::sqrt(square_onset), stated / 1.5);
  EXPECT_LT(std::sqrt(square_rest), 1.5 * stated);
  EXPECT_GT(std::sqrt(square_rest), stated / 1.5);
}

TEST(PointHistories, ByHand) {
  const ParticleSet set = particles_at(square_lattice(6, 6, 1), 1);
  const auto law = [](double start) {
    return DisplacementLaw([=](const Vec2& x, double t) { return Vec2(0, -x.x() * std::clamp(t - start, 0.0, 2.0)); });
  };
  std::vector<double> times;
  for (int k = 0; k <= 20; ++k) times.push_back(0.25 * k);
  CompareOptions options;
  options.points_m = {{3, 3}, {50, 50}};  // between four particles; nowhere
  const Comparison c = compared(motion_of("a", set, times, law(1)), motion_of("b", set, times, law(2)), options);
  EXPECT_NEAR(metric(c, "point_1_onset_first").value, 1.1, 1e-5);  // 5 % of 6 at 3 a second
  EXPECT_NEAR(metric(c, "point_1_onset_difference").value, 1, 1e-5);
  EXPECT_NEAR(metric(c, "point_1_peak_rate_first").value, 3, 1e-5);
  EXPECT_NEAR(metric(c, "point_1_rest_first").value, 2.9, 1e-5);
  EXPECT_NEAR(metric(c, "point_1_max").value, 3, 1e-5);
  EXPECT_FALSE(has_metric(c, "point_2_rms"));
  bool said = false;
  for (const std::string& r : c.remarks) said = said || r.find("(50, 50)") != std::string::npos;
  EXPECT_TRUE(said);
  ASSERT_FALSE(c.tables.empty());
}

TEST(Limits, EveryKeyJudgesItsMetric) {
  const Pair2 pair;
  LimitOptions limits;
  LimitOptions::fields(limits, [](std::string_view, std::optional<double>& limit, const OptionInfo&) { limit = 1e-9; });
  limits["outline_iou_min"] = 0.999;
  limits["coverage_min"] = 1;
  const Comparison c = compared(pair.one(), pair.two(), pair.options, limits);
  ASSERT_EQ(c.limits.size(), 14U);
  for (const LimitResult& l : c.limits) {
    EXPECT_EQ(l.met, l.key == "coverage_min") << l.key << " reached " << l.reached;
    EXPECT_EQ(std::isfinite(l.reached), l.key != "slope_angle_deg" && l.key != "history_rms")
        << l.key;  // a vertical face has no angle; there is no history here
  }
  EXPECT_TRUE(any_exceeded(c.limits));
  LimitOptions slope;
  slope["run_out_m"] = 1;
  EXPECT_THROW(compared(pair.one(), pair.two(), {}, slope), InputError);  // without a base
  LimitOptions unknown;
  unknown["displacement_over_u"] = 1;
  const Comparison u = compared(pair.one(), pair.two(), {}, unknown);  // no uncertainty: no verdict means not met
  EXPECT_TRUE(any_exceeded(u.limits));
}

}  // namespace
}  // namespace pivnp::compare
