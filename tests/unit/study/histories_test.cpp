// Curves and fronts compared as histories: tables, the front of a record's motion, the digitised experiments.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "apps/study/study.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {
namespace {

namespace fs = std::filesystem;

using test::Scratch;

class Histories : public testing::Test {
 protected:
  Scratch scratch;
  RunOutcome compared(const std::string& first, const std::string& second, compare::CompareOptions options = {},
                      compare::LimitOptions limits = {}, double step = 1) {
    RunSettings settings;
    settings.out = scratch.path / "out";
    fs::create_directories(settings.out);
    SilentProgress progress;
    CompareSources sources{first, second, {}, 2, step};
    return compare_records(sources, options, limits, settings, progress);
  }
  Metric held(const std::string& name) const {
    const io::RecordReader record(scratch.path / "out" / "record.h5");
    const Comparison comparison = record.comparison().value();
    for (const Metric& m : comparison.metrics)
      if (m.name == name) return m;
    ADD_FAILURE() << "no metric " << name;
    return {};
  }
  double stored(const std::string& name) const { return held(name).value; }
  // A record of two motions, each a row of a hundred particles of one area from x = 0 on that is drawn out `speed` times
  // its length a second; "mpm" after "np".
  std::string record_of_spreading(double speed_np, double speed_mpm) const {
    const fs::path folder = scratch.path / "record";
    ParticleSet row;
    row.label_names = {"sand"};
    for (int p = 0; p < 100; ++p) {
      row.id.push_back(p);
      row.label.push_back(0);
      row.x0.emplace_back(0.01 * (p + 1), 0.0);
      row.area.push_back(1e-4f);
      row.born.push_back(0);
      row.end.push_back(std::nan(""));
      row.end_reason.push_back(EndReason::none);
    }
    io::RecordWriter writer(folder, io::RecordHead{}, false);
    for (const auto& [name, speed] : {std::pair{"np", speed_np}, std::pair{"mpm", speed_mpm}}) {
      writer.begin_motion(name, row);
      for (double t = 0; t <= 3; t += 0.25) {
        MotionFrame f;
        f.time = t;
        for (const Vec2& x : row.x0) {
          f.u.push_back({float(speed * t * x.x()), 0});
          f.F.push_back({float(1 + speed * t), 0, 0, 1});
          f.status.push_back(ParticleStatus::active);
        }
        writer.add_frame(name, f);
      }
      writer.end_stage(std::string("motion/") + name, &row);
    }
    writer.finish();
    return (folder / "record.h5").string();
  }
  std::string shared(const char* file) const {
    const char* folder = std::getenv("PIVNP_TEST_DATA");
    return folder ? (fs::path(folder) / file).string() : "";
  }
};

TEST_F(Histories, ATableAgainstAScaledOne) {
  std::ofstream(scratch.path / "lab.csv") << "time (s),front (m),other\n0,1,9\n1,2,9\n2,4,9\n";
  std::ofstream(scratch.path / "sim.txt")
      << "step  other (Pa)  front (mm)\n0  7  1100\n1  7  2100\n2  7  4400\n3  7  nan\n";
  compare::CompareOptions options;
  options.second_scale = 1e-3;
  compare::LimitOptions limits;
  limits["history_rms"] = 0.2;
  const RunOutcome outcome =
      compared("history=" + (scratch.path / "lab.csv").string(),
               "history=" + (scratch.path / "sim.txt").string() + ":front (mm)", options, limits);
  EXPECT_NEAR(stored("history_rms"), std::sqrt((0.01 + 0.01 + 0.16) / 3), 1e-9);
  EXPECT_TRUE(any_exceeded(outcome.limits));
  EXPECT_TRUE(fs::exists(outcome.report_html));
  EXPECT_TRUE(fs::exists(scratch.path / "out" / "figures" / "curves.png"));
  EXPECT_THROW(compared("history=" + (scratch.path / "lab.csv").string(), "out/record.h5"), InputError);
  EXPECT_THROW(compared("history=" + (scratch.path / "lab.csv").string(),
                        "history=" + (scratch.path / "sim.txt").string() + ":frnt"),
               InputError);
}

// As the tables of a report's figures are.
TEST_F(Histories, NamesBetweenQuotationMarksMayHoldTheSeparator) {
  std::ofstream(scratch.path / "a.csv") << "\"A, time (s)\",\"A, pore pressure (Pa)\",\"B, time (s)\",\"B, pore pressure (Pa)\"\n0,10,0,100\n1,20,1,200\n";
  std::ofstream(scratch.path / "b.csv") << "time (s);p (Pa)\n0;103\n1;204\n";
  compared("history=" + (scratch.path / "a.csv").string() + ":B, pore pressure (Pa)", "history=" + (scratch.path / "b.csv").string());
  EXPECT_NEAR(stored("history_rms"), std::sqrt((9.0 + 16.0) / 2), 1e-9);
  EXPECT_EQ(held("history_rms").unit, "Pa");
}

TEST_F(Histories, OtherUnitsAreConvertedOrRefused) {
  std::ofstream(scratch.path / "m.csv") << "time (s),front (m)\n0,1\n1,2\n2,4\n";
  std::ofstream(scratch.path / "mm.csv") << "time (s),front (mm)\n0,1000\n1,2000\n2,4000\n";
  std::ofstream(scratch.path / "ms.csv") << "time (ms),front (m)\n0,1\n1000,2\n2000,4\n";
  std::ofstream(scratch.path / "bare.csv") << "time,front\n0,1\n1,2\n2,4\n";
  const auto file = [&](const char* name) { return "history=" + (scratch.path / name).string(); };
  EXPECT_THROW(compared(file("m.csv"), file("mm.csv")), InputError);
  EXPECT_THROW(compared(file("m.csv"), file("ms.csv")), InputError);
  compare::CompareOptions scaled;
  scaled.second_scale = 1e-3;
  compared(file("m.csv"), file("mm.csv"), scaled);
  EXPECT_NEAR(stored("history_max"), 0, 1e-12);
  compare::CompareOptions slower;
  slower.second_time_scale = 1e-3;
  compared(file("m.csv"), file("ms.csv"), slower);
  EXPECT_NEAR(stored("history_max"), 0, 1e-12);
  compared(file("m.csv"), file("bare.csv"));  // no unit stated
  EXPECT_EQ(stored("history_max"), 0);
}

// By hand: 99.5 % of a row of a hundred lies within the last one's place, 1 + speed t, and 0.01 (1 + speed t) from the
// left.
TEST_F(Histories, TheFrontOfARecordsMotion) {
  const std::string record = record_of_spreading(1, 2);
  std::ofstream(scratch.path / "lab.csv") << "time (s),front (m)\n0,1\n1,3\n2,5\n";
  const std::string lab = "history=" + (scratch.path / "lab.csv").string();
  compared(lab, "front=" + record + ":mpm");
  EXPECT_NEAR(stored("history_rms"), 0, 1e-6);
  compared(lab, "front=" + record + ":np");
  EXPECT_NEAR(stored("history_bias"), -(0 + 1 + 2) / 3.0, 1e-6);
  EXPECT_NEAR(stored("history_peak_rate_second"), 1, 1e-6);
  compared("front_left=" + record + ":np", "front_left=" + record + ":mpm");
  EXPECT_NEAR(stored("history_max"), 0.01 * 3, 1e-6);
  for (const char* bad : {"", ":mpn"}) EXPECT_THROW(compared(lab, "front=" + record + bad), InputError);
  EXPECT_THROW(compared(lab, "front=" + (scratch.path / "none.h5").string()), InputError);
}

TEST_F(Histories, AStatedErrorBecomesTheUncertaintyOfEveryMetric) {
  std::ofstream(scratch.path / "a.csv") << "time (s),front (m)\n0,0\n1,0\n2,10\n3,20\n4,20\n";
  compare::CompareOptions options;
  options.measurement_uncertainty_m = 0.1;
  const std::string a = "history=" + (scratch.path / "a.csv").string();
  compared(a, a, options);
  const double interval = 1 / std::sqrt(12.0), slope = 10;
  const double u = std::hypot(interval, 0.1 * std::sqrt(2.0) / slope);
  const Metric onset = held("history_onset_difference");
  EXPECT_NEAR(onset.uncertainty, u * std::sqrt(2.0), 1e-9);
  EXPECT_EQ(onset.verdict, Verdict::agrees);
  EXPECT_NEAR(held("history_rms").uncertainty, 0.1 * std::sqrt(2.0), 1e-12);
}

// Martin & Moyce (1952): the surge front of a water column against shallow-water theory's bound x/W = 1 + 2 t (dry bed,
// Ritter 1892, in units of sqrt(gW) at unit height): the front is slower, and the comparison says by how much.
TEST_F(Histories, DamBreak) {
  const std::string file = shared("dam_break/exp_surge_front.csv");
  if (file.empty()) GTEST_SKIP() << "PIVNP_TEST_DATA is not set";
  std::ofstream(scratch.path / "ritter.csv") << "time,front\n0,1\n4,9\n";
  compared("history=" + file, "history=" + (scratch.path / "ritter.csv").string());
  EXPECT_GT(stored("history_bias"), 0);
  EXPECT_GT(stored("history_rms"), 0.3);
  compared("history=" + file, "history=" + file);
  EXPECT_EQ(stored("history_rms"), 0);
  compared("history=" + file, "front=" + record_of_spreading(1, 2) + ":mpm");  // a simulated front, 1 + 2 t as well
  EXPECT_GT(stored("history_bias"), 0);
  EXPECT_GT(stored("history_rms"), 0.3);
}

// Two cameras saw one collapse: the comparison of an experiment with itself, its repeatability.
TEST_F(Histories, ColumnCollapseByTwoCameras) {
  const std::string file = shared("column_collapse/20210804_08g_050g_050_050_005.txt");
  if (file.empty()) GTEST_SKIP() << "PIVNP_TEST_DATA is not set";
  compared("history=" + file + ":r_p (m) (Cam 1)", "history=" + file + ":r_p (m) (Cam 2)", {}, {}, 1.0 / 240);
  EXPECT_GT(stored("history_rms"), 1e-4);
  EXPECT_LT(stored("history_rms"), 0.03);
  EXPECT_NEAR(stored("history_onset_first"), 9.0 / 240, 4.0 / 240);
}

}  // namespace
}  // namespace pivnp::app
