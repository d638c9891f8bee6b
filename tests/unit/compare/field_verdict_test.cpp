// What is said of what is lost in its uncertainty: the mean over a field whose errors are shared over a known length, tolerances
// that are shown, differences that would have been seen, no verdict over too little, and numerics metric by metric.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "compare/alignment/onset.hpp"
#include "compare/metrics/numerical.hpp"
#include "compare/metrics/significance.hpp"
#include "compare/shapes/ridges.hpp"
#include "compare/uncertainty/numerics.hpp"
#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace field_verdict {

constexpr int nx = 100, ny = 50, cell = 5;  // 5,000 particles, errors shared by 5 x 5 of them
constexpr double sigma = 0.01;

// `scale`: of the errors against what is stated of them.
MotionMemory measured(std::mt19937& random, double bias, double scale) {
  const ParticleSet set = particles_at(square_lattice(nx, ny, 1), 1);
  std::normal_distribution<double> normal(0, sigma * scale);
  std::map<int, Vec2> shared;
  MotionMemory motion("np", "m", "s", set);
  for (int k = 0; k < 2; ++k) {
    MotionFrame f = frame_of(set, k, [&](const Vec2& x, double t) -> Vec2 {
      const int group = int(x.y()) / cell * nx + int(x.x()) / cell;
      auto at = shared.find(group);
      if (at == shared.end()) at = shared.emplace(group, Vec2(normal(random), normal(random))).first;
      return t * (Vec2(2 + 0.01 * x.y(), bias) + at->second);
    }, rigid);
    f.cov_u.assign(set.size(), {float(k * sigma * sigma), float(k * sigma * sigma), 0});
    motion.add(std::move(f));
  }
  return motion;
}

MotionMemory simulated() {
  return motion_of("mpm", particles_at(square_lattice(nx, ny, 1), 1), {0, 1},
                   [](const Vec2& x, double t) -> Vec2 { return t * Vec2(2 + 0.01 * x.y(), 0); });
}

#if defined(__SANITIZE_ADDRESS__)
constexpr int many = 6;
#else
constexpr int many = 48;
#endif

int flagged(double bias, double scale, bool correlation_known, int runs) {
  std::mt19937 random(99);
  StrainNote note;
  if (correlation_known) note.gauge_length = cell;
  SilentProgress progress;
  const MotionMemory second = simulated();
  int count = 0;
  for (int run = 0; run < runs; ++run) {
    const Comparison c = compare(measured(random, bias, scale), second, {}, {}, progress, {}, {note, {}});
    count += metric(c, "displacement_bias_y_final").told_apart();
  }
  return count;
}

// Criterion: a bias of one u_val is found in 48 of 48 comparisons; none is found in at most 8 %, be the errors as stated or
// twice as large.
TEST(FieldVerdict, ABiasOfOneUValOverFiveThousandParticlesIsSeen) {
  EXPECT_EQ(flagged(sigma, 1, true, many), many);
  EXPECT_LE(flagged(0, 1, true, many), 4);
  EXPECT_LE(flagged(0, 2, true, many), 5);
  // Nothing is known of how far errors are shared: they may be one and the same everywhere.
  EXPECT_EQ(flagged(sigma, 1, false, many / 6), 0);
}

TEST(FieldVerdict, ACorrelationLengthThatIsGivenWins) {
  std::mt19937 random(7);
  CompareOptions options;
  options.correlation_m = 200;  // the whole material
  SilentProgress progress;
  StrainNote note;
  note.gauge_length = cell;
  const MotionMemory first = measured(random, sigma, 1);
  const Metric m = metric(compare(first, simulated(), options, {}, progress, {}, {note, {}}), "displacement_bias_y_final");
  EXPECT_NEAR(m.uncertainty, sigma, 1e-6);
  EXPECT_TRUE(m.lost());
}

TEST(FieldVerdict, ToleranceAndPowerByHand) {
  Metric m;
  m.value = -2, m.uncertainty = 1;
  EXPECT_TRUE(std::isnan(m.within()));  // no difference
  m.factor = 2;
  EXPECT_NEAR(m.within(), 2 + 1.645, 1e-12);
  EXPECT_NEAR(m.seen(), 3.645, 1e-12);
  EXPECT_EQ(difference(1, 1, "", 3).factor, 3);
}

