#include "pivnp/piv/window/subset_kernels.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/piv/window/subset_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include "pivnp/piv/sampling/sample_row-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::piv::HWY_NAMESPACE {

using SubsetD = hn::CappedTag<float, 16>;
using SubsetV = hn::Vec<SubsetD>;

HWY_INLINE int subset_lanes() { return static_cast<int>(hn::Lanes(SubsetD())); }
HWY_INLINE double row_total(SubsetV v) { return static_cast<double>(hn::GetLane(hn::SumOfLanes(SubsetD(), v))); }

// Where the places of a row lie from the pixels base, base + 1, ...: small numbers, as single precision wants them.
HWY_INLINE int row_offsets(double start, double slope, double curvature, double first_a, int count, float* out) {
  const SubsetD d;
  const double base = std::clamp(std::round(start), -1e6, 1e6);
  const SubsetV from = hn::Set(d, static_cast<float>(start - base)), along = hn::Set(d, static_cast<float>(slope));
  const SubsetV bend = hn::Set(d, static_cast<float>(curvature)),
                two_first = hn::Set(d, static_cast<float>(2 * first_a));
  for (int k = 0; k < count; k += subset_lanes()) {
    const SubsetV n = hn::Iota(d, static_cast<float>(k));
    // bend ((first + n)^2 - first^2) = bend n (2 first + n)
    const SubsetV rise = hn::MulAdd(bend, hn::Add(two_first, n), along);
    hn::StoreU(hn::MulAdd(n, rise, from), d, out + k);
  }
  return static_cast<int>(base);
}

void warp_rows(const SplineImage& image, const SubsetWarp& warp, double first_a, double first_b, int columns, int rows,
               std::ptrdiff_t stride, float* scratch, float* out) {
  const int lanes = subset_lanes(), count = (columns + lanes - 1) / lanes * lanes;
  float *ux = scratch, *uy = scratch + stride;
  for (int j = 0; j < rows; ++j) {
    const double a = first_a, b = first_b + j;
    const auto start = [&](int q) {
      const double* c = warp.bend[q];
      return (q == 0 ? warp.x : warp.y) + warp.A[q][0] * a + warp.A[q][1] * b + c[0] * a * a + c[1] * a * b +
             c[2] * b * b;
    };
    const int column =
        row_offsets(start(0), warp.A[0][0] + warp.bend[0][1] * b - 1, warp.bend[0][0], first_a, count, ux);
    const int row = row_offsets(start(1), warp.A[1][0] + warp.bend[1][1] * b, warp.bend[1][0], first_a, count, uy);
    sample_row(image, nullptr, column, row, ux, uy, count, out + j * stride, nullptr);
  }
}

double centre(float* plane, const float* use, int side, double number) {
  const SubsetD d;
  const std::ptrdiff_t stride = subset_stride(side);
  double sum = 0, energy = 0;
  for (int j = 0; j < side; ++j) {
    SubsetV row = hn::Zero(d);
    for (int k = 0; k < side; k += subset_lanes())
      row = hn::MulAdd(hn::LoadU(d, use + j * stride + k), hn::LoadU(d, plane + j * stride + k), row);
    sum += row_total(row);
  }
  const SubsetV mean = hn::Set(d, static_cast<float>(sum / number));
  for (int j = 0; j < side; ++j) {
    SubsetV row = hn::Zero(d);
    for (std::ptrdiff_t k = 0; k < stride; k += subset_lanes()) {
      float* at = plane + j * stride + k;
      const SubsetV v = hn::Mul(hn::LoadU(d, use + j * stride + k), hn::Sub(hn::LoadU(d, at), mean));
      hn::StoreU(v, d, at);
      row = hn::MulAdd(v, v, row);
    }
    energy += row_total(row);
  }
  return energy;
}

void slopes(const float* high, const float* low, const float* use, int side, float* slope) {
  const SubsetD d;
  const std::ptrdiff_t stride = subset_stride(side);
  for (std::ptrdiff_t k = 0; k < side * stride; k += subset_lanes())
    hn::StoreU(hn::Mul(hn::LoadU(d, use + k), hn::Sub(hn::LoadU(d, high + k), hn::LoadU(d, low + k))), d, slope + k);
}

