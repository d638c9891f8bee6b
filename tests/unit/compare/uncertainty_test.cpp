// Uncertainties and verdicts of whole comparisons.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "compare/metrics/significance.hpp"
#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

// A block that stands still but for a strip, measured with noise of known covariance.
MotionMemory measured(unsigned seed, double sigma, double bias, const std::string& name) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, sigma);
  const ParticleSet set = particles_at(square_lattice(30, 30, 1), 1);
  MotionMemory motion(name, "m", "s", set);
  for (double t : {0.0, 1.0, 2.0}) {
    MotionFrame f = frame_of(
        set, t,
        [&](const Vec2& x, double time) -> Vec2 {
          const double moved = x.x() > 20 ? time : 0;
          return time == 0 ? Vec2(0, 0) : Vec2(moved + bias + noise(random), noise(random));
        },
        rigid);
    const float variance = t == 0 ? 0.0f : float(sigma * sigma);
    f.cov_u.assign(set.size(), {variance, variance, 0});
    motion.add(f);
  }
  return motion;
}

TEST(Uncertainty, IndependentNoiseIsNotDistinguishedAndAGrossBiasIs) {
  const double sigma = 0.01;
  for (unsigned seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    const MotionMemory a = measured(seed, sigma, 0, "a"), b = measured(seed + 100, sigma, 0, "b");
    const Comparison same = compared(a, b);
    // Two data sets, two components: each difference has a trace of 4 sigma^2, at two of three times.
    EXPECT_NEAR(metric(same, "displacement_rms_final").uncertainty, 2 * sigma, 1e-7);
    EXPECT_NEAR(metric(same, "displacement_rms").uncertainty, 2 * sigma * std::sqrt(2.0 / 3), 1e-7);
    EXPECT_NEAR(metric(same, "displacement_bias_x_final").uncertainty, std::sqrt(2.0) * sigma, 1e-7);
    EXPECT_NEAR(metric(same, "displacement_rms_final").value, 2 * sigma, 0.1 * sigma);
    for (const char* name : {"displacement_bias_x", "displacement_bias_y", "displacement_rms", "displacement_p95"})
      EXPECT_TRUE(metric(same, name).lost()) << name;
    EXPECT_NEAR(series(same, "displacement_uncertainty")[2], 2 * sigma, 1e-7);

    const Comparison biased = compared(a, measured(seed + 100, sigma, 8 * sigma, "b"));
    EXPECT_TRUE(metric(biased, "displacement_bias_x").told_apart());
    EXPECT_TRUE(metric(biased, "displacement_rms").told_apart());
    EXPECT_TRUE(metric(biased, "displacement_bias_y").lost());
  }
}

TEST(Uncertainty, UnknownWithoutACovariance) {
  const ParticleSet set = particles_at(square_lattice(6, 6, 1), 1);
  const DisplacementLaw u = [](const Vec2&, double t) { return Vec2(t, 0); };
  const Comparison c = compared(motion_of("a", set, {0, 1}, u), motion_of("b", set, {0, 1}, u));
  EXPECT_TRUE(std::isnan(metric(c, "displacement_rms").uncertainty));
  EXPECT_TRUE(std::isnan(metric(c, "strain_dev_rms").uncertainty));
  EXPECT_EQ(metric(c, "displacement_rms").verdict, Verdict::none);
  EXPECT_NE(metric(c, "displacement_rms").definition.find("not known"), std::string::npos);
  EXPECT_EQ(metric(c, "decomposition_displacement_x_distance").value, 0);
  EXPECT_EQ(metric(c, "decomposition_displacement_x_distance").verdict, Verdict::none);  // its own residual alone says nothing
  EXPECT_NE(metric(c, "strain_dev_rms").definition.find("noise floor not measured"), std::string::npos);
}

TEST(Uncertainty, OneSideMayKnowItsError) {
  const MotionMemory a = measured(7, 0.01, 0, "np");
  const MotionMemory b = motion_of("mpm", a.particles(), {0, 1, 2}, [](const Vec2& x, double t) {
    return Vec2(x.x() > 20 ? t : 0, 0);
  });
  for (const Comparison& c : {compared(a, b), compared(b, a)}) {
    EXPECT_NEAR(metric(c, "displacement_rms_final").uncertainty, std::sqrt(2.0) * 0.01, 1e-7);
    EXPECT_NE(metric(c, "displacement_rms").definition.find("(np)"), std::string::npos);
  }
}

