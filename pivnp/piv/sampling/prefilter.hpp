// Recursive filters that turn samples into coefficients of quintic B-splines, many lines side by side.
#pragma once

#include <cstddef>

namespace pivnp::piv {

/// Lines are taken this many at a time: `lanes` below is a multiple of it.
inline constexpr int prefilter_lanes = 16;

/// Prefilters `lanes` lines side by side in place: sample k of line l is data[k * stride + l]. Mirror boundaries.
/// `smoothing` a: of (a, 1 - 2a, a) times the samples.
void prefilter_lines(float* data, int samples, std::ptrdiff_t stride, int lanes, float smoothing);

/// lines[c * lanes + r] = image[r * stride + c], c < columns, r < rows; both counts are rounded up to multiples of 4.
/// The second goes back.
void transpose_rows(const float* image, std::ptrdiff_t stride, int rows, int columns, int lanes, float* lines);
void transpose_back(const float* lines, int lanes, int rows, int columns, std::ptrdiff_t stride, float* image);

}  // namespace pivnp::piv
