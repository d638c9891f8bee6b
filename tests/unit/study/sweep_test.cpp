// What a sweep consists of, and what is read off its runs.
#include "apps/study/sweep/sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "apps/plot/canvas.hpp"
#include "apps/plot/painter.hpp"
#include "apps/study/sweep/plan.hpp"
#include "apps/study/sweep/sweep_charts.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {

namespace sweep_test {

using testing::ElementsAre;
using testing::HasSubstr;

// A block on two rollers that falls freely for a tenth of a second.
constexpr const char* falling = R"(
[grid]
spacing_m = 0.1
area_m = [[0.0, 0.0], [0.6, 1.0]]
[region.block]
polygon_m = [[0.2, 0.6], [0.4, 0.6], [0.4, 0.8], [0.2, 0.8]]
[material.block]
model = "linear_elastic"
density_kg_m3 = 1000.0
young_pa = 1e5
[mpm]
initial_equilibrium = false
gravity_m_s2 = [0.0, -5.0]
courant = 0.05
end_s = 0.1
output_rate_hz = 50.0
)";

std::string refused(const std::string& text) {
  try {
    parse_variation(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SweepPlan, ReadsKeysAndValues) {
  const Variation v = parse_variation("water.level_history+water.other=[[0, 1], [2, 3]], \"a,b\",4");
  EXPECT_THAT(v.keys, ElementsAre("water.level_history", "water.other"));
  EXPECT_THAT(v.values, ElementsAre("[[0, 1], [2, 3]]", "\"a,b\"", "4"));
  EXPECT_THAT(refused("material.soil.friction_deg"), HasSubstr("no '='"));
  EXPECT_THAT(refused("friction=3"), HasSubstr("no key of a section"));
  EXPECT_THAT(refused("mpm.damping=1,,2"), HasSubstr("empty value"));
}

TEST(SweepPlan, VariesOneKeyAtATimeOrAll) {
  std::vector<Variation> two = {parse_variation("a.x=1,2.0,3"), parse_variation("b.y=5,6")};
  two[0].own = "2";
  const std::vector<SweepRun> single = plan_sweep(two, false), all = plan_sweep(two, true);
  ASSERT_EQ(single.size(), 5u);  // the case itself, 1 and 3, 5 and 6
  EXPECT_EQ(single[0].label, "the case");
  EXPECT_THAT(keys_of(single[2], two), ElementsAre("a.x=3"));
  ASSERT_EQ(all.size(), 6u);
  EXPECT_THAT(keys_of(all[5], two), ElementsAre("a.x=3", "b.y=6"));
}

TEST(SweepPlan, KnowsTheCasesOwnValues) {
  const Case c = parse_case(falling, "case", ".");
  EXPECT_EQ(std::stod(value_in(c, "material.block.young_pa")), 1e5);
  EXPECT_EQ(value_in(c, "mpm.damping"), "");
}

TEST(SweepCharts, OrderKeysByTheirEffect) {
  std::vector<Variation> two = {parse_variation("a.x=1,3"), parse_variation("b.y=5,6")};
  std::vector<SweepRun> runs = plan_sweep(two, false);
  const double values[] = {10, 9, 12, 20, std::nan("")};  // the case, a.x = 1, 3, b.y = 5, 6
  for (std::size_t k = 0; k < runs.size(); ++k) runs[k].responses = {values[k]};
  const std::vector<Swing> s = swings(0, two, runs);
  ASSERT_EQ(s.size(), 2u);
  EXPECT_EQ(s[0].key, "b.y");
  EXPECT_EQ(s[0].upper, 20);
  EXPECT_EQ(s[0].lower, 10);
  EXPECT_EQ(s[1].least, "1");
  EXPECT_EQ(s[1].most, "3");
}

TEST(SweepCharts, LeaveRoomForTheValuesAtTheEnds) {
  plot::start_qt();
  const std::string words = "… , [27.0, 120.0]]";
  const std::vector<Swing> bars = {{"a", "1", "2", 10, 14, 10}, {"b", words, "3", 9, 10.5, 10}};
  constexpr double width_mm = 100;
  const auto [lower, upper] = tornado_span(bars, width_mm);
  EXPECT_GT((9 - lower) / (upper - lower) * width_mm, plot::text_width(words, plot::small_text) + 1);
  EXPECT_GT((upper - 14) / (upper - lower) * width_mm, plot::text_width("2", plot::small_text) + 1);
  EXPECT_LT(upper - lower, 2 * (14 - 9));
}

#ifdef PIVNP_PROGRAM
TEST(Sweep, RunsItsCasesAndKeepsThem) {
  const test::Scratch folder;
  std::ofstream(folder.path / "case.toml") << falling;
  const Case c = read_case(folder.path / "case.toml");
  SweepOptions options;
  options.program = PIVNP_PROGRAM;
  options.vary = {"mpm.gravity_m_s2=[0.0, -10.0],[0.0, -20.0]", "material.block.young_pa=2e5"};
  options.responses = {"top_speed", "displacement", "failure_time", "difference.displacement_rms"};
  {  // a block that falls as under 5.5 m/s^2, known to 0.1 mm
    std::ofstream tracks(folder.path / "lab.csv");
    tracks << "time,id,x,y\n";
    for (int k = 0; k <= 5; ++k)
      for (int p = 0; p < 64; ++p)
        tracks << 0.02 * k << "," << p << "," << 0.2 + 0.025 * (p % 8 + 0.5) << "," << 0.6 + 0.025 * (p / 8 + 0.5) - 2.75 * std::pow(0.02 * k, 2) << "\n";
  }
  options.against = "csv=" + (folder.path / "lab.csv").string();
  options.given = {"compare.measurement_uncertainty_m=1e-4"};
  RunSettings settings;
  settings.out = folder.path / "out";
  settings.threads = 2;
  SilentProgress progress;
  const SweepOutcome first = sweep(c, options, settings, progress);
  ASSERT_EQ(first.runs.size(), 4u);
  EXPECT_NEAR(first.runs[0].responses[0], 0.5, 0.01);  // g t
  EXPECT_NEAR(first.runs[1].responses[0], 1.0, 0.02);
  EXPECT_NEAR(first.runs[0].responses[1], 0.025, 0.001);  // g t^2/2
  EXPECT_TRUE(std::isnan(first.runs[0].responses[2]));
  EXPECT_NEAR(first.runs[3].responses[0], 0.5, 0.01);
  // Half of (g - 5.5 m/s^2) t^2: 2.5 mm at the end for 5 m/s^2, 22.5 for 10.
  EXPECT_GT(first.runs[0].responses[3], 0.5e-3);
  EXPECT_LT(first.runs[0].responses[3], 2.6e-3);
  EXPECT_NEAR(first.runs[1].responses[3] / first.runs[0].responses[3], 9, 0.5);
  EXPECT_GT(first.runs[0].uncertainties[3], 0);
  EXPECT_LT(first.runs[0].uncertainties[3], 1e-3);
  EXPECT_TRUE(std::isnan(first.runs[0].uncertainties[0]));
  std::ifstream csv(settings.out / "sweep.csv");
  std::string head;
  std::getline(csv, head);
  EXPECT_THAT(head, HasSubstr(",failure_time (s),difference.displacement_rms (m),sigma_difference.displacement_rms (m),folder"));
  for (const char* name : {"sweep.html", "sweep.pdf", "sweep.csv", "sweep.h5", "tornado_top_speed.svg", "tornado_top_speed.png"})
    EXPECT_TRUE(std::filesystem::exists(settings.out / name)) << name;
  options.grid = true;  // of which all values but one were run already
  options.vary = {"mpm.gravity_m_s2=[0.0, -10.0]", "material.block.young_pa=1e5,2e5"};
  const SweepOutcome all = sweep(c, options, settings, progress);
  ASSERT_EQ(all.runs.size(), 2u);
  EXPECT_TRUE(all.runs[0].kept);
  EXPECT_EQ(all.runs[0].responses[0], first.runs[1].responses[0]);
  EXPECT_TRUE(std::filesystem::exists(settings.out / "top_speed_over_material_block_young_pa.svg"));
  options.grid = false;
  options.vary = {"mpm.gravity_m_s2=[0.0, -10.0],[0.0, -20.0]", "material.block.young_pa=2e5"};
  const SweepOutcome again = sweep(c, options, settings, progress);
  for (std::size_t k = 0; k < again.runs.size(); ++k) {
    EXPECT_EQ(again.runs[k].kept, again.runs[k].failure.empty());
    if (first.runs[k].failure.empty()) { EXPECT_EQ(again.runs[k].responses[0], first.runs[k].responses[0]); }
  }
}
#endif

TEST(Sweep, RefusesWhatItCannotDo) {
  const test::Scratch folder;
  std::ofstream(folder.path / "case.toml") << falling;
  const Case c = read_case(folder.path / "case.toml");
  const auto told = [&](auto&& change) {
    SweepOptions options;
    options.vary = {"mpm.damping=0.1"};
    change(options);
    RunSettings settings;
    settings.out = folder.path / "out";
    SilentProgress progress;
    try {
      sweep(c, options, settings, progress);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(told([](SweepOptions& o) { o.vary.clear(); }), HasSubstr("--vary: missing"));
  EXPECT_THAT(told([](SweepOptions& o) { o.vary = {"mpm.dampling=0.1"}; }), HasSubstr("did you mean 'damping'"));
  EXPECT_THAT(told([](SweepOptions& o) { o.responses = {"top_sped"}; }), HasSubstr("did you mean 'top_speed'"));
  EXPECT_THAT(told([](SweepOptions& o) { o.fields = {"pressur"}; }), HasSubstr("pressure"));
  EXPECT_THAT(told([](SweepOptions& o) { o.responses = {"difference.displacement_rsm"}; }), HasSubstr("did you mean 'difference.displacement_rms'"));
  EXPECT_THAT(told([](SweepOptions& o) { o.responses = {"difference.displacement_rms"}; }), HasSubstr("expected --against RECORD[:MOTION]"));
  EXPECT_THAT(told([](SweepOptions& o) { o.against = "nothing.h5:np"; }), HasSubstr("nothing.h5"));
  EXPECT_THAT(told([](SweepOptions& o) { o.zone_m = {1, 0, 0, 1}; }), HasSubstr("--zone"));
}

}  // namespace sweep_test

}  // namespace pivnp::app