// Particles that happen to stand still deform as others do: a floor comes from a zone that is declared, or it is not known.
TEST(Uncertainty, StrainFloorIsWhatTheDeclaredZoneShows) {
  const MotionMemory a = measured(5, 0.01, 0, "np");
  const ParticleSet set = a.particles();
  MotionMemory strained("np", "m", "s", set);
  const auto still = [](const Vec2& x) { return x.x() > 20; };
  for (std::size_t k = 0; k < 3; ++k) {
    MotionFrame f = a.frame(k);
    // False shear of alternating sign in the strip; ten times as much where the block stands still, and deforms.
    for (std::size_t p = 0; p < set.size() && k > 0; ++p)
      f.F[p][1] = (p % 2 == 0 ? 0.002f : -0.002f) * (still(set.x0[p]) ? 1 : 10);
    strained.add(f);
  }
  const MotionMemory b = motion_of("mpm", set, {0, 1, 2}, [&](const Vec2& x, double t) {
    return Vec2(still(x) ? t : 0, 0);
  });
  const Comparison undeclared = compared(strained, b);
  EXPECT_TRUE(std::isnan(metric(undeclared, "strain_dev_rms").uncertainty));
  EXPECT_EQ(metric(undeclared, "strain_dev_rms").verdict, Verdict::none);
  const double floor = 0.002 / std::sqrt(3.0);  // e_xy = 0.001: sqrt(2/3 2 e_xy^2)
  for (const bool turns : {false, true}) {  // the strip moves as one piece: in its own frame it is still
    CompareOptions options;
    (turns ? options.fixed_zone_m : options.reference_m) = {{20.1, -1}, {31, -1}, {31, 31}, {20.1, 31}};
    const Comparison c = compared(strained, b, options);
    EXPECT_NEAR(metric(c, "strain_dev_rms").uncertainty, floor, 1e-6);
    EXPECT_TRUE(metric(c, "strain_dev_rms").told_apart());  // ten times the floor in most of the block
    EXPECT_NE(metric(c, "strain_dev_rms").definition.find(turns ? "fixed_zone_m" : "reference_m"), std::string::npos);
    ASSERT_EQ(series(c, "strain_dev_uncertainty").size(), 3U);
    EXPECT_NEAR(series(c, "strain_dev_uncertainty")[2], floor, 1e-6);
  }
}

// A floor that a record states is the data set's, whatever its still particles show.
TEST(Uncertainty, StrainFloorOfTheRecord) {
  const MotionMemory a = measured(5, 0.01, 0, "np");
  const MotionMemory b = motion_of("mpm", a.particles(), {0, 1, 2}, [](const Vec2& x, double t) {
    return Vec2(x.x() > 20 ? t : 0, 0);
  });
  StrainNote note;
  note.floor_source = StrainFloor::still_frames;
  note.floor_dev = 0.003, note.floor_vol = 0.004, note.floor_path = 0.005;
  SilentProgress progress;
  const Comparison c = compare(a, b, {}, {}, progress, {}, {note, {}});
  EXPECT_EQ(metric(c, "strain_dev_rms").uncertainty, 0.003);
  EXPECT_EQ(metric(c, "strain_vol_rms_final").uncertainty, 0.004);
  EXPECT_EQ(metric(c, "strain_dev_path_bias").uncertainty, 0.005);
  EXPECT_NE(metric(c, "strain_dev_rms").definition.find("np (still frames)"), std::string::npos);
  EXPECT_EQ(metric(c, "area_metric_strain_dev").uncertainty, 0.003);
  // Both measured: in squares. Where one says "not measured" and no zone is declared, nothing is known.
  EXPECT_NEAR(metric(compare(a, b, {}, {}, progress, {}, {note, note}), "strain_dev_rms").uncertainty,
              0.003 * std::sqrt(2.0), 1e-12);
  const Comparison own = compare(a, b, {}, {}, progress, {}, {StrainNote{}, {}});
  EXPECT_TRUE(std::isnan(metric(own, "strain_dev_rms").uncertainty));
  const Comparison half = compare(a, measured(6, 0.01, 0, "b"), {}, {}, progress, {}, {note, {}});
  EXPECT_TRUE(std::isnan(metric(half, "strain_dev_rms").uncertainty));
}

