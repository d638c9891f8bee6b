// A law that is added from outside goes through the whole chain: its name, keys and rules in the case, its history in
// the record, in computed fields and in the report.
#include "tests/unit/mpm/material/own_law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "apps/case/listing.hpp"
#include "apps/report/words/words.hpp"
#include "apps/study/study.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {
namespace {

const mpm::test::OwnLawListed listed;  // before any case is read

std::string case_of(const std::string& constants) {
  return R"(
[grid]
spacing_m = 0.02
area_m = [[0.0, 0.0], [0.4, 0.3]]
[region.block]
polygon_m = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.2], [0.0, 0.2]]
[material.block]
model = "of_a_test"
density_kg_m3 = 1000.0
young_pa = 1e5
)" + constants + R"(
[mpm]
end_s = 0.02
output_rate_hz = 100.0
initial_equilibrium = false
[boundary.base]
line_m = [[0.0, 0.0], [0.4, 0.0]]
[report]
fields = ["volume_of_test"]
[output]
fields = ["volume_of_test"]
)";
}

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(OwnLaw, IsListedWithItsKeyAndFaultsHaveTheirPlace) {
  bool model = false, key = false;
  for (const SectionRow& section : case_sections())
    for (const KeyRow& row : section.keys) {
      if (section.path != "material") continue;
      model = model || (row.key == "model" && row.allowed.find("of_a_test") != std::string::npos);
      key = key || row.key == "scale_of_test";
    }
  EXPECT_TRUE(model);
  EXPECT_TRUE(key);
  const auto message = [](const std::string& constants) -> std::string {
    try {
      parse_case(case_of(constants), "case.toml", ".");
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message("scale_of_test = 2.0"), "");
  EXPECT_TRUE(message("").starts_with("case.toml:7: material.block.scale_of_test")) << message("");
  EXPECT_TRUE(message("scale_of_test = 11").starts_with("case.toml:11: material.block.scale_of_test"));
  EXPECT_TRUE(message("friction_deg = 30.0\nscale_of_test = 1.0").starts_with("case.toml:12: material.block.scale_of_test"));
  const Case c = parse_case(case_of("scale_of_test = 2.0"), "case.toml", ".");
  const Case again = parse_case(write_case(c), "again.toml", ".");
  EXPECT_EQ(again.materials.front().second.own_value("scale_of_test"), 2.0);
}

TEST(OwnLaw, ItsHistoryIsInTheRecordAndTheReport) {
  test::Scratch scratch;
  RunSettings settings;
  settings.out = scratch.path;
  settings.threads = 1;
  SilentProgress silent;
  run_case(parse_case(case_of("scale_of_test = 2.0"), "case.toml", "."), settings, Stages::simulate, silent);
  const io::RecordReader record(scratch.path / "record.h5");
  const auto motion = record.motion("mpm");
  const MotionFrame last = motion->frame(motion->times().size() - 1);
  double most = 0;
  for (std::size_t p = 0; p < motion->particles().size(); ++p)
    most = std::max(most, std::abs(double(last.field("volume_of_test")(p))));
  EXPECT_GT(most, 0);
  EXPECT_NE(last.find("strained_of_test"), nullptr);
  EXPECT_EQ(last.find("axes_of_test"), nullptr);
  DerivedReader derived(*motion, true);
  EXPECT_NEAR(derived.values("volume_of_test", motion->times().size() - 1)[0], double(last.field("volume_of_test")(0)), 1e-12);
  EXPECT_EQ(report::field_words("volume_of_test"), "remembered volume");
  EXPECT_TRUE(std::filesystem::exists(scratch.path / "figures" / "volume_of_test.png"));
  EXPECT_NE(read(scratch.path / "report.html").find("emembered volume"), std::string::npos);
}

// What is taken out by the case is told in the record's ends, in the remarks and in the report.
TEST(Excavation, GoesThroughTheWholeChain) {
  test::Scratch scratch;
  RunSettings settings;
  settings.out = scratch.path;
  settings.threads = 1;
  SilentProgress silent;
  const Case c = parse_case(R"(
[grid]
spacing_m = 0.02
area_m = [[0.0, 0.0], [0.4, 0.2]]
[region.bank]
polygon_m = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.0, 0.1]]
material = "sand"
[region.dug]
polygon_m = [[0.2, 0.0], [0.3, 0.0], [0.3, 0.1], [0.2, 0.1]]
[material.sand]
model = "mohr_coulomb"
density_kg_m3 = 1600.0
young_pa = 1e6
friction_deg = 35.0
[material.dug]
model = "mohr_coulomb"
density_kg_m3 = 1600.0
young_pa = 1e6
friction_deg = 35.0
removed_s = 0.02
[mpm]
end_s = 0.05
output_rate_hz = 100.0
initial_equilibrium = false
k0 = 0.4
[boundary.base]
line_m = [[0.0, 0.0], [0.4, 0.0]]
[boundary.left]
line_m = [[0.0, 0.0], [0.0, 0.2]]
type = "roller"
)",
                            "case.toml", ".");
  const RunOutcome outcome = run_case(c, settings, Stages::simulate, silent);
  const auto motion = io::RecordReader(outcome.record).motion("mpm");
  const ParticleSet& set = motion->particles();
  std::size_t removed = 0;
  for (std::size_t p = 0; p < set.size(); ++p) {
    const bool dug = set.label_names[std::size_t(set.label[p])] == "dug";
    removed += dug;
    EXPECT_EQ(set.end_reason[p], dug ? EndReason::removed : EndReason::none) << p;
    if (dug) {
      EXPECT_NEAR(set.end[p], 0.02, 0.005);
    }
  }
  EXPECT_EQ(removed, 100u);
  EXPECT_TRUE(std::any_of(outcome.remarks.begin(), outcome.remarks.end(),
                          [](const Remark& r) { return r.text.find(words(EndReason::removed)) != std::string::npos; }));
  EXPECT_NE(read(scratch.path / "report.html").find(words(EndReason::removed)), std::string::npos);
  EXPECT_NO_THROW(report_record(outcome.record, settings, silent));
}

}  // namespace
}  // namespace pivnp::app
