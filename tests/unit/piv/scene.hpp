// Pairs of synthetic frames with known displacement, and errors of what was measured on them.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "pivnp/image/synthetic.hpp"
#include "pivnp/piv/piv.hpp"

namespace pivnp::piv {

/// Displacement that a particle at a place (column, row) of the first frame undergoes.
using Motion = std::function<Vec2(const Vec2&)>;

inline Motion uniform(double u, double v) {
  return [=](const Vec2&) { return Vec2(u, v); };
}
inline Motion rotation(double degrees, double cx, double cy) {
  const double a = degrees * M_PI / 180;
  return [=](const Vec2& p) {
    const double x = p.x() - cx, y = p.y() - cy;
    return Vec2(std::cos(a) * x - std::sin(a) * y - x, std::sin(a) * x + std::cos(a) * y - y);
  };
}
inline Motion plain_shear(double slope, double middle) {
  return [=](const Vec2& p) { return Vec2(slope * (p.y() - middle), 0); };
}
/// Triangle wave in y, period 256 px, as in the comparison of other programs.
inline Motion triangle_shear(double slope) {
  return [=](const Vec2& p) {
    const double phase = p.y() / 256 - std::floor(p.y() / 256);
    return Vec2(slope * 64 * (phase < 0.5 ? 4 * phase - 1 : 3 - 4 * phase), 0);
  };
}
/// Shear wave of the named length across its own direction, tilted 5 degrees.
inline Motion sine(double amplitude, double length) {
  const double t = 5 * M_PI / 180, c = std::cos(t), s = std::sin(t);
  return [=](const Vec2& p) {
    const double a = amplitude * std::sin(2 * M_PI * (-s * p.x() + c * p.y()) / length);
    return Vec2(a * c, a * s);
  };
}
/// A tanh of half-width w across a line through (cx, cy), tilted 5 degrees.
inline Motion band(double amplitude, double half_width, double cx, double cy) {
  const double t = 5 * M_PI / 180, c = std::cos(t), s = std::sin(t);
  return [=](const Vec2& p) {
    const double a = amplitude * std::tanh((-s * (p.x() - cx) + c * (p.y() - cy)) / half_width);
    return Vec2(a * c, a * s);
  };
}

struct Scene {
  Motion motion;
  int width = 0, height = 0;
  Image first, second;

  /// Truth at a place of the lattice: forward, of the particle there in the first frame; central, of the particle whose
  /// mid-point is there (by fixed-point iteration).
  Vec2 truth(const Vec2& place, bool central) const {
    if (!central) return motion(place);
    Vec2 start = place;
    for (int k = 0; k < 60; ++k) start = place - 0.5 * motion(start);
    return motion(start);
  }
};

/// Particles are drawn over a margin beyond the image, so that they enter where others leave; lost ones reappear at
/// random.
inline Scene make_scene(Motion motion, int width, int height, image::TextureOptions texture) {
  constexpr double margin = 48;
  const auto mix = [](std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  };
  const auto random = [&](std::uint64_t k) {
    return static_cast<double>(
               mix((static_cast<std::uint64_t>(texture.seed) << 40) + (k + 1) * 0x9e3779b97f4a7c15ull) >> 11) *
           0x1.0p-53;
  };
  const auto place = [&](std::uint64_t k) {
    return Vec2(random(2 * k) * (width + 2 * margin) - margin - 0.5,
                random(2 * k + 1) * (height + 2 * margin) - margin - 0.5);
  };
  const auto count = static_cast<std::size_t>(texture.density_per_px * (width + 2 * margin) * (height + 2 * margin));
  std::vector<Vec2> before(count), after(count);
  for (std::size_t k = 0; k < count; ++k) before[k] = place(k), after[k] = before[k] + motion(before[k]);
  const image::BlobRenderer renderer(texture, width, height);
  for (const std::size_t k : renderer.lost(count, 1)) after[k] = place(count + k);
  return {std::move(motion), width, height, renderer.draw(before, 0, 2), renderer.draw(after, 1, 2)};
}

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

struct Errors {
  double rms = 0;                         // of the worse component, over valid vectors, px
  double bias = 0;                        // of the worse component
  double valid = 0;                       // share of all nodes
  double within_one = 0, within_two = 0;  // share of components whose error is within 1 and 2 standard deviations
  double largest = 0;
  double sigma = 0;  // median standard deviation stated for u
};

inline Errors errors(const Scene& scene, const NodeLattice& nodes, const PixelVectors& found,
                     const std::function<bool(const Vec2&)>& scored = {}) {
  double sum[2] = {0, 0}, square[2] = {0, 0}, one = 0, two = 0;
  std::size_t valid = 0, all = 0;
  Errors e;
  std::vector<double> sigmas;
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    const Vec2 place(nodes.pixel[k][0], nodes.pixel[k][1]);
    if (scored && !scored(place)) continue;
    ++all;
    if (found.status[k] != VectorStatus::valid) continue;
    ++valid;
    const Vec2 truth = scene.truth(place, found.anchor == Anchor::central);
    for (std::size_t c = 0; c < 2; ++c) {
      const double error = found.displacement[k][c] - truth[static_cast<Eigen::Index>(c)];
      sum[c] += error, square[c] += error * error;
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
  if (!sigmas.empty()) {
    std::nth_element(sigmas.begin(), sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2), sigmas.end());
    e.sigma = sigmas[sigmas.size() / 2];
  }
  return e;
}

inline PixelVectors measure(const Scene& scene, const NodeLattice& nodes, const PivOptions& options = {},
                            int threads = 1, const MaskView& mask = {}) {
  PairCorrelator correlator(options, nodes, scene.width, scene.height, threads);
  return correlator.correlate(scene.first.view(), scene.second.view(), mask);
}

}  // namespace pivnp::piv
