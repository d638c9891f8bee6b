// Gauge length and noise floor of a run's strains.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "apps/study/methods/paths/strain_floor.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {
namespace {

Case plain_case() {
  Case c;
  c.name = "floor";
  c.grid.spacing_px = 16;
  c.piv = piv::PivOptions{};
  c.np = np::NpOptions{};
  return c;
}

// F wanders by steps of `noise` an entry; the right half is stretched besides.
MotionMemory wandering(const ParticleSet& set, int frames, double noise, float stretch = 0.01f) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, noise);
  MotionMemory motion("np", "px", "frame", set);
  std::vector<std::array<float, 4>> F(set.size(), {1, 0, 0, 1});
  for (int k = 0; k < frames; ++k) {
    MotionFrame frame;
    frame.time = k;
    frame.u.assign(set.size(), {0, 0});
    for (std::size_t p = 0; p < set.size(); ++p)
      if (k > 0) {
        for (float& v : F[p]) v += float(normal(random));
        if (set.x0[p].x() > 128) F[p][0] += stretch;
      }
    frame.F = F;
    frame.status.assign(set.size(), ParticleStatus::active);
    motion.add(frame);
  }
  return motion;
}

TEST(StrainFloor, NotMeasuredUnlessSomethingIsKnownToRest) {
  const Case c = plain_case();
  const Setting setting = make_setting(c, 256, 256);
  const StrainNote note = strain_note(c, setting, wandering(seed_particles(c, setting), 3, 1e-3), true);
  EXPECT_DOUBLE_EQ(note.gauge_length, 3 * 16 + 32);
  EXPECT_EQ(note.floor_source, StrainFloor::not_measured);
  EXPECT_TRUE(std::isnan(note.floor_dev));
  Case narrow = c;
  narrow.np->shape = np::ShapeFunctions::bilinear;
  EXPECT_DOUBLE_EQ(strain_note(narrow, setting, wandering(seed_particles(c, setting), 3, 1e-3), true).gauge_length, 16 + 32);
}

TEST(StrainFloor, OfAZoneAndOfFramesAtRest) {
  Case c = plain_case();
  const Setting setting = make_setting(c, 256, 256);
  const double noise = 1e-3;
  const int frames = 26;
  const MotionMemory motion = wandering(seed_particles(c, setting), frames, noise);
  c.np->still_zone_px = {{0, 0}, {127, 0}, {127, 255}, {0, 255}};
  EXPECT_NO_THROW(check_strain_floor(c, setting, std::size_t(frames)));
  const StrainNote zone = strain_note(c, setting, motion, true);
  EXPECT_EQ(zone.floor_source, StrainFloor::still_zone);
  // xx, yy of variance s^2, xy of s^2/2, s^2 = 25 noise^2: 2/3 e:e of the deviator comes to 14/9 s^2, tr to 2 s^2.
  const double s = std::sqrt(25.0) * noise;
  EXPECT_NEAR(zone.floor_vol, std::sqrt(2.0) * s, 0.05 * s);
  EXPECT_NEAR(zone.floor_dev, std::sqrt(14.0 / 9) * s, 0.08 * s);
  EXPECT_GT(zone.floor_path, 4 * zone.floor_dev);  // norms only add

  Case early = plain_case();
  early.np->still_frames = 6;  // half of the material does move, so that this is more
  const StrainNote more = strain_note(early, setting, motion, true);
  EXPECT_EQ(more.floor_source, StrainFloor::still_frames);
  EXPECT_GT(more.floor_dev, 2 * zone.floor_dev);
  // Where nothing moves, what five steps show is carried on to what twenty-five do.
  const MotionMemory still = wandering(seed_particles(early, setting), frames, noise, 0);
  const StrainNote carried = strain_note(early, setting, still, true);
  c.np->still_zone_px = {{0, 0}, {255, 0}, {255, 255}, {0, 255}};
  const StrainNote whole = strain_note(c, setting, still, true);
  EXPECT_NEAR(carried.floor_dev, whole.floor_dev, 0.1 * whole.floor_dev);
  EXPECT_NEAR(carried.floor_vol, whole.floor_vol, 0.1 * whole.floor_vol);
  EXPECT_NEAR(carried.floor_path, whole.floor_path, 0.1 * whole.floor_path);
}

TEST(StrainFloor, WhatIsWrongIsSaidBeforeMeasuring) {
  const Setting setting = make_setting(plain_case(), 256, 256);
  const auto refuses = [&](auto change) {
    Case c = plain_case();
    change(*c.np);
    EXPECT_THROW(check_strain_floor(c, setting, 10), InputError);
  };
  const Points box = {{10, 10}, {60, 10}, {60, 60}};
  refuses([&](np::NpOptions& o) { o.still_zone_px = box, o.still_zone_m = box; });
  refuses([&](np::NpOptions& o) { o.still_zone_px = box, o.still_frames = 4; });
  refuses([](np::NpOptions& o) { o.still_frames = 1; });
  refuses([](np::NpOptions& o) { o.still_frames = 11; });
  refuses([](np::NpOptions& o) { o.still_zone_px = {{900, 10}, {960, 10}, {960, 60}}; });
  refuses([](np::NpOptions& o) { o.still_zone_px = {{10, 10}, {20, 20}}; });
  EXPECT_NO_THROW(check_strain_floor(plain_case(), setting, 10));
}

}  // namespace
}  // namespace pivnp::app
