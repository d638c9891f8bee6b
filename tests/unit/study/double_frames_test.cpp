// Recordings of double-frame cameras: two exposures a pair, and no motion known from one pair to the next.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "apps/study/study.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/image/files/write.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/silent.hpp"

namespace pivnp::app {
namespace double_frames_tests {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// Between exposures grains move by (2.3, -0.7) px and (-1.9, 1.1) px in turn; each pair shows other grains.
Vec2 moved(int pair) { return pair % 2 == 0 ? Vec2(2.3, -0.7) : Vec2(-1.9, 1.1); }

void film(const fs::path& folder, int pairs) {
  constexpr int columns = 160, rows = 128;
  const image::BlobRenderer renderer({}, columns, rows);
  fs::create_directories(folder);
  for (int k = 0; k < 2 * pairs; ++k) {
    std::vector<Vec2> at;
    for (std::uint64_t n = 0; n < 2600; ++n) {
      const std::uint64_t seed = std::uint64_t(31 + k / 2);
      at.emplace_back(uniform(seed, 2 * n) * (columns + 20) - 10 + (k % 2) * moved(k / 2).x(),
                      uniform(seed, 2 * n + 1) * (rows + 20) - 10 + (k % 2) * moved(k / 2).y());
    }
    const std::string name = "b" + std::to_string(100 + k / 2) + (k % 2 == 0 ? "a" : "b") + ".png";
    image::write_image(renderer.draw(at, k, 2 * pairs).view(), folder / name);
  }
}

RunOutcome run(const fs::path& folder, const std::string& frames, Stages stages = Stages::piv) {
  SilentProgress silent;
  RunSettings settings;
  settings.threads = 1;
  settings.out = folder / "out";
  return run_case(parse_case("[frames]\npath = \"f\"\npairs = \"double\"\n" + frames + "[piv]\nwindow_px = 24\n", "case.toml", folder), settings, stages, silent);
}

std::string refusal(const fs::path& folder, const std::string& frames, Stages stages = Stages::piv) {
  try {
    run(folder, frames, stages);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(DoubleFrames, EachPairIsMeasuredByItself) {
  test::Scratch scratch;
  film(scratch.path / "f", 4);
  const RunOutcome outcome = run(scratch.path, "rate_hz = 15\npair_time_s = 2e-4\n");
  const io::RecordReader record(outcome.record);
  ASSERT_EQ(record.pair_count(), 4u);
  ASSERT_EQ(record.frames().size(), 8u);
  EXPECT_EQ(record.frames()[5].name, "b102b.png");
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(record.frames()[std::size_t(2 * k)].time, k / 15.0, 1e-12);
    EXPECT_NEAR(record.frames()[std::size_t(2 * k + 1)].time, k / 15.0 + 2e-4, 1e-12);
    EXPECT_EQ(record.frames()[std::size_t(2 * k + 1)].flag, frame_ok) << k;
    const VectorField field = record.pair(std::size_t(k));
    EXPECT_EQ(field.pair, (std::array<int, 2>{2 * k, 2 * k + 1}));
    double valid = 0, square = 0;
    for (std::size_t n = 0; n < field.status.size(); ++n) {
      if (field.status[n] != VectorStatus::valid) continue;
      ++valid;
      square += std::pow(double(field.displacement[n][0]) - moved(k).x(), 2) + std::pow(-double(field.displacement[n][1]) - moved(k).y(), 2);
    }
    EXPECT_GT(valid, 0.95 * double(field.status.size())) << k;
    EXPECT_LT(std::sqrt(square / valid), 0.05) << k;
  }
  std::ifstream page(outcome.report_html, std::ios::binary);
  const std::string html{std::istreambuf_iterator<char>(page), {}};
  EXPECT_THAT(html, HasSubstr("8, two exposures a pair 0.0002 s apart, 15 pairs a second"));
}

TEST(DoubleFrames, WhatDoesNotFitIsRefused) {
  test::Scratch scratch;
  film(scratch.path / "f", 2);
  EXPECT_THAT(refusal(scratch.path, "rate_hz = 15\n"), HasSubstr("frames.pair_time_s: missing"));
  EXPECT_THAT(refusal(scratch.path, "rate_hz = 15\npair_time_s = 0.07\n"), HasSubstr("less than 1/rate_hz"));
  EXPECT_THAT(refusal(scratch.path, "last = 2\n"), HasSubstr("found 3 frames"));
  EXPECT_THAT(refusal(scratch.path, "stride = 2\n"), HasSubstr("frames.stride"));
  EXPECT_THAT(refusal(scratch.path, "", Stages::track), HasSubstr("expected the command piv"));
}

}  // namespace double_frames_tests
}  // namespace pivnp::app
