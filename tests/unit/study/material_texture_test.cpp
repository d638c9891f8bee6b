// Texture that a simulation's own material points carry: exact where the points are, linear between, and none of it beyond
// what was simulated.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/record/record_head.hpp"
#include "apps/study/synth/material_map.hpp"
#include "apps/study/synth/synthesize.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/image/frames/frames.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {
namespace material_texture {

namespace fs = std::filesystem;

ParticleSet points(int nx, int ny, double spacing, double split = 1e9) {
  ParticleSet set;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec2 x = spacing * Vec2(i + 0.5 + 0.2 * std::sin(7.0 * i + j), j + 0.5 + 0.2 * std::cos(3.0 * j + 2 * i));
      set.id.push_back(std::int64_t(set.id.size()));
      set.label.push_back(x.x() > split ? 1 : 0);
      set.x0.push_back(x);
      set.area.push_back(spacing * spacing);
      set.born.push_back(0);
      set.end.push_back(std::numeric_limits<double>::quiet_NaN());
      set.end_reason.push_back(EndReason::none);
    }
  set.label_names = {"left", "right"};
  return set;
}

template <class U>
MotionFrame moved(const ParticleSet& set, double time, const U& u) {
  MotionFrame frame;
  frame.time = time;
  for (const Vec2& x : set.x0) {
    const Vec2 d = u(x);
    frame.u.push_back({float(d.x()), float(d.y())});
    frame.F.push_back({1, 0, 0, 1});
    frame.status.push_back(ParticleStatus::active);
  }
  return frame;
}

TEST(MaterialMap, IsThatOfThePointsThere) {
  const ParticleSet set = points(12, 9, 2);
  MaterialMap map(set);
  const auto wild = [](const Vec2& x) { return Vec2(std::sin(3 * x.x()) + x.y(), 5 * std::cos(x.x() * x.y())); };
  const MotionFrame frame = moved(set, 0, wild);
  map.set(frame);
  for (std::size_t p = 0; p < set.size(); ++p) {
    const auto s = map.stencil(set.x0[p]);
    ASSERT_TRUE(s);
    // To the last bit of what a record holds, and so far below 1e-6 of a cell.
    EXPECT_NEAR((map.at(*s) - set.x0[p] - Vec2(double(frame.u[p][0]), double(frame.u[p][1]))).norm(), 0, 1e-12);
    // And without a step: a little aside it is almost the same.
    const auto aside = map.stencil(set.x0[p] + Vec2(1e-6, 1e-6));
    EXPECT_NEAR((map.at(*aside) - map.at(*s)).norm(), 0, 1e-4);
  }
}

TEST(MaterialMap, IsLinearBetweenPointsWhereTheMotionIs) {
  const ParticleSet set = points(12, 9, 2);
  MaterialMap map(set);
  Mat2 G;
  G << 0.4, -0.3, 0.2, 0.1;
  map.set(moved(set, 0, [&](const Vec2& x) -> Vec2 { return G * x + Vec2(3, -1); }));
  for (double x = 0.2; x < 23; x += 0.37)
    for (double y = 0.2; y < 17; y += 0.41) {
      const auto s = map.stencil({x, y});
      ASSERT_TRUE(s);
      EXPECT_NEAR((map.at(*s) - Vec2(x, y) - G * Vec2(x, y) - Vec2(3, -1)).norm(), 0, 2e-5);  // single precision of u
    }
  EXPECT_FALSE(map.stencil({60, 5}));
}

TEST(MaterialMap, DoesNotStickAcrossAContact) {
  const ParticleSet set = points(12, 9, 2, 12);
  MaterialMap map(set);
  map.set(moved(set, 0, [](const Vec2& x) { return Vec2(0, x.x() > 12 ? 5 : 0); }));
  for (double x = 1; x < 23; x += 0.21) {
    const double up = map.at(*map.stencil({x, 9})).y() - 9;
    EXPECT_TRUE(std::abs(up) < 1e-6 || std::abs(up - 5) < 1e-6) << x << ": " << up;
  }
}

