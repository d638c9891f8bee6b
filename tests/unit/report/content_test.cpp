// What is computed for the figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <set>
#include <span>

#include "apps/report/content/differences.hpp"
#include "apps/report/content/fields.hpp"
#include "apps/report/content/point_curves.hpp"
#include "apps/report/content/material.hpp"
#include "apps/report/content/metric_layout.hpp"
#include "apps/report/content/quality.hpp"
#include "apps/report/content/selection.hpp"
#include "pivnp/core/particles/gauge.hpp"
#include "pivnp/core/particles/places.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "tests/unit/report/synthetic.hpp"

namespace pivnp::report {
namespace {

TEST(Content, PointCurvesReproduceAffineMotion) {
  ParticleSet set;
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) {
      set.id.push_back(j * 5 + i);
      set.label.push_back(0);
      set.x0.emplace_back(i, j);
      set.area.push_back(1);
      set.born.push_back(0);
      set.end.push_back(NAN);
      set.end_reason.push_back(EndReason::none);
    }
  Mat2 G;
  G << 0.25, 0.5, -0.125, 0.0625;
  MotionMemory motion("np", "m", "s", set);
  for (int k = 0; k < 3; ++k) {
    MotionFrame f;
    f.time = k;
    for (const Vec2& x : set.x0) {
      const Vec2 u = k * (G * x + Vec2(1, 2));
      f.u.push_back({float(u.x()), float(u.y())});
      f.F.push_back({1, 0, 0, 1});
      f.status.push_back(ParticleStatus::active);
      f.cov_u.push_back({0.04f, 0.09f, 0});
    }
    motion.add(f);
  }
  const Vec2 inside(1.3, 2.6);
  const auto h = point_curves(motion, {inside, Vec2(2, 2), Vec2(40, 40)});
  ASSERT_EQ(h.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(h[0].displacement[k], double(k) * (G * inside + Vec2(1, 2)).norm(), 1e-6);
    EXPECT_NEAR(h[1].displacement[k], double(k) * (G * Vec2(2, 2) + Vec2(1, 2)).norm(), 1e-6);
    EXPECT_TRUE(std::isnan(h[2].displacement[k]));
  }
  // u of particle (2, 2) points along (2.5, 1.875), that is (0.8, 0.6): variance 0.64 * 0.04 + 0.36 * 0.09.
  EXPECT_NEAR(h[1].sigma[1], std::sqrt(0.64 * 0.04 + 0.36 * 0.09), 1e-6);
}

// A plane through wet and dry particles is below zero at the dry face; what is linear stays so, suction too.
TEST(Content, PointCurvesGiveDryParticlesNoTension) {
  ParticleSet set;
  for (int k = 0; k < 25; ++k) {
    set.id.push_back(k);
    set.label.push_back(0);
    set.x0.emplace_back(k % 5, k / 5);
    set.area.push_back(1);
    set.born.push_back(0);
    set.end.push_back(NAN);
    set.end_reason.push_back(EndReason::none);
  }
  MotionMemory motion("mpm", "m", "s", set);
  for (const bool dry : {true, false}) {
    MotionFrame f;
    f.time = dry ? 0 : 1;
    f.u.assign(25, {0, 0});
    f.F.assign(25, {1, 0, 0, 1});
    f.status.assign(25, ParticleStatus::active);
    const std::span<float> pressure = f.add("pressure", 25);
    for (int k = 0; k < 25; ++k) {
      const float linear = 3 - float(set.x0[std::size_t(k)].y());
      pressure[std::size_t(k)] = dry ? std::max(0.f, 50 * linear) : linear;
    }
    motion.add(f);
  }
  const PointCurve at = point_curves(motion, {Vec2(4, 3.9)}).front();
  ASSERT_EQ(at.pressure.size(), 2u);
  EXPECT_EQ(at.pressure[0], 0);
  EXPECT_NEAR(at.pressure[1], -0.9, 1e-6);
}

TEST(Content, TimesAndPoints) {
  SyntheticOptions o;
  o.spacing_m = 0.01;
  const Synthetic s = make_synthetic(o);
  const std::vector<double> times = chosen_times({}, s.content);
  ASSERT_EQ(times.size(), 3u);
  EXPECT_DOUBLE_EQ(times.back(), 0.5);
  EXPECT_LT(times[0], times[1]);
  const std::vector<Vec2> points = chosen_points({}, s.content);
  ASSERT_EQ(points.size(), 3u);
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < a; ++b) EXPECT_GT((points[a] - points[b]).norm(), 0.01);
  EXPECT_FALSE(frame_at(*s.content.measured, 0.7));
  EXPECT_EQ(*frame_at(*s.content.measured, 0.301), 15u);
}

