// Strain differences against their own uncertainty: covariances of F, the gauge length, and no zone that stands still.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "compare/uncertainty/gauge.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

constexpr int cells = 14;

// F = stretch by 1.2 along x, with errors of standard deviation `sigma` in each component, alike within cells of `alike`.
struct Made {
  double sigma = 0, alike = 1, more = 0;  // more: volumetric strain that is added
  bool states = true;
  unsigned seed = 1;

  MotionMemory motion(const std::string& name) const {
    const ParticleSet set = particles_at(square_lattice(cells, cells, 1), 1);
    MotionMemory motion(name, "m", "s", set);
    for (const double t : {0.0, 1.0}) {
      std::mt19937 random(seed);
      std::normal_distribution<double> normal;
      std::map<std::pair<int, int>, Mat2> drawn;
      MotionFrame f = frame_of(set, t, [](const Vec2&, double) { return Vec2(0, 0); }, rigid);
      f.cov_u.assign(set.size(), {1e-6f, 1e-6f, 0});
      std::span<float> cov;
      if (states) cov = f.add("cov_F", set.size());
      for (std::size_t p = 0; p < set.size(); ++p) {
        const auto [at, fresh] = drawn.try_emplace({int(set.x0[p].x() / alike), int(set.x0[p].y() / alike)}, Mat2::Zero());
        if (fresh)
          for (double& e : at->second.reshaped()) e = t * sigma * normal(random);
        Mat2 F = Mat2::Identity();
        F(0, 0) += 0.2 * t;
        F = std::exp(more * t / 2) * F + at->second;
        f.F[p] = {float(F(0, 0)), float(F(0, 1)), float(F(1, 0)), float(F(1, 1))};
        if (states) cov[3 * p] = cov[3 * p + 1] = float(t * sigma * sigma);
      }
      motion.add(f);
    }
    return motion;
  }
};

StrainNote gauge_of(double length) {
  StrainNote note;
  note.gauge_length = length;
  return note;
}

Comparison with(const MotionSource& a, const MotionSource& b, const StrainNotes& notes = {}) {
  SilentProgress progress;
  return compare(a, b, {}, {}, progress, {}, notes);
}

// ln J of F = diag(1.2, 1): variance s^2 (1/1.2^2 + 1).
TEST(StrainUncertainty, IsThatOfTheGradientsOfBoth) {
  const Made one{.sigma = .01, .seed = 2}, other{.sigma = .01, .seed = 3};
  const double vol = .01 * std::sqrt(1 / 1.44 + 1);
  const Comparison c = with(one.motion("a"), Made{.states = false}.motion("b"));
  EXPECT_TRUE(std::isnan(metric(c, "strain_vol_rms_final").uncertainty));  // the second measures, and knows no error of F
  Made exact;
  const Comparison single = with(one.motion("a"), exact.motion("b"));
  EXPECT_NEAR(metric(single, "strain_vol_rms_final").uncertainty, vol, .02 * vol);
  EXPECT_NE(metric(single, "strain_vol_rms_final").definition.find("covariances of F of both"), std::string::npos);
  const Comparison both = with(one.motion("a"), other.motion("b"));
  EXPECT_NEAR(metric(both, "strain_vol_rms_final").uncertainty, vol * std::sqrt(2.0), .02 * vol);
  for (const char* name : {"strain_dev_rms", "strain_dev_rms_final", "strain_dev_p95_final", "strain_dev_max", "strain_vol_rms_final",
                           "strain_dev_field_rms", "strain_vol_field_rms", "area_metric_strain_dev",
                           "decomposition_strain_dev_distance"})
    EXPECT_TRUE(metric(both, name).lost()) << name;
  ASSERT_EQ(series(both, "strain_dev_uncertainty").size(), 2u);
  EXPECT_GT(series(both, "strain_dev_uncertainty")[1], 0);
  // A path adds up errors of increments, of which no covariance of F tells anything.
  EXPECT_TRUE(std::isnan(metric(both, "strain_dev_path_rms").uncertainty));
  // A volumetric strain of four standard deviations.
  const Comparison more = with(one.motion("a"), Made{.sigma = .01, .more = 4 * vol, .seed = 3}.motion("b"));
  EXPECT_TRUE(metric(more, "strain_vol_rms_final").told_apart());
  EXPECT_TRUE(metric(more, "strain_vol_field_rms").told_apart());
}