// A block of 30 x 30 whose last ten columns draw off by 2: two outlines of lengths 100 and 80, known to half a spacing
// and the error of u. The other data set is the same, or shifted by 6, and then both cover a width of 38.
TEST(Uncertainty, OfTheOutlinesShareInCommon) {
  const double sigma = 0.3, length = 180;
  const MotionMemory a = measured(3, sigma, 0, "np");
  for (const double shift : {0.0, 6.0}) {
    const MotionMemory b = motion_of("mpm", a.particles(), {0, 1, 2}, [=](const Vec2& x, double t) {
      return Vec2((x.x() > 20 ? t : 0) + shift * t / 2, 0);
    });
    const Metric iou = metric(compared(a, b), "outline_iou");
    const double either = shift == 0 ? 900 : 1140;
    const double half = 1 / std::sqrt(12.0), u_a = std::hypot(half, sigma * std::sqrt(2.0));
    EXPECT_NEAR(iou.uncertainty, length * std::hypot(u_a, half) / either, 0.1 * iou.uncertainty);
    EXPECT_EQ(1 - iou.value < 2 * iou.uncertainty, shift == 0) << iou.value << " u " << iou.uncertainty;
  }
}

// What is given as a number is part of what shapes are uncertain by: the camera's and the gauge's share the first's, the
// model's the second's.
TEST(Uncertainty, OfShapesHoldsWhatIsGiven) {
  const ParticleSet set = particles_at(square_lattice(20, 10, 1), 1);
  const MotionMemory a = motion_of("a", set, {0, 1}, [](const Vec2& x, double t) { return Vec2(t * x.x() / 20, 0); });
  CompareOptions options;
  options.slope_base_m = 0;
  options.measurement_uncertainty_m = 0.3;
  options.numerical_uncertainty_m = 0.2;
  options.input_uncertainty_m = 0.4;
  const Comparison c = compared(a, a, options);
  const double half = 1 / std::sqrt(12.0), one = std::hypot(half, 0.3 * std::sqrt(2.0)),
               two = std::hypot(half, std::sqrt(2 * (0.04 + 0.16)));
  EXPECT_NEAR(metric(c, "crest_height_first").uncertainty, one, 1e-9);
  EXPECT_NEAR(metric(c, "crest_height_second").uncertainty, two, 1e-9);
  for (const char* name : {"outline_hausdorff_95", "crest_retreat_difference"})
    EXPECT_NEAR(metric(c, name).uncertainty, std::hypot(one, two), 1e-9) << name;
  // cot = (.015 of the width)^2 / (.01 of the area): a steep end.
  EXPECT_NEAR(metric(c, "run_out_x_difference").uncertainty, (1 + .0225 * 2.1) * std::hypot(one, two), .005);
  EXPECT_GT(metric(c, "mobilised_area_difference").uncertainty, 0);
  EXPECT_NEAR(metric(compared(a, a, {}), "outline_hausdorff_95").uncertainty, half * std::sqrt(2.0), 1e-9);
}

// A wedge of material whose surface is known to d: its run-out to d (1 + cot), its tip to d over the sine of its angle.
TEST(Uncertainty, OfAThinEndIsTheGreater) {
  constexpr double h = .05;
  CompareOptions options;
  options.slope_base_m = 0;
  options.measurement_uncertainty_m = .1;
  for (const double angle : {15.0, 25.0, 45.0}) {
    const double tangent = std::tan(angle * M_PI / 180), width = 4 / tangent;
    std::vector<Vec2> wedge;
    for (const Vec2& x : square_lattice(int(width / h) + 1, int(4 / h), h))
      if (x.y() < (width - x.x()) * tangent) wedge.push_back(x);
    const MotionMemory a = motion_of("a", particles_at(wedge, h), {0, 1}, [](const Vec2&, double t) { return Vec2(1e-6 * t, 0); });
    const Comparison c = compared(a, a, options);
    const double d = std::hypot(h / std::sqrt(12.0), .1 * std::sqrt(2.0));
    EXPECT_NEAR(metric(c, "run_out_x_first").uncertainty, d * (1 + 1 / tangent), .2 * d / tangent) << angle;
    EXPECT_NEAR(metric(c, "toe_x_first").uncertainty, d / std::sin(angle * M_PI / 180), .2 * d / tangent) << angle;
  }
}