TEST(Content, PairsAreCounted) {
  const Synthetic s = make_synthetic({});
  const auto pairs = pair_quality(s.content);
  ASSERT_EQ(pairs.size(), 25u);
  for (const PairQuality& q : pairs) {
    EXPECT_EQ(q.valid + q.replaced + q.rejected + q.failed, q.nodes);
    EXPECT_NEAR(q.sigma, 4e-5, 1e-9);
    EXPECT_LE(q.score_low, q.score_median);
  }
  EXPECT_NE(pairs[15].flag, 0);
  EXPECT_EQ(pairs[14].flag, 0);
  EXPECT_LT(pairs[15].share(pairs[15].valid), 0.5);
}

// A grid that reaches far beyond the material: what windows in front of the background gave is neither here nor there.
TEST(Content, SharesAreOfTheMaterial) {
  SyntheticOptions o;
  o.frames = 4;
  o.spacing_m = 0.01;
  Synthetic s = make_synthetic(o);
  s.content.tracked = s.content.measured;
  const VectorField real = s.content.pair(1);
  const auto inside = nodes_in_material(s.content, real);
  ASSERT_EQ(inside.size(), real.status.size());
  const MotionFrame at = s.content.tracked->frame(1);
  const auto distance = [&](const Vec2& x) {
    double least = 1;
    for (std::size_t p = 0; p < at.u.size(); ++p)
      least = std::min(least, (s.content.tracked->particles().x0[p] + Vec2(double(at.u[p][0]), double(at.u[p][1])) - x).norm());
    return least;
  };
  std::size_t material = 0, outside = 0;
  s.content.pair = [&](std::size_t) {
    VectorField f = real;
    for (std::size_t n = 0; n < f.status.size(); ++n)
      f.status[n] = inside[n] ? VectorStatus::valid : n % 2 ? VectorStatus::valid : VectorStatus::rejected;
    return f;
  };
  for (int j = 0; j < real.grid.ny; ++j)
    for (int i = 0; i < real.grid.nx; ++i) {
      const bool in = inside[real.grid.node(i, j)];
      const double d = distance(real.grid.position(i, j));
      EXPECT_FALSE(in && d > 0.0100) << i << ", " << j;  // a particle's spacing from all of them
      EXPECT_FALSE(!in && d < 0.0049) << i << ", " << j;
      ++(in ? material : outside);
    }
  ASSERT_GT(material, 50u);
  ASSERT_GT(outside, 50u);
  const PairQuality q = pair_quality(s.content).at(1);
  EXPECT_EQ(q.nodes, material);
  EXPECT_EQ(q.outside, outside);
  EXPECT_EQ(q.share(q.valid), 1.0);
}

