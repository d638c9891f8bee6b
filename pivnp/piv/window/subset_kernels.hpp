// The loops over the pixels of a subset: a square of odd side whose places in an image are given by a warp. Plain
// pointers: each is compiled for every instruction set.
#pragma once

#include <cstddef>

#include "pivnp/piv/sampling/spline_image.hpp"

namespace pivnp::piv {

/// Places in an image, in pixels: x + A (a, b) + bend (a^2, a b, b^2).
struct SubsetWarp {
  double x = 0, y = 0;
  double A[2][2] = {{1, 0}, {0, 1}};
  double bend[2][3] = {};
};

/// Floats of a row of a plane. Planes are `side` rows of them; what lies behind a row's `side` is written, and without
/// meaning until `centre_subset` or `slopes_of` make it zero.
constexpr int subset_stride(int side) { return (side + 15) / 16 * 16; }

/// Samples the image at the warp's places of (first_a + k, first_b + j), k < columns, j < rows; places outside the
/// image are moved to its edge. `scratch`: 2 stride floats.
void warp_subset(const SplineImage& image, const SubsetWarp& warp, double first_a, double first_b, int columns,
                 int rows, std::ptrdiff_t stride, float* scratch, float* out);

/// Frees a plane of its mean over the pixels used (use = 1; 0 elsewhere, where zeros are written), returns the sum of
/// squares.
double centre_subset(float* plane, const float* use, int side, double number);

/// slope = use (high - low).
void slopes_of(const float* high, const float* low, const float* use, int side, float* slope);

/// Sums over the pixels (a, b) of a subset about its middle of (fx^2, fx fy, fy^2) x (1, a, b, a^2, a b, b^2).
void slope_products(const float* fx, const float* fy, int side, double (*sums)[6]);

/// Sums of e (fx, fx a, fx b, fy, fy a, fy b) with the residual e = f - gain g.
void residual_slopes(const float* f, const float* g, float gain, const float* fx, const float* fy, int side,
                     double* sums);

/// Sums of e^2, f g and, for q = fx e and fy e: of q^2, and of the squares of q's sums over all squares of
/// `residual_span` pixels.
struct ResidualSums {
  double squares = 0, product = 0;
  double alone = 0, together = 0;
};
inline constexpr int residual_span = 4;

/// Sums over four rows: two planes with zeros before and behind each line.
struct ResidualScratch {
  static constexpr int before = 16;
  int rows, line;
  explicit ResidualScratch(int side)
      : rows(side + residual_span - 1), line(before + subset_stride(side + residual_span - 1) + before) {}
  int plane() const { return rows * line; }
  std::size_t floats() const { return 2 * std::size_t(plane()); }
};

/// `scratch`: as many floats as ResidualScratch says, zero at the first call and left alone between calls.
ResidualSums residual_sums(const float* f, const float* g, float gain, const float* fx, const float* fy, int side,
                           float* scratch);

/// Sum of a b.
double product_sum(const float* a, const float* b, int side);

}  // namespace pivnp::piv