// Two one-sided tests at 5 %: a difference that is just beyond the tolerance is shown within it in 5 of 100 cases.
TEST(FieldVerdict, AShownToleranceIsWrongInFiveOfAHundred) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  int shown = 0, missed = 0;
  constexpr int runs = 20000;
  for (int k = 0; k < runs; ++k) {
    Metric m;
    m.uncertainty = 1, m.factor = 2;
    m.value = 10 + normal(random);  // the true difference is the tolerance
    shown += m.within() <= 10;
    const double e = m.seen() + normal(random);  // a real difference of that size
    missed += std::abs(e) < m.factor;
  }
  EXPECT_NEAR(shown / double(runs), 0.05, 0.01);
  EXPECT_NEAR(missed / double(runs), 0.05, 0.01);
}

TEST(FieldVerdict, OfTooLittleNothingIsSaid) {
  const ParticleSet all = particles_at(square_lattice(20, 10, 1), 1), part = particles_at(square_lattice(8, 10, 1), 1);
  const DisplacementLaw u = [](const Vec2&, double t) { return Vec2(t, 0); };
  MotionMemory first("np", "m", "s", all);
  for (int k = 0; k < 3; ++k) {
    MotionFrame f = frame_of(all, k, u, rigid);
    f.cov_u.assign(all.size(), {1e-4F, 1e-4F, 0});
    first.add(f);
  }
  const MotionMemory second = motion_of("mpm", part, {0, 1, 2}, u);
  LimitOptions limits;
  limits["displacement_rms_m"] = 1;
  const Comparison c = compared(first, second, {}, limits);
  EXPECT_EQ(metric(c, "displacement_rms_final").verdict, Verdict::withheld);
  EXPECT_TRUE(std::isnan(metric(c, "displacement_rms_final").uncertainty));
  ASSERT_EQ(c.limits.size(), 1U);
  EXPECT_FALSE(c.limits[0].met);
  EXPECT_TRUE(std::any_of(c.remarks.begin(), c.remarks.end(), [](const std::string& r) { return r.starts_with("No verdict: "); }));
  CompareOptions asked;
  asked.verdict_coverage = 0.3;
  EXPECT_EQ(metric(compared(first, second, asked, limits), "displacement_rms").limit, LimitFate::met);
}

// Particles that ran away count: the second's lose their way, and with them the verdict.
TEST(FieldVerdict, ParticlesThatEndCountAsNotCompared) {
  const ParticleSet set = particles_at(square_lattice(20, 10, 1), 1);
  const DisplacementLaw u = [](const Vec2&, double t) { return Vec2(t, 0); };
  MotionMemory first("np", "m", "s", set), second("mpm", "m", "s", set);
  for (int k = 0; k < 3; ++k) {
    MotionFrame f = frame_of(set, k, u, rigid);
    second.add(f);
    f.cov_u.assign(set.size(), {1e-4F, 1e-4F, 0});
    first.add(f);
  }
  MotionMemory left("mpm", "m", "s", set);
  for (int k = 0; k < 3; ++k) {
    MotionFrame f = frame_of(set, k, u, rigid);
    if (k == 2)
      for (std::size_t p = 0; p < set.size() * 6 / 10; ++p) f.status[p] = ParticleStatus::ended;
    left.add(f);
  }
  EXPECT_TRUE(metric(compared(first, second), "displacement_rms_final").lost());
  EXPECT_EQ(metric(compared(first, left), "displacement_rms_final").verdict, Verdict::withheld);
}

