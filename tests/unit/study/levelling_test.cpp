// Levelling: a simulation that is right, measured like the experiment, differs from it by noise alone where the plain
// comparison shows the measurement's filter.
#include "apps/study/methods/paths/levelling.hpp"
#include "apps/study/methods/frames/texture.hpp"
#include "apps/study/methods/paths/levelled_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/study/methods/paths/tracking.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/verification.hpp"

namespace pivnp::app {
namespace {

namespace fs = std::filesystem;

using test::Scratch;

constexpr int columns = 176, rows = 144, count = 3;
constexpr double mm = 1e-3;  // a pixel

// A shear band 4 px wide in a window of 32 px: far below what correlation resolves.
double slide(double y) { return 3 * mm * 0.5 * (1 + std::tanh((y - 72 * mm) / (4 * mm))); }
double shear(double y) { return 3 * mm * 0.5 / (4 * mm) / std::pow(std::cosh((y - 72 * mm) / (4 * mm)), 2); }

class Drawn final : public image::FrameSource {
 public:
  explicit Drawn(const image::TextureOptions& texture) : renderer_(texture, columns, rows) {
    for (int k = 0; k < count; ++k) frames_.push_back({"drawn", double(k), frame_ok});
    const int blobs = int(texture.density_per_px * (columns + 40) * rows);
    for (int n = 0; n < blobs; ++n)
      blobs_.emplace_back(uniform(3, 2 * std::uint64_t(n)) * (columns + 40) - 30,
                          uniform(3, 2 * std::uint64_t(n) + 1) * rows);
  }
  const std::vector<Frame>& frames() const override { return frames_; }
  bool has_rate() const override { return true; }
  int width() const override { return columns; }
  int height() const override { return rows; }
  Image read(int index) override {
    std::vector<Vec2> x = blobs_;
    for (Vec2& b : x) b.x() += index * slide((rows - 1 - b.y()) * mm) / mm;
    return renderer_.draw(x, index, count);
  }

