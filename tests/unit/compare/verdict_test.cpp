// The verdict's two errors: two measurements of one motion flagged as different, and a real difference not found.
// V&V 20's E and u_val, and numerical uncertainty by coarser grids, against values worked by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "compare/budget.hpp"
#include "compare/metrics.hpp"
#include "compare/numerics.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

enum class Errors { independent, of_neighbours, one_and_the_same };

// A block that stretches, measured with errors of standard deviation `sigma` a component that grow as a tracker's do.
MotionMemory measured(std::mt19937& random, Errors errors, double sigma, double bias, const std::string& name) {
  const ParticleSet set = particles_at(square_lattice(8, 8, 1), 1);
  std::normal_distribution<double> normal(0, 1);
  std::vector<Vec2> error(set.size(), Vec2::Zero());
  MotionMemory motion(name, "m", "s", set);
  const int steps = 2;
  for (int k = 0; k <= steps; ++k) {
    const double t = double(k) / steps;
    if (k > 0) {
      std::map<int, Vec2> shared;
      for (std::size_t p = 0; p < set.size(); ++p) {
        const int column = int(set.x0[p].x()), row = int(set.x0[p].y());
        const int group = errors == Errors::independent     ? int(p)
                          : errors == Errors::of_neighbours ? (row / 2) * 4 + column / 2
                                                            : 0;
        const auto it = shared.find(group);
        if (it == shared.end()) shared[group] = Vec2(normal(random), normal(random));
        error[p] += sigma / std::sqrt(double(steps)) * shared[group];
      }
    }
    MotionFrame f = frame_of(
        set, t, [](const Vec2& x, double time) -> Vec2 { return 0.1 * time * Vec2(x.x(), -x.y()); }, rigid);
    f.cov_u.assign(set.size(), {float(sigma * sigma * t), float(sigma * sigma * t), 0});
    for (std::size_t p = 0; p < set.size(); ++p) {
      f.u[p][0] += float(error[p].x() + bias * std::sqrt(t));
      f.u[p][1] += float(error[p].y());
    }
    motion.add(f);
  }
  return motion;
}

// Criterion (issue of the comparison): flagged at most 5 % of the time.
TEST(Verdict, TwoMeasurementsOfOneMotionAreRarelyFlagged) {
  const unsigned seed = 20250301;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const int runs = 100;
  for (const Errors errors : {Errors::independent, Errors::of_neighbours, Errors::one_and_the_same}) {
    std::map<std::string, int> flagged;
    for (int run = 0; run < runs; ++run) {
      const Comparison c = compared(measured(random, errors, 0.01, 0, "a"), measured(random, errors, 0.01, 0, "b"));
      std::vector<std::string> names{"area_metric_displacement", "outline_iou", "outline_hausdorff_95"};
      for (const char* base : {"displacement_", "velocity_"})
        for (const char* what : {"bias_x", "bias_y", "rms", "p95", "max"})
          for (const char* end : {"", "_final"}) names.push_back(std::string(base) + what + end);
      for (const std::string& name : names) {
        if (!has_metric(c, name)) continue;
        ASSERT_GT(metric(c, name).uncertainty, 0) << name;
        flagged[name] += metric(c, name).verdict != not_distinguishable;
      }
    }
    EXPECT_EQ(flagged.size(), 18U);
    double worst = 0;
    std::string where;
    for (const auto& [name, count] : flagged) {
      // Where the true rate is 5 %, 100 runs show up to 9 % now and then.
      EXPECT_LE(count, 0.05 * runs + 2 * std::sqrt(0.05 * 0.95 * runs)) << name << ", errors " << int(errors);
      if (double(count) / runs > worst) worst = double(count) / runs, where = name;
    }
    const char* kind = errors == Errors::independent       ? "independent noise"
                       : errors == Errors::of_neighbours ? "noise shared by 2 x 2 neighbours"
                                                         : "one error shared by all";
    test::verification_row(std::string("two measurements of one motion, ") + kind,
                           "no metric flagged more than 5 % of the time",
                           number(100 * worst, 3) + " % of " + std::to_string(runs) + " runs" +
                               (where.empty() ? "" : " (" + where + ")"));
  }
}

