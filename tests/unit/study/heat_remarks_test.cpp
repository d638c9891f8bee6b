// What a simulation finds outside the equations of heat is told at its end, in its report, and in one made anew of its record.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "apps/study/pipeline/record/remarks.hpp"
#include "apps/study/study.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {
namespace {

constexpr const char* boiling = R"(
[grid]
spacing_m = 0.02
area_m = [[0.0, 0.0], [0.2, 0.2]]
[region.block]
polygon_m = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]]
[material.block]
model = "linear_elastic"
density_kg_m3 = 1000.0
young_pa = 1e5
grain_specific_heat_j_kg_k = 800.0
conductivity_w_m_k = 1.0
[heat]
initial_c = 150.0
[mpm]
end_s = 0.02
output_rate_hz = 100.0
initial_equilibrium = false
[boundary.base]
line_m = [[0.0, 0.0], [0.2, 0.0]]
)";

MotionFrame with_limits(double time, std::vector<float> codes) {
  MotionFrame frame;
  frame.time = time;
  frame.u.assign(codes.size(), {0, 0});
  frame.F.assign(codes.size(), {1, 0, 0, 1});
  frame.status.assign(codes.size(), ParticleStatus::active);
  std::copy(codes.begin(), codes.end(), frame.add("heat_limit", codes.size()).begin());
  return frame;
}

std::size_t told(const std::vector<Remark>& remarks, const std::string& part) {
  return std::size_t(std::count_if(remarks.begin(), remarks.end(), [&](const Remark& r) { return r.text.find(part) != std::string::npos; }));
}

std::vector<Remark> remarks_on_energy(std::vector<EnergyRow> rows, bool damped) {
  RecordSeen seen;
  seen.energy = std::move(rows), seen.damped = damped;
  return remarks_of(seen);
}

std::vector<Remark> remarks_on_heat(const MotionSource& motion) {
  RecordSeen seen;
  seen.motions = {seen_in(motion)};
  return remarks_of(seen);
}

// What a swing has at its end does not count, what it was given at most does; damping that was asked for is no loss.
TEST(EnergyRemarks, SayWhatTheSchemeTook) {
  std::vector<EnergyRow> rows(3);
  rows[0].kinetic = 2;
  rows[1].external = 8;
  rows[2].external = 0.5;
  rows[2].damping = 0.6;
  rows[2].residual = -0.3;
  EXPECT_TRUE(remarks_on_energy(rows, false).empty());  // 0.9 of 10
  rows[2].residual = -1.4;
  ASSERT_EQ(told(remarks_on_energy(rows, false), "has lost 20 % of the energy supplied"), 1u);
  EXPECT_EQ(told(remarks_on_energy(rows, true), "has lost 14 %"), 1u);
  rows[2].residual = 3.6;
  EXPECT_EQ(told(remarks_on_energy(rows, false), "has gained 30 %"), 1u);
  rows[2].damping = 3.5;  // taken out and counted, though it was not
  EXPECT_TRUE(remarks_on_energy(rows, false).empty());
  EXPECT_TRUE(remarks_on_energy({}, false).empty());
}

TEST(HeatRemarks, CountTheWorstState) {
  ParticleSet set;
  for (int k = 0; k < 4; ++k) {
    set.id.push_back(k);
    set.label.push_back(0);
    set.x0.emplace_back(k, 0);
    set.area.push_back(1);
  }
  MotionMemory motion("mpm", "m", "s", set);
  motion.add(with_limits(0, {0, 0, 0, 0}));
  EXPECT_TRUE(remarks_on_heat(motion).empty());
  motion.add(with_limits(1, {1, 3, 2, 0}));
  motion.add(with_limits(2, {1, 1, 1, 0}));
  const std::vector<Remark> remarks = remarks_on_heat(motion);
  EXPECT_EQ(remarks.size(), 2u);
  EXPECT_EQ(told(remarks, "Up to 3 particles are hotter than 100 C"), 1u);
  EXPECT_EQ(told(remarks, "Up to 2 particles have a water pressure"), 1u);
}

TEST(HeatRemarks, AreInTheReport) {
  test::Scratch scratch;
  SilentProgress silent;
  RunSettings settings;
  settings.out = scratch.path / "out";
  settings.threads = 1;
  const std::string words = "Up to 100 particles are hotter than 100 C";
  const auto read = [](const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  };
  const Case c = parse_case(boiling, "case.toml", scratch.path);
  const RunOutcome first = run_case(c, settings, Stages::simulate, silent);
  EXPECT_EQ(told(first.remarks, words), 1u);
  EXPECT_NE(read(first.report_html).find(words), std::string::npos);
  RunSettings again = settings;
  again.out = scratch.path / "again";
  const RunOutcome second = report_record(first.record, again, silent);
  EXPECT_EQ(told(second.remarks, words), 1u);
  EXPECT_NE(read(second.report_html).find(words), std::string::npos);
  settings.out = scratch.path / "plain";
  settings.report = false;
  EXPECT_EQ(told(run_case(c, settings, Stages::simulate, silent).remarks, words), 1u);
}

}  // namespace
}  // namespace pivnp::app
