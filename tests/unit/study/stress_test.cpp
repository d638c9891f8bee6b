// Survival maps: what is counted, that methods hold where they must and flag where they fail, and that a run goes on where it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <limits>

#include "apps/study/methods/frames/peak_locking.hpp"
#include "apps/study/methods/simulation/doubts.hpp"
#include "apps/study/stress/cells.hpp"
#include "apps/study/stress/compare/compare_maps.hpp"
#include "apps/study/stress/mpm/mpm_maps.hpp"
#include "apps/study/stress/np/np_maps.hpp"
#include "apps/study/stress/piv/piv_maps.hpp"
#include "apps/study/stress/stress.hpp"
#include "apps/study/stress/stress_pages.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/seeding.hpp"
#include "pivnp/image/files/write.hpp"
#include "pivnp/image/synthetic/synthetic_pair.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/silent.hpp"

namespace pivnp::app {
namespace {

// Those of a stage that are named, in their short form; none named: all.
std::vector<SurvivalMap> made(const std::vector<MapPlan>& plans, const std::vector<std::string>& names = {}) {
  std::vector<MapPlan> wanted;
  for (const MapPlan& plan : plans)
    if (names.empty() || std::find(names.begin(), names.end(), plan.map.name) != names.end()) wanted.push_back(thinned(plan));
  EXPECT_TRUE(names.empty() || wanted.size() == names.size());
  return filled(wanted, {}, 2, silent).maps;
}

const SurvivalMap& named(const std::vector<SurvivalMap>& maps, const std::string& name) {
  return *std::find_if(maps.begin(), maps.end(), [&](const SurvivalMap& map) { return map.name == name; });
}

Survival row_of(const SurvivalMap& map, std::size_t j) {
  Survival sum;
  for (std::size_t i = 0; i < map.x.size(); ++i) sum.add(map.at(i, j));
  return sum;
}

Survival column_of(const SurvivalMap& map, std::size_t i) {
  Survival sum;
  for (std::size_t j = 0; j < map.y.size(); ++j) sum.add(map.at(i, j));
  return sum;
}

TEST(Stress, TheDefaultFlagsWhatIsWrongOverAllMaps) {
  const std::vector<SurvivalMap> maps = made(piv_maps({}, 320, 1));
  Survival all;
  for (const SurvivalMap& map : maps) {
    ASSERT_EQ(map.cells.size(), map.x.size() * map.y.size());
    all.add(map.total());
    for (const Survival& s : map.cells) EXPECT_EQ(s.all(), map.cells.front().all()) << map.name;  // every vector is one of the four
  }
  EXPECT_GT(all.wrong_values, 400);
  EXPECT_GT(all.right_values, 10000);
  EXPECT_GT(all.wrong_flagged, 0.97 * all.wrong_values);
  EXPECT_LT(all.right_flagged, 0.05 * all.right_values);
  const SurvivalMap& gradient = maps.front();
  EXPECT_GT(gradient.at(0, 0).good, 0.99 * gradient.at(0, 0).all());  // .3 px, no gradient
  EXPECT_LT(gradient.cells.back().good, gradient.at(0, 0).good);      // 45 px and 40 %
  const SurvivalMap& jpeg = named(maps, "piv_jpeg_window");
  EXPECT_GT(jpeg.cells.back().good, 0.99 * jpeg.cells.back().all());  // quality 90, 64 px
  EXPECT_LT(jpeg.at(0, 0).good, 0.9 * jpeg.at(0, 0).all());           // quality 5, 16 px
}

TEST(Stress, FramesOfWhichBlocksAreLeftAreWarnedOf) {
  image::TextureOptions texture;
  texture.noise = 0.01;
  Setting setting;
  const auto blocks = [&](int quality) {
    const image::SyntheticPair pair = image::synthetic_pair(image::uniform(0, 0), 320, 320, texture);
    const Image frame = image::through_jpeg(pair.first.view(), quality);
    const std::vector<std::string> remarks = texture_remarks(setting, frame);
    return std::any_of(remarks.begin(), remarks.end(), [](const std::string& r) { return r.find("blocks of a strong compression") != std::string::npos; });
  };
  EXPECT_FALSE(blocks(5));  // strong texture outlives it
  texture.peak_min = 0.05, texture.peak_max = 0.12;
  EXPECT_FALSE(blocks(40));
  EXPECT_TRUE(blocks(5));
}

TEST(Stress, AMaskKeepsAWallOutOfVectors) {
  const std::vector<SurvivalMap> maps = made(piv_edge_maps({}, 1));
  EXPECT_EQ(named(maps, "piv_surface_shear").total().wrong, 0);
  EXPECT_GT(column_of(named(maps, "piv_wall_shear"), 0).wrong, 0);  // 1 px from it windows see both
  const Survival masked = named(maps, "piv_masked_wall_shear").total();
  EXPECT_EQ(masked.wrong, 0);
  EXPECT_GT(masked.good, 0.5 * masked.all());
}

TEST(Stress, AStepOverTheLimitStopsARunOrIsSeen) {
  const std::vector<SurvivalMap> maps = made(mpm_maps(), {"mpm_step", "mpm_points"});
  const SurvivalMap& step = maps.front();
  EXPECT_EQ(column_of(step, 0).wrong + column_of(step, 0).flagged, 0);    // .3 of the critical step
  EXPECT_GE(column_of(step, step.x.size() - 1).flagged, 2);              // one and a half times it
  for (const SurvivalMap& map : maps) EXPECT_LE(map.total().wrong, 0.1 * map.total().all()) << map.name << ": " << csv(map);
}

TEST(Stress, FlightIsExactWithoutTurningAndSliversAreHarmless) {
  const std::vector<SurvivalMap> maps = made(mpm_maps(), {"mpm_flight", "mpm_sliver"});
  const SurvivalMap& flight = named(maps, "mpm_flight");
  EXPECT_EQ(column_of(flight, 0).good, double(flight.y.size()));
  const SurvivalMap& sliver = named(maps, "mpm_sliver");
  EXPECT_EQ(sliver.total().wrong, 0) << csv(sliver);
  EXPECT_GE(row_of(sliver, sliver.y.size() - 1).good, double(sliver.x.size()) - 1) << csv(sliver);  // the default
}

std::vector<std::string> doubts_of(const std::vector<mpm::MaterialOptions>& materials, double thickness = 1) {
  mpm::Scene scene;
  scene.grid = {{0, 0}, {0.1, 0.1}, 21, 13};
  std::vector<Region> layers;
  for (std::size_t k = 0; k < materials.size(); ++k)
    layers.push_back({"layer " + std::to_string(k), Polygon({{0.2, thickness * double(k)}, {1.8, thickness * double(k)}, {1.8, thickness * double(k + 1)}, {0.2, thickness * double(k + 1)}}, "layer")});
  scene.particles = seed(scene.grid, layers, 4, SeedPattern::even, 0, "per_element");
  scene.materials = materials;
  return doubts({}, scene);
}

TEST(Stress, SofteningByTheCellsGreatContrastsAndThinLayersAreDoubted) {
  mpm::MaterialOptions soil;
  soil.young_pa = 1e6;
  soil.friction_deg = 30;
  EXPECT_TRUE(doubts_of({soil}).empty());
  mpm::MaterialOptions stiff = soil;
  stiff.young_pa = 99e6;
  EXPECT_TRUE(doubts_of({soil, stiff}, 0.5).empty());
  stiff.young_pa = 1e8;
  EXPECT_EQ(doubts_of({soil, stiff}, 0.5).size(), 1u);
  mpm::MaterialOptions softening = soil;
  softening.softening_shape = 10;
  softening.cohesion_residual_pa = 0;
  EXPECT_EQ(doubts_of({softening}).size(), 1u);
  softening.softening_length_m = 0.1;
  EXPECT_TRUE(doubts_of({softening}).empty());
  EXPECT_EQ(doubts_of({soil}, 0.2).size(), 1u);        // two cells
  EXPECT_TRUE(doubts_of({soil}, 0.3).empty());         // three
  EXPECT_TRUE(doubts_of({soil, soil}, 0.2).empty());   // two layers of two, one on the other
  mpm::MaterialOptions elastic = soil;
  elastic.friction_deg = 0;
  EXPECT_TRUE(doubts_of({elastic}, 0.2).empty());      // nothing rubs
}

TEST(Stress, SoilThatDrainsLessDeepThanACellIsDoubted) {
  mpm::Scene scene;
  scene.grid = {{0, 0}, {0.25, 0.25}, 5, 9};
  scene.particles.label_names = {"silt"};
  mpm::MaterialOptions silt;
  silt.young_pa = 4e6;
  silt.poisson = 0;
  silt.porosity = 0.45;
  silt.permeability_m_s = 3e-9;  // c_v 1.2e-6 m^2/s: a cell in 5.1e4 s
  scene.materials = {silt};
  scene.water.emplace();
  mpm::MpmOptions options;
  options.end_s = 4e4;
  EXPECT_TRUE(doubts(options, scene).empty());  // nothing drains it
  mpm::BoundaryOptions top;
  top.drained = true;
  scene.boundaries = {{"top", top}};
  ASSERT_EQ(doubts(options, scene).size(), 1u);
  EXPECT_NE(doubts(options, scene).front().find("material.silt"), std::string::npos);
  options.end_s = 6e4;
  EXPECT_TRUE(doubts(options, scene).empty());
}

TEST(Stress, WallsBetweenLinesOfNodesAreDoubted) {
  mpm::Scene scene;
  scene.grid = {{-0.1, 0.3}, {0.2, 0.1}, 8, 9};
  const auto wall = [](double x0, double y0, double x1, double y1, mpm::BoundaryType type) {
    mpm::BoundaryOptions b;
    b.line_m = {{x0, y0}, {x1, y1}};
    b.type = type;
    return b;
  };
  scene.boundaries = {{"side", wall(0.3, 0.3, 0.3, 0.9, mpm::BoundaryType::roller)},
                      {"slope", wall(0.1, 0.33, 0.9, 0.5, mpm::BoundaryType::fixed)},
                      {"load", wall(0.1, 0.66, 0.9, 0.66, mpm::BoundaryType::traction)}};
  EXPECT_TRUE(doubts({}, scene).empty());
  scene.boundaries.emplace_back("base", wall(-0.1, 0.37, 1.1, 0.37, mpm::BoundaryType::frictional));
  EXPECT_TRUE(doubts({}, scene).empty());  // its nodes are moved onto it
  const std::string said = "boundary.base lies 0.3 of a cell beside";
  mpm::MpmOptions bilinear;
  bilinear.shape = mpm::ShapeKind::bilinear;
  ASSERT_EQ(doubts(bilinear, scene).size(), 1u);
  EXPECT_EQ(doubts(bilinear, scene).front().find(said), 0u) << doubts(bilinear, scene).front();
  scene.water.emplace();
  scene.materials.emplace_back().porosity = 0.4;
  ASSERT_EQ(doubts({}, scene).size(), 1u);
  EXPECT_EQ(doubts({}, scene).front().find(said), 0u) << doubts({}, scene).front();
  scene.materials.back().drained = true;
  EXPECT_TRUE(doubts({}, scene).empty());
}

// The stated error of summed vectors is as large as they are off, whether errors are new in each pair or the same.
TEST(Stress, ParticlesStateTheirDrift) {
  const std::vector<SurvivalMap> maps = made(np_maps({}), {"np_drift_noise", "np_drift_repeated"});
  for (const SurvivalMap& map : maps) {
    const Survival s = map.total();
    EXPECT_GT(s.wrong_values, 500) << map.name;
    EXPECT_GE(s.wrong_flagged, 0.97 * s.wrong_values) << map.name;
    EXPECT_LE(s.right_flagged, 0.05 * s.right_values) << map.name;
  }
}

TEST(Stress, ParticlesAtHolesMasksAndEdges) {
  const std::vector<SurvivalMap> maps = made(np_maps({}), {"np_hole", "np_fold", "np_leave", "np_masked", "np_births"});
  for (const SurvivalMap& map : maps)
    for (const Survival& s : map.cells) EXPECT_LE(s.right_flagged + s.good + s.fair + s.wrong, s.all()) << map.name;
  const SurvivalMap& hole = named(maps, "np_hole");
  EXPECT_EQ(hole.at(0, 0).flagged, 0);                                   // no hole, no strain
  EXPECT_GT(column_of(hole, hole.x.size() - 1).flagged, 0.1 * column_of(hole, hole.x.size() - 1).all());
  const SurvivalMap& fold = named(maps, "np_fold");
  for (std::size_t j = 1; j < fold.y.size(); ++j) EXPECT_GT(fold.at(fold.x.size() - 1, j).flagged, 0.2 * fold.at(fold.x.size() - 1, j).all()) << j;  // gradient 2: what passes through itself
  const SurvivalMap& leave = named(maps, "np_leave");
  EXPECT_EQ(leave.at(leave.x.size() - 1, leave.y.size() - 1).good, 0);   // 80 elements on
  EXPECT_EQ(leave.total().wrong, 0);
  EXPECT_GT(row_of(named(maps, "np_births"), 0).good, 0.88 * (row_of(named(maps, "np_births"), 0).all() - row_of(named(maps, "np_births"), 0).flagged));  // (splines average the nodes' noise less than bilinear functions do)
}

TEST(Stress, VerdictsHoldWhereErrorsAreAsStated) {
  const std::vector<SurvivalMap> maps = made(compare_maps());
  const SurvivalMap& noise = named(maps, "compare_noise");
  EXPECT_EQ(noise.at(0, 0).good, noise.at(0, 0).all());  // a tenth of what is stated, no difference
  const auto stated = std::size_t(std::find(noise.x.levels.begin(), noise.x.levels.end(), 4) - noise.x.levels.begin());
  EXPECT_GT(noise.at(stated, 0).flagged, 0.5 * noise.at(stated, 0).all());  // four times what is stated: remarked on, from what rests
  EXPECT_EQ(noise.at(0, noise.y.size() - 1).good, noise.at(0, 0).all());  // ten u_val: never missed
  const SurvivalMap& overlap = named(maps, "compare_overlap");
  EXPECT_EQ(column_of(overlap, 0).flagged, column_of(overlap, 0).all());
  EXPECT_EQ(overlap.total().wrong, 0) << csv(overlap);
  const SurvivalMap& offset = named(maps, "compare_offset");
  EXPECT_GT(row_of(offset, 0).wrong, 0);                               // clocks that are not brought together
  EXPECT_LE(row_of(offset, 2).wrong, 0.15 * row_of(offset, 2).all()) << csv(offset);  // and those that are (the onset's own error is not in u_val)
  EXPECT_EQ(row_of(offset, 3).wrong, 0) << csv(offset);
}

MapPlan counting_plan(std::atomic<int>& made_now, int fails_at = -1) {
  MapPlan plan;
  plan.map.name = "piv_counted";
  plan.map.x = {"x", {1, 2, 3, 4}, {}};
  plan.map.y = {"y", {}, {"a", "b", "c"}};
  plan.result = [&made_now, fails_at](std::size_t i, std::size_t j, Progress&) {
    if (made_now++ == fails_at) throw Interrupted();
    Survival s;
    s.good = 1 + double(i) / 3, s.wrong_values = double(j);
    return s;
  };
  return plan;
}

TEST(Stress, AStoppedRunGoesOnWithWhatItHad) {
  const test::Scratch scratch;
  const std::filesystem::path kept = scratch.path / "part";
  std::atomic<int> count = 0;
  EXPECT_THROW(filled({counting_plan(count, 5)}, kept, 1, silent), Interrupted);
  {
    std::ofstream torn(kept, std::ios::app);  // as a killed run leaves it
    torn << "0123456789abcdef 1 0 0";
  }
  count = 0;
  const FilledMaps second = filled({counting_plan(count)}, kept, 2, silent);
  EXPECT_EQ(second.kept, 5u);
  EXPECT_EQ(count, 7);
  std::atomic<int> whole = 0;
  EXPECT_EQ(csv(second.maps[0]), csv(filled({counting_plan(whole)}, {}, 1, silent).maps[0]));
  count = 0;
  MapPlan other = counting_plan(count);
  other.settings = "window_px = 24";
  EXPECT_EQ(filled({other}, kept, 1, silent).kept, 0u);  // other settings: none of it counts
}

TEST(Stress, AShortFormIsPartOfTheWhole) {
  std::atomic<int> count = 0;
  const MapPlan plan = counting_plan(count), part = thinned(plan);
  EXPECT_EQ(part.map.x.levels, (std::vector<double>{1, 3, 4}));
  EXPECT_EQ(part.map.y.names, plan.map.y.names);
  EXPECT_EQ(part.result(2, 1, silent).good, plan.result(3, 1, silent).good);
}

// A simulation, too, ends where it is asked to stop.
TEST(Stress, AStopIsHeardWithinACombination) {
  class Stopping final : public Progress {
   public:
    void update(std::string_view, std::int64_t, std::int64_t) override {}
    bool stop_requested() const override { return true; }
  } stopping;
  for (const MapPlan& plan : mpm_maps()) EXPECT_THROW(plan.result(0, 0, stopping), Interrupted) << plan.map.name;
  for (const MapPlan& plan : np_maps({})) EXPECT_THROW(plan.result(0, 0, stopping), Interrupted) << plan.map.name;
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
  EXPECT_EQ(std::count_if(document.blocks.begin(), document.blocks.end(), [](const auto& b) { return std::holds_alternative<report::Figure>(b); }), 3);  // and all at a glance
  EXPECT_EQ(flags_sentence(map.total()), "of what is wrong, 50 % is flagged; of what is right, 0 % is flagged.");
}

TEST(Stress, CountsOneResult) {
  const Bounds bounds{0.1, 0.5};
  Survival s;
  s.count(0.05, bounds, true);
  s.count(0.05, bounds, false);
  s.count(0.3, bounds, true);
  s.count(0.7, bounds, true);
  s.count(std::numeric_limits<double>::quiet_NaN(), bounds, false);
  s.count_none();
  EXPECT_EQ(s.good, 1);
  EXPECT_EQ(s.fair, 1);
  EXPECT_EQ(s.wrong, 1);
  EXPECT_EQ(s.flagged, 3);
  EXPECT_EQ(s.right_values, 2);
  EXPECT_EQ(s.right_flagged, 1);
  EXPECT_EQ(s.wrong_values, 2);
  EXPECT_EQ(s.wrong_flagged, 1);
}

}  // namespace
}  // namespace pivnp::app