// Criterion: a bias of four u_val is found at least 95 % of the time. u_val of a component's difference is sqrt(2)
// sigma.
TEST(Verdict, ABiasOfFourUValIsFound) {
  const unsigned seed = 20250302;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const int runs = 100;
  double least = 1;
  for (const Errors errors : {Errors::independent, Errors::of_neighbours, Errors::one_and_the_same}) {
    int found = 0;
    for (int run = 0; run < runs; ++run) {
      const Comparison c = compared(measured(random, errors, 0.01, 0, "a"),
                                    measured(random, errors, 0.01, 4 * std::sqrt(2.0) * 0.01, "b"));
      const Metric m = metric(c, "displacement_bias_x_final");
      EXPECT_NEAR(m.uncertainty, std::sqrt(2.0) * 0.01, 1e-6);
      found += m.verdict != not_distinguishable;
    }
    EXPECT_GE(found, 0.95 * runs) << int(errors);
    least = std::min(least, double(found) / runs);
  }
  test::verification_row("bias of four u_val", "found at least 95 % of the time", number(100 * least, 4) + " %");
}

TEST(Verdict, TheGreatestOfManyErrorsIsNoDifference) {
  EXPECT_EQ(greatest_factor(0), std::sqrt(2 * std::log(20.0)));
  EXPECT_NEAR(greatest_factor(1000000), std::sqrt(2 * std::log(2e7)), 1e-12);
  EXPECT_EQ(difference_metric("a", 4, "m", 1, "", greatest_factor(1000000)).verdict, not_distinguishable);
  EXPECT_EQ(difference_metric("a", 6, "m", 1, "", greatest_factor(1000000)).verdict, "");
}

TEST(Budget, PartsByHand) {
  CompareOptions options;
  options.measurement_uncertainty_m = 0.3;
  options.gauge_uncertainty = 0.01;
  options.numerical_uncertainty_m = 0.2;
  options.input_uncertainty_m = 0.4;
  const Vec2 none = Vec2::Constant(std::nan(""));
  const Variance v = Budget(options).at(Vec2(1, 2), Vec2(3, 4), Vec2(100, -50), Vec2(0.5, 0.25), Vec2(0.01, 0.02));
  EXPECT_NEAR(v.measurement.x(), 1 + 3 + 0.09 + 1 + 0.5, 1e-12);
  EXPECT_NEAR(v.measurement.y(), 2 + 4 + 0.09 + 0.25 + 0.25, 1e-12);
  EXPECT_NEAR(v.numerical.x(), 0.05, 1e-12);
  EXPECT_NEAR(v.input.y(), 0.16, 1e-12);
  EXPECT_NEAR(v.total().x(), 5.59 + 0.05 + 0.16, 1e-12);
  // One side's covariance, or none.
  EXPECT_NEAR(Budget({}).at(none, Vec2(3, 4), Vec2(1, 1), Vec2::Zero(), Vec2::Zero()).total().y(), 4, 1e-12);
  EXPECT_TRUE(std::isnan(Budget({}).at(none, none, Vec2(1, 1), Vec2::Zero(), Vec2::Zero()).total().x()));
  EXPECT_NEAR(Budget({}).at(none, none, Vec2(1, 1), Vec2::Zero(), Vec2(9, 1)).total().x(), 9, 1e-12);
}

