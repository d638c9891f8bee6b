// Progress: a line drawn over on a terminal, few plain lines elsewhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "apps/cli/terminal_progress.hpp"

namespace pivnp::app {
namespace {

struct Display {
  double now = 100;
  std::ostringstream out;
  TerminalProgress progress;
  explicit Display(ProgressStyle style)
      : progress(
            out, style, [] { return false; }, [this] { return now; }) {}
  std::ptrdiff_t count(char c) {
    const std::string text = out.str();
    return std::count(text.begin(), text.end(), c);
  }
};

TEST(Progress, ElsewhereALineEveryFiveSecondsAndAtTheEnd) {
  Display d(ProgressStyle::lines);
  for (int k = 0; k <= 120; ++k, d.now += 0.125) d.progress.update("piv", k, 120);
  EXPECT_EQ(d.out.str(), "piv 40/120, 8/s, 10 s left\npiv 80/120, 8/s, 5 s left\npiv 120/120, done in 15 s\n");
}

TEST(Progress, OnATerminalOneLineAStage) {
  Display d(ProgressStyle::bar);
  for (int k = 0; k <= 100; ++k, d.now += 0.03125) d.progress.update("piv", k, 100);
  for (int k = 0; k <= 10; ++k, d.now += 0.03125) d.progress.update("np", k, 10);
  EXPECT_EQ(d.count('\n'), 2);
  EXPECT_LE(d.count('\r'), 3.5 / 0.1 + 6);
  const std::string text = d.out.str();
  EXPECT_NE(text.find("piv [###########.............] 48/100, 32/s, 1.6 s left"), std::string::npos) << text;
  EXPECT_NE(text.find("piv [########################] 100/100, done in 3.1 s\n"), std::string::npos) << text;
}

TEST(Progress, AResumedStageCountsItsRateFromWhereItBegan) {
  Display d(ProgressStyle::lines);
  for (int k = 90; k <= 100; ++k, d.now += 1) d.progress.update("piv", k, 100);
  EXPECT_EQ(d.out.str().substr(0, 26), "piv 95/100, 1/s, 5 s left\n");
}

TEST(Progress, AStageKeepsItsClockThroughOneWithinIt) {
  Display d(ProgressStyle::lines);
  for (int k = 1; k <= 4; ++k) {
    for (int n = 0; n < 3; ++n, d.now += 5) d.progress.update("steps", n, 100);
    d.progress.update("states", k, 4);
  }
  EXPECT_NE(d.out.str().find("states 4/4, done in 45 s"), std::string::npos) << d.out.str();
}

TEST(Progress, AnUnfinishedLineIsEndedBeforeOtherText) {
  std::ostringstream out;
  {
    TerminalProgress progress(out, ProgressStyle::bar, [] { return false; });
    progress.update("mpm", 1, 10);
    EXPECT_NE(out.str().back(), '\n');
  }
  EXPECT_EQ(out.str().back(), '\n');
}

TEST(Progress, QuietSaysNothingAndOddCountsDoNoHarm) {
  Display quiet(ProgressStyle::silent);
  quiet.progress.update("piv", 1, 1);
  EXPECT_EQ(quiet.out.str(), "");
  for (const ProgressStyle style : {ProgressStyle::bar, ProgressStyle::lines}) {
    Display d(style);
    d.progress.update("x", 0, 0);
    d.now += 6;
    d.progress.update("x", 7, 0);
    d.progress.update("x", 20, 10);
    d.progress.update("x", 20, 10);
    d.progress.update("x", 1, 10);  // begins again
    d.progress.update("y", 1, 1);
    d.progress.update("y", 1, 1);
    const std::string text = d.out.str();
    const std::size_t first = text.find("y ");
    EXPECT_NE(first, std::string::npos);
    EXPECT_EQ(text.find("y ", first + 1), std::string::npos) << "said once that it is done\n" << text;
  }
}

TEST(Progress, Durations) {
  EXPECT_EQ(duration_text(0.04), "0 s");
  EXPECT_EQ(duration_text(2.34), "2.3 s");
  EXPECT_EQ(duration_text(59.4), "59 s");
  EXPECT_EQ(duration_text(59.6), "1 min 00 s");
  EXPECT_EQ(duration_text(200), "3 min 20 s");
  EXPECT_EQ(duration_text(7500), "2 h 05 min");
}

}  // namespace
}  // namespace pivnp::app
