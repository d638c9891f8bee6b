// The loops over the pixels of a window. Plain pointers: each is compiled for every instruction set.
#pragma once

#include <cstddef>

namespace pivnp::piv {

/// Lags that are correlated directly, in each direction: -2 ... 2.
inline constexpr int near_lags = 2;

/// Columns that the loops below touch: they write zeros behind a window's side, and read what lies there.
constexpr int padded_columns(int side) { return (side + 15) / 16 * 16; }

/// out[k] = sqrt(1 - (2 (first + k) / side)^2), 0 where that is imaginary, k < padded_columns(side). Returns the sum of
/// squares.
float taper_weights(float first, int side, float* out);

struct WindowCut {
  const float *f, *g, *use, *masked;  // upper left pixel of the source; `masked` may be null
  std::ptrdiff_t source_stride;
  const float *wx, *wy;          // weights; wx holds padded_columns, zero where the source has none
  int side, first_row, end_row;  // rows that the source has
  float *a, *b, *weight;         // upper left pixel of the window, zero on all sides; `weight` may be null
  std::ptrdiff_t stride;
  bool whole;          // every pixel may be used: `use` and `masked` are not read
  float whole_weight;  // sum of (wx wy)^2
};

/// With v = wx wy use: sums of v^2 (1, f, g), of the masked pixels' (wx wy)^2, and of a^2 and b^2.
struct CutSums {
  float weight = 0, f = 0, g = 0, masked = 0, energy_a = 0, energy_b = 0;
};

/// weight = v, a = v (f - mean f), b = v (g - mean g), the means weighted with v^2.
CutSums cut_window(const WindowCut& cut);

/// Sums of a(x) b(x + s) over the lags -reach ... reach (at most near_lags) in each direction, into c[y][x] about its
/// middle. Both windows are read as one line: what a lag carries across a row's end meets a zero.
void near_sums(const float* a, const float* b, int side, std::ptrdiff_t stride, int reach,
               float (*c)[2 * near_lags + 1]);

/// D_x(x) = a(x) b(x + 1) - a(x + 1) b(x), D_y alike; xx, yy, xy: sums over all boxes of 5 x 5 pixels of the products
/// of their sums over the box; slope_x, slope_y: sums of w^2 times the squared central difference of a.
struct FlankSums {
  float xx = 0, yy = 0, xy = 0, slope_x = 0, slope_y = 0;
};
inline constexpr int flank_span = 5;

/// Sums over five rows in `scratch`: two planes with zeros before and behind each line.
struct FlankScratch {
  static constexpr int before = 16;
  int rows, line;
  explicit FlankScratch(int side)
      : rows(side + flank_span - 1), line(before + padded_columns(side + flank_span - 1) + before) {}
  int plane() const { return rows * line; }
  std::size_t floats() const { return 2 * std::size_t(plane()); }
};

/// `scratch`: as many floats as FlankScratch says, zero at the first call and left alone between calls.
FlankSums flank_sums(const float* a, const float* b, const float* w, int side, std::ptrdiff_t stride, float* scratch);

}  // namespace pivnp::piv
