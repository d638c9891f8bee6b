// What is written for other programs holds the record's numbers: CSV read back, VTKHDF as VTK's own reader sees it (skipped
// without python3-vtk9).
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>

#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/exports/exports.hpp"
#include "pivnp/io/imports/import_motion.hpp"
#include "tests/unit/io/records/sample.hpp"

namespace pivnp::io {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char ch : line)
    if (ch == ',') cells.emplace_back();
    else cells.back() += ch;
  return cells;
}

struct Exported : testing::Test {
  pivnp::test::Scratch scratch{"exports"};
  fs::path record = scratch.path / "run" / "record.h5";
  void SetUp() override { sample::run(scratch.path / "run", {}, false); }
};

// What export writes, compare csv= reads: places, ends and units.
TEST_F(Exported, CsvIsReadBackAsTheMotionThatItWas) {
  const RecordReader reader(record);
  const auto motion = reader.motion("np");
  const auto files = export_csv(reader, {.motions = {"np"}, .fields = {"displacement_x", "displacement_y"}, .times = {}}, scratch.path);
  const auto back = open_import("csv=" + files[0].string(), {.length_unit = "px", .time_unit = "frame"});
  EXPECT_EQ(back->length_unit(), motion->length_unit());
  EXPECT_EQ(back->time_unit(), motion->time_unit());
  ASSERT_EQ(back->times().size(), motion->times().size());
  std::map<std::int64_t, std::size_t> place;
  for (std::size_t p = 0; p < back->particles().size(); ++p) place[back->particles().id[p]] = p;
  std::size_t compared = 0;
  for (std::size_t k = 0; k < motion->times().size(); ++k) {
    EXPECT_NEAR(back->times()[k], motion->times()[k], 1e-8 * std::abs(motion->times()[k]));
    const MotionFrame f = motion->frame(k), g = back->frame(k);
    for (std::size_t p = 0; p < f.u.size(); ++p) {
      const bool followed = f.status[p] == ParticleStatus::active || f.status[p] == ParticleStatus::flagged;
      const auto at = place.find(motion->particles().id[p]);
      if (!followed) {
        EXPECT_TRUE(at == place.end() || g.status[at->second] != ParticleStatus::active) << k << " " << p;
        continue;
      }
      ASSERT_NE(at, place.end());
      EXPECT_EQ(g.status[at->second], ParticleStatus::active);
      for (const int c : {0, 1}) {
        const double x = motion->particles().x0[p][c] + double(f.u[p][std::size_t(c)]);
        EXPECT_NEAR(back->particles().x0[at->second][c] + double(g.u[at->second][std::size_t(c)]), x, 1e-6 * std::max(1.0, std::abs(x)));
      }
      ++compared;
    }
  }
  EXPECT_GT(compared, 50u);
  std::ofstream(scratch.path / "mixed.csv") << "x (mm),y (m)\n1,2\n3,4\n5,7\n";
  try {
    open_import("csv=" + (scratch.path / "mixed.csv").string(), {});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("column 'y' is in 'm', expected the unit of x, 'mm'"), std::string::npos) << error.what();
  }
}

