// Records as comparisons leave them: reported again with the same numbers, units of other programs' files, and runs whose
// sides cannot be compared.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "apps/report/content/differences.hpp"
#include "apps/report/content/selection.hpp"
#include "apps/report/report.hpp"
#include "apps/study/study.hpp"
#include "compare/metrics/rows.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/image/frames/frames.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/added.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {
namespace {

namespace fs = std::filesystem;

class Records : public testing::Test {
 protected:
  test::Scratch scratch;
  SilentProgress progress;

  // A block of n by n particles over 8 by 8, moved by `rate` a second along x.
  std::string tracks(const std::string& name, int n, double rate) const {
    std::ofstream out(scratch.path / name);
    out << "time,id,x,y\n";
    for (const double t : {0.0, 1.0, 2.0})
      for (int p = 0; p < n * n; ++p)
        out << t << "," << p << "," << 8.0 / n * (p % n + 0.5) + rate * t << "," << 8.0 / n * (p / n + 0.5) << "\n";
    return "csv=" + (scratch.path / name).string();
  }
  RunSettings settings(const std::string& folder) const {
    RunSettings s;
    s.out = scratch.path / folder;
    fs::create_directories(s.out);
    return s;
  }
};

// Without the coarser grid u_val would not be known, and the limit exceeded.
TEST_F(Records, ReportedAgainHoldWhatCoarserGridsSaid) {
  CompareSources sources;
  sources.first = tracks("lab.csv", 8, 0.30), sources.second = tracks("sim.csv", 10, 0.31);
  sources.coarser = {tracks("coarse.csv", 5, 0.33)};
  compare::LimitOptions limits;
  limits["displacement_over_u"] = 1;
  const RunOutcome first = compare_records(sources, {}, limits, settings("out"), progress);
  EXPECT_FALSE(any_exceeded(first.limits));
  const RunOutcome again = report_record(scratch.path / "out", settings("again"), progress);
  EXPECT_FALSE(any_exceeded(again.limits));
  ASSERT_EQ(again.limits.size(), 1U);
  EXPECT_EQ(again.limits[0].reached, first.limits[0].reached);
  EXPECT_TRUE(fs::exists(again.report_html));
}

TEST_F(Records, ReportedAgainAsIsAskedFor) {
  CompareSources sources;
  sources.first = tracks("lab.csv", 6, 0.30), sources.second = tracks("sim.csv", 6, 0.31);
  compare_records(sources, {}, {}, settings("out"), progress);
  const RunOutcome again = report_record(scratch.path / "out", settings("again"), progress, [](report::ReportOptions& o) {
    o.title = "asked for";
    o.fields_drawn = {"velocity_x"};
  });
  std::ifstream in(again.report_html, std::ios::binary);
  const std::string html{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  EXPECT_NE(html.find("<h1>asked for</h1>"), std::string::npos);
  EXPECT_TRUE(fs::exists(scratch.path / "again" / "figures" / "velocity_x.svg"));
  EXPECT_FALSE(fs::exists(scratch.path / "again" / "figures" / "deviatoric_strain.svg"));
}

// Particles moved by 0.25 a second along x: 0.5 at the end, wherever it is asked for.
TEST_F(Records, AreAskedForValuesAtPlaces) {
  const std::string lab = tracks("lab.csv", 8, 0.25);
  QueryOptions at;
  at.fields_shown = {"displacement_x"};
  at.points_m = {{3.3, 4.4}, {1.1, 2.2}};
  at.times_s = {2};
  EXPECT_EQ(query_motion(lab, at), "time (s),x0 (m),y0 (m),x (m),y (m),status,displacement_x (m),sigma_displacement_x (m)\n"
                                   "2,3.3,4.4,3.8,4.4,1,0.5,\n"
                                   "2,1.1,2.2,1.6,2.2,1,0.5,\n");
  QueryOptions mean;
  mean.fields_shown = {"velocity_x"};
  mean.rectangle_m = {{6, 6}, {2, 4}};
  EXPECT_EQ(query_motion(lab, mean), "time (s),x0 (m),y0 (m),x (m),y (m),status,velocity_x (m/s)\n"
                                     "0,4,5,4,5,1,0.25\n"
                                     "1,4,5,4.25,5,1,0.25\n"
                                     "2,4,5,4.5,5,1,0.25\n");
  QueryOptions line;
  line.fields_shown = {"displacement_x"};
  line.line_m = {{1, 1}, {3, 1}};
  const std::string along = query_motion(lab, line);
  EXPECT_EQ(std::count(along.begin(), along.end(), '\n'), 122);
  EXPECT_NE(along.find("\n2,2,3,1,0.5,\n"), std::string::npos) << along;
  QueryOptions strain;
  strain.extensometer_m = {{1.5, 1.5}, {5.5, 1.5}};
  strain.times_s = {1};
  EXPECT_EQ(query_motion(lab, strain).substr(0, 31), "time (s),strain,sigma_strain\n1,");

  const auto fault = [&](const QueryOptions& options) {
    try {
      query_motion(lab, options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(fault({}), "query: found 0 kinds of place, expected one of --points-m, --line-m, --rectangle-m and --extensometer-m");
  at.points_m = {{3, 3}, {30, 3}};
  EXPECT_EQ(fault(at), "--points-m (30, 3): no particle of the first frame is there");
  line.line_m = {{1, 1}};
  EXPECT_EQ(fault(line), "--line-m: found 1 point, expected two");
  line.line_m = {{21, 1}, {23, 1}};
  EXPECT_EQ(fault(line), "--line-m: no particle is beside it at the times that are asked for");
  at.fields_shown = {"strain_dve"};
  EXPECT_NE(fault(at).find("strain_dev"), std::string::npos);
}

// One motion alone, by name, is shown without the comparison; one that the record lacks is refused.
TEST_F(Records, ReportedOfTheDataSetsAskedFor) {
  CompareSources sources;
  sources.first = tracks("lab.csv", 6, 0.30), sources.second = tracks("sim.csv", 6, 0.31);
  const RunOutcome first = compare_records(sources, {}, {}, settings("out"), progress);
  const std::vector<std::string> names = io::RecordReader(first.record).motion_names();
  ASSERT_EQ(names.size(), 2u);
  const auto of = [&](std::vector<std::string> wanted) {
    return report_record(scratch.path / "out", settings("again"), progress, [&](report::ReportOptions& o) { o.data_sets = wanted; });
  };
  of({names[1]});
  EXPECT_FALSE(fs::exists(scratch.path / "again" / "figures" / "verdict.svg"));
  EXPECT_TRUE(fs::exists(scratch.path / "again" / "figures" / "displacement.svg"));
  report_record(scratch.path / "out", settings("moving"), progress, [](report::ReportOptions& o) { o.animation = true; });
  const fs::path video = scratch.path / "moving" / "animation.mp4";
  ASSERT_TRUE(fs::exists(video));
  image::FrameOptions frames;
  frames.path = video.string();
  const auto shown = image::open_frames(frames, scratch.path);
  EXPECT_EQ(shown->frames().size(), io::RecordReader(first.record).comparison()->times().size());
  EXPECT_GT(shown->width(), 700);
  of({names[0], names[1]});
  EXPECT_TRUE(fs::exists(scratch.path / "again" / "figures" / "verdict.svg"));
  EXPECT_THROW(of({"nobody"}), InputError);
}

// Other runs stand beside this one: a curve each, and their numbers in a table.
TEST_F(Records, RunsStandBesideEachOther) {
  CompareSources sources;
  sources.first = tracks("lab.csv", 6, 0.30), sources.second = tracks("sim.csv", 6, 0.31);
  compare_records(sources, {}, {}, settings("out"), progress);
  sources.second = tracks("worse.csv", 6, 0.4);
  compare_records(sources, {}, {}, settings("worse"), progress);
  const auto beside = [&](const std::string& other) {
    return report_record(scratch.path / "out", settings("again"), progress, [&](report::ReportOptions& o) { o.compare_runs = {other}; });
  };
  std::ifstream in(beside((scratch.path / "worse").string()).report_html, std::ios::binary);
  const std::string html{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  EXPECT_NE(html.find("<figure id=\"runs\">"), std::string::npos);
  EXPECT_NE(html.find(">worse</th>"), std::string::npos);
  EXPECT_THROW(beside((scratch.path / "nothing").string()), InputError);
}

TEST_F(Records, LengthsOfOtherProgramsAreInTheUnitThatIsNamed) {
  CompareSources sources;
  sources.first = tracks("a.csv", 6, 0.1), sources.second = tracks("b.csv", 6, 0.1);
  sources.length_unit = "px";
  compare_records(sources, {}, {}, settings("out"), progress);
  const io::RecordReader record(scratch.path / "out" / "record.h5");
  EXPECT_EQ(record.head().length_unit, "px");
  const Comparison held = record.comparison().value();
  for (const Metric& m : held.metrics)
    if (m.name == "displacement_rms") {
      EXPECT_EQ(m.unit, "px");
    }
}

// Column by column: the first, the second and their difference, whatever was done to bring them together.
TEST_F(Records, FieldsAreDrawnAsTheyWereCompared) {
  CompareSources sources;
  sources.first = tracks("lab.csv", 6, 0.30), sources.second = tracks("sim.csv", 6, 0.50);
  compare::CompareOptions options;
  options.time_offset_s = 0.5;
  const RunOutcome outcome = compare_records(sources, options, {}, settings("out"), progress);
  const io::RecordReader record(outcome.record);
  report::ReportInput input;
  input.record = &record;
  input.compared = options;
  const report::Content content = report::content_of({}, input);
  EXPECT_FALSE(content.alignment.empty());
  const std::vector<double> times = report::chosen_times({}, content);
  EXPECT_EQ(times.back(), 2.0);
  for (const double t : times) {
    const auto first = report::fields_at(*content.measured, "displacement_magnitude", true, {t});
    const auto second = report::fields_at(*content.simulated, "displacement_magnitude", true, {t});
    const std::vector<double> apart = report::field_difference(content, "displacement_magnitude", t, first[0]);
    ASSERT_EQ(apart.size(), 36U);
    for (std::size_t p = 0; p < apart.size(); ++p)
      EXPECT_NEAR(apart[p], second[0].value[p] - first[0].value[p], 1e-5) << t;
  }
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST_F(Records, AMetricThatIsAddedIsRecordedAndReported) {
  const test::Added limit_row(compare::limit_rows(), {.name = "slant_max", .unit = "", .text = "greatest slant"});
  const test::Added row(compare::metric_rows(), compare::MetricRow{{.name = "slant", .unit = "L", .definition = "made up by a test",
                               .words = "slant of a test", .limit = "slant_max"},
                              [](const compare::Findings&) { return compare::difference(3, 0.1, ""); }});
  CompareSources sources;
  sources.first = tracks("a.csv", 6, 0.1), sources.second = tracks("b.csv", 6, 0.2);
  compare::LimitOptions limits;
  limits["slant_max"] = 2;
  const RunOutcome outcome = compare_records(sources, {}, limits, settings("out"), progress);
  EXPECT_TRUE(any_exceeded(outcome.limits));
  const Comparison held = io::RecordReader(outcome.record).comparison().value();
  const Metric* found = find(held.metrics, "slant");
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->value, 3);
  EXPECT_EQ(found->unit, "m");
  EXPECT_EQ(found->definition, "made up by a test");
  EXPECT_EQ(found->limit, LimitFate::exceeded);
  EXPECT_NE(text_of(outcome.report_html).find("Slant of a test"), std::string::npos);
  EXPECT_TRUE(any_exceeded(report_record(outcome.record, settings("again"), progress).limits));  // from its case
}

// Of each kind of comparison into one folder: what is there afterwards is what the report shows.
TEST_F(Records, AComparisonLeavesNoFiguresOfTheOneBefore) {
  std::ofstream(scratch.path / "a.txt") << "t (s),x (m)\n0,0\n1,1\n2,3\n";
  CompareSources motions, curves;
  motions.first = tracks("a.csv", 8, 0.1), motions.second = tracks("b.csv", 8, 0.2);
  curves.first = curves.second = "history=" + (scratch.path / "a.txt").string();
  std::set<std::string> seen;
  for (const CompareSources* sources : {&curves, &motions, &curves, &motions}) {
    const RunOutcome outcome = compare_records(*sources, {}, {}, settings("out"), progress);
    const std::string html = text_of(outcome.report_html);
    for (const auto& entry : fs::directory_iterator(scratch.path / "out" / "figures")) {
      const std::string name = entry.path().stem().string();
      EXPECT_NE(html.find("<figure id=\"" + name + "\">"), std::string::npos) << name;
      seen.insert(name);
    }
  }
  EXPECT_TRUE(seen.contains("curves") && seen.contains("decomposition"));
}

// An onset is asked for and the simulated block does not move: what was measured and simulated is there all the same.
TEST_F(Records, ARunWhoseSidesCannotBeComparedKeepsThem) {
  Case c = parse_case(
      "name = \"block\"\n[frames]\nrate_hz = 1.0\n[camera]\nmetres_per_pixel = 1e-3\n[grid]\nspacing_px = 16\n"
      "[region.soil]\npolygon_px = [[32, 32], [96, 32], [96, 96], [32, 96]]\n"
      "[piv]\nmethod = \"fast\"\n"
      "[material.soil]\nmodel = \"linear_elastic\"\ndensity_kg_m3 = 1000.0\nyoung_pa = 1e4\npoisson = 0.3\n"
      "[mpm]\ngravity_m_s2 = [0.0, 0.0]\n[compare]\ntime_alignment = \"onset\"\n"
      "[synth]\nmotion = \"affine\"\nwidth_px = 128\nheight_px = 128\nframes = 3\nshift_px_per_frame = [1.0, 0.0]\n",
      "test", scratch.path);
  std::string said;
  try {
    run_case(c, settings("out"), Stages::all, progress);
  } catch (const InputError& e) {
    said = e.what();
  }
  EXPECT_NE(said.find("shows no onset"), std::string::npos) << said;
  EXPECT_NE(said.find("record.h5 and its report are written"), std::string::npos) << said;
  EXPECT_EQ(said.find('\n'), std::string::npos);
  const io::RecordReader record(scratch.path / "out" / "record.h5");
  EXPECT_EQ(record.motion_names(), (std::vector<std::string>{"np", "mpm"}));
  EXPECT_FALSE(record.comparison().has_value());
  EXPECT_TRUE(fs::exists(scratch.path / "out" / "report.html"));
}

}  // namespace
}  // namespace pivnp::app
