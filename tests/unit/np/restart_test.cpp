// Going on after a break: the same bits, and no state that is not this run's.
#include <gtest/gtest.h>

#include <cmath>

#include "pivnp/core/error.hpp"
#include "tests/verification/np_testing.hpp"

namespace pivnp::np {
namespace {

using namespace testing;

const Grid grid{{0, 0}, {0.25, 0.25}, 17, 17};
const ReversingVortex vortex({2, 2}, 1, 2.5, 20);

VectorField pair(int k) {
  NodalIncrements d = sample_increments(vortex, grid, k % 3 == 0 ? Anchor::forward : Anchor::central, k, k + 1);
  d.cov.assign(grid.node_count(), {1e-4f, 2e-4f, 3e-5f});
  for (std::size_t n = std::size_t(k); n < d.status.size(); n += 23) d.status[n] = VectorStatus::failed;
  if (k == 3) d.status.assign(d.status.size(), VectorStatus::replaced);
  return vector_field(d, {k, k + 1});
}

ParticleSet particles() {
  ParticleSet set = block(grid, {0, 0}, {4, 4}, 4);
  set.born[5] = 4.5;
  for (Vec2& x : set.x0) x += Vec2(0.05, 0);  // those at the right are outside, or soon will be
  return set;
}

TEST(Restart, MidwayGivesTheSameBits) {
  for (const int stop : {0, 1, 4, 5, 9}) {
    Tracker straight({}, particles(), 0);
    std::vector<std::byte> saved;
    if (stop == 0) saved = straight.save();
    for (int k = 0; k < 10; ++k) {
      straight.step(pair(k), k + 1);
      if (k + 1 == stop) saved = straight.save();
    }
    Tracker resumed({}, particles(), 0);
    resumed.load(saved);
    EXPECT_EQ(resumed.time(), stop);
    EXPECT_EQ(resumed.save(), saved);
    for (int k = stop; k < 10; ++k) resumed.step(pair(k), k + 1);
    EXPECT_EQ(resumed.save(), straight.save());
    const MotionFrame a = straight.frame(), b = resumed.frame();
    EXPECT_EQ(a.u, b.u);
    EXPECT_EQ(a.F, b.F);
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.cov_u, b.cov_u);
    EXPECT_EQ(straight.particles().end_reason, resumed.particles().end_reason);
  }
}

TEST(Restart, TheTestRunHoldsEveryKindOfState) {
  Tracker tracker({}, particles(), 0);
  std::array<int, 4> seen{};
  for (int k = 0; k < 10; ++k) {
    tracker.step(pair(k), k + 1);
    for (std::size_t p = 0; p < tracker.state().size(); ++p) ++seen[std::size_t(tracker.state()[p].status)];
  }
  for (const int count : seen) EXPECT_GT(count, 0);
}

TEST(Restart, RefusesDamagedBytesAndStaysAsItWas) {
  Tracker tracker({}, particles(), 0);
  tracker.step(pair(0), 1);
  const std::vector<std::byte> good = tracker.save();
  Tracker other({}, particles(), 0);
  const std::vector<std::byte> before = other.save();
  EXPECT_THROW(other.load({}), InputError);
  EXPECT_THROW(other.load({good.begin(), good.end() - 1}), InputError);
  EXPECT_THROW(other.load({good.begin(), good.end() - 82}), InputError);
  EXPECT_THROW(other.load({good.begin(), good.begin() + 60}), InputError);
  std::vector<std::byte> longer = good;
  longer.push_back(std::byte{0});
  EXPECT_THROW(other.load(longer), InputError);
  for (std::size_t at = 0; at < good.size(); at += at < 64 ? 1 : 997) {
    std::vector<std::byte> damaged = good;
    damaged[at] ^= std::byte{0x10};
    EXPECT_THROW(other.load(damaged), InputError) << "byte " << at;
  }
  EXPECT_EQ(other.save(), before);
  other.load(good);
  EXPECT_EQ(other.save(), good);
}

TEST(Restart, RefusesTheStateOfAnotherRun) {
  Tracker tracker({}, particles(), 0);
  tracker.step(pair(0), 1);
  const std::vector<std::byte> bytes = tracker.save();

  NpOptions options;
  options.gradient = GradientPlace::element;
  Tracker centre(options, particles(), 0);
  EXPECT_THROW(centre.load(bytes), InputError);
  options = {};
  options.error_correlation = 0.5;
  Tracker correlation(options, particles(), 0);
  EXPECT_THROW(correlation.load(bytes), InputError);

  ParticleSet moved = particles();
  moved.x0[3].x() += 1e-12;
  Tracker elsewhere({}, moved, 0);
  EXPECT_THROW(elsewhere.load(bytes), InputError);
  Tracker fewer({}, block(grid, {0, 0}, {1, 1}, 4), 0);
  EXPECT_THROW(fewer.load(bytes), InputError);
  try {
    fewer.load(bytes);
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("1024 particles, expected 64"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace pivnp::np
