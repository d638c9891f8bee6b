// A simulation that fails leaves the measurement and its report; --resume does again only what depends on keys that changed.
#include <gmock/gmock.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "apps/study/study.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

// A bench of sand whose face no friction holds up; some cohesion does.
std::string bench(double cohesion_pa, const std::string& more = "") {
  return "name = \"bench\"\n[frames]\nrate_hz = 100.0\n[camera]\nmetres_per_pixel = 1e-3\n[grid]\nspacing_px = 8\n"
         "[region.sand]\npolygon_px = [[24, 103], [88, 103], [88, 39], [24, 39]]\n[piv]\nmethod = \"fast\"\nwindow_px = 16\n"
         "[synth]\nmotion = \"affine\"\nwidth_px = 128\nheight_px = 128\nframes = 4\nshift_px_per_frame = [0.3, 0.0]\n"
         "[material.sand]\nmodel = \"mohr_coulomb\"\ndensity_kg_m3 = 1600.0\nyoung_pa = 1e6\npoisson = 0.3\nfriction_deg = 20.0\ncohesion_pa = " +
         std::to_string(cohesion_pa) + "\n[mpm]\ninitial_equilibrium = true\n[boundary.base]\nline_m = [[0.0, 0.024], [0.127, 0.024]]\n" + more;
}

class FailedStage : public ::testing::Test {
 protected:
  const test::Scratch scratch;

  RunOutcome run(const std::string& text, bool resume, const char* folder = "out", bool report = false) {
    RunSettings settings;
    settings.out = scratch.path / folder;
    settings.threads = 1;
    settings.resume = resume;
    settings.report = report;
    SilentProgress progress;
    return run_case(parse_case(text, "c.toml", scratch.path), settings, Stages::all, progress);
  }
  std::string failure(const std::string& text, bool resume, bool report = false) {
    try {
      run(text, resume, "out", report);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }
  fs::file_time_type vectors_of() const { return fs::last_write_time(scratch.path / "out/parts/piv.end.h5"); }

  void expect_same(const char* a, const char* b) {
    const io::RecordReader x(scratch.path / a / "record.h5"), y(scratch.path / b / "record.h5");
    ASSERT_EQ(x.motion_names(), y.motion_names());
    for (const std::string& name : x.motion_names()) {
      const auto m = x.motion(name), n = y.motion(name);
      ASSERT_EQ(m->times(), n->times());
      for (std::size_t k = 0; k < m->times().size(); ++k) EXPECT_EQ(m->frame(k).u, n->frame(k).u) << name << k;
    }
    ASSERT_EQ(x.pair_count(), y.pair_count());
    for (std::size_t k = 0; k < x.pair_count(); ++k) {
      EXPECT_EQ(x.pair(k).displacement, y.pair(k).displacement);
      EXPECT_EQ(x.pair(k).status, y.pair(k).status);
    }
    for (std::size_t k = 0; k < x.frames().size(); ++k) EXPECT_EQ(x.frames()[k].flag, y.frames()[k].flag);
    ASSERT_TRUE(x.comparison() && y.comparison());
    const auto p = x.comparison()->metrics, q = y.comparison()->metrics;
    ASSERT_EQ(p.size(), q.size());
    for (std::size_t k = 0; k < p.size(); ++k) {
      EXPECT_EQ(std::memcmp(&p[k].value, &q[k].value, sizeof(double)), 0) << p[k].name;
      EXPECT_EQ(std::memcmp(&p[k].uncertainty, &q[k].uncertainty, sizeof(double)), 0) << p[k].name;
    }
  }
};

TEST_F(FailedStage, LeavesTheMeasurementAndResumesFromIt) {
  const std::string why = failure(bench(0), false, true);
  EXPECT_THAT(why, HasSubstr("record.h5 and its report; --resume goes on from there)"));
  {
    const io::RecordReader record(scratch.path / "out/record.h5");
    EXPECT_EQ(record.pair_count(), 3u);
    EXPECT_EQ(record.motion_names(), std::vector<std::string>{"np"});
    EXPECT_TRUE(record.strain_note("np").has_value());
  }
  std::ifstream page(scratch.path / "out/report.html");
  const std::string html((std::istreambuf_iterator<char>(page)), {});
  EXPECT_THAT(html, HasSubstr("The simulation failed: "));

  const fs::file_time_type measured = vectors_of();
  EXPECT_EQ(failure(bench(0), true).substr(0, 40), why.substr(0, 40));  // nothing has changed: it fails as before
  EXPECT_EQ(vectors_of(), measured);
  EXPECT_THAT(failure(bench(500) + "[preprocess]\ncap_std = 2.0\n", true), HasSubstr("the case differs"));
  run(bench(500), true);
  EXPECT_FALSE(fs::exists(scratch.path / "out/parts"));
  run(bench(500), false, "whole");
  expect_same("out", "whole");
}

TEST_F(FailedStage, AFinishedRecordKeepsItsMeasurementWhereOnlyTheSimulationDiffers) {
  const std::string measured = bench(500);
  run(measured, false);
  run(bench(800), true);
  run(bench(800), false, "whole");
  expect_same("out", "whole");
  // What the measurement depends on is not measured anew in silence, nor is a simulation run that need not be.
  EXPECT_THAT(failure(bench(800, "[np]\nper_element = 9\n"), true), HasSubstr("the case differs"));
  EXPECT_THAT(failure(bench(800, "[report]\ntitle = \"a bench\"\n"), true), HasSubstr("the case differs"));
}

}  // namespace
}  // namespace pivnp::app