TEST_F(Exported, CsvHoldsTheRecordsNumbers) {
  const RecordReader reader(record);
  const auto files = export_csv(reader, {.motions = {"np", "piv"}, .fields = {"displacement_x", "strain_dev"}, .times = {}}, scratch.path);
  ASSERT_EQ(files.size(), 2u);
  const auto motion = reader.motion("np");
  DerivedReader derived(*motion, true);
  std::ifstream in(files[0]);
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> head = cells_of(line);
  std::map<std::string, std::size_t> column;
  for (std::size_t c = 0; c < head.size(); ++c) column[head[c].substr(0, head[c].find(' '))] = c;
  ASSERT_TRUE(column.contains("strain_dev") && column.contains("displacement_x") && column.contains("sigma_y") && column.contains("status"));
  const std::size_t n = motion->particles().size();
  for (std::size_t k = 0; k < motion->times().size(); ++k) {
    const MotionFrame frame = motion->frame(k);
    const std::vector<double> strain = derived.values("strain_dev", k), u = derived.values("displacement_x", k);
    for (std::size_t p = 0; p < n; ++p) {
      ASSERT_TRUE(std::getline(in, line));
      const std::vector<std::string> cells = cells_of(line);
      ASSERT_EQ(cells.size(), head.size());
      EXPECT_EQ(std::stoll(cells[column["id"]]), motion->particles().id[p]);
      EXPECT_EQ(std::stoi(cells[column["status"]]), int(frame.status[p]));
      for (const auto& [name, expected] : {std::pair<const char*, double>{"strain_dev", strain[p]}, {"displacement_x", u[p]},
                                           {"sigma_y", std::sqrt(double(frame.cov_u.empty() ? NAN : frame.cov_u[p][1]))},
                                           {"x", motion->particles().x0[p].x() + double(frame.u[p][0])}}) {
        const std::string& cell = cells[column[name]];
        if (std::isfinite(expected)) {
          EXPECT_NEAR(std::stod(cell), expected, 1e-8 * std::abs(expected)) << name;
        } else {
          EXPECT_EQ(cell, "") << name;
        }
      }
    }
  }
  EXPECT_FALSE(std::getline(in, line));
  std::ifstream vectors(files[1]);
  std::size_t rows = 0;
  while (std::getline(vectors, line)) ++rows;
  EXPECT_EQ(rows, 1 + reader.pair_count() * reader.pair(0).grid.node_count());
}

TEST_F(Exported, WhatIsNotThereIsRefused) {
  const RecordReader reader(record);
  EXPECT_THROW(export_csv(reader, {.motions = {"nobody"}, .fields = {}, .times = {}}, scratch.path), InputError);
  EXPECT_THROW(export_csv(reader, {.motions = {}, .fields = {"strain_dve"}, .times = {}}, scratch.path), InputError);
}

// A series that VTK 9.1 reads: each time with the particles that are followed then.
TEST_F(Exported, VtkReadsASeriesOfTimes) {
  const RecordReader reader(record);
  const auto files = export_vtu(reader, {.motions = {"np"}, .fields = {"strain_dev"}, .times = {}}, scratch.path);
  ASSERT_EQ(files, std::vector<fs::path>{scratch.path / "np.pvd"});
  const auto motion = reader.motion("np");
  std::ifstream in(files[0]);
  const std::string listed{std::istreambuf_iterator<char>(in), {}};
  for (std::size_t k = 0; k < motion->times().size(); ++k) {
    const std::string name = "np/np_00000" + std::to_string(k) + ".vtu";
    EXPECT_TRUE(fs::exists(scratch.path / name));
    EXPECT_NE(listed.find("file=\"" + name + "\""), std::string::npos);
  }
  const std::string python = fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
  if (std::system((python + " -c 'import vtkmodules.vtkIOXML, numpy' > /dev/null 2>&1").c_str()) != 0) GTEST_SKIP() << "python3-vtk9 is not installed";
  FILE* pipe = ::popen((python + " " PIVNP_EXPORT_TESTS "/read_pvd.py " + files[0].string() + " 2> /dev/null").c_str(), "r");
  std::string text;
  char buffer[4096];
  for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
  EXPECT_EQ(::pclose(pipe), 0) << text;
  std::istringstream out(text);
  DerivedReader derived(*motion, true);
  for (std::size_t k = 0; k < motion->times().size(); ++k) {
    const MotionFrame frame = motion->frame(k);
    const std::vector<double> strain = derived.values("strain_dev", k);
    std::map<std::string, double> expected;
    std::size_t followed = 0;
    for (std::size_t p = 0; p < frame.u.size(); ++p) {
      if (frame.status[p] != ParticleStatus::active && frame.status[p] != ParticleStatus::flagged) continue;
      ++followed;
      expected["displacement"] += double(frame.u[p][0]) + double(frame.u[p][1]);
      expected["Points"] += motion->particles().x0[p].sum() + double(frame.u[p][0]) + double(frame.u[p][1]);
      expected["id"] += double(motion->particles().id[p]);
      expected["status"] += double(frame.status[p]);
      expected["strain_dev"] += std::isfinite(strain[p]) ? strain[p] : 0;
      if (frame.cov_u.empty()) continue;
      const double sigma = std::sqrt((double(frame.cov_u[p][0]) + double(frame.cov_u[p][1])) / 2);
      expected["sigma"] += std::isfinite(sigma) ? sigma : 0;
    }
    double time = 0;
    std::size_t points = 0, vertices = 0, arrays = 0;
    out >> time >> points >> vertices >> arrays;
    EXPECT_EQ(time, motion->times()[k]);
    EXPECT_EQ(points, followed);
    EXPECT_EQ(vertices, followed);
    std::map<std::string, double> found;
    for (std::string name; arrays > 0 && out >> name; --arrays) out >> found[name];
    for (const auto& [key, value] : expected) {
      ASSERT_TRUE(found.contains(key)) << key << "\n" << text;
      EXPECT_NEAR(found[key], value, 1e-5 * (1 + std::abs(value))) << key;
    }
  }
}

