// The stages of pivnp frontier beside image correlation and a case's simulation, and all of them in small.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "apps/study/frontier/frontier.hpp"
#include "apps/study/frontier/np/np_frontier.hpp"
#include "apps/study/frontier/piv/piv_frontier.hpp"
#include "apps/study/frontier/piv/spacing_frontier.hpp"
#include "apps/study/frontier/work.hpp"
#include "apps/study/methods/frames/known_pairs.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/silent.hpp"

namespace pivnp::app {
namespace {

const FrontierPoint& at(const FrontierStage& stage, const std::string& name) {
  const auto p = std::find_if(stage.points.begin(), stage.points.end(), [&](const FrontierPoint& q) { return q.name == name; });
  if (p == stage.points.end()) throw std::runtime_error(stage.name + ": there is no " + name);
  return *p;
}

TEST(FrontierStages, WorkKnowsTimeAndMemory) {
  constexpr std::size_t bytes = 64 << 20;
  std::vector<char> held;
  const Effort w = measured(1, [&] { held.assign(bytes, 1); });
  EXPECT_GT(w.seconds, 0);
  if (std::isnan(w.bytes)) GTEST_SKIP() << "the system does not say";
  EXPECT_NEAR(w.bytes, double(bytes), 0.1 * double(bytes));
  const Effort again = measured(1, [&] { std::fill(held.begin(), held.end(), char(2)); });  // what was held before is not counted
  EXPECT_LT(again.bytes, 0.1 * double(bytes));
}

TEST(FrontierStages, ASettingOfManyNamesIsListedOnce) {
  const KnownPairs known = drawn_pairs(160, 5);
  piv::PivOptions mine;
  mine.method = "gn";
  mine.order = 2;   // of no use to adaptive smoothing
  mine.passes = 3;  // what is chosen anyway
  const FrontierStage stage = piv_frontier(known, mine, true, 1, 1, silent), plain = piv_frontier(known, {}, true, 1, 1, silent);
  ASSERT_EQ(stage.points.size(), plain.points.size());
  std::set<std::string> keys;
  for (const FrontierPoint& p : stage.points) EXPECT_TRUE(keys.insert(p.keys).second) << p.keys;
  EXPECT_TRUE(at(stage, "default, 32 px").own && at(stage, "default, 32 px").standard);
}

// What nodes are for: between those of a window's width nothing is known of a short wave; more of them than tell it cost time.
TEST(FrontierStages, SpacingIsJudgedBetweenTheNodes) {
  KnownPairs known = drawn_pairs(192, 5);
  std::erase_if(known.pairs, [](const KnownPair& pair) { return pair.name != "shift" && pair.name != "wave 128 px" && pair.name != "wave 64 px" && pair.name != "wave 32 px"; });
  ASSERT_EQ(known.pairs.size(), 4u);
  SpacingKey given{.px = 12};
  given.key = [](double px) { return "grid.spacing_m=" + std::to_string(int(px)) + "e-3"; };
  piv::PivOptions plain;
  const FrontierStage stage = spacing_frontier(known, plain, {}, given, true, 1, 1, silent);
  const FrontierPoint &usual = at(stage, "default, 32 px, nodes 8 px"), &wide = at(stage, "default, 32 px, nodes 32 px"), &own = at(stage, "default, 32 px, nodes 12 px");
  EXPECT_TRUE(usual.standard && !usual.own && own.own && !own.standard);
  EXPECT_EQ(wide.keys, "grid.spacing_m=32e-3");
  EXPECT_EQ(own.keys, "the case as it is");
  EXPECT_LT(usual.error, 0.2 * wide.error);
  EXPECT_LT(usual.error, own.error);
  constexpr std::size_t followed = 1, wave = 4;
  EXPECT_GT(wide.columns[wave], 1.5 * usual.columns[wave]);
  for (const FrontierPoint& p : stage.points) EXPECT_GT(p.columns[followed], 0.9) << p.name;
  // At the nodes themselves a wide grid is as good as a narrow one: it is what lies between them that counts.
  EXPECT_LT(at(stage, "fft, 16 px, nodes 8 px").error, 0.7 * at(stage, "fft, 16 px, nodes 16 px").error);
}

// Without noise each shape is as good as its order; noise sets a floor.
TEST(FrontierStages, ParticlesAreJudgedByShapeAndNumber) {
  Followed clean;
  clean.noise = 0;
  clean.steps = 8;
  clean.of_case = true;
  np::NpOptions mine;
  mine.per_element = 9;
  const std::vector<FrontierStage> stages = np_frontier(mine, clean, 1, 1, silent);
  ASSERT_EQ(stages.size(), 2u);
  const FrontierStage &paths = stages[0], &strains = stages[1];
  EXPECT_TRUE(at(paths, "bspline3, 4 an element").standard && !at(paths, "bspline3, 4 an element").own);
  EXPECT_TRUE(at(paths, "bspline3, 9 an element").own && at(strains, "bspline3, 9 an element").own);
  EXPECT_LT(at(paths, "bspline3, 4 an element").error, 0.3 * at(paths, "bilinear, 4 an element").error);
  EXPECT_LT(at(strains, "bspline3, 16 an element").error, 0.5 * at(strains, "bilinear, 16 an element").error);
  EXPECT_LT(at(strains, "bspline3, 16 an element").error, at(strains, "bspline3, 1 an element").error);
  for (const FrontierPoint& p : paths.points) EXPECT_TRUE(p.complete) << p.name;
  Followed noisy = clean;
  noisy.noise = 0.1;
  const std::vector<FrontierStage> worse = np_frontier(mine, noisy, 1, 1, silent);
  // Eight independent steps of .1 px in two components, averaged over the nodes of a point: between .5 and 1 of that.
  const double floor = 0.1 * std::sqrt(2.0 * clean.steps);
  EXPECT_GT(at(worse[0], "bilinear, 4 an element").error, 0.4 * floor);
  EXPECT_LT(at(worse[0], "bilinear, 4 an element").error, 1.1 * floor);
}

// The command without a case, every stage as small as it can be.
TEST(FrontierStages, AllInSmall) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "takes minutes where sanitizers are built in; its stages have tests of their own";
#endif
  test::Scratch scratch;
  RunSettings settings;
  settings.out = scratch.path / "out";
  settings.threads = 1;
  FrontierOptions options;
  options.repeats = 1;
  options.drawn_px = 160;
  options.column_cell_px = 20;
  const FrontierOutcome outcome = frontier(nullptr, options, settings, silent);
  std::vector<std::string> names;
  for (const FrontierStage& stage : outcome.stages) {
    names.push_back(stage.name);
    SCOPED_TRACE(stage.name);
    EXPECT_TRUE(std::any_of(stage.points.begin(), stage.points.end(), [](const FrontierPoint& p) { return p.on_front; }));
    EXPECT_EQ(std::count_if(stage.points.begin(), stage.points.end(), [](const FrontierPoint& p) { return p.standard; }), 1);
    for (const FrontierPoint& p : stage.points) {
      EXPECT_TRUE(std::isfinite(p.error) && p.error > 0) << p.name;
      EXPECT_GT(p.seconds, 0) << p.name;
      EXPECT_EQ(p.columns.size(), stage.columns.size()) << p.name;
      EXPECT_FALSE(p.elsewhere && p.on_front) << p.name;
      EXPECT_TRUE(p.elsewhere || std::isnan(p.bytes) || p.bytes >= 0) << p.name;
    }
    for (const char* end : {".csv", ".svg", ".png"}) EXPECT_GT(std::filesystem::file_size(settings.out / (stage.name + end)), 300u) << end;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"piv", "piv_spacing", "peers", "np", "np_strain", "drift", "vortex", "mpm", "chain"}));
  EXPECT_EQ(std::count_if(outcome.stages[2].points.begin(), outcome.stages[2].points.end(), [](const FrontierPoint& p) { return p.elsewhere; }), 8);
  // Direct correlation holds what summed increments let drift.
  const FrontierStage& drift = outcome.stages[5];
  EXPECT_TRUE(at(drift, "summed increments").standard);
  EXPECT_LT(at(drift, "summed increments").error, 1);
  EXPECT_LT(at(drift, "corrected every 10 frames").error, 0.8 * at(drift, "summed increments").error);
  // The vortex converges; bilinear functions do not get through it.
  const FrontierStage& vortex = outcome.stages[6];
  const auto standard = std::find_if(vortex.points.begin(), vortex.points.end(), [](const FrontierPoint& p) { return p.standard; });
  const auto of_cells = [&](double cell) {
    return std::find_if(vortex.points.begin(), vortex.points.end(), [&](const FrontierPoint& p) { return p.keys == standard->keys && p.columns[0] == cell; })->error;
  };
  EXPECT_GT(std::log2(of_cells(0.1) / of_cells(0.05)), 1.5);
  EXPECT_GT(std::log2(of_cells(0.05) / of_cells(0.025)), 1.5);
  for (const std::string& left : vortex.left_out) EXPECT_TRUE(left.starts_with("bilinear")) << left;
  // The whole chain: a verdict's numbers are right to a part of the motion.
  const FrontierStage& chain = outcome.stages.back();
  EXPECT_LT(at(chain, "default + default scheme").error, 40);
}

}  // namespace
}  // namespace pivnp::app