 private:
  image::BlobRenderer renderer_;
  std::vector<Frame> frames_;
  std::vector<Vec2> blobs_;
};

Case scene() {
  return parse_case(
      "name = \"band\"\n[frames]\npath = \"drawn\"\nrate_hz = 1.0\n[camera]\nmetres_per_pixel = "
      "1e-3\n[grid]\nspacing_px = 8\n"
      "[region.soil]\npolygon_px = [[24, 24], [152, 24], [152, 120], [24, 120]]\n[piv]\nwindow_px = "
      "32\n[np]\nper_element = 4\n",
      "test", ".");
}

MotionMemory exact() {
  ParticleSet set;
  set.label_names = {"soil"};
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns / 2; ++i) {
      set.id.push_back(std::int64_t(1000000 + j * columns + i));
      set.label.push_back(0);
      set.x0.push_back(mm * Vec2(2 * i + 0.5, j));
      set.area.push_back(float(2 * mm * mm));
      set.born.push_back(0);
      set.end.push_back(std::nan(""));
      set.end_reason.push_back(EndReason::none);
    }
  MotionMemory motion("mpm", "m", "s", set);
  for (int k = 0; k < count; ++k) {
    MotionFrame f;
    f.time = k;
    for (const Vec2& x : set.x0) {
      f.u.push_back({float(k * slide(x.y())), 0});
      f.F.push_back({1, float(k * shear(x.y())), 0, 1});
      f.status.push_back(ParticleStatus::active);
    }
    motion.add(f);
  }
  return motion;
}

std::unique_ptr<io::RecordWriter> tracked(const Case& c, const Setting& setting, image::FrameSource& source,
                                          const fs::path& folder) {
  io::RecordHead head;
  head.case_text = write_case(c);
  head.grid = setting.grid;
  fs::create_directories(folder);
  auto writer = std::make_unique<io::RecordWriter>(folder, head, false);
  SilentProgress progress;
  measure(c, setting, source, *writer, 1, progress);
  track(c, setting, source.frames(), &source, {}, *writer, 1, progress);
  return writer;
}

double value(const Comparison& c, const std::string& name) {
  for (const Metric& m : c.metrics)
    if (m.name == name) return m.value;
  return std::nan("");
}

// Criterion: the strain difference of a simulation that is exact falls to a third or less when it is levelled.
TEST(Levelling, TheMeasurementsFilterCancels) {
  const Scratch scratch;
  const Case c = scene();
  const Setting setting = make_setting(c, columns, rows);
  image::TextureOptions texture;
  texture.noise = 0.02;
  Drawn source(texture);
  const auto measured = tracked(c, setting, source, scratch.path / "measured");
  std::vector<Vec2> nodes;
  for (int j = 0; j < setting.grid.ny; ++j)
    for (int i = 0; i < setting.grid.nx; ++i) nodes.push_back(setting.camera.to_pixel(setting.grid.position(i, j)));
  const Image first = source.read(0);
  const double noise = noise_variance(first.view(), nodes, 32, {measured->pair(0), measured->pair(1)});
  const double drawn = 0.02 * 255;
  EXPECT_NEAR(std::sqrt(noise), drawn, 0.4 * drawn);

  const MotionMemory simulation = exact();
  const auto carried = carried_frames(first, source.frames(), true, setting.camera, simulation, noise, 1);
  ASSERT_EQ(carried->frames().size(), std::size_t(count));
  const auto levelled = tracked(c, setting, *carried, scratch.path / "levelled");
  measured->pack();
  levelled->pack();
  SilentProgress progress;
  const auto np = measured->motion("np"), like = levelled->motion("np");
  const double plain = value(compare::compare(*np, simulation, {}, {}, progress), "strain_dev_rms_final");
  const double level = value(compare::compare(*np, *like, {}, {}, progress), "strain_dev_rms_final");
  EXPECT_LT(level, plain / 3);
  test::verification_row("exact simulation of a band 4 px wide, window 32 px: strain difference levelled against plain",
                         "a third at most", number(level, 2) + " against " + number(plain, 2));
}

// A particle that is lost where texture is carried says so, as it departs from the simulation that carried it by far
// more than it states; the others keep what they state.
TEST(Levelling, WhatItIsOffByItselfIsInItsUncertainty) {
  const auto stated = [](MotionMemory m, float off) {
    MotionMemory out("np", "m", "s", m.particles());
    for (std::size_t k = 0; k < m.times().size(); ++k) {
      MotionFrame f = m.frame(k);
      f.cov_u.assign(f.u.size(), {1e-8f, 1e-8f, 0});
      f.add("cov_F", f.u.size());
      for (std::size_t p = 0; p < f.u.size(); ++p) f.fields[0](p, 0) = f.fields[0](p, 1) = 1e-6f;
      if (k == 2) f.u[7][0] += off, f.u[8][1] += 2e-4f, f.F[7][1] += 100 * off;
      out.add(f);
    }
    return out;
  };
  const MotionMemory simulation = exact();
  SilentProgress progress;
  const auto measured = [&] { return std::make_unique<MotionMemory>(stated(simulation, .01f)); };
  const LevelledMotion levelled(measured(), compare::compare(*measured(), simulation, {}, {}, progress));
  const MotionFrame before = levelled.frame(1), after = levelled.frame(2);
  EXPECT_FLOAT_EQ(before.cov_u[7][0], 1e-8f);
  EXPECT_NEAR(after.cov_u[7][0], 1e-8f + 1e-4f, 1e-7f);
  EXPECT_NEAR(after.cov_u[7][1], 1e-8f, 1e-12f);
  EXPECT_FLOAT_EQ(after.cov_u[8][1], 1e-8f);  // two standard deviations
  const FieldValues& cov_F = after.field("cov_F");
  EXPECT_GT(cov_F(7, 0), .05f);
  EXPECT_FLOAT_EQ(cov_F(8, 0), 1e-6f);
}

// The exact simulation's particles, at rest until t = 2.
MotionMemory at_rest() {
  MotionMemory still("mpm", "m", "s", exact().particles());
  MotionFrame f = exact().frame(0);
  still.add(f);
  f.time = 2;
  still.add(f);
  return still;
}

TEST(Levelling, WithoutMotionTheFirstFrameIsKept) {
  image::TextureOptions texture;
  Drawn source(texture);
  const Case c = scene();
  const Setting setting = make_setting(c, columns, rows);
  const MotionMemory still = at_rest();
  const Image first = source.read(0);
  const auto carried = carried_frames(first, source.frames(), true, setting.camera, still, 0, 1);
  const Image later = carried->read(2);
  int worst = 0;
  for (int r = 0; r < rows; ++r)
    for (int col = 0; col < columns; ++col)
      worst = std::max(worst, std::abs(int(first.view().row<std::uint8_t>(r)[col]) -
                                       int(later.view().row<std::uint8_t>(r)[col])));
  EXPECT_LE(worst, 1);  // float rounding of the spline
}

TEST(Levelling, EveryFrameHasNoiseOfItsOwn) {
  Drawn source(image::TextureOptions{});
  const Case c = scene();
  const Setting setting = make_setting(c, columns, rows);
  const MotionMemory still = at_rest();
  const double noise = 9;
  const auto carried = carried_frames(source.read(0), source.frames(), true, setting.camera, still, noise, 1);
  const Image one = carried->read(1), two = carried->read(2);
  double sum = 0, square = 0;
  std::size_t count_bright = 0;
  for (int r = 0; r < rows; ++r)
    for (int col = 0; col < columns; ++col) {
      const double a = double(one.view().row<std::uint8_t>(r)[col]), b = double(two.view().row<std::uint8_t>(r)[col]);
      if (a < 20 || a > 235 || b < 20 || b > 235) continue;  // not clipped
      sum += a - b;
      square += (a - b) * (a - b);
      ++count_bright;
    }
  const double n = double(count_bright);
  ASSERT_GT(n, 1000);
  EXPECT_NEAR(std::sqrt(square / n), std::sqrt(2 * (noise + 1.0 / 12)), 0.2);
  EXPECT_NEAR(sum / n, 0, 0.3);
}

}  // namespace
}  // namespace pivnp::app
