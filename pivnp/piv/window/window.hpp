// One interrogation window of a warped pair: weighted, freed of its mean, masked pixels left out.
#pragma once

#include <vector>

#include "pivnp/piv/window/warp.hpp"
#include "pivnp/piv/window/window_kernels.hpp"

namespace pivnp::piv {

/// Two windows of side x side pixels with a border of zeros near_lags wide, rows `stride` apart.
/// The pixel weight is W = w^2, w(x, y) = w(x) w(y), w(x) = sqrt(1 - (2x/side)^2), centred on the node itself (not on a
/// pixel). W multiplies the products of the correlation once: w on each side.
struct Window {
  int side = 0, stride = 0;
  std::vector<float> a, b;                    // w (f - mean f), w (g - mean g)
  std::vector<float> weight;                  // w, 0 where a pixel must not be used
  float energy_a = 0, energy_b = 0;           // sums of squares of a and b
  float variance_f = 0, variance_g = 0;       // weighted variance of the grey values, grey^2
  float usable = 0, masked = 0, outside = 0;  // shares of the weight; they add up to 1

  explicit Window(int side_px);
  std::size_t index(int column, int row) const {
    return std::size_t(row + near_lags) * std::size_t(stride) + std::size_t(column + near_lags);
  }
  /// Cuts the window about (column, row) of the level out of the warped pair; without `weights` they are left as they
  /// were.
  void cut(const WarpedPair& pair, float column, float row, bool weights = true);

 private:
  std::vector<float> axis_x_, axis_y_;
};

/// Side of the tapered window whose noise equals that of an even one of `window_px`: 1.2 times it. (The weight
/// W = 1 - (2x/L)^2 averages noise like an even window of (sum W)^2 / sum W^2 = 0.833 L an axis.)
int support_of_window(int window_px);

/// Correlation of w with itself at lags 0 ... count - 1 over that at lag 0: the share by which the taper lowers the
/// correlation of windows displaced by the lag (Westerweel 1997).
std::vector<float> taper_correlation(int side, int count);

}  // namespace pivnp::piv
