// Closure of a sequence of drawn frames.
//   criterion: where the stated error is right (still light, rotation that speeds up) nothing is added; where something
//     stands still before the moving texture, paths whose error the stated one covers in less than half of the
//     particles are covered in 95 % within three standard deviations.
#include "apps/study/methods/paths/closure.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/study/methods/frames/repeated_cause.hpp"
#include "apps/study/methods/paths/tracking.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"

namespace pivnp::app {
namespace {

constexpr int columns = 208, rows = 160;

// Blobs carried by `place`, some that stand still before them.
class Drawn final : public image::FrameSource {
 public:
  using Place = std::function<Vec2(const Vec2& first, int frame)>;  // column and row
  Drawn(int count, Place place, double standing_per_px)
      : place_(std::move(place)), renderer_(options(), columns, rows) {
    for (int k = 0; k < count; ++k) frames_.push_back({"drawn", double(k), frame_ok});
    moving_ = blobs(5, 0.05);
    if (standing_per_px > 0) standing_ = blobs(6, standing_per_px);
  }
  const std::vector<Frame>& frames() const override { return frames_; }
  bool has_rate() const override { return true; }
  int width() const override { return columns; }
  int height() const override { return rows; }
  Image read(int index) override {
    std::vector<Vec2> at = standing_;
    for (const Vec2& b : moving_) at.push_back(place_(b, index));
    return renderer_.draw(at, index, int(frames_.size()));
  }

 private:
  static image::TextureOptions options() {
    image::TextureOptions o;
    o.noise = 0.02;
    return o;
  }
  static std::vector<Vec2> blobs(std::uint64_t seed, double per_px) {
    std::vector<Vec2> out;
    const int count = int(per_px * (columns + 80) * (rows + 80));
    for (int n = 0; n < count; ++n)
      out.emplace_back(uniform(seed, 2 * std::uint64_t(n)) * (columns + 80) - 40,
                       uniform(seed, 2 * std::uint64_t(n) + 1) * (rows + 80) - 40);
    return out;
  }
  std::vector<Frame> frames_;
  Place place_;
  image::BlobRenderer renderer_;
  std::vector<Vec2> moving_, standing_;
};

Case scene(const std::string& more = "") {
  return parse_case(
      "name = \"closure\"\n[frames]\npath = \"drawn\"\n[grid]\nspacing_px = 8\n"
      "[region.block]\npolygon_px = [[48, 40], [160, 40], [160, 120], [48, 120]]\n"
      "[piv]\nwindow_px = 32\n" +
          more + "[np]\nper_element = 1\n",
      "test", ".");
}

struct Closed {
  ClosureNote note;
  double within = 0, within_without = 0;  // share of components within three standard deviations at the last frame
  double rms_over_sigma = 0;              // of errors at the last frame, in standard deviations as stated with it
};

Closed closed(const Case& c, Drawn& frames, const Drawn::Place& place) {
  const Setting setting = make_setting(c, columns, rows);
  std::vector<VectorField> fields;
  for (int k = 0; k + 1 < int(frames.frames().size()); ++k)
    fields.push_back(measure_pair(c, setting, frames, {k, k + 1}, 1));
  SilentProgress quiet;
  Closed out;
  out.note = check_closure(
      c, setting, frames, [&](int k) { return fields[std::size_t(k)]; }, 1, quiet);
  for (const bool with : {false, true}) {
    const Measured measured{plan_steps(frames.frames()),
                            [&](const TrackStep& s) { return fields[std::size_t(s.from)]; },
                            [&](int k) { return frames.read(k); }, with ? out.note : ClosureNote{}};
    std::size_t inside = 0, all = 0;
    double squares = 0;
    follow(c, setting, frames.frames(), measured, 1, quiet, [&](std::size_t k, const np::Tracker& now) {
      if (k + 1 != frames.frames().size()) return;
      for (std::size_t p = 0; p < now.state().size(); ++p) {
        const auto s = now.state()[p];
        if (s.status == ParticleStatus::ended) continue;
        const Vec2 truth = setting.camera.to_world(place(setting.camera.to_pixel(now.particles().x0[p]), int(k)));
        for (int k2 = 0; k2 < 2; ++k2, ++all) {
          const double square = std::pow(s.x[k2] - truth[k2], 2) / s.cov[std::size_t(k2)];
          inside += square <= 9;
          squares += square;
        }
      }
    });
    (with ? out.within : out.within_without) = double(inside) / double(all);
    out.rms_over_sigma = std::sqrt(squares / double(all));
  }
  return out;
}

TEST(Closure, WhatStandsStillIsFoundAndPathsHoldIt) {
  const auto place = [](const Vec2& x, int k) { return Vec2(x + k * Vec2(0.8, 0.3)); };
  const Case c = scene();
  Drawn frames(13, place, 0.004);
  const Closed r = closed(c, frames, place);
  EXPECT_EQ(r.note.verdict, "repeated error");
  EXPECT_EQ(r.note.chains, (std::vector<std::array<int, 2>>{{0, 4}, {4, 8}, {8, 12}}));
  std::printf("within three standard deviations: %.3f, without %.3f; rms %.2f; strength %.2f of %.2f\n", r.within,
              r.within_without, r.rms_over_sigma, r.note.strength, r.note.threshold);
  EXPECT_LT(r.within_without, 0.5);
  EXPECT_GE(r.within, 0.95);
  EXPECT_GT(r.rms_over_sigma, 0.5);  // nor is it stated too large
  EXPECT_LT(r.rms_over_sigma, 1.5);
  const auto remarks = closure_remarks(r.note, make_setting(c, columns, rows));
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("stands still"), std::string::npos) << remarks[0];
}

TEST(Closure, MotionAloneIsLeftAlone) {
  const Vec2 centre(104, 80);
  const auto turning = [&](const Vec2& x, int k) {  // .6 degrees a frame and ever faster: 9 degrees after 8
    const double angle = 0.0105 * k + 0.0011 * k * k;
    Mat2 R;
    R << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    return Vec2(centre + R * (x - centre));
  };
  const Case c = scene();
  Drawn frames(9, turning, 0);
  const Closed r = closed(c, frames, turning);
  EXPECT_EQ(r.note.verdict, "agrees") << r.note.strength << " of " << r.note.threshold;
  EXPECT_GT(r.note.threshold, 0);
  EXPECT_TRUE(r.note.repeated.empty());
  EXPECT_EQ(r.within, r.within_without);
  EXPECT_GE(r.within, 0.95);
  EXPECT_TRUE(closure_remarks(r.note, make_setting(c, columns, rows)).empty());
}

// Nothing stands still in these frames: an error that repeats is not laid on the light.
TEST(Closure, OnlyACauseThatIsSeenIsNamed) {
  const auto place = [](const Vec2& x, int k) { return Vec2(x + k * Vec2(0.8, 0.3)); };
  const Case c = scene();
  const Setting setting = make_setting(c, columns, rows);
  for (const double standing : {0.0, 0.004}) {
    Drawn frames(9, place, standing);
    std::vector<Vec2> places;
    for (int j = 0; j < setting.grid.ny; ++j)
      for (int i = 0; i < setting.grid.nx; ++i) places.push_back(setting.camera.to_pixel(setting.grid.position(i, j)));
    const StillPicture still = still_picture(frames.read(0), frames.read(8), places);
    EXPECT_EQ(still.seen(), standing > 0) << still.correlation << ' ' << still.error;
  }
  // An error that repeats in a band of three columns.
  VectorField field;
  field.grid = setting.grid;
  const std::size_t count = field.grid.node_count();
  field.status.assign(count, VectorStatus::valid);
  field.displacement.assign(count, {0, 0});
  std::vector<std::array<float, 3>> repeated(count, {1e-6f, 1e-6f, 0});
  const int middle = field.grid.nx / 2;
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) {
      field.displacement[field.grid.node(i, j)][1] = i < middle ? 0.0f : 4.0f;
      if (std::abs(i - middle) < 2) repeated[field.grid.node(i, j)] = {1e-4f, 1e-2f, 0};
    }
  const Bent bent = bent_share(repeated, field, 4, 1);
  EXPECT_TRUE(bent.seen()) << bent.variance << ' ' << bent.nodes;
  EXPECT_NE(repeated_cause({}, bent).find("bends"), std::string::npos);
  EXPECT_EQ(repeated_cause({}, {}), "");
  ClosureNote note;
  note.repeated = repeated;
  note.chains = {{0, 4}};
  const auto remarks = closure_remarks(note, setting);
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_EQ(remarks[0].find("light"), std::string::npos) << remarks[0];
}

