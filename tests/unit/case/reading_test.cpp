// What a sound case reads as.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "apps/case/init.hpp"
#include "tests/unit/case/case_text.hpp"

namespace pivnp::app {
namespace {

Case parsed(const std::string& text) { return parse_case(text, "c.toml", "/data"); }

TEST(Reading, ValuesArriveAndTheRestKeepsItsDefaults) {
  const Case c = parsed(whole_case);
  EXPECT_EQ(c.name, "slope");
  EXPECT_EQ(c.folder, "/data");
  ASSERT_TRUE(c.frames && c.piv && c.np && c.mpm);
  EXPECT_EQ(c.frames->path, "frames/*.png");
  EXPECT_FALSE(c.frames->rate_hz);
  EXPECT_EQ(c.camera.metres_per_pixel, 2e-4);
  ASSERT_EQ(c.regions.size(), 1u);
  EXPECT_EQ(c.regions[0].second.polygon_m[2], (Pair{0.2, 0.2}));
  EXPECT_EQ(c.materials[0].second.density_kg_m3, 1545.0);  // a whole number where a number is wanted
  EXPECT_EQ(c.piv->window_px, piv::PivOptions{}.window_px);
  EXPECT_FALSE(c.synth);
}

TEST(Reading, NamedSectionsKeepTheFilesOrder) {
  const Case c = parsed(
      "[region.zeta]\npolygon_m = [[0,0],[1,0],[1,1]]\n[region.alpha]\npolygon_m = [[0,0],[1,0],[1,1]]\n"
      "[mask.b]\nimage = 'b.png'\n[region.\"the middle\"]\npolygon_px = [[0,0],[1,0],[1,1]]\n");
  ASSERT_EQ(c.regions.size(), 3u);
  EXPECT_EQ(c.regions[0].first, "zeta");
  EXPECT_EQ(c.regions[1].first, "alpha");
  EXPECT_EQ(c.regions[2].first, "the middle");
}

TEST(Reading, MeasuringStagesComeWithFrames) {
  EXPECT_TRUE(parsed("[frames]\npath = 'a'\n").piv);
  EXPECT_TRUE(parsed("[synth]\nmotion = 'none'\n").np);
  EXPECT_TRUE(parsed("[synth.texture]\nbits = 16\n").synth);
  EXPECT_FALSE(parsed("name = 'x'\n").piv);
}

TEST(Reading, FoldersWindowsLineEndsAndAByteOrderMark) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "pivnp reading test" / "sand slope";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "case.toml", std::ios::binary) << "\xEF\xBB\xBF[frames]\r\npath = 'a b/*.png'\r\n";
  const Case c = read_case(folder);
  EXPECT_EQ(c.frames->path, "a b/*.png");
  EXPECT_EQ(c.folder, folder);
  EXPECT_EQ(c.file, folder / "case.toml");
  EXPECT_EQ(c.name, "sand slope");
  EXPECT_EQ(short_name(c), "sand slope");
  std::ofstream(folder / "other.toml") << "name = 'x'\n";
  EXPECT_EQ(short_name(read_case(folder / "other.toml")), "other");
  std::filesystem::remove_all(folder.parent_path());
}

TEST(Reading, TheEmbeddedCaseIsTheDataSets) {
  std::ifstream file(PIVNP_SOURCE_DIR "/datasets/gate_slope/case.toml", std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  ASSERT_FALSE(text.empty());
  EXPECT_EQ(embedded_case_text(), text);
  const Case c = parse_case(embedded_case_text(), "gate_slope", ".");
  EXPECT_TRUE(c.synth) << "the default case must not need frames";
  EXPECT_EQ(short_name(c), "gate_slope");
}

std::string uncommented(const std::string& text) {  // "# key = value" and "# [section]" become live
  std::string out;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    std::string line = text.substr(begin, end - begin);
    const bool example = line.find("= ...") != std::string::npos || line.find("points_") != std::string::npos;
    if (!example && line.starts_with("# ") && (line[2] == '[' || line.find(" = ") < 30)) line = line.substr(2);
    out += line + "\n";
    begin = end + 1;
  }
  return out;
}

TEST(Reading, TheInitialEquilibriumByItsFormerKeys) {
  const Case old = parsed(whole_case + "settle = false\nsettle_damping = 0.5\nsettle_tolerance = 0.01\n");
  EXPECT_FALSE(old.mpm->initial_equilibrium);
  EXPECT_EQ(old.mpm->equilibrium_damping, 0.5);
  EXPECT_EQ(old.mpm->equilibrium_tolerance, 0.01);
  EXPECT_EQ(old.notes.size(), 3u);
  EXPECT_TRUE(parsed(write_case(old)).notes.empty());
  EXPECT_FALSE(parsed(write_case(old)).mpm->initial_equilibrium);
  EXPECT_NE(refusal(whole_case + "settle = false\ninitial_equilibrium = false\n").find("c.toml:14: mpm.settle"), std::string::npos);
}

