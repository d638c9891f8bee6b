// Readers that are not ours: h5py, and the Xdmf library that ParaView's readers are built on.
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include "gmock/gmock.h"
#include "pivnp/core/particles/derived.hpp"
#include "sample.hpp"

namespace pivnp::io {
namespace {

std::string run_command(const std::string& command, int& code) {
  std::string out;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (!pipe) return out;
  char block[4096];
  for (std::size_t n; (n = std::fread(block, 1, sizeof block, pipe)) > 0;) out.append(block, n);
  code = ::pclose(pipe);
  return out;
}

#ifdef PIVNP_XDMF_VALUES
struct Grid2 {
  double time = 0;
  std::map<std::string, std::vector<double>> values;
};

std::map<std::string, std::vector<Grid2>> parse(const std::string& text) {
  std::map<std::string, std::vector<Grid2>> out;
  std::istringstream lines(text);
  std::string collection;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind, name, word;
    words >> kind >> name;
    if (kind == "collection") collection = name;
    if (kind == "grid") {
      words >> word;
      out[collection].push_back({std::stod(word), {}});
    }
    if (kind == "points" || kind == "attribute" || kind == "cells")
      while (words >> word) out[collection].back().values[name].push_back(std::stod(word));  // stod knows "nan"
  }
  return out;
}
#endif

void expect_values(const std::vector<double>& found, const std::vector<double>& expected, const std::string& what) {
  ASSERT_EQ(found.size(), expected.size()) << what;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (std::isnan(expected[k])) EXPECT_TRUE(std::isnan(found[k])) << what << " " << k;
    else EXPECT_NEAR(found[k], expected[k], 1e-6 * std::max(1.0, std::abs(expected[k]))) << what << " " << k;
  }
}

TEST(ViewerTest, TheXdmfLibraryReadsTimesPositionsAndAttributes) {
#ifndef PIVNP_XDMF_VALUES
  GTEST_SKIP() << "the Xdmf library (libxdmf-dev) was not found when this was configured";
#else
  const sample::Size size;
  test::Scratch directory("pivnp_xdmf_");  // the Xdmf library cuts paths at spaces (docs/limits.md)
  sample::run(directory.path, size, false);
  int code = -1;
  const std::string text =
      run_command(std::string(PIVNP_XDMF_VALUES) + " '" + (directory.path / "record.xdmf").string() + "'", code);
  ASSERT_EQ(code, 0) << text;
  const auto found = parse(text);
  ASSERT_EQ(found.size(), 3u) << text;
  for (const bool simulated : {false, true}) {
    const std::string name = simulated ? "mpm" : "np";
    const auto& grids = found.at(name);
    ASSERT_EQ(grids.size(), size.pairs + 1);
    const ParticleSet particles = sample::particles(size);
    const auto motion = RecordReader(directory.path / "record.h5").motion(name);
    for (std::size_t k = 0; k < grids.size(); ++k) {
      EXPECT_DOUBLE_EQ(grids[k].time, sample::time(k));
      const MotionFrame f = motion->frame(k);
      std::vector<double> position, u, status, id, label, vertex;
      for (std::size_t p = 0; p < size.particles; ++p) {
        position.insert(position.end(),
                        {particles.x0[p].x() + double(f.u[p][0]), particles.x0[p].y() + double(f.u[p][1]), 0});
        u.insert(u.end(), {double(f.u[p][0]), double(f.u[p][1])});
        status.push_back(double(static_cast<int>(f.status[p])));
        id.push_back(double(particles.id[p]));
        label.push_back(double(particles.label[p]));
        vertex.push_back(double(p));
      }
      expect_values(grids[k].values.at("position"), position, "position");
      expect_values(grids[k].values.at("vertex"), vertex, "vertex");
      expect_values(grids[k].values.at("displacement"), u, "displacement");
      expect_values(grids[k].values.at("status"), status, "status");
      expect_values(grids[k].values.at("id"), id, "id");
      expect_values(grids[k].values.at("label"), label, "label");
      DerivedReader derived(*motion, true);
      for (const char* field : {"strain_dev", "strain_vol"}) expect_values(grids[k].values.at(field), derived.values(field, k), field);
      EXPECT_EQ(grids[k].values.contains("sigma_displacement_magnitude"), !f.cov_u.empty());
      if (!f.cov_u.empty())
        expect_values(grids[k].values.at("sigma_displacement_magnitude"), derived.values("sigma_displacement_magnitude", k), "sigma");
      EXPECT_EQ(grids[k].values.contains("stress"), simulated);
    }
  }
  const auto& piv = found.at("piv");
  ASSERT_EQ(piv.size(), size.pairs);
  for (std::size_t k = 0; k < piv.size(); ++k) {
    EXPECT_DOUBLE_EQ(piv[k].time, sample::time(k + 1));
    const VectorField f = RecordReader(directory.path / "record.h5").pair(k);
    std::vector<double> displacement, status, score;
    for (std::size_t n = 0; n < f.status.size(); ++n) {
      displacement.insert(displacement.end(), {double(f.displacement[n][0]), double(f.displacement[n][1])});
      status.push_back(double(static_cast<int>(f.status[n])));
      score.push_back(double(f.score[n]));
    }
    expect_values(piv[k].values.at("origin"), {0, f.grid.origin.y(), f.grid.origin.x()}, "origin");
    expect_values(piv[k].values.at("spacing"), {1, f.grid.spacing.y(), f.grid.spacing.x()}, "spacing");
    expect_values(piv[k].values.at("nodes"), {1, double(f.grid.ny), double(f.grid.nx)}, "nodes");
    expect_values(piv[k].values.at("displacement"), displacement, "displacement");
    expect_values(piv[k].values.at("status"), status, "status");
    expect_values(piv[k].values.at("score"), score, "score");
  }
#endif
}

TEST(ViewerTest, H5pyReadsTheRecordAsTheContractSays) {
  int code = -1;
  run_command("/usr/bin/python3 -c 'import h5py' 2>/dev/null", code);
  if (code != 0) GTEST_SKIP() << "h5py (python3-h5py) is not installed";
  const sample::Size size;
  test::Scratch directory;
  sample::run(directory.path, size, false);
  const std::string out = run_command("/usr/bin/python3 '" PIVNP_IO_TESTS "/check_record.py' '" +
                                          (directory.path / "record.h5").string() + "' '" PIVNP_FORMAT_DOC "' 2>&1",
                                      code);
  EXPECT_EQ(code, 0) << out;
  EXPECT_THAT(out, ::testing::HasSubstr("record agrees with the contract")) << out;
}

}  // namespace
}  // namespace pivnp::io
