// Differences of the pressure in the pores, by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "pivnp/core/particles/fields.hpp"
#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

const DisplacementLaw at_rest = [](const Vec2&, double) { return Vec2(0, 0); };

MotionMemory wet(const std::string& name, const ParticleSet& set, const std::vector<double>& times,
                 const std::function<double(const Vec2&, double)>& pressure) {
  MotionMemory motion(name, "m", "s", set);
  for (const double t : times) {
    MotionFrame frame = frame_of(set, t, at_rest, rigid);
    const std::span<float> values = frame.add("pressure", set.size());
    for (std::size_t p = 0; p < set.size(); ++p) values[p] = float(pressure(set.x0[p], t));
    motion.add(std::move(frame));
  }
  return motion;
}

TEST(Pressures, AreComparedWhereBothKnowThem) {
  const ParticleSet set = particles_at(square_lattice(4, 3, 1), 1);
  const MotionMemory first = wet("a", set, {0, 1, 2}, [](const Vec2& x, double t) { return 1000 * x.y() + 100 * t; });
  // Its frames lie elsewhere in time: linear between them. Less by 300 Pa in the column at the left, by 100 Pa t elsewhere.
  const MotionMemory second = wet("b", set, {0, 0.5, 1.5, 2}, [](const Vec2& x, double t) {
    return 1000 * x.y() + (x.x() < 1 ? 100 * t - 300 : 0);
  });
  const Comparison c = compared(first, second);
  EXPECT_NEAR(metric(c, "pressure_bias").value, -(0.25 * 300 + 0.75 * 100), 1e-3);
  EXPECT_NEAR(metric(c, "pressure_rms").value, std::sqrt(0.25 * 9e4 + 0.75 * (0 + 1e4 + 4e4) / 3), 1e-3);
  EXPECT_NEAR(metric(c, "pressure_max").value, 300, 1e-3);
  EXPECT_NEAR(metric(c, "pressure_bias_final").value, -(0.25 * 300 + 0.75 * 200), 1e-3);
  EXPECT_NEAR(metric(c, "pressure_rms_final").value, std::sqrt(0.25 * 9e4 + 0.75 * 4e4), 1e-3);
  EXPECT_NEAR(metric(c, "pressure_peak_first").value, 2700, 1e-3);
  EXPECT_NEAR(metric(c, "pressure_peak_second").value, 2500, 1e-3);
  EXPECT_EQ(metric(c, "pressure_rms").unit, "Pa");
  const ComparisonField* field = c.field("difference_pressure");
  ASSERT_NE(field, nullptr);
  ASSERT_EQ(field->time, (std::vector<double>{0, 1, 2}));
  EXPECT_NEAR(double(field->values[12]), -300, 1e-3);
  EXPECT_NEAR(double(field->values[13]), -100, 1e-3);
}

TEST(Pressures, OfOtherParticlesAreThoseAtTheSamePlace) {
  const auto linear = [](double more) { return [=](const Vec2& x, double) { return 1000 * x.y() - 200 * x.x() + more; }; };
  const Comparison c = compared(wet("a", particles_at(square_lattice(6, 5, 1), 1), {0, 1}, linear(0)),
                                wet("b", particles_at(square_lattice(12, 10, 0.5), 0.5), {0, 1}, linear(50)));
  EXPECT_NEAR(metric(c, "pressure_bias").value, 50, 0.01);
  EXPECT_NEAR(metric(c, "pressure_max").value, 50, 0.01);
}

// By coarser grids each metric of pressures has its own u_num; it is no u_val, since what the first is uncertain by is not known.
TEST(Pressures, HaveAPartFromTheNumerics) {
  const ParticleSet set = particles_at(square_lattice(6, 5, 1), 1);
  const auto by = [&](const std::string& name, double more) {
    return wet(name, set, {0, 1}, [=](const Vec2& x, double) { return 1000 * x.y() + more; });
  };
  const MotionMemory first = by("a", 0), second = by("b", 50), coarser = by("c", 58), coarsest = by("d", 58 + 8 * 1.3 * 1.3);
  SilentProgress progress;
  const Comparison one = compare(first, second, {}, {}, progress, Refinement{{&coarser}, 1.3});
  EXPECT_NE(metric(one, "pressure_rms").definition.find("with u_num = 8 (change from one coarser grid"), std::string::npos) << metric(one, "pressure_rms").definition;
  const Comparison two = compare(first, second, {}, {}, progress, Refinement{{&coarser, &coarsest}, 1.3});
  for (const char* name : {"pressure_rms", "pressure_bias", "pressure_max_final"})
    EXPECT_NE(metric(two, name).definition.find("(GCI of three grids, order 2)"), std::string::npos) << metric(two, name).definition;
  EXPECT_FALSE(metric(two, "pressure_rms").lost());
}

TEST(Pressures, AreNoMetricsWhereOneDoesNotKnowThem) {
  const ParticleSet set = particles_at(square_lattice(4, 3, 1), 1);
  const Comparison c = compared(motion_of("a", set, {0, 1}, at_rest), wet("b", set, {0, 1}, [](const Vec2&, double) { return 7.0; }));
  EXPECT_FALSE(has_metric(c, "pressure_rms"));
  EXPECT_FALSE(has_metric(c, "pressure_peak_second"));
  EXPECT_EQ(c.field("difference_pressure"), nullptr);
}

}  // namespace
}  // namespace pivnp::compare