TEST(Init, TheFirstCaseReadsAsItIs) {
  for (const bool all : {false, true}) for (const FrameFacts& facts : {FrameFacts{1920, 1080, 100, {}}, FrameFacts{40, 30, 2, 25.0}}) {
    const std::string text =
        initial_case({.frames = "a \"b\"/*.png", .folder = ".", .metres_per_pixel = {}, .rate_hz = {}, .all = all}, facts);
    EXPECT_TRUE(all || std::count(text.begin(), text.end(), '\n') < 15) << text;
    EXPECT_EQ(all, text.find("[mpm]") != std::string::npos);
    EXPECT_EQ(refusal(text), "") << text;
    const Case c = parsed(text);
    EXPECT_EQ(c.frames->path, "a \"b\"/*.png");
    EXPECT_FALSE(c.frames->rate_hz) << "a container's claim is shown, not taken for granted";
    EXPECT_FALSE(c.camera.metres_per_pixel);
    ASSERT_EQ(c.regions.size(), 1u);
    EXPECT_LE(c.piv->window_px, std::max(8, facts.height / 8));
  }
}

TEST(Init, EveryCommentedLineIsSoundWhenItsMarkIsTakenAway) {
  const std::string text =
      initial_case({.frames = "*.png", .folder = ".", .metres_per_pixel = {}, .rate_hz = {}, .all = true}, {1920, 1080, 10, {}});
  const std::string live = uncommented(text);
  EXPECT_EQ(refusal(live), "") << live;
  const Case c = parsed(live);
  EXPECT_TRUE(c.mpm && c.frames->rate_hz && c.camera.metres_per_pixel && c.limits["displacement_rms_m"]);
  EXPECT_EQ(c.masks.size(), 1u);
  EXPECT_EQ(c.boundaries.size(), 3u);
}

TEST(Init, WhatIsKnownIsWritten) {
  const std::string text =
      initial_case({.frames = "/data/v.mp4", .folder = "/tmp/study", .metres_per_pixel = 1e-3, .rate_hz = 240.0, .all = true},
                   {640, 480, 10, 30.0});
  const Case c = parsed(text);
  EXPECT_EQ(c.camera.metres_per_pixel, 1e-3);
  EXPECT_EQ(c.frames->rate_hz, 240.0);
  EXPECT_EQ(c.frames->path, "/data/v.mp4");
  EXPECT_EQ(c.name, "study");
}

TEST(Init, RelativeFramesBecomeRelativeToTheCase) {
  const std::string text = initial_case(
      {.frames = "frames/*.png", .folder = "study", .metres_per_pixel = {}, .rate_hz = {}}, {640, 480, 10, {}});
  EXPECT_EQ(parsed(text).frames->path, "../frames/*.png");
}

TEST(Init, OpensTheFramesToLearnTheirSize) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "pivnp init test";
  std::filesystem::create_directories(folder);
  for (const char* name : {"a 1.pgm", "a 2.pgm", "a 10.pgm"})
    std::ofstream(folder / name, std::ios::binary) << "P5\n96 64\n255\n" << std::string(96 * 64, '\x40');
  const std::string text =
      init_case({.frames = (folder / "a *.pgm").string(), .folder = folder, .metres_per_pixel = {}, .rate_hz = {}});
  EXPECT_NE(text.find("# 3 frames of 96 x 64 px"), std::string::npos) << text;
  EXPECT_EQ(parsed(text).piv->window_px, 8);
  EXPECT_THROW(
      init_case({.frames = (folder / "b*.pgm").string(), .folder = folder, .metres_per_pixel = {}, .rate_hz = {}}),
      InputError);
  std::filesystem::remove_all(folder);
}

// A later version's case, as a record of it holds: what is not known is left out and named, the rest is read.
TEST(Reading, TheCaseOfARecordMayBeALaterVersions) {
  const std::string later = whole_case +
                            "[wetting]\nfront_m = 0.1\n[compare]\nlater_key = 3\n[compare.limits]\ndisplacement_rms_m = 0.5\n"
                            "[report]\nlater = \"x\"\n[np]\nper_element = \"many\"\n";
  EXPECT_THROW(parse_case(later, "c.toml", "."), InputError);
  const Case c = parse_recorded_case(later, "c.toml", ".");
  EXPECT_EQ(c.name, "slope");
  EXPECT_EQ(c.limits["displacement_rms_m"], 0.5);
  EXPECT_EQ(c.np->per_element, np::NpOptions{}.per_element);
  for (const char* named : {"[wetting]", "later_key", "report.later", "np.per_element"}) {
    const auto tells = [&](const std::string& note) { return note.find(named) != note.npos && note.starts_with("c.toml:"); };
    EXPECT_EQ(std::count_if(c.notes.begin(), c.notes.end(), tells), 1) << named;
  }
  EXPECT_TRUE(parse_recorded_case(whole_case, "c.toml", ".").notes.empty());
  EXPECT_THROW(parse_recorded_case("[piv\n", "c.toml", "."), InputError);
}

}  // namespace
}  // namespace pivnp::app