// Where errors reach over three particles, a mean is known much better than one of them, and is not told apart by chance.
TEST(StrainUncertainty, OfAMeanKnowsHowFarErrorsAreShared) {
  constexpr int runs = 60;
  int alarms = 0, found = 0;
  double uncertainty = 0;
  for (int run = 0; run < runs; ++run) {
    const unsigned seed = 100 + 3 * unsigned(run);
    const MotionMemory exact = Made{}.motion("exact"), a = Made{.sigma = .01, .alike = 3, .seed = seed}.motion("a"),
                       shifted = Made{.more = .011}.motion("more");
    const StrainNotes notes{gauge_of(3), gauge_of(3)};
    const Metric same = metric(with(a, exact, notes), "strain_vol_field_mean"), plain = metric(with(a, exact, notes), "strain_vol_bias_final");
    uncertainty += same.uncertainty / runs;
    EXPECT_GT(plain.uncertainty, 0);
    alarms += same.told_apart();
    found += metric(with(a, shifted, notes), "strain_vol_field_mean").told_apart();
  }
  EXPECT_LT(uncertainty, .5 * .01 * std::sqrt(1 / 1.44 + 1));
  EXPECT_LE(alarms, 6);
  EXPECT_GE(found, .9 * runs);
}

TEST(StrainUncertainty, AFloorIsTheLeastItCanBe) {
  StrainNote note;
  note.floor_dev = .05, note.floor_vol = .06, note.floor_path = .07;
  const Comparison c = with(Made{.sigma = .01}.motion("a"), Made{}.motion("b"), {note, note});
  EXPECT_NEAR(metric(c, "strain_vol_rms_final").uncertainty, .06 * std::sqrt(2.0), 1e-12);
  note.floor_dev = note.floor_vol = 1e-4;
  const Comparison low = with(Made{.sigma = .01}.motion("a"), Made{}.motion("b"), {note, note});
  EXPECT_GT(metric(low, "strain_vol_rms_final").uncertainty, .01);
}

// A band of half width 1.5 that the first shows averaged over 6: the same, if that is known.
TEST(StrainUncertainty, AveragingOverTheGaugeIsNoDifference) {
  const ParticleSet set = particles_at(square_lattice(40, 20, .5), .5);
  const auto shear = [](double x) { return .4 * std::exp(-.5 * std::pow((x - 10) / 1.5, 2)); };
  const auto banded = [&](const std::string& name, double over) {
    MotionMemory motion(name, "m", "s", set);
    for (const double t : {0.0, 1.0}) {
      MotionFrame f = frame_of(set, t, [](const Vec2&, double) { return Vec2(0, 0); }, rigid);
      if (over > 0) f.cov_u.assign(set.size(), {1e-6f, 1e-6f, 0});
      if (over > 0)
        for (float& v : f.add("cov_F", set.size())) v = 1e-8f;
      for (std::size_t p = 0; p < set.size(); ++p) {
        double sum = 0;
        for (int k = -12; k <= 12; ++k) sum += shear(set.x0[p].x() + k * over / 25) / 25;
        f.F[p][2] = float(t * sum);
      }
      motion.add(f);
    }
    return motion;
  };
  const MotionMemory sharp = banded("mpm", 0), seen = banded("np", 6);
  const Comparison known = with(seen, sharp, {gauge_of(6), {}}), unknown = with(seen, sharp);
  EXPECT_TRUE(metric(unknown, "strain_dev_rms_final").told_apart());
  for (const char* name : {"strain_dev_rms_final", "strain_dev_max_final", "strain_dev_field_rms"})
    EXPECT_TRUE(metric(known, name).lost()) << name;
  const Metric rms = metric(known, "strain_dev_rms_final");
  EXPECT_NEAR(rms.uncertainty, rms.value, .15 * rms.value);  // what averaging takes off is what they differ by
  EXPECT_TRUE(metric(with(sharp, seen, {std::nullopt, gauge_of(6)}), "strain_dev_rms_final").lost());
  // Both average alike: a difference is one.
  EXPECT_TRUE(metric(with(seen, banded("b", 1e-9), {gauge_of(6), gauge_of(6)}), "strain_dev_rms_final").told_apart());
}

TEST(GaugeAverage, OverASquareByHand) {
  const std::vector<Vec2> X{{.5, .5}, {1.5, .5}, {3.9, .5}, {30, .5}};
  std::vector<Mat2> F;
  for (const double v : {1.0, 2.0, 6.0, 8.0}) F.push_back(Mat2::Constant(v));
  const std::vector<Mat2> mean = GaugeAverage(X, 5).of(F);  // cells of 1: two to either side
  EXPECT_NEAR(mean[0](0, 0), 1.5, 1e-12);
  EXPECT_NEAR(mean[1](0, 0), 3, 1e-12);
  EXPECT_NEAR(mean[2](0, 0), 4, 1e-12);
  EXPECT_NEAR(mean[3](0, 0), 8, 1e-12);
}

}  // namespace
}  // namespace pivnp::compare
