// Survival maps: what is counted, and that methods hold where they must and flag where they fail.
#include <gtest/gtest.h>

#include <algorithm>

#include "apps/study/stress/mpm_stress.hpp"
#include "apps/study/stress/piv_stress.hpp"
#include "apps/study/stress/stress.hpp"
#include "apps/study/stress/stress_pages.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/silent.hpp"

namespace pivnp::app {
namespace {

TEST(Stress, TheDefaultFlagsWhatIsWrongOverAllMaps) {
  const std::vector<SurvivalMap> maps = piv_stress({}, 320, 1, 1, silent);
  Survival all;
  for (const SurvivalMap& map : maps) {
    ASSERT_EQ(map.cells.size(), map.x.size() * map.y.size());
    all.add(map.total());
    for (const Survival& s : map.cells) EXPECT_EQ(s.all(), map.cells.front().all()) << map.name;  // every vector is one of the four
  }
  // In small; the whole is held by `piv_table --map` and by hand (docs/stress.md).
  EXPECT_GT(all.wrong_flagged, 0.97 * all.wrong_values);
  EXPECT_LT(all.right_flagged, 0.05 * all.right_values);
  const SurvivalMap& gradient = maps.front();
  EXPECT_GT(gradient.at(0, 0).good, 0.99 * gradient.at(0, 0).all());  // .3 px, no gradient
  EXPECT_LT(gradient.at(6, 6).good, gradient.at(0, 0).good);          // 45 px and 40 %
}

TEST(Stress, AStepOverTheLimitStopsARunOrIsSeen) {
  const std::vector<SurvivalMap> maps = mpm_stress(1, silent);
  const SurvivalMap& step = maps.front();
  const std::size_t small = 1, over = step.x.size() - 1;
  for (std::size_t j = 0; j < step.y.size(); ++j) EXPECT_EQ(step.at(small, j).wrong + step.at(small, j).flagged, 0) << step.y.names[j];
  Survival beyond;
  for (std::size_t j = 0; j < step.y.size(); ++j) beyond.add(step.at(over, j));
  EXPECT_GE(beyond.flagged, 2);  // one and a half times the critical step
  for (const SurvivalMap& map : maps)
    EXPECT_LE(map.total().wrong, 0.1 * map.total().all()) << map.name << ": " << csv(map);
}

TEST(Stress, PagesHoldEveryMap) {
  SurvivalMap map;
  map.name = "piv_map";
  map.title = "A map";
  map.x = {"noise", {0.1, 0.2}, {}};
  map.y = {"scheme", {}, {"one", "two"}};
  map.cells = {{1, 0, 0, 0, 0, 1, 0, 0}, {0, 1, 0, 0, 0, 0, 0, 0}, {0, 0, 1, 0, 1, 0, 1, 0}, {0, 0, 0, 1, 1, 0, 0, 0}};
  EXPECT_EQ(csv(map), "\"noise\",\"scheme\",good,fair,flagged,wrong,wrong_values,wrong_flagged,right_values,right_flagged\n"
                      "0.1,\"one\",1,0,0,0,0,0,1,0\n0.2,\"one\",0,1,0,0,0,0,0,0\n"
                      "0.1,\"two\",0,0,1,0,1,1,0,0\n0.2,\"two\",0,0,0,1,1,0,0,0\n");
  const report::Document document = stress_document({map, map}, "a subject");
  EXPECT_EQ(std::count_if(document.blocks.begin(), document.blocks.end(), [](const auto& b) { return std::holds_alternative<report::Figure>(b); }), 2);
  EXPECT_EQ(flags_sentence(map.total()), "of what is wrong, 50 % is flagged; of what is right, 0 % is flagged.");
}

}  // namespace
}  // namespace pivnp::app