TEST(FieldVerdict, NumericsOfOneNumberByHand) {
  const GridConvergence second_order = grid_convergence({1.0, 1.03, 1.15}, 2);
  EXPECT_TRUE(second_order.asymptotic);
  EXPECT_NEAR(second_order.order, 2, 1e-12);
  EXPECT_NEAR(second_order.factor * 0.03, 0.01 * 1.25 / 1.15, 1e-12);
  const GridConvergence to_and_fro = grid_convergence({1.0, 1.1, 1.05}, 2);
  EXPECT_FALSE(to_and_fro.asymptotic);
  EXPECT_NEAR(to_and_fro.factor * 0.1, 0.1, 1e-12);  // the range
  const GridConvergence diverging = grid_convergence({1.0, 1.4, 1.5}, 2);
  EXPECT_FALSE(diverging.asymptotic);
  EXPECT_NEAR(diverging.factor * 0.4, 0.5, 1e-12);
  EXPECT_NEAR(grid_convergence(std::vector<double>{1.0, 1.2}, 1.3).factor, 1, 1e-12);

  std::vector<Metric> fine(1), middle(1), coarse(1);
  fine[0].name = middle[0].name = coarse[0].name = "run_out_x_difference";
  fine[0].value = 0.10, middle[0].value = 0.13, coarse[0].value = 0.25;
  fine[0].uncertainty = 0.03, fine[0].factor = 2;
  EXPECT_TRUE(add_numerical(fine, {middle, coarse}, 2).empty());
  EXPECT_NEAR(fine[0].uncertainty, std::hypot(0.03, 0.01 * 1.25 / 1.15), 1e-12);
  judge(fine, {}, "m");
  EXPECT_EQ(fine[0].verdict, Verdict::larger);  // the mesh's part is known, the inputs' is not
  judge(fine, {.input = true}, "m");
  EXPECT_EQ(fine[0].verdict, Verdict::differs);
  coarse[0].value = 0.0;
  fine[0].uncertainty = 0.03;
  EXPECT_EQ(add_numerical(fine, {middle, coarse}, 2).size(), 1U);
  EXPECT_NEAR(fine[0].uncertainty, std::hypot(0.03, 0.13), 1e-12);
  judge(fine, {}, "m");
  EXPECT_EQ(fine[0].verdict, Verdict::not_resolved);
  EXPECT_EQ(fine[0].lost_in, LostIn::mesh);
}

// Criterion: one coarser grid does not hide a difference that is ten times its change, at any ratio.
TEST(FieldVerdict, OneCoarserGridDoesNotBlind) {
  const ParticleSet set = particles_at(square_lattice(10, 10, 1), 1);
  const auto moved = [&](const std::string& name, double by) {
    return motion_of(name, set, {0, 1, 2}, [=](const Vec2&, double t) { return Vec2(t * by, 0); });
  };
  MotionMemory first("np", "m", "s", set);
  for (int k = 0; k < 3; ++k) {
    MotionFrame f = frame_of(set, k, [](const Vec2&, double t) { return Vec2(t, 0); }, rigid);
    f.cov_u.assign(set.size(), {1e-6F, 1e-6F, 0});
    first.add(f);
  }
  const MotionMemory second = moved("mpm", 1.1), coarser = moved("coarser", 1.11);
  SilentProgress progress;
  const Comparison c = compare(first, second, {}, {}, progress, Refinement{{&coarser}, 1.3});
  EXPECT_NEAR(metric(c, "u_numerical_final").value, 0.02, 1e-5);
  EXPECT_TRUE(metric(c, "displacement_rms_final").told_apart());
  // In velocity the grid's error is one and the same from time to time: .01, not sqrt(2) of the displacement's over the time.
  EXPECT_NEAR(metric(c, "velocity_rms").uncertainty, 0.01, 2e-3);
}

// Criterion: two simulations from rest, of which nothing but the grids' part is known, have an uncertainty of all their
// times: at the start that part is zero, which is not unknown.
TEST(FieldVerdict, SimulationsFromRestAreComparedByTheirGrids) {
  const ParticleSet set = particles_at(square_lattice(10, 10, 1), 1);
  const auto moved = [&](const std::string& name, double by) {
    return motion_of(name, set, {0, 1, 2}, [=](const Vec2&, double t) { return Vec2(t * by, 0); });
  };
  const MotionMemory first = moved("one", 1), second = moved("other", 1.1), coarser = moved("coarser", 1.11);
  SilentProgress progress;
  const Comparison c = compare(first, second, {}, {}, progress, Refinement{{&coarser}, 1.3});
  // Root mean square of 0, .01 and .02.
  EXPECT_NEAR(metric(c, "displacement_rms").uncertainty, 0.01 * std::sqrt(5.0 / 3), 1e-5);
  const Comparison without = compare(first, second, {}, {}, progress);
  EXPECT_TRUE(std::isnan(metric(without, "displacement_rms").uncertainty));
}

