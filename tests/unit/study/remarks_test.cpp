// What a record says of itself, and that the report, the terminal without it and a later reader say the same.
#include "apps/study/pipeline/record/remarks.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>

#include "apps/study/methods/frames/exposure.hpp"
#include "apps/study/study.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/image/files/write.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/silent.hpp"

namespace pivnp::app {
namespace remarks_tests {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int columns = 176, rows = 144;
const std::string fast = "method = \"fast\"\n";

std::vector<std::string> texts(const std::vector<Remark>& remarks, const std::string& id = "") {
  std::vector<std::string> out;
  for (const Remark& r : remarks)
    if (id.empty() || r.id == id) out.push_back(r.text);
  return out;
}

RecordSeen steps(const std::vector<std::uint8_t>& flags, double rate_hz) {
  RecordSeen seen;
  seen.time_unit = "s";
  for (std::size_t k = 0; k < flags.size(); ++k) {
    seen.steps.push_back({"f" + std::to_string(k), "f" + std::to_string(k + 1), flags[k], 50, 50, 0, 0, 0, 0.9});
    seen.time_steps.push_back(1 / rate_hz);
  }
  return seen;
}

TEST(Remarks, FramesThatAreHeldTellTheTrueRate) {
  std::vector<std::uint8_t> flags;
  for (int k = 0; k < 39; ++k) flags.push_back(k % 4 == 3 ? frame_ok : frame_repeated);
  const auto said = remarks_of(steps(flags, 120));
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said[0].text, AllOf(HasSubstr("holds each frame 4 times"), HasSubstr("at 30 frames a second, not at 120"), HasSubstr("frames.stride = 4")));
  EXPECT_EQ(said[0].weight, RemarkWeight::doubt);
  std::vector<std::uint8_t> some(39, frame_ok);
  for (const std::size_t k : {5u, 6u, 20u}) some[k] = frame_repeated;
  EXPECT_EQ(texts(remarks_of(steps(some, 120)), "step_repeated").size(), 3u);
  EXPECT_TRUE(texts(remarks_of(steps(std::vector<std::uint8_t>(9, frame_ok), 120))).empty());
}

TEST(Remarks, ManyFlaggedStepsAreCounted) {
  const auto said = texts(remarks_of(steps(std::vector<std::uint8_t>(25, frame_jump), 10)), "step_jump");
  ASSERT_EQ(said.size(), 7u);
  EXPECT_THAT(said.back(), HasSubstr("19 further steps"));
}

TEST(Remarks, WhatIsNotUsableIsSaidSo) {
  RecordSeen seen = steps({frame_decorrelated, frame_decorrelated}, 10);
  for (auto& s : seen.steps) s.valid = 0;
  RecordSeen::Motion lost{"np", "px", true, 70, 0, 0, std::nan(""), {{EndReason::no_vectors, 70}}, 0, 0};
  seen.motions = {lost};
  const auto said = remarks_of(seen);
  EXPECT_THAT(texts(said, "no_vectors"), ElementsAre(AllOf(HasSubstr("0 % of the vectors are valid"), HasSubstr("not usable"))));
  EXPECT_THAT(texts(said, "no_particles"), ElementsAre(HasSubstr("0 % of the 70 particles reach the end: it is not usable")));
  EXPECT_THAT(texts(said, "step_lost"), Contains(HasSubstr("piv.first_window_px")));
  for (auto& s : seen.steps) {
    s.asked = 9000;
    s.valid = 24;
  }
  EXPECT_TRUE(texts(remarks_of(seen), "no_vectors").empty()) << "a small body in a wide image, well measured";
  for (auto& s : seen.steps) s.score = 0.3;
  EXPECT_FALSE(texts(remarks_of(seen), "no_vectors").empty());
  seen.motions[0].ends = {{EndReason::left_image, 70}};  // what has flowed out of sight was followed
  EXPECT_TRUE(texts(remarks_of(seen), "no_particles").empty());
}

TEST(Remarks, FlaggedParticlesTellHowFarTheyMayBeOff) {
  RecordSeen seen;
  seen.motions = {{"np", "px", true, 900, 800, 120, 0.7, {}, 0, 0}};
  EXPECT_THAT(texts(remarks_of(seen)), ElementsAre(AllOf(HasSubstr("120 of the 800 particles"), HasSubstr("1.4 px or more"))));
  seen.motions[0].flagged = 3;
  EXPECT_TRUE(remarks_of(seen).empty());
}

// docs/troubleshooting.md explains every kind of remark in the registry's words.
TEST(Remarks, AreExplainedInThePages) {
  std::ifstream file(PIVNP_SOURCE_DIR "/docs/troubleshooting.md", std::ios::binary);
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(page, HasSubstr(std::string(remark_head) + remark_reference() + "## "))
      << "write it anew: cmake --build build/release --target remark_reference";
}

TEST(Remarks, SayWhatTheirRowsQuote) {
  RecordSeen seen = steps({frame_repeated, frame_flash, frame_jump, frame_decorrelated, frame_ok, frame_ok}, 25);
  seen.steps[4].valid = 31;
  RecordSeen::Motion m{"np", "mm", true, 90, 60, 40, 0.2, {{EndReason::no_vectors, 30}}, 7, 8};
  seen.motions = {m};
  seen.energy = {EnergyRow{}, EnergyRow{}};
  seen.energy[0].kinetic = 3;
  seen.energy[1].residual = 2;
  std::vector<Remark> said = remarks_of(seen);
  RecordSeen none = steps({frame_ok}, 25), every = steps({frame_ok, frame_repeated, frame_ok, frame_repeated, frame_ok}, 25);
  none.steps[0].valid = 0;
  m.to_the_end = m.flagged = 0;
  none.motions = {m};
  for (const RecordSeen& other : {none, every})
    for (Remark& r : remarks_of(other)) said.push_back(r);
  for (const RemarkRow& row : remark_rows())
    EXPECT_THAT(texts(said, std::string(row.name)), Contains(HasSubstr(std::string(row.said)))) << row.name;
}

// Blobs moved by `x` px, frame by frame, with noise of their own; written to a folder.
void film(const fs::path& folder, const std::vector<double>& x, const std::function<Image(Image, int)>& change = {}) {
  image::TextureOptions texture;
  texture.noise = 0.012;
  const image::BlobRenderer renderer(texture, columns, rows);
  std::vector<Vec2> blobs;
  for (std::uint64_t n = 0; n < 6500; ++n) blobs.emplace_back(uniform(9, 2 * n) * (columns + 500) - 450, uniform(9, 2 * n + 1) * (rows + 20) - 10);
  fs::create_directories(folder);
  for (std::size_t k = 0; k < x.size(); ++k) {
    std::vector<Vec2> at;
    for (const Vec2& b : blobs) at.emplace_back(b.x() + x[k], b.y() + 0.3 * x[k]);
    Image frame = renderer.draw(at, int(k), int(x.size()));
    if (change) frame = change(std::move(frame), int(k));
    image::write_image(frame.view(), folder / (std::string(k < 10 ? "0" : "") + std::to_string(k) + ".png"));
  }
}

struct Told {
  std::vector<Frame> frames;
  std::vector<Remark> with, without, later;
};

Told told(const fs::path& folder, const std::string& rest, Stages stages = Stages::piv, bool both = false) {
  Told out;
  SilentProgress silent;
  RunSettings settings;
  settings.threads = 1;
  settings.out = folder / "out";
  settings.report = false;
  const Case c = parse_case("[frames]\npath = \"f\"\nrate_hz = 60\n[piv]\nclosure = 0\n" + rest, "case.toml", folder);
  out.without = run_case(c, settings, stages, silent).remarks;
  const io::RecordReader record(settings.out / "record.h5");
  out.frames = record.frames(), out.later = remarks_of(record);
  if (!both) return out;
  settings.out = folder / "drawn";
  settings.report = true;
  out.with = run_case(c, settings, stages, silent).remarks;
  return out;
}

TEST(Remarks, AreTheSameWithAndWithoutReport) {
  test::Scratch scratch;
  film(scratch.path / "f", {0, 71, 139, 212});
  const Told t = told(scratch.path, "", Stages::track, true);
  EXPECT_EQ(texts(t.with), texts(t.without));
  EXPECT_EQ(texts(t.later), texts(t.without));
  for (std::size_t k = 1; k < t.frames.size(); ++k) EXPECT_TRUE(t.frames[k].flag & frame_decorrelated) << k;
  EXPECT_THAT(texts(t.without, "no_vectors"), ElementsAre(HasSubstr("not usable")));
}

TEST(Remarks, FindHeldFramesInFiles) {
  for (const bool anew : {false, true}) {
    test::Scratch scratch;
    Image kept;
    std::vector<double> x;
    for (int k = 0; k < 21; ++k) x.push_back(1.3 * (k / 3));
    film(scratch.path / "f", x, [&](Image frame, int k) {
      if (k % 3 == 0) kept = image::part_of(frame.view(), 0, 0, columns, rows);
      Image out = image::part_of(kept.view(), 0, 0, columns, rows);
      return anew ? image::through_jpeg(out.view(), 98 - k % 3) : std::move(out);
    });
    const Told t = told(scratch.path, fast);
    for (std::size_t k = 1; k < t.frames.size(); ++k) EXPECT_EQ(t.frames[k].flag, k % 3 == 0 ? frame_ok : frame_repeated) << anew << " " << k;
    EXPECT_THAT(texts(t.without), Contains(AllOf(HasSubstr("holds each frame 3 times"), HasSubstr("at 20 frames a second, not at 60"))));
  }
}

TEST(Remarks, TurningPointsAreNoRepeats) {
  test::Scratch scratch;
  std::vector<double> x;
  for (int k = 0; k < 24; ++k) x.push_back(6 * std::cos(2 * M_PI * (k + 0.5) / 14));  // at rest between 13 and 14, 6 and 7
  film(scratch.path / "f", x);
  for (const Frame& f : told(scratch.path, fast).frames) EXPECT_EQ(f.flag, frame_ok) << f.name;
}

Image drawn(const std::function<double(int, int)>& grey) {
  Image image(columns, rows, PixelDepth::u8, 255);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double texture = 40 * (uniform(4, std::uint64_t(r / 2 * columns + c / 3)) - 0.5) + 6 * uniform(5, std::uint64_t(r * columns + c));
      image.row<std::uint8_t>(r)[c] = std::uint8_t(std::clamp(grey(c, r) * (110 + texture), 0.0, 255.0));
    }
  return image;
}

TEST(Exposure, ClippedPixelsAndMosaicsAreSaid) {
  const Case c = parse_case("[frames]\npath = \"none\"\n", "case.toml", ".");
  const Setting setting = make_setting(c, columns, rows);
  const auto said = [&](const std::function<double(int, int)>& grey) { return exposure_remarks(setting, drawn(grey)); };
  EXPECT_TRUE(said([](int, int) { return 1.0; }).empty());
  EXPECT_TRUE(said([](int, int r) { return r % 2 ? 1.1 : 1.0; }).empty());  // lines of an interlaced camera
  EXPECT_THAT(said([](int, int) { return 2.4; }), ElementsAre(HasSubstr("the greatest grey value: they are clipped")));
  EXPECT_THAT(said([](int col, int) { return col % 4 ? 0.0 : 1.0; }), Contains(HasSubstr("the least grey value: they are clipped")));
  const auto bayer = [](int col, int r) { return (col + r) % 2 ? 1.0 : r % 2 ? 0.75 : 0.85; };  // green, blue, red
  EXPECT_THAT(said(bayer), ElementsAre(HasSubstr("mosaic of a colour sensor")));
}

}  // namespace remarks_tests
}  // namespace pivnp::app
