// A session in the window by mouse and keys, without a screen: from frames to a case that `pivnp check` accepts, a wrong outline,
// undo, the live pair, a run and its record.
#include "apps/view/window/main_window.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>

#include <QCheckBox>
#include <QFileInfo>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QProcess>
#include <QSpinBox>
#include <QTest>

#include "apps/case/case.hpp"
#include "apps/plot/canvas.hpp"
#include "tests/unit/view/drawn_shear.hpp"

namespace pivnp::view {
namespace {

class Window : public testing::Test {
 protected:
  void SetUp() override {
    plot::start_qt();
    window = std::make_unique<MainWindow>(false);
    window->show();
  }

  void wait_for(const std::function<bool()>& there, int milliseconds = 15000) {
    for (int k = 0; k < milliseconds / 5 && !there(); ++k) QTest::qWait(5);
    EXPECT_TRUE(there());
  }
  void settle() {
    wait_for([&] { return window->idle(); });
    QTest::qWait(10);
    wait_for([&] { return window->idle(); });
  }
  void open(const std::filesystem::path& path) {
    window->open(path);
    settle();
  }
  FrameView& view() { return window->setup().view(); }
  Session& session() { return window->setup().session(); }
  QPoint at(double column, double row) { return view().to_widget({column, row}).toPoint(); }
  void click(double column, double row) { QTest::mouseClick(&view(), Qt::LeftButton, {}, at(column, row)); }
  void draw(Qt::Key tool, const std::vector<std::pair<double, double>>& points) {
    view().setFocus();
    QTest::keyClick(&view(), tool);
    for (const auto& [column, row] : points) click(column, row);
    QTest::keyClick(&view(), Qt::Key_Return);
  }
  template <class W>
  W& find(const char* name) {
    return *window->findChild<W*>(name);
  }
  QString message() { return find<QLabel>("message").text(); }
  void expect_points(std::size_t shape, const std::vector<std::pair<double, double>>& wanted) {
    ASSERT_LT(shape, session().shapes().size());
    const std::vector<Vec2>& points = session().shapes()[shape].points;
    ASSERT_EQ(points.size(), wanted.size());
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      EXPECT_NEAR(points[k].x(), wanted[k].first, 1);
      EXPECT_NEAR(points[k].y(), wanted[k].second, 1);
    }
  }

