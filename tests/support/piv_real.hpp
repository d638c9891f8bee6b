// Real and published images, each against what is known of it: one list of figures for the tests and the bench.
// Images are read with OpenCV directly: the figures are about the correlation, not our readers.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/piv/piv.hpp"
#include "tests/support/piv_score.hpp"

namespace pivnp::piv {

struct RealFigure {
  std::string name;
  double value = 0, limit = 0;
  bool at_least = false;
  bool met() const { return at_least ? value >= limit : value <= limit; }  // false for NaN
};

using RealFigures = std::vector<RealFigure>;

namespace real {

namespace fs = std::filesystem;

inline Image read(const fs::path& file) {
  const cv::Mat grey = cv::imread(file.string(), cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH);
  if (grey.empty()) throw std::runtime_error(file.string() + ": cannot be read");
  const bool eight = grey.depth() == CV_8U;
  Image image(grey.cols, grey.rows, eight ? PixelDepth::u8 : PixelDepth::u16, eight ? 255.0f : 65535.0f);
  for (int r = 0; r < grey.rows; ++r) std::memcpy(image.row<std::byte>(r), grey.ptr(r), std::size_t(image.stride()));
  return image;
}

inline double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

inline PixelVectors correlate(const Image& a, const Image& b, const NodeLattice& nodes, PivOptions options,
                              Anchor anchor, int threads) {
  options.anchor = anchor;
  return PairCorrelator(options, nodes, a.width(), a.height(), threads).correlate(a.view(), b.view(), {});
}

struct Field {
  double mean[2] = {0, 0}, median_of[2] = {0, 0}, valid = 0;
};

inline Field summarise(const PixelVectors& found) {
  std::vector<double> d[2];
  double asked = 0;
  for (std::size_t k = 0; k < found.status.size(); ++k) {
    asked += found.status[k] != VectorStatus::masked;
    if (found.status[k] != VectorStatus::valid) continue;
    for (std::size_t c = 0; c < 2; ++c) d[c].push_back(found.displacement[k][c]);
  }
  Field f;
  for (std::size_t c = 0; c < 2; ++c) {
    for (const double x : d[c]) f.mean[c] += x / static_cast<double>(d[c].size());
    f.median_of[c] = median(d[c]);
  }
  f.valid = static_cast<double>(d[0].size()) / asked;
  return f;
}

/// SEM DIC Challenge 2D, sample 14: u(x) of .1 px, of growing frequency; truth per column. Over columns: rms of the
/// mean over rows. Forward anchor (the truth belongs to the first frame).
inline RealFigures dic_challenge_14(const fs::path& data, const PivOptions& options, int threads) {
  RealFigures figures;
  const fs::path folder = data / "dic_challenge_14";
  std::vector<std::array<double, 7>> truth;
  std::ifstream table(folder / "command.csv");
  for (std::string line; std::getline(table, line);) {
    std::array<double, 7> row{};
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &row[0], &row[1], &row[2], &row[3], &row[4], &row[5],
                    &row[6]) == 7)
      truth.push_back(row);
  }
  const Image reference = read(folder / "Sample14 Reference.tif");
  const NodeLattice nodes = even_nodes(reference.width(), reference.height(), 8, 32);
  const std::pair<const char*, double> images[] = {{"L1", 0.004}, {"L5", 0.008}};
  for (const auto& [name, limit] : images) {
    const std::size_t column = name[1] == '1' ? 1 : 5;
    const PixelVectors found = correlate(reference, read(folder / ("Sample14 " + std::string(name) + " Amp0.1b.tif")),
                                         nodes, options, Anchor::forward, threads);
    std::vector<double> sum(std::size_t(nodes.nx), 0), count(std::size_t(nodes.nx), 0);
    for (std::size_t k = 0; k < nodes.pixel.size(); ++k)
      if (found.status[k] == VectorStatus::valid)
        sum[k % std::size_t(nodes.nx)] += found.displacement[k][0], count[k % std::size_t(nodes.nx)] += 1;
    double square = 0, columns = 0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      if (count[i] == 0) continue;
      const double error = sum[i] / count[i] - truth.at(static_cast<std::size_t>(nodes.pixel[i][0]))[column];
      square += error * error, columns += 1;
    }
    figures.push_back(
        {"DIC Challenge 14 " + std::string(name) + ": rms over columns, px", std::sqrt(square / columns), limit});
    figures.push_back({"DIC Challenge 14 " + std::string(name) + ": valid", summarise(found).valid, 0.98, true});
  }
  return figures;
}

