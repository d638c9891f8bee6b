// Whole comparisons worked by hand: zero against itself, known bias, swapped data sets, times, ended particles, reference.
#include "compare/compare.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pivnp/core/error.hpp"
#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

TEST(Compare, ARecordAgainstItselfIsZero) {
  const MotionMemory a = motion_of("np", block(), {0, 0.5, 1}, shear, shear_F);
  const Comparison c = compared(a, a);
  for (const Metric& m : c.metrics) {
    bool difference = false;
    for (const char* part : {"_bias", "_rms", "_p95", "_max", "_difference", "_distance", "hausdorff", "area_metric",
                             "_offset", "_outside", "increment_"})
      difference = difference || m.name.find(part) != std::string::npos;
    EXPECT_TRUE(!difference || m.value == 0) << m.name << " " << m.value;
    EXPECT_FALSE(m.definition.empty()) << m.name;
    EXPECT_FALSE(m.unit.empty()) << m.name;
  }
  EXPECT_EQ(metric(c, "outline_iou").value, 1);
  EXPECT_EQ(metric(c, "coverage_first").value, 1);
  EXPECT_EQ(metric(c, "coverage_second").value, 1);
  EXPECT_EQ(c.times(), (std::vector<double>{0, 0.5, 1}));
  EXPECT_FALSE(any_exceeded(c.limits));
}