void slope_products_of(const float* fx, const float* fy, int side, double (*sums)[6]) {
  const SubsetD d;
  const std::ptrdiff_t stride = subset_stride(side);
  const int half = side / 2;
  for (int q = 0; q < 3; ++q) std::fill_n(sums[q], 6, 0.0);
  for (int j = 0; j < side; ++j) {
    SubsetV row[3][3];
    for (auto& of : row)
      for (SubsetV& s : of) s = hn::Zero(d);
    for (int k = 0; k < side; k += subset_lanes()) {
      const SubsetV x = hn::LoadU(d, fx + j * stride + k), y = hn::LoadU(d, fy + j * stride + k);
      const SubsetV a = hn::Iota(d, static_cast<float>(k - half));
      const SubsetV products[3] = {hn::Mul(x, x), hn::Mul(x, y), hn::Mul(y, y)};
      for (int q = 0; q < 3; ++q) {
        const SubsetV moment = hn::Mul(products[q], a);
        row[q][0] = hn::Add(row[q][0], products[q]);
        row[q][1] = hn::Add(row[q][1], moment);
        row[q][2] = hn::MulAdd(moment, a, row[q][2]);
      }
    }
    const double b = j - half;
    for (int q = 0; q < 3; ++q) {
      const double plain = row_total(row[q][0]), first = row_total(row[q][1]), second = row_total(row[q][2]);
      const double terms[6] = {plain, first, b * plain, second, b * first, b * b * plain};
      for (int t = 0; t < 6; ++t) sums[q][t] += terms[t];
    }
  }
}

void residual_slopes_of(const float* f, const float* g, float gain, const float* fx, const float* fy, int side,
                        double* sums) {
  const SubsetD d;
  const std::ptrdiff_t stride = subset_stride(side);
  const int half = side / 2;
  const SubsetV by = hn::Set(d, gain);
  std::fill_n(sums, 6, 0.0);
  for (int j = 0; j < side; ++j) {
    SubsetV x = hn::Zero(d), xa = x, y = x, ya = x;
    for (int k = 0; k < side; k += subset_lanes()) {
      const std::ptrdiff_t at = j * stride + k;
      const SubsetV e = hn::NegMulAdd(by, hn::LoadU(d, g + at), hn::LoadU(d, f + at));
      const SubsetV a = hn::Iota(d, static_cast<float>(k - half));
      const SubsetV ex = hn::Mul(e, hn::LoadU(d, fx + at)), ey = hn::Mul(e, hn::LoadU(d, fy + at));
      x = hn::Add(x, ex), xa = hn::MulAdd(ex, a, xa);
      y = hn::Add(y, ey), ya = hn::MulAdd(ey, a, ya);
    }
    const double b = j - half, sum_x = row_total(x), sum_y = row_total(y);
    sums[0] += sum_x, sums[1] += row_total(xa), sums[2] += b * sum_x;
    sums[3] += sum_y, sums[4] += row_total(ya), sums[5] += b * sum_y;
  }
}

