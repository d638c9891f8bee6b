// What laboratories' footage needs: filters that help only where they do, longer steps where motion is slow, flashes.
//   criterion: a fixed pattern in front of moving material makes the median background help, and it is chosen; without
//   a pattern no background is;
//     in slow tests none is tried. Steps by motion are of at least the length asked for but for the last, keep their
//     times, and pass a blank frame over. A flash is flagged, and steps or slopes of brightness are not.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "apps/study/methods/frames/filters.hpp"
#include "apps/study/methods/frames/stride.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"
#include "tests/support/drawn_source.hpp"
#include "tests/support/silent.hpp"

namespace pivnp::app {
namespace footage_tests {

using ::testing::HasSubstr;

constexpr int columns = 256, rows = 192;

// Blobs that move along x by `moved` px until a frame, behind a pattern that does not; some frames are blank.
class Footage final : public test::DrawnSource {
 public:
  Footage(int count, std::function<double(int)> moved, double pattern, int blank = -1)
      : DrawnSource(columns, rows, count, 10), moved_(std::move(moved)), pattern_(pattern), blank_(blank), renderer_(texture(), columns, rows) {
    for (std::uint64_t n = 0; n < 9000; ++n)
      blobs_.emplace_back(uniform(5, 2 * n) * (columns + 400) - 350, uniform(5, 2 * n + 1) * (rows + 40) - 20);
  }
  Image read(int index) override {
    std::vector<Vec2> at;
    if (index != blank_)
      for (const Vec2& b : blobs_) at.emplace_back(b.x() + moved_(index), b.y());
    Image frame = renderer_.draw(at, index, int(frames().size()));
    for (int r = 0; r < rows && pattern_ > 0; ++r)
      for (int c = 0; c < columns; ++c) {
        const double dirt = pattern_ * uniform(77, std::uint64_t(r / 3 * columns + c / 3));
        frame.row<std::uint8_t>(r)[c] = std::uint8_t(std::min(255.0, frame.row<std::uint8_t>(r)[c] + dirt));
      }
    return frame;
  }

