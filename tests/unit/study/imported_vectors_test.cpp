// Vectors of other programs through the whole chain: a pair that was measured here and written as each format gives the
// same particles, a format that is added arrives everywhere, and real files agree with what is measured here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "apps/case/listing.hpp"
#include "apps/study/pipeline/measure/imported_vectors.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "apps/study/study.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "pivnp/io/records/record.hpp"
#include "tests/support/added.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {
namespace {

namespace fs = std::filesystem;

SilentProgress silent;

RunOutcome run(const std::string& text, const fs::path& out, Stages stages = Stages::track) {
  RunSettings settings;
  settings.out = out;
  settings.threads = 1;
  Case c = parse_case(text, "case.toml", out.parent_path());
  c.name = "case";
  return run_case(c, settings, stages, silent);
}

std::string refusal(const std::string& text, const fs::path& out) {
  try {
    run(text, out);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

constexpr int height = 128;

struct Format {
  const char *name, *head, *row;  // of x, y, u, v in px, y downward, and a status
  double first_pixel;
  int codes[5];  // of masked, valid, replaced, rejected, failed
  double digits;
};
const Format written[] = {
    {"pivlab", "PIVlab, ASCII chart output\r\nx [px],y [px],u [px/frame],v [px/frame],Vector type [-]\r\n",
     "%.10g,%.10g,%.10g,%.10g,%d\r\n", 1, {0, 1, 2, 2, 2}, 1e-5},
    {"openpiv", "# x\ty\tu\tv\tflags\tmask\n", "%.4e\t%.4e\t%.4e\t%.4e\t%d\t0\n", 0, {1, 0, 2, 1, 1}, 3e-4},
    {"dice", "***\nCOORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,MATCH\n", "%.4E,%.4E,%.4E,%.4E,%d\n", 0,
     {-1, 0, 0, -1, -1}, 3e-4},
    {"csv", "x_px,y_px,u_px,v_px,status\n", "%.9g,%.9g,%.9g,%.9g,%d\n", 0, {0, 1, 2, 3, 4}, 1e-5}};

void write_as(const Format& format, const VectorField& field, const fs::path& file) {
  std::string text = format.head;
  for (int j = field.grid.ny - 1; j >= 0; --j)
    for (int i = 0; i < field.grid.nx; ++i) {
      const std::size_t n = field.grid.node(i, j);
      const Vec2 x = field.grid.position(i, j);
      // (Particles beside a surface read what was measured beyond it.)
      const VectorStatus status = field.status[n] == VectorStatus::outside ? VectorStatus::valid : field.status[n];
      char row[160];
      std::snprintf(row, sizeof row, format.row, x.x() + format.first_pixel, height - 1 - x.y() + format.first_pixel,
                    double(field.displacement[n][0]), -double(field.displacement[n][1]), format.codes[int(status)]);
      text += row;
    }
  std::ofstream(file, std::ios::binary) << text;
}

TEST(ImportedVectors, OfEachFormatGiveTheParticlesOfTheDirectRun) {
  const test::Scratch there;
  run(R"(
[grid]
spacing_px = 8
[piv]
closure = 0
[synth]
width_px = 128
height_px = 128
frames = 3
motion = "affine"
shift_px_per_frame = [1.3, -0.6]
gradient_per_frame = [0.010, 0.004, -0.006, -0.008]
centre_px = [64.0, 64.0]
)", there.path / "direct");
  const io::RecordReader direct(there.path / "direct" / "record.h5");
  const auto expected = direct.motion("np");
  for (const Format& format : written) {
    SCOPED_TRACE(format.name);
    const fs::path folder = there.path / format.name;
    fs::create_directories(folder);
    for (std::size_t k = 0; k < direct.pair_count(); ++k)
      write_as(format, direct.pair(k), folder / ("v_" + std::to_string(k) + ".txt"));
    const RunOutcome outcome = run("[camera]\norigin_px = [0.0, 127.0]\n[vectors]\npath = \"" + std::string(format.name) +
                                       "/v_*.txt\"\nanchor = \"central\"\nformat = \"" + format.name + "\"\n",
                                   there.path / "out");
    EXPECT_TRUE(std::any_of(outcome.remarks.begin(), outcome.remarks.end(),
                            [](const Remark& r) { return r.text.find("no uncertainty") != std::string::npos; }));
    const io::RecordReader record(outcome.record);
    EXPECT_EQ(record.head().grid, direct.head().grid);
    EXPECT_EQ(record.frames().size(), 3u);
    ASSERT_EQ(record.pair_count(), 2u);
    const auto motion = record.motion("np");
    ASSERT_EQ(motion->particles().id, expected->particles().id);
    const MotionFrame a = expected->frame(2), b = motion->frame(2);
    std::size_t followed = 0;
    for (std::size_t p = 0; p < a.u.size(); ++p) {
      ASSERT_EQ(a.status[p] == ParticleStatus::ended, b.status[p] == ParticleStatus::ended) << p;
      if (a.status[p] == ParticleStatus::ended) continue;
      ++followed;
      for (std::size_t c = 0; c < 2; ++c) EXPECT_NEAR(double(b.u[p][c]), double(a.u[p][c]), format.digits) << p;
      for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(double(b.F[p][c]), double(a.F[p][c]), format.digits) << p;
      EXPECT_TRUE(std::isnan(b.cov_u[p][0]));  // not stated, so not zero
    }
    EXPECT_GT(followed, 400u);
    EXPECT_TRUE(fs::exists(there.path / "out" / "figures" / "vectors_1.png"));
  }
}

// Two numbers a line at the nodes of a fixed grid.
io::ImportedVectors read_pairs(const fs::path& file, std::optional<double>) {
  io::ImportedVectors out;
  std::ifstream in(file);
  double u, v;
  for (int n = 0; n < 30 && in >> u >> v; ++n) {
    out.line.push_back(n + 1);
    out.x.push_back({8.0 * (n % 6), 8.0 * (n / 6)});
    out.d.push_back({u, v});
    out.sigma.push_back({0.1, 0.1});
  }
  return out;
}

std::string allowed_formats() {
  for (const SectionRow& section : case_sections())
    for (const KeyRow& row : section.keys)
      if (section.path == "vectors" && row.key == "format") return row.allowed;
  return "";
}

TEST(ImportedVectors, AnAddedFormatIsListedReadAndTracked) {
  const test::Scratch there;
  {
    std::ofstream file(there.path / "pairs_1.txt");
    for (int n = 0; n < 30; ++n) file << "0.5 -0.25\n";
  }
  const std::string text = "[vectors]\npath = \"pairs_*.txt\"\nformat = \"pairs\"\nrate_hz = 4.0\n";
  EXPECT_EQ(allowed_formats().find("pairs"), std::string::npos);
  EXPECT_NE(refusal(text, there.path / "out").find("case.toml:3: vectors.format"), std::string::npos);
  const test::Added pairs(io::file_formats(), {.name = "pairs", .files = "pairs_*.txt", .text = "pairs", .read_vectors = read_pairs});
  EXPECT_NE(allowed_formats().find("pairs"), std::string::npos);
  EXPECT_NE(case_reference().find("pairs"), std::string::npos);
  const io::RecordReader record(run(text, there.path / "out").record);
  const auto motion = record.motion("np");
  const MotionFrame last = motion->frame(1);
  EXPECT_EQ(last.time, 0.25);
  EXPECT_EQ(last.u[0], (std::array<float, 2>{0.5f, 0.25f}));
  EXPECT_NEAR(double(last.cov_u[0][0]), 0.01, 1e-6);
}

TEST(ImportedVectors, WhatDoesNotGoTogetherIsNamedWithItsLine) {
  const test::Scratch there;
  std::ofstream(there.path / "v_1.csv") << "x_m,y_m,u_m,v_m\n0,0,0,0\n1,0,0,0\n0,1,0,0\n1,1,0,0\n";
  const std::string vectors = "[vectors]\npath = \"v_*.csv\"\nformat = \"csv\"\n";
  const auto expect = [&](const std::string& more, const std::string& said) {
    const std::string found = refusal(vectors + more, there.path / "out");
    EXPECT_NE(found.find(said), std::string::npos) << "expected " << said << "\nfound " << found;
  };
  expect("[grid]\nspacing_px = 8\n", "case.toml:5: grid.spacing_px");
  expect("[synth]\n", "case.toml:1: [vectors]: given together with [synth]");
  expect("[np]\ndrift = \"corrected\"\n", "case.toml:5: np.drift");
  expect("[camera]\nmetres_per_pixel = 0.1\n", "case.toml:5: camera.metres_per_pixel");
  expect("[mask.a]\ncircle_px = [1.0, 1.0, 1.0]\n", "case.toml:4: mask.a");
  expect("[region.a]\npolygon_px = [[0, 0], [1, 0], [1, 1]]\n", "case.toml:5: region.a.polygon_px");
  expect("[piv]\n", "case.toml:4: [piv]");
  EXPECT_EQ(refusal(vectors, there.path / "out"), "");
}

// The files of real programs against what is measured here on the same frames: places and signs are right.
struct Real {
  const char *format, *vectors, *first, *second;
};
class RealVectors : public testing::TestWithParam<Real> {};

TEST_P(RealVectors, AgreeWithThoseMeasuredHere) {
  const char* data = std::getenv("PIVNP_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "PIVNP_TEST_DATA names no folder of published images";
  const Real& real = GetParam();
  const fs::path folder = data;
  const test::Scratch there;
  const fs::path ending = fs::path(real.first).extension();
  fs::copy_file(folder / real.first, there.path / ("f_1" + ending.string()));
  fs::copy_file(folder / real.second, there.path / ("f_2" + ending.string()));
  Case c = parse_case("[frames]\npath = \"f_*" + ending.string() + "\"\n[vectors]\npath = \"" + (folder / real.vectors).string() +
                          "\"\nformat = \"" + real.format + "\"\n", "case.toml", there.path);
  const auto source = image::open_frames(*c.frames, c.folder);
  const auto files = case_vectors(c, source.get());
  const Setting setting = make_setting(c, source->width(), source->height(), files.get());
  c.piv.emplace();
  c.piv->anchor = files->read(0).anchor;
  const VectorField theirs = imported_pair(*files, setting, 0), ours = measure_pair(c, setting, *source, {0, 1}, 1);
  std::vector<double> off[2];
  for (std::size_t n = 0; n < ours.status.size(); ++n)
    if (theirs.status[n] == VectorStatus::valid && ours.status[n] == VectorStatus::valid)
      for (std::size_t k = 0; k < 2; ++k) off[k].push_back(std::abs(double(theirs.displacement[n][k] - ours.displacement[n][k])));
  for (std::vector<double>& o : off) {
    ASSERT_GT(o.size(), ours.status.size() / 2);
    std::nth_element(o.begin(), o.begin() + std::ptrdiff_t(o.size() / 2), o.end());
    std::printf("%s: median difference %.3f px of %zu vectors\n", real.format, o[o.size() / 2], o.size());
    EXPECT_LT(o[o.size() / 2], 0.2);
  }
}
INSTANTIATE_TEST_SUITE_P(
    Published, RealVectors,
    testing::Values(Real{"pivlab", "sand_wedge/github_test_0001.txt", "sand_wedge/pjt_highfric_15deg_glass1cm_071619_crop_500.jpg",
                         "sand_wedge/pjt_highfric_15deg_glass1cm_071619_crop_501.jpg"},
                    Real{"openpiv", "openpiv/test5/frame_a.tif.txt", "openpiv/test5/frame_a.tif", "openpiv/test5/frame_b.tif"},
                    Real{"dice", "dic_challenge_12/DICe_solution_01.txt", "dic_challenge_12/oht_cfrp_00.tiff",
                         "dic_challenge_12/oht_cfrp_01.tiff"}),
    [](const auto& value) { return std::string(value.param.format); });

}  // namespace
}  // namespace pivnp::app