// |u| of the second minus |u| of the first, and the RMS against time, from fields worked by hand.
TEST(Content, Differences) {
  SyntheticOptions o;
  o.spacing_m = 0.01;
  const Synthetic s = make_synthetic(o);
  const auto first = fields_at(*s.content.measured, "displacement_magnitude", true, {0.4});
  const auto second = fields_at(*s.content.simulated, "displacement_magnitude", true, {0.4});
  const auto d = field_difference(s.content, "displacement_magnitude", 0.4, first[0]);
  ASSERT_EQ(d.size(), first[0].value.size());
  std::size_t compared = 0;
  for (std::size_t p = 0; p < d.size(); ++p) {
    if (std::isnan(d[p])) continue;
    EXPECT_NEAR(d[p], second[0].value[p] - first[0].value[p], 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 100u);
  EXPECT_TRUE(field_difference(s.content, "strain_vol", 0.4, first[0]).empty());
  const DifferenceCurve h = difference_curve(s.content);
  ASSERT_EQ(h.time.size(), 26u);
  EXPECT_NEAR(h.sigma[4], std::sqrt(2.0) * 4e-5 * 2, 1e-9);
  EXPECT_GT(h.rms.back(), h.median.back());
}

// Every metric has one place, whatever its name; a family has two members at least.
TEST(Content, EveryMetricIsLaidOutOnce) {
  std::vector<Metric> metrics;
  for (const char* name : {"displacement_bias_x", "displacement_rms", "displacement_max", "displacement_rms_final_over_u", "displacement_max_final_over_u",
                           "strain_dev_bias", "strain_dev_rms", "run_out_x_first", "run_out_x_second", "run_out_x_difference", "coverage_first",
                           "coverage_second", "coverage_first_final", "u_val", "history_rms", "velocity_peak_first", "rms", "biased_x"})
    metrics.push_back({name, 1, "m", 0.1, "", Verdict::none});
  const MetricLayout layout = layout_of(metrics);
  std::set<const Metric*> seen(layout.single.begin(), layout.single.end());
  std::size_t places = layout.single.size();
  const auto take = [&](const Metric* m) {
    if (m == nullptr) return;
    seen.insert(m);
    ++places;
  };
  for (const StatisticsRow& row : layout.statistics)
    for (const Metric* m : row.members) take(m);
  for (const BothRow& row : layout.both) take(row.first), take(row.second), take(row.difference);
  EXPECT_EQ(places, metrics.size());
  EXPECT_EQ(seen.size(), metrics.size());
  ASSERT_EQ(layout.statistics.size(), 3u);
  EXPECT_EQ(layout.statistics[1].stem, "displacement_final_over_u");
  EXPECT_EQ(layout.statistics[0].members[1], nullptr);
  EXPECT_EQ(layout.statistics[2].members[2]->name, "strain_dev_rms");
  ASSERT_EQ(layout.both.size(), 2u);
  EXPECT_EQ(layout.both[0].difference->name, "run_out_x_difference");
  EXPECT_EQ(&layout.both[1].any(), layout.both[1].first);
  EXPECT_EQ(layout.single.size(), 6u);
}

// A sheared and stretched square whose displacements carry noise of their own.
std::shared_ptr<MotionMemory> noisy(const Mat2& F, double noise) {
  ParticleSet set;
  MotionFrame first, last;
  last.time = 1;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 30; ++i) {
      const Vec2 x(0.01 * i, 0.01 * j), u = (F - Mat2::Identity()) * x + noise * Vec2(normal(random), normal(random));
      set.id.push_back(set.id.size());
      set.label.push_back(0);
      set.x0.push_back(x);
      set.area.push_back(1e-4);
      set.born.push_back(0);
      set.end.push_back(nan_value);
      set.end_reason.push_back(EndReason::none);
      first.u.push_back({0, 0});
      last.u.push_back({float(u.x()), float(u.y())});
      for (MotionFrame* f : {&first, &last}) {
        f->F.push_back({1, 0, 0, 1});
        f->status.push_back(ParticleStatus::active);
        f->cov_u.push_back({1e-8f, 1e-8f, 0});
      }
    }
  auto motion = std::make_shared<MotionMemory>("np", "m", "s", set);
  motion->add(first);
  motion->add(last);
  return motion;
}

// An affine motion has one strain over any gauge; noise goes with the gauge, as 1 / length^2 in two dimensions.
TEST(Content, StrainOverAnotherGauge) {
  Mat2 F;
  F << 1.1, 0.2, -0.05, 0.9;
  const MotionFrame exact = with_gauge(noisy(F, 0), 0.05)->frame(1);
  for (const auto& f : exact.F) EXPECT_LT((matrix(f) - F).cwiseAbs().maxCoeff(), 1e-5);
  const auto scatter = [&](double gauge) {
    const MotionFrame frame = with_gauge(noisy(F, 1e-4), gauge)->frame(1);
    double sum = 0, n = 0;
    for (const auto& f : frame.F) sum += (matrix(f) - F).squaredNorm(), ++n;
    return std::sqrt(sum / n);
  };
  const double ratio = scatter(0.045) / scatter(0.09);
  EXPECT_GT(ratio, 2.5);  // 4 where a gauge holds many particles
  EXPECT_LT(ratio, 5.5);
  EXPECT_TRUE(std::isnan(with_gauge(noisy(F, 0), 0.015)->frame(1).F[40][0]));  // no neighbour within it
}

