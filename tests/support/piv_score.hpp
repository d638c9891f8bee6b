// Errors of measured vectors against the truth of a synthetic pair.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "pivnp/image/synthetic/synthetic_pair.hpp"
#include "pivnp/piv/piv.hpp"

namespace pivnp::piv {

/// Nodes `spacing` apart, j upward in the world: row 0 of the lattice is the lowest in the image.
inline NodeLattice even_nodes(int width, int height, double spacing, double margin, double shift = 0) {
  NodeLattice nodes;
  nodes.nx = static_cast<int>((width - 1 - 2 * margin) / spacing) + 1;
  nodes.ny = static_cast<int>((height - 1 - 2 * margin) / spacing) + 1;
  for (int j = 0; j < nodes.ny; ++j)
    for (int i = 0; i < nodes.nx; ++i)
      nodes.pixel.push_back({static_cast<float>(margin + shift + i * spacing),
                             static_cast<float>(height - 1 - margin - shift - j * spacing)});
  return nodes;
}

/// All over valid vectors but the shares of nodes.
struct Errors {
  double rms = 0;                         // of the worse component, px
  double bias = 0;                        // of the worse component, px
  double valid = 0;                       // share of the nodes scored
  double within_one = 0, within_two = 0;  // share of components whose error is within 1 and 2 standard deviations
  double largest = 0;
  double sigma = 0;  // median standard deviation stated for u
  double gain = 0;   // regression of what was found on the truth; NaN without motion
};

inline Errors errors(const image::SyntheticPair& scene, const NodeLattice& nodes, const PixelVectors& found,
                     const std::function<bool(const Vec2&)>& scored = {}) {
  double sum[2] = {0, 0}, square[2] = {0, 0}, one = 0, two = 0, cross = 0, truths = 0;
  std::size_t valid = 0, all = 0;
  Errors e;
  std::vector<double> sigmas;
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    const Vec2 place(nodes.pixel[k][0], nodes.pixel[k][1]);
    if (scored && !scored(place)) continue;
    ++all;
    if (found.status[k] != VectorStatus::valid) continue;
    ++valid;
    const Vec2 truth = scene.image::SyntheticPair::truth(place, found.anchor);
    for (std::size_t c = 0; c < 2; ++c) {
      const double t = truth[static_cast<Eigen::Index>(c)], error = found.displacement[k][c] - t;
      sum[c] += error, square[c] += error * error;
      cross += t * found.displacement[k][c], truths += t * t;
      e.largest = std::max(e.largest, std::abs(error));
      const double sigma = std::sqrt(found.cov[k][c]);
      one += std::abs(error) <= sigma, two += std::abs(error) <= 2 * sigma;
    }
    sigmas.push_back(std::sqrt(found.cov[k][0]));
  }
  const double n = static_cast<double>(valid);
  e.rms = std::sqrt(std::max(square[0], square[1]) / n);
  e.bias = std::max(std::abs(sum[0]), std::abs(sum[1])) / n;
  e.valid = n / static_cast<double>(all);
  e.within_one = one / (2 * n), e.within_two = two / (2 * n);
  e.gain = truths > 0 ? cross / truths : std::numeric_limits<double>::quiet_NaN();
  if (!sigmas.empty()) {
    std::nth_element(sigmas.begin(), sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2), sigmas.end());
    e.sigma = sigmas[sigmas.size() / 2];
  }
  return e;
}

/// Distance across a band (image::band through the image's middle) between -0.8 and +0.8 of its amplitude, px:
/// crossings of the mean profile in bins of 1 px, filled by interpolation. NaN where the profile does not reach them.
inline double band_width(const image::SyntheticPair& scene, const NodeLattice& nodes, const PixelVectors& found,
                         double amplitude, double half_width) {
  const double tilt = 5 * M_PI / 180, c = std::cos(tilt), s = std::sin(tilt);
  const double cx = 0.5 * (scene.width - 1), cy = 0.5 * (scene.height - 1);
  const int reach = static_cast<int>(6 * half_width + 16);
  struct Bin {
    double along = 0, across = 0, count = 0;
  };
  std::vector<Bin> bins(std::size_t(2 * reach + 1));
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    if (found.status[k] != VectorStatus::valid) continue;
    const double across = -s * (nodes.pixel[k][0] - cx) + c * (nodes.pixel[k][1] - cy);
    const double bin = std::round(across) + reach;
    if (bin < 0 || bin > 2 * reach) continue;
    Bin& b = bins[static_cast<std::size_t>(bin)];
    b.along += c * found.displacement[k][0] + s * found.displacement[k][1], b.across += across, ++b.count;
  }
  std::erase_if(bins, [](const Bin& b) { return b.count == 0; });
  for (Bin& b : bins) b.along /= b.count, b.across /= b.count;
  const auto crossing = [&](double level, int direction) {  // first one seen from the middle
    const auto n = static_cast<int>(bins.size());
    int start = 0;
    while (start < n && bins[std::size_t(start)].across < 0) ++start;
    for (int k = start - (direction > 0); k >= 0 && k < n && k + direction >= 0 && k + direction < n; k += direction) {
      const Bin &a = bins[std::size_t(k)], &b = bins[std::size_t(k + direction)];
      const double from = direction * a.along, to = direction * b.along;
      if (from <= level && to > level) return a.across + (level - from) / (to - from) * (b.across - a.across);
    }
    return std::numeric_limits<double>::quiet_NaN();
  };
  return crossing(0.8 * amplitude, 1) - crossing(0.8 * amplitude, -1);
}

}  // namespace pivnp::piv
