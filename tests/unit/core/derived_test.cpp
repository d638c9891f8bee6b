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

TEST(Derived, StrainRatesOfAStretchThatTurns) {
  // F = R(a t) diag(exp(b t), exp(-c t)): the rate of deformation is R diag(b, -c) R^T whatever the turn.
  const double a = 0.4, b = 0.2, c = 0.05;
  for (const double h : {0.02, 0.01}) {
    MotionMemory motion("np", "m", "s", particles(1));
    for (int k = 0; k < 5; ++k) {
      const double t = 1 + h * k, cs = std::cos(a * t), sn = std::sin(a * t), p = std::exp(b * t), q = std::exp(-c * t);
      motion.add(frame(t, {0, 0}, {float(cs * p), float(-sn * q), float(sn * p), float(cs * q)}));
    }
    DerivedReader reader(motion, true);
    const double near = 1e-4;  // frames are single precision
    EXPECT_NEAR(reader.values("strain_rate_1", 2)[0], b, near);
    EXPECT_NEAR(reader.values("strain_rate_2", 2)[0], -c, near);
    EXPECT_NEAR(reader.values("strain_rate_angle", 2)[0], a * (1 + 2 * h), 1e-3);
    EXPECT_NEAR(reader.values("strain_rate_vol", 0)[0], b - c, near);
    const double mean = (b - c) / 3;
    EXPECT_NEAR(reader.values("strain_rate_dev", 4)[0],
                std::sqrt(2.0 / 3 * (std::pow(b - mean, 2) + std::pow(-c - mean, 2) + mean * mean)), near);
    const double angle = a * (1 + 2 * h);
    EXPECT_NEAR(reader.values("strain_rate_xx", 2)[0], b * std::pow(std::cos(angle), 2) - c * std::pow(std::sin(angle), 2),
                near);
    EXPECT_NEAR(reader.values("strain_rate_xy", 2)[0], (b + c) * std::sin(angle) * std::cos(angle), near);
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