TEST(Content, ExtensometersAndSections) {
  Mat2 F;
  F << 1.1, 0, 0, 0.9;
  const auto motion = noisy(F, 0);
  const ExtensometerCurve along = extensometer(*motion, {0.05, 0.1}, {0.25, 0.1}), up = extensometer(*motion, {0.1, 0.05}, {0.1, 0.25});
  EXPECT_NEAR(along.strain.at(1), 0.1, 1e-6);
  EXPECT_NEAR(up.strain.at(1), -0.1, 1e-6);
  EXPECT_EQ(along.strain.at(0), 0);
  EXPECT_NEAR(along.sigma.at(1), std::sqrt(2.0) * 1e-4 / 0.2, 1e-7);
  EXPECT_TRUE(std::isnan(extensometer(*motion, {0.05, 0.1}, {2, 2}).strain.at(1)));
  // u_x = 0.1 X = 0.1 x / 1.1, of the particle nearest to the place.
  const SectionCurve curve = section(*motion, "displacement_x", true, 1, {0.0, 0.1}, {0.5, 0.1});
  for (std::size_t k = 0; k < curve.distance.size(); ++k) {
    if (curve.distance[k] < 0.3) {
      EXPECT_NEAR(curve.value[k], 0.1 * curve.distance[k] / 1.1, 0.1 * 0.0051);
    }
    if (curve.distance[k] > 0.34) {
      EXPECT_TRUE(std::isnan(curve.value[k]));
    }
  }
}

// F = diag(1.2, 1) with errors of .01 a component: the volumetric strain errs by .01 sqrt(1/1.44 + 1).
TEST(Content, StrainsBringTheirUncertainty) {
  Mat2 F;
  F << 1.2, 0, 0, 1;
  const auto plain = noisy(F, 0);
  auto motion = std::make_shared<MotionMemory>("np", "m", "s", plain->particles());
  for (std::size_t k = 0; k < 2; ++k) {
    MotionFrame f = plain->frame(k);
    const std::span<float> cov = f.add("cov_F", f.F.size());
    for (std::size_t p = 0; p < f.F.size(); ++p) {
      if (k == 1) f.F[p] = {1.2f, 0, 0, 1};
      cov[3 * p] = cov[3 * p + 1] = k == 1 ? 1e-4f : 0;
    }
    motion->add(f);
  }
  const SectionCurve along = section(*motion, "strain_vol", true, 1, {0.05, 0.1}, {0.25, 0.1});
  ASSERT_EQ(along.sigma.size(), along.value.size());
  EXPECT_NEAR(along.value[60], std::log(1.2), 1e-6);
  EXPECT_NEAR(along.sigma[60], .01 * std::sqrt(1 / 1.44 + 1), 1e-6);
  EXPECT_NEAR(section(*motion, "displacement_x", true, 1, {0.05, 0.1}, {0.25, 0.1}).sigma.at(60), 1e-4, 1e-9);  // of cov_u
  EXPECT_TRUE(section(*plain, "strain_vol", true, 1, {0.05, 0.1}, {0.25, 0.1}).sigma.empty());
  const PointCurve point = point_curves(*motion, {Vec2(.1, .1)}).front();
  ASSERT_EQ(point.strain_sigma.size(), 2u);
  EXPECT_EQ(point.strain_sigma[0], 0);
  EXPECT_NEAR(point.strain[1], deviatoric(log_strain(F)), 1e-6);
  EXPECT_GT(point.strain_sigma[1], .003);
  EXPECT_LT(point.strain_sigma[1], .01);
  EXPECT_TRUE(point_curves(*plain, {Vec2(.1, .1)}).front().strain_sigma.empty());
  // Over another gauge F is another.
  EXPECT_EQ(with_gauge(motion, 0.05)->frame(1).find("cov_F"), nullptr);
}

}  // namespace
}  // namespace pivnp::report