TEST(Budget, UValStandsBesideItsParts) {
  const ParticleSet set = particles_at(square_lattice(6, 6, 1), 1);
  const MotionMemory a = motion_of("a", set, {0, 1}, [](const Vec2&, double t) { return Vec2(t, 0); });
  const MotionMemory b = motion_of("b", set, {0, 1}, [](const Vec2&, double t) { return Vec2(t, 0.05 * t); });
  CompareOptions options;
  options.measurement_uncertainty_m = 0.03;
  options.input_uncertainty_m = 0.04;
  const Comparison c = compared(a, b, options);
  EXPECT_NEAR(metric(c, "u_measurement_final").value, 0.03 * std::sqrt(2.0), 1e-7);
  EXPECT_NEAR(metric(c, "u_input_final").value, 0.04 * std::sqrt(2.0), 1e-7);
  EXPECT_EQ(metric(c, "u_numerical_final").value, 0);
  EXPECT_NEAR(metric(c, "u_val_final").value, 0.05 * std::sqrt(2.0), 1e-7);
  EXPECT_NEAR(metric(c, "displacement_bias_y_final").value, 0.05, 1e-7);
  EXPECT_NEAR(metric(c, "displacement_bias_y_final").uncertainty, 0.05, 1e-7);
  EXPECT_NEAR(metric(c, "displacement_bias_y_final_over_u").value, 1, 1e-5);
  EXPECT_NEAR(metric(c, "displacement_rms_final_over_u").value, 1 / std::sqrt(2.0), 1e-5);
  EXPECT_EQ(metric(c, "displacement_bias_y_final").verdict, "not distinguishable at this u_val");
}

// Celik et al. (2008), table 1, first column: phi = 6.063, 5.972, 5.863, r = 1.5 and 1.333; here with one ratio.
TEST(GridConvergence, ByHand) {
  const GridConvergence g = grid_convergence(0.1, 0.4, 2);  // order ln 4 / ln 2 = 2
  EXPECT_NEAR(g.order, 2, 1e-12);
  EXPECT_TRUE(g.asymptotic);
  EXPECT_NEAR(g.factor, 1.25 / 3 / 1.15, 1e-12);
  const GridConvergence two = grid_convergence(0.1, std::nan(""), 2);
  EXPECT_NEAR(two.factor, 3 / 1.15, 1e-12);
  const GridConvergence diverging = grid_convergence(0.4, 0.1, 2);
  EXPECT_FALSE(diverging.asymptotic);
  EXPECT_NEAR(diverging.factor, 3 / (std::sqrt(2.0) - 1) / 1.15, 1e-12);
}

TEST(GridConvergence, CoarserSimulationsGiveTheNumericalPart) {
  // u(h) = exact + c h^2: on h = 1, 2, 4 the changes are 3c and 12c; the error of the finest is c.
  const double exact = 1, c = 0.01;
  const auto simulated = [&](int n, double h) {
    return motion_of("h" + std::to_string(n), particles_at(square_lattice(n, n, 16.0 / n), 16.0 / n), {0, 0.5, 1},
                     [=](const Vec2&, double t) { return Vec2(t * (exact + c * h * h), 0); });
  };
  const MotionMemory fine = simulated(16, 1), middle = simulated(8, 2), coarse = simulated(4, 4);
  const MotionMemory lab = motion_of("lab", particles_at(square_lattice(12, 12, 1, Vec2(2, 2)), 1), {0, 0.5, 1},
                                     [=](const Vec2&, double t) { return Vec2(t * exact, 0); });
  SilentProgress progress;
  const Comparison r = compare(lab, fine, {}, {}, progress, Refinement{{&middle, &coarse}, 2});
  EXPECT_NEAR(metric(r, "grid_convergence_order").value, 2, 1e-4);
  const double u = 3 * c * 1.25 / 3 / 1.15;
  EXPECT_NEAR(metric(r, "u_numerical_final").value, u, 1e-6);
  EXPECT_NEAR(metric(r, "u_val_final").value, u, 1e-6);
  EXPECT_NEAR(metric(r, "displacement_bias_x_final").value, c, 1e-6);
  EXPECT_EQ(metric(r, "displacement_bias_x_final").verdict, not_distinguishable);
  const MotionMemory elsewhere = motion_of("elsewhere", particles_at(square_lattice(8, 8, 2, Vec2(90, 0)), 2),
                                           {0, 0.5, 1}, [](const Vec2&, double) { return Vec2(0, 0); });
  EXPECT_THROW(compare(lab, fine, {}, {}, progress, Refinement{{&elsewhere}, 2}), InputError);
}

}  // namespace
}  // namespace pivnp::compare