TEST_F(Exported, VtkReadsTheRecordsNumbers) {
  const std::string python = fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";  // Debian's, which has its modules
  if (std::system((python + " -c 'import vtkmodules.vtkIOHDF, numpy' > /dev/null 2>&1").c_str()) != 0) GTEST_SKIP() << "python3-vtk9 is not installed";
  const RecordReader reader(record);
  const auto files = export_vtkhdf(reader, {.motions = {"np"}, .fields = {"strain_dev", "strain_xx"}, .times = {}}, scratch.path);
  ASSERT_EQ(files.size(), 1u);
  const auto motion = reader.motion("np");
  DerivedReader derived(*motion, true);
  std::map<std::string, double> expected;
  const auto add = [&](const std::string& name, double value) { expected[name] += std::isfinite(value) ? value : 0; };
  for (std::size_t k = 0; k < motion->times().size(); ++k) {
    const MotionFrame frame = motion->frame(k);
    for (const char* name : {"strain_dev", "strain_xx"})
      for (const double v : derived.values(name, k)) add(name, v);
    for (std::size_t p = 0; p < frame.u.size(); ++p) {
      add("displacement", double(frame.u[p][0]) + double(frame.u[p][1]));
      add("Points", motion->particles().x0[p].sum() + double(frame.u[p][0]) + double(frame.u[p][1]));
      add("status", double(frame.status[p]));
      if (!frame.cov_u.empty()) add("sigma", std::sqrt((double(frame.cov_u[p][0]) + double(frame.cov_u[p][1])) / 2));
    }
  }
  const std::string command = python + " " PIVNP_EXPORT_TESTS "/read_vtkhdf.py " + files[0].string() + " 2> /dev/null";
  FILE* pipe = ::popen(command.c_str(), "r");
  std::string text;
  char buffer[4096];
  for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
  EXPECT_EQ(::pclose(pipe), 0) << text;
  std::istringstream in(text);
  std::size_t points = 0, cells = 0, steps = 0;
  in >> points >> cells >> steps;
  EXPECT_EQ(points, motion->particles().size() * motion->times().size()) << text;
  if (steps > 1) {  // VTK before 9.3 shows all times at once
    EXPECT_EQ(steps, motion->times().size()) << text;
  }
  EXPECT_EQ(cells, points);
  std::string name;
  int components = 0;
  double sum = 0;
  std::map<std::string, double> found;
  while (in >> name >> components >> sum) found[name] = sum;
  for (const auto& [key, value] : expected) {
    ASSERT_TRUE(found.contains(key)) << key << "\n" << text;
    EXPECT_NEAR(found[key], value, 1e-5 * (1 + std::abs(value))) << key;
  }
}

}  // namespace
}  // namespace pivnp::io