 private:
  static image::TextureOptions texture() {
    image::TextureOptions o;
    o.noise = 0.01;
    return o;
  }
  std::function<double(int)> moved_;
  double pattern_;
  int blank_;
  image::BlobRenderer renderer_;
  std::vector<Vec2> blobs_;
};

Case case_with(const std::string& text) { return parse_case("[frames]\npath = \"none\"\n" + text, "case.toml", "."); }

FilterTrials tried(Footage& footage) {
  const Case c = case_with("[grid]\nspacing_px = 16.0\n[preprocess]\nchoose = true\nbackground_frames = 30\n");
  return try_filters(c, make_setting(c, columns, rows), footage, 1, silent);
}

const FilterTrial* trial(const FilterTrials& trials, const std::string& name) {
  for (const FilterTrial& t : trials.trials)
    if (t.name == name) return &t;
  return nullptr;
}

TEST(Filters, ABackgroundHelpsWhereAPatternStays) {
  Footage behind_dirt(
      60, [](int k) { return 3.3 * k; }, 120),
      clean(
          60, [](int k) { return 3.3 * k; }, 0);
  const FilterTrials with = tried(behind_dirt), without = tried(clean);
  ASSERT_TRUE(trial(with, "background_median") && trial(without, "background_median"));
  EXPECT_TRUE(trial(with, "background_median")->helps) << ::testing::PrintToString(words_of(with));
  EXPECT_LT(trial(with, "background_median")->rms_px, 0.8 * trial(with, "background_median")->plain_px);
  EXPECT_NE(with.best.background, image::Background::none);
  EXPECT_FALSE(trial(without, "background_median")->helps);
  EXPECT_EQ(without.best.background, image::Background::none) << ::testing::PrintToString(words_of(without));
}

TEST(Filters, NoBackgroundIsTakenOfWhatHardlyMoves) {
  Footage slow(
      12, [](int k) { return 0.5 * k; }, 0);
  const FilterTrials trials = tried(slow);
  EXPECT_THAT(trials.left_out, HasSubstr("No background was tried"));
  EXPECT_EQ(trial(trials, "background_median"), nullptr);
  EXPECT_TRUE(trial(trials, "high_pass"));
}

TEST(Filters, WhatACaseStatesIsAppliedToFrames) {
  Footage footage(
      4, [](int k) { return 2.0 * k; }, 0);
  const Case c = case_with("[preprocess]\nlocal_px = 10.0\n");
  Setting setting = make_setting(c, columns, rows);
  EXPECT_TRUE(set_filter(c, footage, 1, silent, setting).empty());
  const Image plain = footage.read(0), filtered = prepared(setting, footage.read(0));
  EXPECT_GT(std::abs(look_of(filtered.view()).mean - 0.5), 0);
  EXPECT_GT(look_of(filtered.view()).mean, look_of(plain.view()).mean + 0.1);  // mid grey
}

TEST(Stride, FollowsTheMotion) {
  // .05 px a frame, then 1 px a frame.
  const auto moved = [](int k) { return k < 30 ? 0.05 * k : 1.5 + 1.0 * (k - 30); };
  Footage footage(40, moved, 0);
  const Case c = case_with("least_motion_px = 0.6\n");
  const std::vector<int> used = frames_by_motion(c, make_setting(c, columns, rows), footage, 1, silent);
  ASSERT_GT(used.size(), 8u);
  EXPECT_EQ(used.front(), 0);
  EXPECT_EQ(used.back(), 39);
  for (std::size_t k = 1; k + 1 < used.size(); ++k) {
    const double step = moved(used[k]) - moved(used[k - 1]);
    EXPECT_GT(step, 0.57) << used[k];
    EXPECT_LT(step, used[k] > 31 ? 1.05 : used[k] > 30 ? 1.65 : 0.7) << used[k];
  }
  const auto some = strided_by_motion(c, std::make_unique<Footage>(40, moved, 0), 1, silent);
  ASSERT_EQ(some->frames().size(), used.size());
  for (std::size_t k = 0; k < used.size(); ++k) EXPECT_DOUBLE_EQ(some->frames()[k].time, used[k] / 10.0);
  EXPECT_EQ(some->frames()[1].name, "frame " + std::to_string(used[1]));
}

TEST(Stride, DoesNotStepToALostFrame) {
  Footage footage(
      12, [](int k) { return 0.1 * k; }, 0, 5);
  const Case c = case_with("least_motion_px = 0.75\n");
  const std::vector<int> used = frames_by_motion(c, make_setting(c, columns, rows), footage, 1, silent);
  EXPECT_NE(std::find(used.begin(), used.end(), 4), used.end());  // the last good one
}

std::vector<std::uint8_t> flashes(const std::vector<double>& means) {
  std::vector<FrameLook> looks;
  for (const double mean : means) looks.push_back({mean, 0, 0});
  return flash_flags(looks);
}

TEST(Flashes, AreFlagged) {
  const std::vector<std::uint8_t> one = flashes({0.4, 0.41, 0.4, 0.7, 0.4, 0.39, 0.4}),
                                  two = flashes({0.4, 0.4, 0.1, 0.12, 0.4, 0.4, 0.41, 0.4, 0.4, 0.4, 0.39});
  for (std::size_t k = 0; k < one.size(); ++k) EXPECT_EQ(one[k] == frame_flash, k == 3) << k;
  for (std::size_t k = 0; k < two.size(); ++k) EXPECT_EQ(two[k] == frame_flash, k == 2 || k == 3) << k;
  std::vector<FrameLook> saturated(7, FrameLook{0.4, 0.001});
  saturated[4].saturated = 0.06;
  EXPECT_EQ(flash_flags(saturated)[4], frame_flash);
}

TEST(Flashes, AreNoStepsSlopesOrFlicker) {
  for (const auto& means : {std::vector<double>{0.4, 0.4, 0.4, 0.6, 0.6, 0.6, 0.6},
                            {0.2, 0.25, 0.3, 0.36, 0.43, 0.5},
                            {0.4, 0.5, 0.4, 0.5, 0.4, 0.5, 0.4}})
    for (const std::uint8_t flag : flashes(means)) EXPECT_EQ(flag, frame_ok);
}

}  // namespace footage_tests
}  // namespace pivnp::app
