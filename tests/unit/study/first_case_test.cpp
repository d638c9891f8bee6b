// A first case as a new user meets it: the template's simulation, what is refused before anything is computed, what
// `check` tells, and a mesh study that a case asks for itself.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "apps/case/init.hpp"
#include "apps/study/study.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {
namespace {

namespace fs = std::filesystem;

class FirstCase : public testing::Test {
 protected:
  test::Scratch scratch;
  SilentProgress progress;

  void SetUp() override {
    for (int k = 0; k < 3; ++k) {
      std::ofstream file(scratch.path / ("f" + std::to_string(k) + ".pgm"), std::ios::binary);
      file << "P5\n96 64\n255\n";
      unsigned grey = 7;
      for (int n = 0; n < 96 * 64; ++n) file << char((grey = grey * 1664525u + 1013904223u) >> 24);
    }
  }
  RunSettings settings(const std::string& folder) const {
    RunSettings s;
    s.out = scratch.path / folder;
    s.threads = 1;
    return s;
  }
  std::string initial(std::optional<double> rate_hz, std::optional<double> metres_per_pixel) const {
    return init_case({.frames = (scratch.path / "f*.pgm").string(), .folder = scratch.path,
                      .metres_per_pixel = metres_per_pixel, .rate_hz = rate_hz, .all = true});
  }
  // What the template says to do: the first '# ' of every line of the simulation goes.
  static std::string with_simulation(const std::string& text) {
    const std::size_t from = text.find("# [material.soil]");
    std::string out = text.substr(0, from);
    for (std::size_t at = from; at < text.size();) {
      const std::size_t end = text.find('\n', at);
      const std::string line = text.substr(at, end - at);
      out += (line.starts_with("# ") ? line.substr(2) : line) + "\n";
      at = end + 1;
    }
    return out;
  }
  std::string refusal(const std::string& text, bool check) {
    try {
      const Case c = parse_case(text, "c.toml", scratch.path);
      if (check) check_case(c, settings("out"), progress);
      else run_case(c, settings("out"), Stages::all, progress);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
};

TEST_F(FirstCase, TheTemplatesSimulationRunsOnceItsMarksAreGone) {
  const std::string text = with_simulation(initial(200.0, 1e-3));
  const Case c = parse_case(text, "c.toml", scratch.path);
  ASSERT_TRUE(c.mpm && c.limits.any()) << text;
  ASSERT_EQ(c.boundaries.size(), 3U);
  const RunOutcome outcome = run_case(c, settings("out"), Stages::simulate, progress);
  const auto motion = io::RecordReader(outcome.record).motion("mpm");
  ASSERT_EQ(motion->times().size(), 3U);
  // The base carries the region: what lies on it does not fall through.
  const MotionFrame last = motion->frame(2);
  double lowest = 1, y = 1;
  for (std::size_t p = 0; p < last.u.size(); ++p)
    if (motion->particles().x0[p].y() < y) y = motion->particles().x0[p].y(), lowest = double(last.u[p][1]);
  EXPECT_GT(lowest, -0.1 * 0.5 * 9.81 * 0.01 * 0.01);
}

TEST_F(FirstCase, ASimulationNeedsTimeAndScale) {
  for (const bool check : {true, false}) {
    EXPECT_NE(refusal(with_simulation(initial({}, 1e-3)), check).find("frames.rate_hz"), std::string::npos) << check;
    EXPECT_NE(refusal(with_simulation(initial(200.0, {})), check).find("camera.metres_per_pixel"), std::string::npos) << check;
  }
}

TEST_F(FirstCase, WhatCannotBeMeantIsRefused) {
  const std::string text = initial(200.0, 1e-3);
  std::string far = text;
  const std::size_t at = far.find("polygon_px = [[") + 15;
  far.replace(at, far.find(',', at) - at, "-400");
  EXPECT_NE(refusal(far, true).find("region.soil.polygon_px"), std::string::npos) << refusal(far, true);
  EXPECT_NE(refusal(initial(200.0, 0.5), true).find("camera.metres_per_pixel"), std::string::npos);
  EXPECT_NE(refusal(text + "\n[report]\nfields = [\"strain_deviator\"]\n", true).find("report.fields"), std::string::npos);
}

TEST_F(FirstCase, CheckTellsTheViewAndTheTime) {
  const CheckOutcome outcome =
      check_case(parse_case(with_simulation(initial(200.0, 1e-3)), "c.toml", scratch.path), settings("out"), progress);
  std::string all;
  for (const std::string& remark : outcome.remarks) all += remark + "\n";
  EXPECT_NE(all.find("96 x 64 px, 0.096 x 0.064 m"), std::string::npos) << all;
  EXPECT_NE(all.find("Expected time"), std::string::npos) << all;
  EXPECT_TRUE(fs::exists(outcome.picture));
}

// The simulation once more on a coarser grid: u_val then holds its numerical error, and the motion is the same.
TEST_F(FirstCase, AMeshStudyOfItsOwn) {
  const std::string text =
      "name = \"block\"\n[frames]\nrate_hz = 10.0\n[camera]\nmetres_per_pixel = 1e-3\n[grid]\nspacing_px = 8\n"
      "[region.soil]\npolygon_px = [[32, 96], [96, 96], [96, 32], [32, 32]]\n[piv]\nmethod = \"fast\"\n"
      "[material.soil]\nmodel = \"linear_elastic\"\ndensity_kg_m3 = 1000.0\nyoung_pa = 1e4\npoisson = 0.3\n"
      "[mpm]\ninitial_equilibrium = false\n[boundary.base]\nline_m = [[0.032, 0.031], [0.096, 0.031]]\n"
      "[synth]\nmotion = \"affine\"\nwidth_px = 128\nheight_px = 128\nframes = 3\nshift_px_per_frame = [0.5, 0.0]\n";
  const auto run = [&](const std::string& more, const std::string& folder) {
    return io::RecordReader(run_case(parse_case(text + more, "c.toml", scratch.path), settings(folder), Stages::all, progress).record);
  };
  const io::RecordReader without = run("", "without"), with = run("[compare]\nmesh_study = 1\n", "with");
  EXPECT_EQ(with.motion_names().size(), 3U);
  const auto part = [](const io::RecordReader& record) {
    const Comparison c = record.comparison().value();
    const Metric* m = find(c.metrics, "u_numerical");
    return m == nullptr ? -1 : m->value;
  };
  EXPECT_EQ(part(without), 0);
  EXPECT_GT(part(with), 0);
  // The two motions of that record, compared once more, use its coarser grid unasked.
  CompareSources sources;
  sources.first = (scratch.path / "with").string() + ":np";
  sources.second = (scratch.path / "with").string() + ":mpm";
  const RunOutcome again = compare_records(sources, {}, {}, settings("again"), progress);
  EXPECT_EQ(part(io::RecordReader(again.record)), part(with));
  EXPECT_EQ(with.motion("mpm")->frame(2).u, without.motion("mpm")->frame(2).u);
  EXPECT_EQ(with.energy().size(), without.energy().size());
}

}  // namespace
}  // namespace pivnp::app