TEST(Compare, KnownBias) {
  const ParticleSet set = block();
  const MotionMemory a = motion_of("np", set, {0, 1}, shear);
  const MotionMemory b =
      motion_of("mpm", set, {0, 1}, [](const Vec2& x, double t) -> Vec2 { return shear(x, t) + t * Vec2(0.3, -0.4); });
  const Comparison c = compared(a, b);
  EXPECT_NEAR(metric(c, "displacement_bias_x_final").value, 0.3, 1e-6);
  EXPECT_NEAR(metric(c, "displacement_bias_y_final").value, -0.4, 1e-6);
  EXPECT_NEAR(metric(c, "displacement_rms_final").value, 0.5, 1e-6);
  EXPECT_NEAR(metric(c, "displacement_p95_final").value, 0.5, 1e-6);
  // Two times, the difference zero at the first.
  EXPECT_NEAR(metric(c, "displacement_bias_x").value, 0.15, 1e-6);
  EXPECT_NEAR(metric(c, "displacement_rms").value, 0.5 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(metric(c, "displacement_max").value, 0.5, 1e-6);
  const double peak = Vec2(0.4 * 4.5 + 0.1, -0.2).norm();
  EXPECT_NEAR(metric(c, "displacement_peak_first").value, peak, 1e-6);
  EXPECT_NEAR(metric(c, "displacement_rms_relative").value, 0.5 / std::sqrt(2.0) / peak, 1e-6);
  EXPECT_EQ(metric(c, "displacement_rms_relative").unit, "1");
  EXPECT_EQ(metric(c, "displacement_rms").unit, "m");
  ASSERT_EQ(series(c, "displacement_rms").size(), 2U);
  EXPECT_EQ(series(c, "displacement_rms")[0], 0);
  EXPECT_NEAR(series(c, "displacement_rms")[1], 0.5, 1e-6);
  EXPECT_EQ(series(c, "particles_compared")[1], 30);
  EXPECT_NEAR(c.fields[0].values[30 + 7], 0.3, 1e-6);
  EXPECT_NEAR(c.fields[2].values[30 + 7], 0.5, 1e-6);
}

TEST(Compare, StrainsWorkedByHand) {
  const ParticleSet set = block();
  auto stretch = [](double x, double y) {
    return GradientLaw([=](const Vec2&, double t) -> Mat2 {
      return Vec2(std::exp(t * x), std::exp(t * y)).asDiagonal().toDenseMatrix();
    });
  };
  const DisplacementLaw none = [](const Vec2&, double) { return Vec2(0, 0); };
  const Comparison c = compared(motion_of("a", set, {0, 1}, none, stretch(0.1, -0.1)),
                                motion_of("b", set, {0, 1}, none, stretch(0.3, -0.1)));
  // e = (a, b, 0): sqrt(2/3 (a^2 + b^2 - (a + b)^2/3)).
  const double first = std::sqrt(2.0 / 3 * 0.02), second = std::sqrt(2.0 / 3 * (0.1 - 0.04 / 3));
  EXPECT_NEAR(metric(c, "strain_dev_bias_final").value, second - first, 1e-6);
  EXPECT_NEAR(metric(c, "strain_dev_rms").value, (second - first) / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(metric(c, "strain_dev_p95").value, second - first, 1e-6);
  EXPECT_NEAR(metric(c, "strain_vol_bias_final").value, 0.2, 1e-6);
  EXPECT_NEAR(metric(c, "strain_vol_rms").value, 0.2 / std::sqrt(2.0), 1e-6);
  EXPECT_FALSE(has_metric(c, "displacement_rms_relative"));  // nothing to be relative to
}

TEST(Compare, SwappedSidesChangeTheSignOfTheBiasAlone) {
  const ParticleSet set = block();
  const MotionMemory a = motion_of("a", set, {0, 0.5, 1}, shear, shear_F);
  const MotionMemory b =
      motion_of("b", set, {0, 0.5, 1},
                [](const Vec2& x, double t) -> Vec2 { return t * Vec2(0.1 * x.x() * x.y(), t * x.y()); });
  const Comparison ab = compared(a, b), ba = compared(b, a);
  for (const std::string end : {"", "_final"}) {
    for (const char* name : {"displacement_bias_x", "displacement_bias_y", "strain_dev_bias", "strain_vol_bias"})
      EXPECT_EQ(metric(ab, name + end).value, -metric(ba, name + end).value) << name << end;
    for (const char* name : {"displacement_rms", "displacement_p95", "displacement_max", "strain_dev_rms",
                             "strain_dev_p95", "strain_dev_max", "strain_vol_rms"})
      EXPECT_EQ(metric(ab, name + end).value, metric(ba, name + end).value) << name << end;
  }
  EXPECT_EQ(metric(ab, "displacement_peak_first").value, metric(ba, "displacement_peak_second").value);
  EXPECT_EQ(metric(ab, "outline_iou").value, metric(ba, "outline_iou").value);
  EXPECT_GT(metric(ab, "displacement_rms").value, 0.1);
}

TEST(Compare, TimesAreInterpolatedAndOutsideTheCommonSpanNothingIsSaid) {
  const ParticleSet set = block();
  const MotionMemory a = motion_of("a", set, {0, 0.3, 0.9, 1.5, 2}, shear, shear_F);
  const MotionMemory b = motion_of("b", set, {0, 0.4, 1.0, 1.6}, shear, shear_F);
  const Comparison c = compared(a, b);
  EXPECT_EQ(c.times(), (std::vector<double>{0, 0.3, 0.9, 1.5}));
  EXPECT_LT(metric(c, "displacement_max").value, 1e-6);
  EXPECT_LT(metric(c, "strain_dev_max").value, 1e-6);
  EXPECT_EQ(c.fields[0].values.size(), 4U * 30U);

  const MotionMemory later = motion_of("later", set, {5, 6}, shear);
  EXPECT_THROW(compared(a, later), InputError);
  const MotionMemory unordered = motion_of("unordered", set, {0, 1, 1}, shear);
  EXPECT_THROW(compared(a, unordered), InputError);
}

TEST(Compare, TheEarlierSideIsCountedFromTheCommonStart) {
  // One motion, seen from its beginning and from t = 0.5 on (where the second's material positions are).
  const ParticleSet early = block();
  ParticleSet late = early;
  for (Vec2& x : late.x0) x += shear(x, 0.5);
  const DisplacementLaw rest = [](const Vec2& x, double t) -> Vec2 {
    const Vec2 origin(x.x() - 0.5 * (0.4 * (x.y() + 0.1) + 0.1), x.y() + 0.1);  // x at t = 0
    return shear(origin, t) - shear(origin, 0.5);
  };
  const GradientLaw rest_F = [](const Vec2&, double t) -> Mat2 {
    Mat2 F = Mat2::Identity();
    F(0, 1) = 0.4 * (t - 0.5);
    return F;
  };
  const MotionMemory a = motion_of("a", early, {0, 0.4, 0.8, 1.2}, shear, shear_F);
  const MotionMemory b = motion_of("b", late, {0.5, 0.8, 1.2}, rest, rest_F);
  for (const auto& [first, second] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    const Comparison c = compared(*first, *second);
    EXPECT_EQ(c.times().back(), 1.2);
    EXPECT_EQ(metric(c, "coverage_first").value, 1);
    EXPECT_LT(metric(c, "displacement_max").value, 1e-6);
    EXPECT_LT(metric(c, "strain_dev_max").value, 1e-6);
    EXPECT_NEAR(metric(c, "displacement_peak_first").value, 0.7 * Vec2(0.4 * 4.5 + 0.1, -0.2).norm(), 1e-6);
  }
}

TEST(Compare, EndedParticlesHaveNoPartnerFromThenOn) {
  const ParticleSet set = block();
  const std::vector<double> times{0, 1, 2, 3};
  MotionMemory a("a", "m", "s", set), b("b", "m", "s", set);
  for (double t : times) {
    MotionFrame f = frame_of(set, t, shear, rigid), g = f;
    if (t >= 2) {  // wrong values that must not count
      f.status[4] = ParticleStatus::ended;
      f.u[4] = {100, 0};
    }
    if (t >= 1 && t < 3) {  // even if it comes back
      g.status[9] = ParticleStatus::ended;
      g.u[9] = {-100, 0};
    }
    g.status[11] = t < 1 ? ParticleStatus::unborn : ParticleStatus::active;
    g.status[12] = ParticleStatus::flagged;  // followed all the same
    a.add(f);
    b.add(g);
  }
  const Comparison c = compared(a, b);
  EXPECT_EQ(metric(c, "displacement_max").value, 0);
  EXPECT_EQ(series(c, "particles_compared"), (std::vector<double>{29, 28, 27, 27}));
  EXPECT_DOUBLE_EQ(metric(c, "coverage_first_final").value, 27.0 / 30);
  EXPECT_EQ(c.fields[0].id.size(), 29U);  // without 11
  EXPECT_FALSE(std::isnan(c.fields[0].values[4]));
  EXPECT_TRUE(std::isnan(c.fields[0].values[2 * 29 + 4]));
  EXPECT_TRUE(std::isnan(c.fields[3].values[3 * 29 + 9]));
}

TEST(Compare, EndsWhenNobodyIsLeft) {
  const ParticleSet set = block();
  MotionMemory b("b", "m", "s", set);
  for (double t : {0.0, 1.0, 2.0}) {
    MotionFrame f = frame_of(set, t, shear, shear_F);
    if (t > 1.5) f.status.assign(set.size(), ParticleStatus::ended);
    b.add(f);
  }
  const MotionMemory a = motion_of("a", set, {0, 1, 2}, shear, shear_F);
  const Comparison c = compared(a, b), self = compared(a, a);
  EXPECT_EQ(c.times(), (std::vector<double>{0, 1}));
  EXPECT_EQ(c.fields[0].values.size(), 60U);
  EXPECT_EQ(metric(c, "coverage_first_final").value, 1);
  EXPECT_EQ(metric(c, "displacement_rms_final").value, 0);
  EXPECT_FALSE(c.outlines[1].empty());  // as it was at t = 1
  EXPECT_NE(c.outlines[0], self.outlines[0]);
  EXPECT_TRUE(std::any_of(c.remarks.begin(), c.remarks.end(),
                          [](const std::string& r) { return r.find("ends at the time before") != std::string::npos; }));
}

TEST(Compare, BetweenAGoodFrameAndAnEndedOneThereIsNoPartner) {
  const ParticleSet set = block();
  MotionMemory b("b", "m", "s", set);
  for (double t : {0.0, 1.0, 2.0}) {
    MotionFrame f = frame_of(set, t, shear, rigid);
    if (t > 1.5) f.status[0] = ParticleStatus::ended;
    b.add(f);
  }
  const Comparison c = compared(motion_of("a", set, {0, 1, 1.5}, shear), b);
  EXPECT_EQ(series(c, "particles_compared"), (std::vector<double>{30, 30, 29}));
  EXPECT_LT(metric(c, "displacement_max").value, 1e-6);
}

TEST(Compare, InterpolationGoesOnWithThoseLeft) {
  // The second loses one particle, then a whole corner: the first's particles there drop out, the others go on.
  const ParticleSet first = particles_at(square_lattice(20, 20, 0.4), 0.4);
  const ParticleSet second = particles_at(square_lattice(8, 8, 1), 1);
  MotionMemory b("b", "m", "s", second);
  for (double t : {0.0, 1.0, 2.0}) {
    MotionFrame f = frame_of(second, t, shear, shear_F);
    for (std::size_t p = 0; p < second.size(); ++p) {
      const bool single = (second.x0[p] - Vec2(2.5, 2.5)).norm() < 0.1;
      const bool corner = second.x0[p].x() > 4 && second.x0[p].y() > 4;
      if ((t >= 1 && single) || (t >= 2 && corner)) {
        f.status[p] = ParticleStatus::ended;
        f.u[p] = {-50, 50};
      }
    }
    b.add(f);
  }
  const Comparison c = compared(motion_of("a", first, {0, 1, 2}, shear, shear_F), b);
  EXPECT_LT(metric(c, "displacement_max").value, 1e-5);
  const std::vector<double>& count = series(c, "particles_compared");
  EXPECT_EQ(count[0], 400);
  EXPECT_EQ(count[1], 400);
  // x > 4 and y > 4 holds 100 of the first's. What is left ends at 3.5 along both sides, cut across its corner from
  // (3.5, 4.5) to (4.5, 3.5): (4.2, 4.2) is 0.28 from there and keeps a partner, no other of the 100 does.
  EXPECT_EQ(count[2], 301);
}

TEST(Compare, ReferencePolygonTakesTheFrameOff) {
  const ParticleSet set = particles_at(square_lattice(10, 6, 1), 1);
  // The same motion, seen from a camera that moves by (0.2, 1.9) a second.
  const DisplacementLaw local = [](const Vec2& x, double t) -> Vec2 {
    return x.x() < 8 ? Vec2(0.05 * t * (8 - x.x()), 0) : Vec2(0, 0);
  };
  const DisplacementLaw seen = [&](const Vec2& x, double t) -> Vec2 { return local(x, t) + t * Vec2(0.2, 1.9); };
  const MotionMemory camera = motion_of("np", set, {0, 1, 2}, seen), soil = motion_of("mpm", set, {0, 1, 2}, local);
  EXPECT_GT(metric(compared(camera, soil), "displacement_rms").value, 1);

  CompareOptions options;
  options.reference_m = {{8, 0}, {10, 0}, {10, 6}, {8, 6}};
  const Comparison c = compared(camera, soil, options);
  EXPECT_LT(metric(c, "displacement_max").value, 2e-6);
  EXPECT_NEAR(metric(c, "reference_shift_first_x").value, 0.4, 1e-6);
  EXPECT_NEAR(metric(c, "reference_shift_first_y").value, 3.8, 1e-6);
  EXPECT_NEAR(metric(c, "reference_shift_second_y").value, 0, 1e-6);
  EXPECT_NEAR(metric(c, "displacement_peak_first").value, 2 * 0.05 * 7.5, 1e-6);
  EXPECT_NEAR(metric(c, "outline_iou").value, 1, 1e-4);

  options.reference_m = {{80, 0}, {90, 0}, {90, 6}};
  EXPECT_THROW(compared(camera, soil, options), InputError);
}

TEST(Compare, AStretchedBodyKeepsItsOutline) {
  const ParticleSet set = particles_at(square_lattice(20, 20, 1), 1);
  const DisplacementLaw u = [](const Vec2& x, double t) -> Vec2 { return t * Vec2(2 * x.x(), -2.0 / 3 * x.y()); };
  const GradientLaw F = [](const Vec2&, double t) -> Mat2 {
    return Vec2(1 + 2 * t, 1 - 2.0 / 3 * t).asDiagonal().toDenseMatrix();
  };
  const MotionMemory a = motion_of("a", set, {0, 1}, u, F);
  const Comparison c = compared(a, a);
  EXPECT_EQ(c.outlines[0].size(), 1U);
  EXPECT_EQ(metric(c, "outline_iou").value, 1);

  // Scattered without any strain that would say so, the particles have no outline, and no number pretends to be one.
  const MotionMemory gas = motion_of("gas", set, {0, 1}, [](const Vec2& x, double t) -> Vec2 { return 9 * t * x; });
  const Comparison none = compared(gas, gas);
  EXPECT_TRUE(none.outlines[0].empty());
  EXPECT_FALSE(has_metric(none, "outline_iou"));
  EXPECT_NE(none.remarks.back().find("outline"), std::string::npos);
}

TEST(Compare, ErrorsNameBothSides) {
  const ParticleSet set = block();
  const MotionMemory a = motion_of("lab", set, {0, 1}, shear);
  MotionMemory px("pixels", "px", "s", set), frames("frames", "m", "frames", set), none("none", "m", "s", set);
  for (MotionMemory* m : {&px, &frames}) m->add(frame_of(set, 0, shear, rigid));
  for (const MotionMemory* m : {&px, &frames}) {
    try {
      compared(a, *m);
      FAIL() << "accepted";
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("'lab'"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(m->name()), std::string::npos) << e.what();
    }
  }
  ParticleSet broken = set;
  broken.x0[3].y() = std::nan("");
  EXPECT_THROW(compared(a, motion_of("broken", broken, {0, 1}, shear)), InputError);
  EXPECT_THROW(compared(a, none), InputError);
  EXPECT_THROW(compared(MotionMemory("empty", "m", "s", ParticleSet{}), a), InputError);
}

TEST(Compare, StopsWhenAsked) {
  struct Stop final : Progress {
    void update(std::string_view, std::int64_t, std::int64_t) override {}
    bool stop_requested() const override { return true; }
  } stop;
  const MotionMemory a = motion_of("a", block(), {0, 1}, shear);
  EXPECT_THROW(compare(a, a, {}, {}, stop), Interrupted);
}

}  // namespace
}  // namespace pivnp::compare