/// Whole-pixel shifts (+k, +k) of a speckle pattern: how far the field's mean is off.
inline RealFigures dice_rigid_shift(const fs::path& data, const PivOptions& options, int threads) {
  RealFigures figures;
  const Image ref = read(data / "dice_rigid_shift/ref.tif");
  const NodeLattice nodes = even_nodes(ref.width(), ref.height(), 16, 40);
  for (const int k : {1, 2, 5, 10, 15}) {
    const std::string shift = std::to_string(k);
    const Image def = read(data / ("dice_rigid_shift/def_" + shift + ".tif"));
    const Field f = summarise(correlate(ref, def, nodes, options, options.anchor, threads));
    const double off = std::max(std::abs(f.mean[0] - k), std::abs(f.mean[1] - k));
    figures.push_back({"whole-pixel shift " + shift + ": error of the field's mean, px", off, 0.005});
    figures.push_back({"whole-pixel shift " + shift + ": valid", f.valid, 0.98, true});
  }
  return figures;
}

/// First-order deformations of a speckle pattern: largest error of the gradients fitted to the field (forward anchor).
inline RealFigures speckle_affine(const fs::path& data, const PivOptions& options, int threads) {
  RealFigures figures;
  const Image ref = read(data / "speckle_affine/Pattern_1.bmp");
  const NodeLattice nodes = even_nodes(ref.width(), ref.height(), 16, 40);
  const std::pair<const char*, std::array<double, 4>> images[] = {{"Tension", {0.02, 0, 0, -0.01}},
                                                                  {"Shear", {0, 0.01, 0.01, 0}}};
  for (const auto& [name, truth] : images) {
    const Image def = read(data / ("speckle_affine/Pattern_1_" + std::string(name) + ".bmp"));
    const PixelVectors found = correlate(ref, def, nodes, options, Anchor::forward, threads);
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> sums = Eigen::Matrix<double, 3, 2>::Zero();
    for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
      if (found.status[k] != VectorStatus::valid) continue;
      const Eigen::Vector3d p(1, nodes.pixel[k][0] - 250, nodes.pixel[k][1] - 250);
      normal += p * p.transpose();
      sums += p * Eigen::RowVector2d(found.displacement[k][0], found.displacement[k][1]);
    }
    const Eigen::Matrix<double, 3, 2> fit = normal.ldlt().solve(sums);
    const double off = std::max({std::abs(fit(1, 0) - truth[0]), std::abs(fit(2, 0) - truth[1]),
                                 std::abs(fit(1, 1) - truth[2]), std::abs(fit(2, 1) - truth[3])});
    figures.push_back({"speckle pattern, " + std::string(name) + ": error of the gradients", off, 2e-4});
    figures.push_back({"speckle pattern, " + std::string(name) + ": valid", summarise(found).valid, 0.98, true});
  }
  return figures;
}

/// Uniform diagonal shifts NNN/32 px by the files' names (inferred): how far the median is off, for both anchors. The
/// particles are about one pixel wide.
inline RealFigures test14(const fs::path& data, const PivOptions& options, int threads) {
  RealFigures figures;
  for (const Anchor anchor : {Anchor::forward, Anchor::central})
    for (const char* name : {"096", "104", "112", "128"}) {
      const std::string stem = std::string("openpiv/test14_disp_series/disp_") + name;
      const Image a = read(data / (stem + "a.bmp")), b = read(data / (stem + "b.bmp"));
      const Field f = summarise(correlate(a, b, even_nodes(a.width(), a.height(), 16, 24), options, anchor, threads));
      const double shift = std::atoi(name) / 32.0;
      const double off =
          std::max(std::abs(std::abs(f.median_of[0]) - shift), std::abs(std::abs(f.median_of[1]) - shift));
      const std::string title = "test14 " + std::string(name) + ", " + std::string(name_of(anchor));
      figures.push_back({title + ": error of the median, px", off, 0.02});
      figures.push_back({title + ": valid", f.valid, 0.95, true});
    }
  return figures;
}

/// Another program's vectors at the nodes of a lattice, row downward; NaN where it has none.
struct Theirs {
  NodeLattice nodes;
  std::vector<std::array<double, 2>> displacement;
};

/// Median difference of the worse component over vectors valid in both, and our share of valid ones.
struct Difference {
  std::vector<double> d[2];
  double valid = 0, fields = 0;

  void add(const PixelVectors& ours, const Theirs& theirs) {
    for (std::size_t k = 0; k < theirs.displacement.size(); ++k) {
      if (ours.status[k] != VectorStatus::valid || std::isnan(theirs.displacement[k][0])) continue;
      for (std::size_t c = 0; c < 2; ++c) d[c].push_back(std::abs(ours.displacement[k][c] - theirs.displacement[k][c]));
    }
    valid += summarise(ours).valid, fields += 1;
  }
  RealFigures figures(const std::string& name, double limit, double least_valid) const {
    return {{name + ": median difference, px", std::max(median(d[0]), median(d[1])), limit},
            {name + ": valid", valid / fields, least_valid, true}};
  }
};

