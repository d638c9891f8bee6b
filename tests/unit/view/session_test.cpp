// What the window holds, without the window.
#include "apps/view/model/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "apps/view/model/live_pair.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/view/drawn_shear.hpp"

namespace pivnp::view {
namespace {

using test::refusal;

Session opened_frames() {
  Session session;
  session.take(open_path(test::drawn_shear()));
  return session;
}

const std::vector<Vec2> box{{20, 20}, {200, 24}, {190, 150}, {22, 140}};

TEST(ViewSession, FramesBecomeACaseThatIsValid) {
  const Session session = opened_frames();
  ASSERT_TRUE(session.frames());
  EXPECT_EQ(session.frames()->frames().size(), std::size_t(test::drawn_frames));
  EXPECT_TRUE(session.valid());
  EXPECT_TRUE(session.faults().empty());
  EXPECT_TRUE(session.shapes().empty());
}

TEST(ViewSession, EveryKindOfEditIsUndoneToTheLetter) {
  Session session = opened_frames();
  std::vector<std::string> texts{session.text()};
  const auto then = [&](auto&& edit) {
    edit();
    EXPECT_NE(session.text(), texts.back());
    texts.push_back(session.text());
  };
  then([&] { EXPECT_EQ(session.add_shape(ShapeKind::region, box), "soil"); });
  then([&] { EXPECT_EQ(session.add_shape(ShapeKind::region, {{100, 100}, {110, 100}, {110, 110}}), "soil_2"); });
  then([&] { session.add_shape(ShapeKind::wall, {{0, 170}, {239, 170}}); });
  then([&] { session.add_shape(ShapeKind::still_zone, {{30, 30}, {60, 30}, {60, 60}}); });
  then([&] { session.set_scale({0, 0}, {200, 0}, 0.05); });
  then([&] { session.set_origin({10, 150}); });
  then([&] { session.set_points(1, {{100, 100}, {120, 100}, {110, 115}}); });
  then([&] { session.copy_shape(0, ShapeKind::mask); });
  then([&] { session.rename_shape(0, "dry sand"); });
  then([&] { session.set_key({"piv", "window_px"}, "24"); });
  then([&] { session.set_horizontal({0, 150}, {200, 146}); });
  then([&] { session.remove_shape(1); });
  then([&] { session.set_text("# by hand\n" + session.text()); });
  const std::vector<std::string> forward = texts;
  for (std::size_t k = texts.size() - 1; k-- > 0;) {
    session.undo();
    EXPECT_EQ(session.text(), forward[k]);
  }
  EXPECT_FALSE(session.can_undo());
  for (std::size_t k = 1; k < forward.size(); ++k) {
    session.redo();
    EXPECT_EQ(session.text(), forward[k]);
  }
  EXPECT_FALSE(session.can_redo());
}

TEST(ViewSession, TypingIsUndoneAtOnce) {
  Session session = opened_frames();
  const std::string before = session.text();
  for (const char* more : {"#", "# a", "# ab"}) session.set_text(before + more, true);
  session.undo();
  EXPECT_EQ(session.text(), before);
}

TEST(ViewSession, AWrongOutlineIsRefusedWithItsReason) {
  Session session = opened_frames();
  const std::string before = session.text();
  EXPECT_THAT(refusal([&] { session.add_shape(ShapeKind::region, {{20, 20}, {200, 150}, {200, 20}, {20, 150}}); }),
              testing::StartsWith("region.soil.polygon_px: "));
  EXPECT_THAT(refusal([&] { session.add_shape(ShapeKind::mask, {{20, 20}, {200, 150}}); }), testing::StartsWith("mask.mask.polygon_px: "));
  EXPECT_EQ(session.text(), before);
  EXPECT_FALSE(session.can_undo());
}

TEST(ViewSession, ScaleOriginAndLevelMeanWhatWasClicked) {
  Session session = opened_frames();
  session.add_shape(ShapeKind::wall, {{10, 160}, {230, 160}});
  session.set_scale({40, 50}, {140, 50}, 0.025);
  EXPECT_NEAR((session.shapes()[0].points[1] - Vec2(230, 160)).norm(), 0, 0.02);  // the first scale moves no wall
  session.set_origin({40, 150});
  EXPECT_NEAR((session.camera().to_world({140, 50}) - Vec2(0.025, 0.025)).norm(), 0, 1e-12);
  session.set_horizontal({40, 150}, {140, 140});
  const Vec2 along = session.camera().to_world({140, 140});
  EXPECT_NEAR(along.y(), 0, 1e-9);
  EXPECT_NEAR(along.x(), 0.025 * std::hypot(1, 0.1), 1e-9);
  session.set_scale({40, 150}, {140, 140}, 0.5);  // of targets
  EXPECT_NEAR(session.camera().to_world({140, 140}).x(), 0.5, 1e-8);
  EXPECT_TRUE(session.valid()) << (session.faults().empty() ? "" : session.faults()[0].text);
}

TEST(ViewSession, AllFaultsAreTold) {
  Session session = opened_frames();
  session.set_text(session.text() + "\n[np]\nper_element = 5\nshap = 3\n[region.a]\nmaterial = \"b\"\n");
  EXPECT_FALSE(session.valid());
  session.set_text("[frames]\nrate_hz = -1\n[piv]\nwindow = 3\n");
  ASSERT_EQ(session.faults().size(), 2u);
  EXPECT_EQ(session.faults()[0].line, 2);
  EXPECT_EQ(session.faults()[1].line, 4);
  session.set_text("[frames\n");
  ASSERT_EQ(session.faults().size(), 1u);
  EXPECT_EQ(session.faults()[0].line, 1);
  EXPECT_THROW(session.add_shape(ShapeKind::region, box), InputError);
}

// Lengths of a text in mm are drawn and written in mm.
TEST(ViewSession, TheTextKeepsItsUnitOfLength) {
  Session session = opened_frames();
  session.set_text(session.text() + "[mask.plate]\npolygon_m = [[2, 2], [10, 2], [10, 8]]\n");
  session.set_key({"camera", "length_unit"}, "\"mm\"");
  session.set_key({"camera", "metres_per_pixel"}, "0.2");
  ASSERT_TRUE(session.valid());
  ASSERT_EQ(session.shapes().size(), 1u);
  EXPECT_NEAR((session.shapes()[0].points[0] - Vec2(10, 175 - 10)).norm(), 0, 1e-9);
  session.set_points(0, {{10, 165}, {60, 165}, {60, 115}});
  EXPECT_THAT(session.text(), testing::HasSubstr("polygon_m = [[2.0, 2.0], [12.0, 2.0], [12.0, 12.0]]"));
}

TEST(ViewSession, ACircleIsShownAndEditedInTheText) {
  Session session = opened_frames();
  session.set_text(session.text() + "[mask.tool]\ncircle_px = [60.0, 50.0, 20.0]\n");
  ASSERT_EQ(session.shapes().size(), 1u);
  for (const Vec2& p : session.shapes()[0].points) EXPECT_NEAR((p - Vec2(60, 50)).norm(), 20, 1e-9);
  EXPECT_EQ(refusal([&] { session.set_points(0, box); }), "mask.tool.circle_px: is a circle, expected its numbers to be edited in the text");
  session.remove_shape(0);
  EXPECT_TRUE(session.shapes().empty());
}

TEST(ViewSession, WhatIsSavedIsReadAgain) {
  Session session = opened_frames();
  session.add_shape(ShapeKind::region, box);
  const std::filesystem::path file = test::drawn_shear().parent_path() / "saved.toml";
  session.save(file);
  EXPECT_FALSE(session.modified());
  EXPECT_THAT(session.text(), testing::HasSubstr("path = \"frames"));
  EXPECT_FALSE(session.frames_stale());
  Session again;
  again.take(open_path(file));
  EXPECT_EQ(again.text(), session.text());
  ASSERT_TRUE(again.frames());
  EXPECT_TRUE(again.valid());
}

TEST(ViewSession, WhatCannotBeOpenedIsRefusedAsByTheCommand) {
  const test::Scratch scratch;
  EXPECT_NE(refusal([&] { open_path(scratch.path / "none.mp4"); }), "");
  std::ofstream(scratch.path / "case.toml") << "[frames]\npath = \"none/*.png\"\n";
  const Opened opened = open_path(scratch.path);
  EXPECT_FALSE(opened.frames);
  EXPECT_THAT(opened.complaint, testing::HasSubstr("none"));
}

TEST(ViewSession, ALivePairIsThatOfARun) {
  Session session = opened_frames();
  session.set_key({"piv", "method"}, "\"fft\"");
  ASSERT_TRUE(session.valid());
  std::vector<LivePair> pairs;
  measure_live(*session.valid(), *session.frames(), 2, PixelBox{50, 50, 150, 130}, 1, [] { return false; }, [&](LivePair p) { pairs.push_back(std::move(p)); });
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_TRUE(pairs[0].part);
  for (const LivePair& pair : pairs) {
    EXPECT_EQ(pair.field.pair, (std::array{2, 3}));
    std::size_t valid = 0;
    double mean = 0;
    for (std::size_t n = 0; n < pair.field.status.size(); ++n)
      if (pair.field.status[n] == VectorStatus::valid) ++valid, mean += double(pair.field.displacement[n][1]);
    ASSERT_GT(valid, pair.field.status.size() / 2);
    EXPECT_NEAR(mean / double(valid), 0.3, 0.02);
  }
  pairs.clear();
  measure_live(*session.valid(), *session.frames(), 2, PixelBox{50, 50, 150, 130}, 1, [] { return true; }, [&](LivePair p) { pairs.push_back(std::move(p)); });
  EXPECT_EQ(pairs.size(), 1u);  // superseded after the visible part
  EXPECT_THAT(csv_of(pairs[0]), testing::StartsWith("column [px],row [px],x [px]"));
}

}  // namespace
}  // namespace pivnp::view
