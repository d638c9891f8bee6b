// Time and memory of stages, as they are measured while work tells how far it is.
#include "apps/study/pipeline/record/stage_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>
#include <vector>

#include "apps/study/study.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {
namespace {

void wait_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

TEST(StageClock, FirstUnitsTellWhatToExpect) {
  SilentProgress silent;
  StageClock clock(silent);
  clock.begin("simulation");
  clock.expect("simulation", 100);
  wait_ms(50);  // what precedes the first unit is not of the units
  for (int k = 1; k <= 8; ++k) {
    clock.update("simulation", k, 8);
    wait_ms(30);
  }
  clock.begin("record");
  clock.end();
  ASSERT_EQ(clock.cost().stages.size(), 2u);
  const StageCost& stage = clock.cost().stages[0];
  EXPECT_GE(stage.expected_s, 100 * 0.030);
  EXPECT_LT(stage.expected_s, 100 * 0.030 * 10);  // a busy machine
  EXPECT_GE(stage.wall_s, 0.05 + 8 * 0.030);
  EXPECT_LT(stage.processor_s, 0.5 * stage.wall_s);  // it slept
  EXPECT_TRUE(std::isnan(clock.cost().stages[1].expected_s));
}

TEST(StageClock, MemoryIsOfTheStageThatHeldIt) {
  SilentProgress silent;
  StageClock clock(silent);
  constexpr std::size_t size = 192 << 20;
  clock.begin("large");
  {
    std::vector<char> block(size);
    std::memset(block.data(), 1, size);
    clock.update("large", 1, 2);
  }
  clock.begin("small");
  clock.end();
  const RunCost& cost = clock.cost();
  EXPECT_GE(cost.stages[0].peak_bytes, cost.before_bytes + 0.95 * double(size));
#if !defined(__SANITIZE_ADDRESS__)  // which keeps for a while what was freed
  EXPECT_LT(cost.stages[1].peak_bytes, cost.stages[0].peak_bytes - 0.5 * double(size));
#endif
}

// A block of texture within more of it: what lies beside the region is none of the material.
TEST(StageClock, ARunsRecordTellsItsStagesAndWhereItsMaterialIs) {
  const test::Scratch scratch;
  const std::string text =
      "name = \"block\"\n[frames]\nrate_hz = 10.0\n[camera]\nmetres_per_pixel = 1e-3\n[grid]\nspacing_px = 8\n"
      "[region.soil]\npolygon_px = [[32, 96], [96, 96], [96, 32], [32, 32]]\n[piv]\nmethod = \"fast\"\n"
      "[synth]\nmotion = \"affine\"\nwidth_px = 128\nheight_px = 128\nframes = 4\nshift_px_per_frame = [0.5, 0.0]\n";
  SilentProgress progress;
  RunSettings settings;
  settings.out = scratch.path / "out";
  settings.threads = 1;
  const RunOutcome outcome = run_case(parse_case(text, "c.toml", scratch.path), settings, Stages::all, progress);
  const io::RecordReader record(outcome.record);
  const RunCost cost = record.cost();
  std::string names;
  for (const StageCost& stage : cost.stages) {
    names += stage.name + " ";
    EXPECT_GT(stage.wall_s, 0) << stage.name;
    EXPECT_GE(stage.peak_bytes, cost.before_bytes * 0.9) << stage.name;
  }
  EXPECT_EQ(names, "frames vectors closure particles record ");
  EXPECT_EQ(outcome.cost.stages.back().name, "report");  // told on the terminal; the record was written before
  EXPECT_NE(text_of(outcome.cost).find(" s report; "), std::string::npos);
  std::size_t inside = 0, outside = 0;
  for (std::size_t k = 0; k < record.pair_count(); ++k) {
    const VectorField field = record.pair(k);
    for (int j = 0; j < field.grid.ny; ++j)
      for (int i = 0; i < field.grid.nx; ++i) {
        const VectorStatus status = field.status[field.grid.node(i, j)];
        const Vec2 x = field.grid.position(i, j);  // the region: 32 to 96 mm along x, 31 to 95 mm along y; it goes .5 mm a pair
        const double off = std::max({0.032 + 0.0005 * double(k) - x.x(), x.x() - 0.096 - 0.0005 * double(k), 0.031 - x.y(), x.y() - 0.095});
        outside += off > 0.5 * field.grid.spacing.x();
        inside += off < -1e-3;
        EXPECT_TRUE(off <= 0.5 * field.grid.spacing.x() || status == VectorStatus::outside) << i << ", " << j;
        EXPECT_TRUE(off >= -1e-3 || status != VectorStatus::outside) << i << ", " << j;
      }
  }
  EXPECT_GT(inside, 100u);
  EXPECT_GT(outside, 100u);
}

}  // namespace
}  // namespace pivnp::app
