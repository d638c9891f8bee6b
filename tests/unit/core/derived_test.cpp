// Derived fields: velocity and acceleration exact for parabolas at uneven times; the summed strain's known fault.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/derived.hpp"

namespace pivnp {
namespace {

ParticleSet particles(std::size_t count) {
  ParticleSet set;
  for (std::size_t p = 0; p < count; ++p) {
    set.id.push_back(std::int64_t(p));
    set.label.push_back(0);
    set.x0.emplace_back(double(p), 0);
    set.area.push_back(1);
    set.born.push_back(0);
    set.end.push_back(std::numeric_limits<double>::quiet_NaN());
    set.end_reason.push_back(EndReason::none);
  }
  set.label_names = {"all"};
  return set;
}

MotionFrame frame(double t, std::array<float, 2> u, std::array<float, 4> F, ParticleStatus s = ParticleStatus::active) {
  MotionFrame f;
  f.time = t;
  f.u = {u};
  f.F = {F};
  f.status = {s};
  return f;
}

TEST(Derived, ParabolaAtUnevenTimes) {
  MotionMemory motion("np", "m", "s", particles(1));
  const std::vector<double> times = {0, 0.5, 1.25, 2, 4};
  for (double t : times) motion.add(frame(t, {float(3 * t * t - t), float(2 * t)}, {1, 0, 0, 1}));
  DerivedReader reader(motion, false);
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_NEAR(reader.values("velocity_x", k)[0], 6 * times[k] - 1, 2e-5);
    EXPECT_NEAR(reader.values("acceleration_x", k)[0], 6, 2e-4);
    EXPECT_NEAR(reader.values("velocity_y", k)[0], 2, 1e-5);
  }
}

TEST(Derived, EndedParticlesAreNaNAndDoNotLeakIntoDifferences) {
  MotionMemory motion("np", "m", "s", particles(1));
  motion.add(frame(0, {0, 0}, {1, 0, 0, 1}));
  motion.add(frame(1, {1, 0}, {1, 0, 0, 1}));
  motion.add(frame(2, {2, 0}, {1, 0, 0, 1}));
  motion.add(frame(3, {99, 0}, {1, 0, 0, 1}, ParticleStatus::ended));
  DerivedReader reader(motion, false);
  EXPECT_NEAR(reader.values("velocity_x", 2)[0], 1, 1e-6);
  EXPECT_TRUE(std::isnan(reader.values("velocity_x", 3)[0]));
}

TEST(Derived, SummedStrainKeepsTheOldStretchAfterATurn) {
  // Why sums are not objective: 24 % stretch, then 90 degrees: the sum stays at the stretch, the true xx strain is zero.
  MotionMemory motion("np", "m", "s", particles(1));
  motion.add(frame(0, {0, 0}, {1, 0, 0, 1}));
  double stretch = 1;
  int t = 0;
  for (int n = 0; n < 15; ++n) {
    stretch *= 1.016;
    motion.add(frame(++t, {0, 0}, {float(stretch), 0, 0, 1}));
  }
  const int turns = 90;
  for (int n = 1; n <= turns; ++n) {
    const double a = std::numbers::pi / 2 * n / turns;
    motion.add(frame(++t, {0, 0}, {float(stretch * std::cos(a)), float(-std::sin(a)), float(stretch * std::sin(a)), float(std::cos(a))}));
  }
  DerivedReader reader(motion, true);
  const std::size_t last = motion.times().size() - 1;
  EXPECT_NEAR(reader.values("strain_xx", last)[0], 0, 1e-6);
  EXPECT_NEAR(reader.values("strain_yy", last)[0], 15 * std::log(1.016), 1e-6);
  EXPECT_NEAR(reader.values("strain_sum_xx", last)[0], 0.24, 0.003);
  EXPECT_NEAR(reader.values("strain_sum_xx", 15)[0], reader.values("strain_sum_xx", last)[0], 1e-4);
}

TEST(Derived, UnknownFieldNamesTheNearest) {
  try {
    derived_field("strain_devv");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("strain_dev"), std::string::npos);
  }
}

}  // namespace
}  // namespace pivnp