// Particles at a thin front are known least: what is read off it is as uncertain as they are, along it and by their height over its
// slope, and not as all particles are on average.
TEST(Uncertainty, OfAThinEndIsThatOfItsParticles) {
  constexpr double h = .05, tangent = .5, width = 4 / tangent;
  CompareOptions options;
  options.slope_base_m = 0;
  std::vector<Vec2> wedge;
  for (const Vec2& x : square_lattice(int(width / h) + 1, int(4 / h), h))
    if (x.y() < (width - x.x()) * tangent) wedge.push_back(x);
  const MotionMemory still = motion_of("a", particles_at(wedge, h), {0, 1}, [](const Vec2&, double t) { return Vec2(1e-6 * t, 0); });
  MotionMemory a("b", "m", "s", still.particles());
  for (std::size_t k = 0; k < 2; ++k) {
    MotionFrame f = still.frame(k);
    for (const Vec2& x : wedge) f.cov_u.push_back(x.x() > .8 * width ? std::array<float, 3>{.04f, .01f, 0} : std::array<float, 3>{1e-6f, 1e-6f, 0});
    a.add(std::move(f));
  }
  const Comparison c = compared(a, a, options);
  const double drawn = h / std::sqrt(12.0), tip = std::hypot(.2, .1 / tangent);
  EXPECT_NEAR(metric(c, "run_out_x_first").uncertainty, std::hypot(drawn * (1 + 1 / tangent), tip), .05 * tip);
  EXPECT_NEAR(metric(c, "toe_x_first").uncertainty, std::hypot(drawn * std::hypot(1, 1 / tangent), tip), .05 * tip);
  EXPECT_LT(metric(c, "crest_height_first").uncertainty, .5 * tip);
}

TEST(Uncertainty, OfSomeParticlesAloneIsSaid) {
  const MotionMemory a = measured(3, 0.01, 0, "a");
  MotionMemory b("b", "m", "s", a.particles());
  for (std::size_t k = 0; k < 3; ++k) {
    MotionFrame f = a.frame(k);
    f.cov_u[5] = {std::nanf(""), std::nanf(""), std::nanf("")};
    b.add(f);
  }
  const Comparison c = compared(a, b);
  EXPECT_TRUE(std::isnan(metric(c, "u_val").value));
  bool said = false;
  for (const std::string& r : c.remarks) said = said || r.find("3 of 2700 particle-times have no known") != r.npos;
  EXPECT_TRUE(said);
}

TEST(Uncertainty, OfTheAreaMetric) {
  const double sigma = 0.01;
  const MotionMemory a = measured(1, sigma, 0, "a"), b = measured(101, sigma, 0, "b");
  const Metric same = metric(compared(a, b), "area_metric_displacement");
  EXPECT_NEAR(same.uncertainty, 2 * sigma, 1e-7);  // u_val at the end: two data sets, two components
  EXPECT_TRUE(same.lost());
  EXPECT_TRUE(metric(compared(a, measured(101, sigma, 20 * sigma, "b")), "area_metric_displacement").told_apart());
}

TEST(Limits, WithinAndOver) {
  const ParticleSet set = particles_at(square_lattice(6, 6, 1), 1);
  const MotionMemory a = motion_of("a", set, {0, 1}, [](const Vec2&, double) { return Vec2(0, 0); });
  const MotionMemory b = motion_of("b", set, {0, 1}, [](const Vec2&, double) { return Vec2(0, 0.25); });
  LimitOptions limits;
  limits["displacement_rms_m"] = 0.25;  // the limit itself is allowed
  limits["strain_rms"] = 0.01;
  Comparison c = compared(a, b, {}, limits);
  EXPECT_EQ(metric(c, "displacement_rms").limit, LimitFate::met);
  EXPECT_EQ(metric(c, "strain_dev_rms").limit, LimitFate::met);
  EXPECT_FALSE(any_exceeded(c.limits));
  limits["displacement_rms_m"] = 0.2;
  c = compared(a, b, {}, limits);
  EXPECT_EQ(metric(c, "displacement_rms").limit, LimitFate::exceeded);
  EXPECT_EQ(metric(c, "strain_dev_rms").limit, LimitFate::met);
  EXPECT_TRUE(any_exceeded(c.limits));
}

}  // namespace
}  // namespace pivnp::compare