// Criterion: scatter of the offset between 0.6 and 1.3 of what is stated, with errors that stay from time to time.
TEST(FieldVerdict, AnOnsetStatesItsScatter) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 0.02);
  const ParticleSet set = particles_at(square_lattice(16, 12, 1), 1);
  std::vector<double> t;
  for (int k = 0; k <= 30; ++k) t.push_back(0.05 * k);
  const auto law = [](double time) { return 0.5 * std::pow(std::max(0.0, time - 0.3), 2); };
  const MotionMemory second = motion_of("mpm", set, t, [&](const Vec2&, double time) { return Vec2(law(time), 0); });
  const Participation b = participation(second, {}, false);
  double sum = 0, square = 0, stated = 0;
  constexpr int runs = 60;
  for (int run = 0; run < runs; ++run) {
    std::map<int, Vec2> walk;  // of 4 x 4 particles each
    MotionMemory first("np", "m", "s", set);
    for (std::size_t k = 0; k < t.size(); ++k) {
      for (int g = 0; g < 12; ++g)
        walk.try_emplace(g, Vec2::Zero()).first->second += Vec2(normal(random), normal(random)) / std::sqrt(double(t.size()));
      first.add(frame_of(set, t[k], [&](const Vec2& x, double time) -> Vec2 {
        return Vec2(law(time), 0) + walk[int(x.y()) / 4 * 4 + int(x.x()) / 4];
      }, rigid));
    }
    const Onset offset = onset_offset(participation(first, {}, false), b);
    sum += offset.time / runs, square += offset.time * offset.time / runs, stated += offset.sigma / runs;
  }
  const double scatter = std::sqrt(square - sum * sum);
  EXPECT_GT(scatter / stated, 0.5);
  EXPECT_LT(scatter / stated, 1.3);
}

// The displacement across a band is kept whatever smooths the strain: sqrt(3) times the area under a Gaussian ridge.
TEST(FieldVerdict, SlipAcrossABandByHand) {
  for (const double s : {1.5, 3.0}) {
    ScatteredField f;
    for (const Vec2& x : square_lattice(60, 40, 1)) {
      f.x.push_back(x);
      f.value.push_back(1.2 / s * std::exp(-0.5 * std::pow((x.x() - 30) / s, 2)));
      f.spacing.push_back(1);
      f.onset.push_back(1);
    }
    const std::vector<ShearBand> bands = find_bands(f, 1, 0.05);
    ASSERT_EQ(bands.size(), 1U);
    const double slip = std::sqrt(3.0) * 1.2 * std::sqrt(2 * M_PI);
    EXPECT_NEAR(bands[0].slip, slip, 0.06 * slip);
    EXPECT_NEAR(bands[0].peak, 1.2 / s, 0.06 * 1.2 / s);  // read half a spacing beside the crest
  }
}

TEST(FieldVerdict, ThinToesAndStraightFacesAreMeasured) {
  // A slope with an apron two particles high that reaches four times as far.
  const auto slope = [](double apron) {
    std::vector<Vec2> x;
    for (const Vec2& p : square_lattice(100, 12, 1))
      if (p.y() < 12 - p.x() || (p.y() < 2 && p.x() < apron)) x.push_back(p);
    return particles_at(x, 1);
  };
  const DisplacementLaw none = [](const Vec2&, double t) { return Vec2(0, -1e-3 * t); };
  CompareOptions options;
  options.slope_base_m = -1;
  const Comparison c = compared(motion_of("np", slope(40), {0, 1}, none), motion_of("mpm", slope(60), {0, 1}, none), options);
  EXPECT_NEAR(metric(c, "toe_x_first").value, 40, 1.1);
  EXPECT_NEAR(metric(c, "toe_x_difference").value, 20, 1.1);
  EXPECT_TRUE(metric(c, "toe_x_difference").told_apart());
  const Metric angle = metric(c, "slope_angle_difference");
  EXPECT_GT(angle.uncertainty, 0.5);
}

}  // namespace field_verdict
}  // namespace pivnp::compare