/// Points on a grid in any order, as rows (x, y, u, v) with row downward: sorted into a lattice; gaps are NaN.
inline Theirs on_lattice(const std::vector<std::array<double, 4>>& points) {
  std::map<double, int> columns, rows;
  for (const auto& p : points) columns[p[0]] = 0, rows[-p[1]] = 0;
  int n = 0;
  for (auto& [x, i] : columns) i = n++;
  n = 0;
  for (auto& [y, j] : rows) j = n++;
  Theirs theirs;
  theirs.nodes.nx = static_cast<int>(columns.size()), theirs.nodes.ny = static_cast<int>(rows.size());
  for (const auto& [y, j] : rows)
    for (const auto& [x, i] : columns) theirs.nodes.pixel.push_back({static_cast<float>(x), static_cast<float>(-y)});
  theirs.displacement.assign(theirs.nodes.pixel.size(), {NAN, NAN});
  for (const auto& p : points)
    theirs.displacement[std::size_t(rows[-p[1]] * theirs.nodes.nx + columns[p[0]])] = {p[2], p[3]};
  return theirs;
}

/// OpenPIV: v upward, rows counted upward within the grid; vectors it did not mask.
inline RealFigures openpiv(const fs::path& data, const PivOptions& options, int threads) {
  RealFigures figures;
  const std::array<const char*, 3> pairs[] = {
      {"test5/frame_a.tif", "test5/frame_b.tif", "OpenPIV test5"},
      {"test10_pivchallenge_B/B001_1.tif", "test10_pivchallenge_B/B001_2.tif", "OpenPIV test10"},
      {"test14_disp_series/disp_096a.bmp", "test14_disp_series/disp_096b.bmp", "OpenPIV test14"}};
  for (const auto& [a, b, name] : pairs) {
    std::ifstream text(data / "openpiv" / (std::string(a) + ".txt"));
    std::vector<std::array<double, 4>> points;
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (std::string line; std::getline(text, line);) {
      double x, y, u, v, mask = 0;
      if (std::sscanf(line.c_str(), "%lf %lf %lf %lf %lf", &x, &y, &u, &v, &mask) < 4) continue;
      least = std::min(least, y), most = std::max(most, y);
      points.push_back(mask != 0 ? std::array{x, y, double(NAN), double(NAN)} : std::array{x, y, u, -v});
    }
    for (auto& p : points) p[1] = least + most - p[1];
    const Theirs theirs = on_lattice(points);
    Difference difference;
    difference.add(
        correlate(read(data / "openpiv" / a), read(data / "openpiv" / b), theirs.nodes, options, Anchor::central,
                  threads),
        theirs);
    for (const RealFigure& f : difference.figures(name, 0.07, 0.8)) figures.push_back(f);
  }
  return figures;
}

/// DICe on carbon fibre with a hole (DIC Challenge sample 12): forward anchor, row downward.
inline RealFigures dice(const fs::path& data, const PivOptions& options, int threads) {
  std::ifstream text(data / "dic_challenge_12/DICe_solution_01.txt");
  std::vector<std::array<double, 4>> points;
  for (std::string line; std::getline(text, line);) {
    std::array<double, 4> p{};
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &p[0], &p[1], &p[2], &p[3]) == 4) points.push_back(p);
  }
  const Theirs theirs = on_lattice(points);
  Difference difference;
  difference.add(correlate(read(data / "dic_challenge_12/oht_cfrp_00.tiff"),
                           read(data / "dic_challenge_12/oht_cfrp_01.tiff"), theirs.nodes, options, Anchor::forward,
                           threads),
                 theirs);
  return difference.figures("DICe, sample 12", 0.03, 0.9);
}

/// PIVlab on sand and glass beads, 19 pairs (1-based pixels, row downward, forward anchor).
inline RealFigures pivlab(const fs::path& data, const PivOptions& options, int threads) {
  std::vector<fs::path> frames;
  for (const auto& entry : fs::directory_iterator(data / "sand_wedge"))
    if (entry.path().extension() == ".jpg") frames.push_back(entry.path());
  std::sort(frames.begin(), frames.end());
  if (frames.size() != 20) throw std::runtime_error((data / "sand_wedge").string() + ": expected 20 frames");
  Difference difference;
  for (std::size_t pair = 0; pair + 1 < frames.size(); ++pair) {
    char name[64];
    std::snprintf(name, sizeof name, "sand_wedge/github_test_%04zu.txt", pair + 1);
    std::ifstream text(data / name);
    std::vector<std::array<double, 4>> points;
    for (std::string line; std::getline(text, line);) {
      double x, y, u = NAN, v = NAN;
      if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &x, &y, &u, &v) >= 2) points.push_back({x - 1, y - 1, u, v});
    }
    const Theirs theirs = on_lattice(points);
    difference.add(correlate(read(frames[pair]), read(frames[pair + 1]), theirs.nodes, options, Anchor::forward,
                             threads),
                   theirs);
  }
  return difference.figures("PIVlab, sand wedge", 0.15, 0.7);
}

}  // namespace real

using RealSet = RealFigures (*)(const std::filesystem::path& data, const PivOptions& options, int threads);
inline constexpr RealSet real_sets[] = {real::dic_challenge_14,
                                        real::dice_rigid_shift,
                                        real::speckle_affine,
                                        real::test14,
                                        real::openpiv,
                                        real::dice,
                                        real::pivlab};

}  // namespace pivnp::piv
