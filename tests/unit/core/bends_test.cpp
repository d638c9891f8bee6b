// What smoothing took off a field that bends, from the smoothed field's Laplacians.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pivnp/core/grid/bends.hpp"

namespace pivnp {
namespace {

namespace sharpening {

constexpr int nx = 9, ny = 61;
constexpr double h = 6, l = 1.5;  // spacing, and length of the smoothing: a Gaussian of variance 2 l^2

double smoothed(double y, double w) {
  double sum = 0, weights = 0;
  for (double t = -6; t <= 6; t += 0.05) {
    const double weight = std::exp(-0.5 * t * t);
    sum += weight * w * std::tanh((y + t * std::sqrt(2.0) * l) / w), weights += weight;
  }
  return sum / weights;
}

double place(std::size_t node, double beside) { return h * (int(node) / nx - ny / 2) + beside; }

// l^2 times second differences along the rows of nodes, of a band beside the middle row.
std::vector<std::array<float, 2>> bends_of_band(double w, double beside) {
  std::vector<std::array<float, 2>> out;
  for (int j = 0; j < ny; ++j) {
    const double y = place(std::size_t(j * nx), beside);
    const double second = smoothed(y + h, w) + smoothed(y - h, w) - 2 * smoothed(y, w);
    out.insert(out.end(), nx, {float(l * l / (h * h) * second), 0});
  }
  return out;
}

}  // namespace sharpening

// From bands that nodes resolve to those of half a spacing, wherever they lie between the nodes: within a quarter of what
// smoothing took off inside; of the narrowest the bare differences show less than half.
TEST(Bends, SharpenedTheyAreWhatSmoothingTookOff) {
  using namespace sharpening;
  for (const double w : {3.0, 5.0, 8.0, 13.0, 30.0}) {
    double bare = 0, sharp = 0, lost = 0;
    for (double beside = 0; beside < h; beside += h / 8) {
      const std::vector<std::array<float, 2>> bends = bends_of_band(w, beside);
      std::vector<std::array<float, 2>> sharpened = bends;
      sharpen_bends(nx, ny, sharpened);
      for (std::size_t k = 0; k < bends.size(); k += nx) {
        const double y = place(k + nx / 2, beside), off = smoothed(y, w) - w * std::tanh(y / w);
        if (std::abs(y) > 1.2 * w) continue;
        const float at = bends[k + nx / 2][0], now = sharpened[k + nx / 2][0];
        bare += at * at, sharp += now * now, lost += off * off;
      }
    }
    EXPECT_NEAR(std::sqrt(sharp / lost), 1, 0.25) << w;
    if (w == 3) {
      EXPECT_LT(std::sqrt(bare / lost), 0.5);
    }
  }
}

TEST(Bends, NothingStaysNothingAndAlternationIsBounded) {
  std::vector<std::array<float, 2>> none(35, {0, 0}), steep(35);
  sharpen_bends(7, 5, none);
  for (std::size_t k = 0; k < steep.size(); ++k) steep[k] = {k % 2 == 0 ? 1.0f : -1.0f, 1e30f};
  sharpen_bends(7, 5, steep);
  for (std::size_t k = 0; k < none.size(); ++k) {
    EXPECT_EQ(none[k][0], 0);
    EXPECT_LE(std::abs(steep[k][0]), 5.5);
    EXPECT_TRUE(std::isfinite(steep[k][1]));
  }
}

}  // namespace
}  // namespace pivnp