TEST(Closure, WhatCannotBeCheckedSaysSo) {
  const auto place = [](const Vec2& x, int k) { return Vec2(x + k * Vec2(0.8, 0.3)); };
  SilentProgress quiet;
  const auto verdict = [&](const Case& c, int count, bool valid) {
    Drawn frames(count, place, 0);
    const Setting setting = make_setting(c, columns, rows);
    VectorField nothing;
    nothing.grid = setting.grid;
    nothing.displacement.assign(setting.grid.node_count(), {0, 0});
    nothing.status.assign(setting.grid.node_count(), valid ? VectorStatus::valid : VectorStatus::rejected);
    nothing.cov.assign(setting.grid.node_count(), {1e-4f, 1e-4f, 0});
    nothing.score.assign(setting.grid.node_count(), 1);
    return check_closure(
               c, setting, frames, [&](int) { return nothing; }, 1, quiet)
        .verdict;
  };
  EXPECT_EQ(verdict(scene(), 2, true), "not checked: fewer than five frames");
  EXPECT_EQ(verdict(scene(), 4, true), "not checked: fewer than five frames");
  EXPECT_EQ(verdict(scene("closure = 0\n"), 13, true), "not checked: switched off");
  EXPECT_EQ(verdict(scene(), 5, false), "not checked: frames two steps apart do not correlate");
}

// A still particle's repeated error adds up as one error; where material leaves a vector's reach, as independent
// pieces.
TEST(Closure, ARepeatedErrorAddsUpAsOne) {
  const Grid grid{Vec2(0, 0), Vec2(1, 1), 3, 2};
  ClosureNote note;
  note.repeated.assign(grid.node_count(), {0.04f, 0.01f, -0.02f});
  VectorField field;
  field.grid = grid;
  field.correlation_length = 2;
  double still[3] = {}, moving = 0;
  for (int step = 1; step <= 10; ++step) {
    field.displacement.assign(grid.node_count(), {0, 0});
    field.displacement[1] = {0.3f, -0.4f};  // four steps to the length
    field.cov.assign(grid.node_count(), {1, 1, 0});
    add_repeated(note, step, field);
    for (std::size_t k = 0; k < 3; ++k) still[k] += double(field.cov[0][k]);
    moving += double(field.cov[1][0]) - 1;
  }
  EXPECT_NEAR(still[0], 10 + 100 * 0.04, 1e-4);
  EXPECT_NEAR(still[1], 10 + 100 * 0.01, 1e-4);
  EXPECT_NEAR(still[2], -100 * 0.02, 1e-4);
  EXPECT_NEAR(moving, (16 + 6 * 7) * 0.04, 1e-4);
  field.cov.clear();  // a pair without covariances stays so
  add_repeated(note, 3, field);
  EXPECT_TRUE(field.cov.empty());
}

}  // namespace
}  // namespace pivnp::app