TEST(MaterialMap, FollowsOnlyPointsThatAreThere) {
  const ParticleSet set = points(6, 6, 2);
  MaterialMap map(set);
  MotionFrame frame = moved(set, 0, [](const Vec2&) { return Vec2(1, 0); });
  const auto s = map.stencil({6, 6});
  frame.status[s->point.front()] = ParticleStatus::ended;
  map.set(frame);
  EXPECT_NEAR(map.at(*s).x(), 7, 1e-6);
  frame.status.assign(set.size(), ParticleStatus::ended);
  map.set(frame);
  EXPECT_TRUE(std::isnan(map.at(*s).x()));
}

Case synthetic(const std::string& record, const std::string& more = "") {
  return parse_case("[frames]\nrate_hz = 1.0\n[grid]\nspacing_px = 16\n[region.soil]\npolygon_m = [[20.0, 20.0], [100.0, 20.0], "
                    "[100.0, 70.0], [20.0, 70.0]]\n[synth]\nmotion = \"record\"\nrecord = \"" + record +
                        "\"\nwidth_px = 128\nheight_px = 96\nframes = 3\n" + more + "[synth.texture]\ndensity_per_px = 0.1\n",
                    "synthetic", fs::current_path());
}

// A record of points that move by whole pixels: frames move by so many, and the truth is the record's motion, bit by bit.
TEST(RecordTexture, MovesWithTheRecordsPoints) {
  const fs::path folder = fs::temp_directory_path() / "pivnp_material_texture";
  fs::remove_all(folder);
  fs::create_directories(folder / "sim");
  ParticleSet set = points(60, 48, 2);
  std::vector<MotionFrame> states;
  for (int k = 0; k < 3; ++k) states.push_back(moved(set, k, [&](const Vec2&) { return Vec2(4 * k, 3 * k); }));
  {
    io::RecordHead head;
    head.length_unit = "px", head.time_unit = "s";
    io::RecordWriter writer(folder / "sim", head, false);
    writer.begin_motion("mpm", set);
    for (const MotionFrame& state : states) writer.add_frame("mpm", state);
    writer.end_stage("motion/mpm", &set);
    writer.finish();
  }
  RunSettings settings;
  settings.out = folder / "drawn";
  SilentProgress progress;
  synthesize(synthetic((folder / "sim" / "record.h5").string() + ":mpm"), settings, progress);
  image::FrameOptions frames;
  frames.path = (settings.out / "frames" / "frame_*.png").string();
  const auto source = image::open_frames(frames, "");
  const Image first = source->read(0), last = source->read(2);
  int bright = 0;
  for (int r = 6; r < 90; ++r)
    for (int c = 0; c < 120; ++c) {
      ASSERT_NEAR(int(last.view().row<std::uint8_t>(r - 6)[c + 8]), int(first.view().row<std::uint8_t>(r)[c]), 1) << r << ", " << c;
      bright += first.view().row<std::uint8_t>(r)[c] > 40;
    }
  EXPECT_GT(bright, 500);
  const io::RecordReader truth(settings.out / "truth" / "record.h5");
  const auto material = truth.motion("material");
  ASSERT_EQ(material->particles().size(), set.size());
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(material->frame(k).u, states[k].u);
  EXPECT_EQ(truth.motion("truth")->frame(2).u[5][0], 8.0F);
  fs::remove_all(folder);
}

TEST(RecordTexture, TimesThatAreNotThereAreRefused) {
  const fs::path folder = fs::temp_directory_path() / "pivnp_material_times";
  fs::remove_all(folder);
  fs::create_directories(folder / "sim");
  const ParticleSet set = points(20, 20, 4);
  {
    io::RecordHead head;
    head.length_unit = "px", head.time_unit = "s";
    io::RecordWriter writer(folder / "sim", head, false);
    writer.begin_motion("mpm", set);
    for (int k = 0; k < 2; ++k) writer.add_frame("mpm", moved(set, 0.75 * k, [](const Vec2&) { return Vec2(0, 0); }));
    writer.end_stage("motion/mpm", &set);
    writer.finish();
  }
  RunSettings settings;
  settings.out = folder / "drawn";
  SilentProgress progress;
  try {
    synthesize(synthetic((folder / "sim" / "record.h5").string()), settings, progress);
    FAIL() << "no state at 1 s, and nothing said";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no state at 1 s"), std::string::npos) << error.what();
  }
  EXPECT_THROW(synthetic(""), InputError);
  fs::remove_all(folder);
}

}  // namespace material_texture
}  // namespace pivnp::app