ResidualSums residuals(const float* f, const float* g, float gain, const float* fx, const float* fy, int side,
                       float* scratch) {
  static_assert(residual_span == 4);
  const SubsetD d;
  const std::ptrdiff_t stride = subset_stride(side);
  const ResidualScratch size(side);
  float* const sums_x = scratch + ResidualScratch::before;  // over the four rows that end in this one
  float* const sums_y = sums_x + size.plane();
  const SubsetV by = hn::Set(d, gain);
  ResidualSums out;
  for (std::ptrdiff_t k = 0; k < stride; k += subset_lanes()) {  // down a strip of columns, the last rows in registers
    SubsetV squares = hn::Zero(d), product = squares, alone = squares;
    SubsetV x1 = squares, x2 = x1, x3 = x1, y1 = x1, y2 = x1, y3 = x1;
    for (int j = 0; j < size.rows; ++j) {
      SubsetV x = hn::Zero(d), y = x;
      if (j < side) {
        const std::ptrdiff_t at = j * stride + k;
        const SubsetV grey = hn::LoadU(d, f + at), there = hn::Mul(by, hn::LoadU(d, g + at)), e = hn::Sub(grey, there);
        squares = hn::MulAdd(e, e, squares);
        product = hn::MulAdd(grey, there, product);
        x = hn::Mul(e, hn::LoadU(d, fx + at)), y = hn::Mul(e, hn::LoadU(d, fy + at));
        alone = hn::MulAdd(x, x, hn::MulAdd(y, y, alone));
      }
      hn::StoreU(hn::Add(hn::Add(x, x1), hn::Add(x2, x3)), d, sums_x + j * size.line + k);
      hn::StoreU(hn::Add(hn::Add(y, y1), hn::Add(y2, y3)), d, sums_y + j * size.line + k);
      x3 = x2, x2 = x1, x1 = x;
      y3 = y2, y2 = y1, y1 = y;
    }
    out.squares += row_total(squares), out.product += row_total(product), out.alone += row_total(alone);
  }
  const auto along = [&](const float* at) HWY_ATTR {  // over the four columns that end in this one
    return hn::Add(hn::Add(hn::LoadU(d, at), hn::LoadU(d, at - 1)),
                   hn::Add(hn::LoadU(d, at - 2), hn::LoadU(d, at - 3)));
  };
  for (int j = 0; j < size.rows; ++j) {
    SubsetV together = hn::Zero(d);
    for (int k = 0; k < side + residual_span - 1; k += subset_lanes()) {
      const SubsetV x = along(sums_x + j * size.line + k), y = along(sums_y + j * size.line + k);
      together = hn::MulAdd(x, x, hn::MulAdd(y, y, together));
    }
    out.together += row_total(together);
  }
  return out;
}

double products(const float* a, const float* b, int side) {
  const SubsetD d;
  const std::ptrdiff_t stride = subset_stride(side);
  double sum = 0;
  for (int j = 0; j < side; ++j) {
    SubsetV row = hn::Zero(d);
    for (int k = 0; k < side; k += subset_lanes())
      row = hn::MulAdd(hn::LoadU(d, a + j * stride + k), hn::LoadU(d, b + j * stride + k), row);
    sum += row_total(row);
  }
  return sum;
}

}  // namespace pivnp::piv::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::piv {

HWY_EXPORT(warp_rows);
HWY_EXPORT(centre);
HWY_EXPORT(slopes);
HWY_EXPORT(slope_products_of);
HWY_EXPORT(residual_slopes_of);
HWY_EXPORT(residuals);
HWY_EXPORT(products);

void warp_subset(const SplineImage& image, const SubsetWarp& warp, double first_a, double first_b, int columns,
                 int rows, std::ptrdiff_t stride, float* scratch, float* out) {
  HWY_DYNAMIC_DISPATCH(warp_rows)(image, warp, first_a, first_b, columns, rows, stride, scratch, out);
}

double centre_subset(float* plane, const float* use, int side, double number) {
  return HWY_DYNAMIC_DISPATCH(centre)(plane, use, side, number);
}

void slopes_of(const float* high, const float* low, const float* use, int side, float* slope) {
  HWY_DYNAMIC_DISPATCH(slopes)(high, low, use, side, slope);
}

void slope_products(const float* fx, const float* fy, int side, double (*sums)[6]) {
  HWY_DYNAMIC_DISPATCH(slope_products_of)(fx, fy, side, sums);
}

void residual_slopes(const float* f, const float* g, float gain, const float* fx, const float* fy, int side,
                     double* sums) {
  HWY_DYNAMIC_DISPATCH(residual_slopes_of)(f, g, gain, fx, fy, side, sums);
}

ResidualSums residual_sums(const float* f, const float* g, float gain, const float* fx, const float* fy, int side,
                           float* scratch) {
  return HWY_DYNAMIC_DISPATCH(residuals)(f, g, gain, fx, fy, side, scratch);
}

double product_sum(const float* a, const float* b, int side) { return HWY_DYNAMIC_DISPATCH(products)(a, b, side); }

}  // namespace pivnp::piv
#endif
