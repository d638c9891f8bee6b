// Outliers put into true fields of vectors: how many of them the validation finds, and how many good ones it rejects.
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/piv/piv.hpp"
#include "pivnp/piv/validation/median_test.hpp"

namespace pivnp::piv {

inline constexpr double outlier_shares[] = {0.05, 0.10, 0.20};

/// Where outliers are: each node by itself, blocks of 3 x 3 with a vector of its own each, blocks moved as one.
enum class OutlierKind { single, cluster, moved_cluster };

inline const char* name(OutlierKind kind) {
  return kind == OutlierKind::single ? "single" : kind == OutlierKind::cluster ? "3x3" : "3x3 as one";
}

struct OutlierField {
  std::string name;
  std::function<Vec2(int, int)> displacement;  // of node (i, j), px
};

inline std::vector<OutlierField> outlier_fields() {
  return {{"uniform", [](int, int) { return Vec2(2.3, -1.4); }},
          {"shear 20 % at 8 px", [](int, int j) { return Vec2(1.6 * j, 0); }},
          {"sine 128 px at 8 px", [](int i, int j) {
             return Vec2(std::sin(2 * M_PI * (j - 0.087 * i) / 16), 0.087 * std::sin(2 * M_PI * (j - 0.087 * i) / 16));
           }}};
}

struct OutlierCounts {
  double outliers = 0, hit = 0, good = 0, rejected = 0;
  void add(const OutlierCounts& o) { outliers += o.outliers, hit += o.hit, good += o.good, rejected += o.rejected; }
  double found() const { return hit / outliers; }
  double false_alarms() const { return rejected / good; }
  bool met() const { return found() >= 0.95 && false_alarms() <= 0.02; }
};

/// 64 x 48 nodes with normal errors of .03 px; outliers miss the truth by 1 to 10 px, evenly, in any direction.
inline OutlierCounts inject(const OutlierField& field, OutlierKind kind, double share, const PivOptions& options,
                            unsigned seed, int threads) {
  constexpr int nx = 64, ny = 48;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 0.03);
  std::uniform_real_distribution<double> even(0, 1);
  VectorGrid grid{nx, ny, {}, std::vector<std::uint8_t>(nx * ny, 1)};
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec2 d = field.displacement(i, j);
      const double u = d.x() + normal(random), v = d.y() + normal(random);
      grid.displacement.push_back({static_cast<float>(u), static_cast<float>(v)});
    }
  const auto miss = [&] {
    const double angle = 2 * M_PI * even(random), length = 1 + 9 * even(random);
    return Vec2(length * std::cos(angle), length * std::sin(angle));
  };
  std::vector<std::uint8_t> outlier(grid.good.size(), 0);
  const auto wanted = static_cast<int>(std::ceil(share * nx * ny));
  const int size = kind == OutlierKind::single ? 1 : 3;
  for (int spoilt = 0; spoilt < wanted;) {
    const int i0 = static_cast<int>(even(random) * (nx - size + 1)),
              j0 = static_cast<int>(even(random) * (ny - size + 1));
    bool taken = false;  // blocks do not overlap, though they may touch
    for (int b = 0; b < size * size; ++b) taken |= outlier[std::size_t((j0 + b / size) * nx + i0 + b % size)] != 0;
    if (taken) continue;
    Vec2 by = miss();
    for (int b = 0; b < size * size; ++b, ++spoilt) {
      const auto k = std::size_t((j0 + b / size) * nx + i0 + b % size);
      outlier[k] = 1;
      grid.displacement[k][0] += static_cast<float>(by.x()), grid.displacement[k][1] += static_cast<float>(by.y());
      if (kind == OutlierKind::cluster) by = miss();
    }
  }
  median_test(grid, options.median_threshold, options.median_floor_px, threads);
  OutlierCounts c;
  for (std::size_t k = 0; k < outlier.size(); ++k) {
    (outlier[k] ? c.outliers : c.good) += 1;
    if (!grid.good[k]) (outlier[k] ? c.hit : c.rejected) += 1;
  }
  return c;
}

}  // namespace pivnp::piv