  std::unique_ptr<MainWindow> window;
};

TEST_F(Window, FromFramesToACaseThatCheckAccepts) {
  open(test::drawn_shear());
  ASSERT_TRUE(session().frames());
  // A scale by two clicks and a length.
  QTest::keyClick(&view(), Qt::Key_S);
  click(40, 120);
  click(140, 120);
  QTest::keyClicks(&find<QLineEdit>("length"), "20");
  QTest::keyClick(&find<QLineEdit>("length"), Qt::Key_Return);
  ASSERT_TRUE(session().seen().camera.metres_per_pixel);
  EXPECT_NEAR(*session().seen().camera.metres_per_pixel, 2e-4, 4e-6);
  // A region whose corner snaps to the frame's edge.
  const std::vector<std::pair<double, double>> outline{{0, 30}, {200, 24}, {210, 150}, {30, 160}};
  draw(Qt::Key_R, outline);
  expect_points(0, outline);
  EXPECT_EQ(session().shapes()[0].points[0].x(), 0);
  // A wrong one: its sides cross.
  const std::string before = session().text();
  draw(Qt::Key_M, {{40, 40}, {120, 120}, {120, 40}, {40, 120}});
  EXPECT_EQ(session().text(), before);
  EXPECT_THAT(message().toStdString(), testing::StartsWith("mask.mask.polygon_px: "));
  // Settings.
  find<QSpinBox>("window").setValue(24);
  find<QDoubleSpinBox>("spacing").setValue(8);
  EXPECT_EQ(session().seen().piv->window_px, 24);
  EXPECT_EQ(session().seen().grid.spacing_px, 8);
  // A point is dragged, and back again.
  click(13.8, 90);  // selects by the outline's side
  ASSERT_EQ(view().selected(), 0);
  QTest::mousePress(&view(), Qt::LeftButton, {}, at(200, 24));
  QTest::mouseMove(&view(), at(180, 40));
  QTest::mouseRelease(&view(), Qt::LeftButton, {}, at(180, 40));
  expect_points(0, {{0, 30}, {180, 40}, {210, 150}, {30, 160}});
  QTest::keyClick(window.get(), Qt::Key_Z, Qt::ControlModifier);
  expect_points(0, outline);

  const std::filesystem::path file = test::drawn_shear().parent_path() / "case.toml";
  ASSERT_TRUE(window->save_to(file));
  EXPECT_FALSE(session().modified());
  const app::Case c = app::read_case(file);
  EXPECT_EQ(c.regions.size(), 1u);
  EXPECT_EQ(c.piv->window_px, 24);
  QProcess check;
  check.start(PIVNP_PROGRAM, {"check", QString::fromStdString(file.string()), "--out", QString::fromStdString((file.parent_path() / "checked").string())});
  ASSERT_TRUE(check.waitForFinished(30000));
  EXPECT_EQ(check.exitCode(), 0) << check.readAllStandardError().toStdString();
}

TEST_F(Window, TheTextIsEditedEitherWay) {
  open(test::drawn_shear());
  TomlEditor& editor = window->setup().editor();
  const std::string before = session().text();
  editor.moveCursor(QTextCursor::End);
  const auto type = [&](const char* line) {
    QTest::keyClicks(&editor, line);
    QTest::keyClick(&editor, Qt::Key_Return);
  };
  type("[region.clay]");
  type("polygon_px = [[10, 10], [100, 12], [60, 90]]");
  ASSERT_EQ(session().shapes().size(), 1u);
  EXPECT_EQ(find<QListWidget>("shapes").count(), 1);
  type("polygon = 3");
  EXPECT_EQ(find<QListWidget>("faults").count(), 1);
  EXPECT_TRUE(find<QListWidget>("faults").isVisible());
  QTest::keyClick(&editor, Qt::Key_Z, Qt::ControlModifier);
  EXPECT_EQ(session().text(), before);
  EXPECT_EQ(editor.toPlainText().toStdString(), before);
  EXPECT_FALSE(find<QListWidget>("faults").isVisible());
}

TEST_F(Window, ALivePairFollowsTheSlider) {
  open(test::drawn_shear());
  session().set_key({"piv", "method"}, "\"fft\"");
  find<QCheckBox>("live").setChecked(true);
  wait_for([&] { return window->setup().pair().has_value() && !window->setup().pair()->part; });
  EXPECT_EQ(window->setup().pair()->field.pair[0], 0);
  view().setFocus();
  QTest::keyClick(&view(), Qt::Key_Right);
  EXPECT_FALSE(window->setup().pair().has_value());  // vectors of another pair are not shown
  wait_for([&] { return window->setup().pair().has_value(); });
  EXPECT_EQ(window->setup().pair()->field.pair[0], 1);
  settle();
  const std::filesystem::path folder = test::drawn_shear().parent_path();
  EXPECT_EQ(window->save_picture(folder / "pair.png"), "");
  EXPECT_EQ(window->save_picture(folder / "pair.svg"), "");
  window->save_values(folder / "pair.csv");
  for (const char* name : {"pair.png", "pair.svg", "pair.csv"}) EXPECT_GT(std::filesystem::file_size(folder / name), 1000u) << name;
}

TEST_F(Window, ARunEndsInItsRecord) {
  const test::Scratch scratch;
  std::filesystem::copy(test::drawn_shear(), scratch.path / "frames");
  open(scratch.path / "frames");
  session().set_key({"piv", "method"}, "\"fft\"");
  ASSERT_TRUE(window->save_to(scratch.path / "case.toml"));
  // The program lies elsewhere than the tests.
  const QByteArray path = qgetenv("PATH");
  qputenv("PATH", QByteArray(QFileInfo(PIVNP_PROGRAM).absolutePath().toLocal8Bit() + ":" + path));
  window->run().start(false);
  EXPECT_TRUE(window->run().running());
  wait_for([&] { return window->look().has_record(); }, 60000);
  qputenv("PATH", path);
  settle();
  ASSERT_TRUE(window->look().has_record());
  EXPECT_EQ(window->look().time().count(), test::drawn_frames);
  RecordPane& pane = window->look().pane(0);
  EXPECT_FALSE(pane.picture.isNull());
  EXPECT_FALSE(window->look().pane(1).isVisible());  // there is no simulation
  QTest::mouseClick(&pane, Qt::LeftButton, {}, pane.rect().center());
  wait_for([&] { return pane.mark.has_value(); });
  window->save_values(scratch.path / "values.csv");
  settle();
  EXPECT_GT(std::filesystem::file_size(scratch.path / "values.csv"), 1000u);
}

TEST_F(Window, WhatIsNoRecordIsToldAndNothingElseIsLost) {
  const test::Scratch scratch;
  open(test::drawn_shear());
  window->look().open(scratch.path / "none.h5");
  settle();
  EXPECT_NE(window->look().words(), "");
  EXPECT_TRUE(session().frames());
}

// Pictures to be looked at: PIVNP_VIEW_PICTURES names the folder, PIVNP_VIEW_OPENS cases, records and frames, parted by colons.
TEST_F(Window, Pictures) {
  const char *folder = std::getenv("PIVNP_VIEW_PICTURES"), *opens = std::getenv("PIVNP_VIEW_OPENS");
  if (folder == nullptr || opens == nullptr) GTEST_SKIP() << "PIVNP_VIEW_PICTURES and PIVNP_VIEW_OPENS are not set";
  int k = 0;
  for (const QString& path : QString(opens).split(':')) {
    open(path.toStdString());
    settle();
    if (window->setup().isVisible()) {
      find<QCheckBox>("live").setChecked(true);
      window->setup().time().go(window->setup().time().count() / 3);
      if (!session().shapes().empty()) view().select(0);
    } else {
      RecordPane& pane = window->look().pane(0);
      QTest::mouseClick(&pane, Qt::LeftButton, {}, QPoint(int(0.41 * pane.width()), int(0.7 * pane.height())));
    }
    for (const bool dark : {false, true}) {
      window->set_dark(dark);
      settle();
      QTest::qWait(300);
      window->grab().save(QString("%1/%2_%3.png").arg(folder).arg(k).arg(dark ? "dark" : "light"));
    }
    ++k;
  }
}

}  // namespace
}  // namespace pivnp::view
