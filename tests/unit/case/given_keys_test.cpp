// Keys given beside the file: they win, are checked as the file's are, and say which of them is wrong.
#include "tests/unit/case/case_text.hpp"

namespace pivnp::app {
namespace {

std::string refused(const std::string& text, const std::vector<std::string>& given) {
  try {
    parse_case(text, "c.toml", ".", given);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

const std::string frames = "[frames]\npath = \"*.png\"\n[piv]\nwindow_px = 64\n";

TEST(GivenKeys, WinOverTheFile) {
  const Case c = parse_case(frames, "c.toml", ".",
                            {"piv.window_px=24", "camera.origin_px=[1, 2.5]", "piv.anchor=forward", "name=two words",
                             "mask.a.circle_px=[1, 2, 3]"});
  EXPECT_EQ(c.piv->window_px, 24);
  EXPECT_EQ(c.piv->anchor, Anchor::forward);
  EXPECT_EQ(c.camera.origin_px, (Pair{1, 2.5}));
  EXPECT_EQ(c.name, "two words");
  ASSERT_EQ(c.masks.size(), 1u);
  EXPECT_EQ(c.masks[0].first, "a");
  EXPECT_EQ(c.frames->path, "*.png");
}

// Of the command line; a case that has frames of its own, or draws them, is read as it is.
TEST(GivenKeys, FramesBesideTheFileStandForAMissingSection) {
  const std::string without = "[piv]\nwindow_px = 24\n";
  EXPECT_EQ(refused(without, {}), "c.toml:1: [piv]: there are no frames to measure; expected [frames] or [synth]");
  const Case c = parse_case(without, "c.toml", ".", {"frames.rate_hz=50"}, true);
  EXPECT_EQ(c.frames->path, "");
  EXPECT_EQ(c.frames->rate_hz, 50);
  EXPECT_EQ(parse_case(frames, "c.toml", ".", {}, true).frames->path, "*.png");
  EXPECT_FALSE(parse_case("[synth]\nmotion = \"affine\"\n", "c.toml", ".", {}, true).frames);
}

TEST(GivenKeys, TheLastOfTwoCounts) {
  EXPECT_EQ(parse_case(frames, "c.toml", ".", {"piv.window_px=24", "piv.window_px=48"}).piv->window_px, 48);
}

TEST(GivenKeys, FaultsNameTheKeyAndWhichOfThem) {
  EXPECT_EQ(refused(frames, {"name=x", "piv.window_px=7"}), "--set:2: piv.window_px: found 7, expected 8 to 256 (px)");
  EXPECT_EQ(refused(frames, {"piv.windw_px=16"}), "--set:1: unknown key 'piv.windw_px'; did you mean 'window_px'?");
  for (const std::string none : {"piv", "=3", "piv.=3", ".x=3", "a.b.c.d.e=1"})
    EXPECT_EQ(refused(frames, {none}).rfind("--set:1: found ", 0), 0u) << none;
  EXPECT_EQ(refused("name = 'x'\n", {"name.x=1"}).rfind("--set:1: name: found ", 0), 0u);
}

// What only the whole case shows names the file's line where there is one, else the file.
TEST(GivenKeys, TheWholeCaseIsChecked) {
  EXPECT_EQ(
      refused(
          "[region.a]\npolygon_m = [[0, 0], [1, 0], [1, 1]]\nmaterial = 'x'\n[mpm]\nend_s = 1\noutput_rate_hz = 1\n",
          {"region.a.material=y"})
          .rfind("c.toml:", 0),
      0u);
}

}  // namespace
}  // namespace pivnp::app
