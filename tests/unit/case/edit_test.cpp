// Changes to a case's text: what is asked for changes, and nothing else does.
#include "apps/case/edit.hpp"

#include <gmock/gmock.h>

#include "tests/support/refusal.hpp"
#include "tests/unit/case/case_text.hpp"

namespace pivnp::app {
namespace {

const std::string given =
    "# Ä case — of ours\n"
    "name = \"été\"\n"
    "\n"
    "[frames]  # [piv] here is none\n"
    "path = \"ö/*.png\"  # kept\n"
    "[region.sand]\n"
    "# the outline\n"
    "polygon_px = [[1, 2],  # first\n"
    "  [30, 2],\n"
    "  [30, 40]]  # last\n"
    "material = \"sand\"\n"
    "\n"
    "# of the walls\n"
    "[boundary.base]\n"
    "line_m = [[0.0, 0.0], [1.0, 0.0]]\n"
    "type = \"fixed\"\n";

std::string replaced(std::string text, const std::string& before, const std::string& after) {
  return text.replace(text.find(before), before.size(), after);
}

TEST(Edit, AValueIsPutInPlaceOfAnother) {
  EXPECT_EQ(with_key(given, "c", {"frames", "path"}, "\"b.mp4\""), replaced(given, "\"ö/*.png\"", "\"b.mp4\""));
  EXPECT_EQ(with_key(given, "c", {"region", "sand", "polygon_px"}, "[[3, 4]]"),
            replaced(given, "[[1, 2],  # first\n  [30, 2],\n  [30, 40]]", "[[3, 4]]"));
  EXPECT_EQ(with_key(given, "c", {"name"}, "\"a\""), replaced(given, "\"été\"", "\"a\""));
}

TEST(Edit, ANewKeyFollowsThoseOfItsSection) {
  EXPECT_EQ(with_key(given, "c", {"frames", "rate_hz"}, "7.5"), replaced(given, "# kept\n", "# kept\nrate_hz = 7.5\n"));
  EXPECT_EQ(with_key(given, "c", {"region", "sand", "x"}, "1"), replaced(given, "material = \"sand\"\n", "material = \"sand\"\nx = 1\n"));
  EXPECT_EQ(with_key(given, "c", {"camera", "metres_per_pixel"}, "1e-4"), given + "\n[camera]\nmetres_per_pixel = 1e-4\n");
  EXPECT_EQ(with_key("", "c", {"piv", "window_px"}, "24"), "[piv]\nwindow_px = 24\n");
  EXPECT_EQ(with_key("[piv]", "c", {"piv", "window_px"}, "24"), "[piv]\nwindow_px = 24\n");
  EXPECT_EQ(with_key("[camera.motion]\nfrom = \"none\"\n", "c", {"camera", "lens"}, "\"none\""),
            "[camera.motion]\nfrom = \"none\"\n\n[camera]\nlens = \"none\"\n");
  EXPECT_EQ(with_key("camera.lens = \"none\"\n[piv]\n", "c", {"camera", "metres_per_pixel"}, "2"),
            "camera.lens = \"none\"\ncamera.metres_per_pixel = 2\n[piv]\n");
  EXPECT_EQ(with_key("piv = { window_px = 8 }\n", "c", {"piv", "order"}, "2"), "piv = { window_px = 8 , order = 2 }\n");
}

TEST(Edit, KeysAndSectionsGoWithoutWhatLiesBesideThem) {
  EXPECT_EQ(without_key(given, "c", {"region", "sand", "polygon_px"}),
            replaced(given, "polygon_px = [[1, 2],  # first\n  [30, 2],\n  [30, 40]]  # last\n", ""));
  EXPECT_EQ(without_key(given, "c", {"region", "sand"}),
            given.substr(0, given.find("[region")) + given.substr(given.find("# of the walls")));
  EXPECT_EQ(without_key(given, "c", {"boundary", "base"}), given.substr(0, given.find("[boundary")));
  EXPECT_EQ(without_key(given, "c", {"mask", "x"}), given);
  EXPECT_EQ(without_key("[np]\na = 1\n[np.b]\nc = 2\n[piv]\n", "c", {"np"}), "[piv]\n");
}

TEST(Edit, ASectionIsRenamed) {
  EXPECT_EQ(with_name(given, "c", {"region", "sand"}, "wet clay"), replaced(given, "[region.sand]", "[region.\"wet clay\"]"));
  EXPECT_EQ(test::refusal([] { with_name("[mask.a]\nx = 1\n[mask.b]\n", "c", {"mask", "a"}, "b"); }),
            "c: [mask.b]: is there already, expected another name");
}

TEST(Edit, WhatCannotBeDoneIsRefused) {
  EXPECT_EQ(test::refusal([] { with_key("piv = 3\n", "c", {"piv", "window_px"}, "1"); }), "c:1: piv: found a value, expected a section");
  EXPECT_THAT(test::refusal([] { with_key("a = [\n", "c", {"b"}, "1"); }), testing::StartsWith("c:"));
  EXPECT_THAT(test::refusal([] { with_key("", "c", {"b", "c"}, "1 2"); }), testing::HasSubstr("cannot be put into this text"));
}

}  // namespace
}  // namespace pivnp::app
