#include "pivnp/piv/sampling/sample.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/piv/sampling/sample.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include "pivnp/piv/sampling/sample_row-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::piv::HWY_NAMESPACE {

void sample_line(const SplineImage& image, int column, int row, const float* ux, const float* uy, int count,
                 float* out) {
  sample_row(image, nullptr, column, row, ux, uy, count, out, nullptr);
}

void place_line(const SplineImage& image, int column, int row, const float* du, const float* dv, float share, int count,
                float* ux, float* uy, float* use) {
  const hn::CappedTag<float, 16> d;
  constexpr float tolerance = 0.01f;
  const auto factor = hn::Set(d, share), zero = hn::Zero(d);
  const auto least_x = hn::Set(d, -tolerance), most_x = hn::Set(d, static_cast<float>(image.width() - 1) + tolerance);
  const auto least_y = least_x, most_y = hn::Set(d, static_cast<float>(image.height() - 1) + tolerance);
  const auto y0 = hn::Set(d, static_cast<float>(row));
  for (int k = 0; k < count; k += static_cast<int>(hn::Lanes(d))) {
    const auto x_moved = hn::Mul(factor, hn::LoadU(d, du + k)), y_moved = hn::Mul(factor, hn::LoadU(d, dv + k));
    hn::StoreU(x_moved, d, ux + k);
    hn::StoreU(y_moved, d, uy + k);
    const auto x = hn::Add(hn::Iota(d, static_cast<float>(column + k)), x_moved), y = hn::Add(y0, y_moved);
    const auto inside = hn::And(hn::And(hn::Gt(x, least_x), hn::Gt(most_x, x)),  // not for NaN
                                hn::And(hn::Gt(y, least_y), hn::Gt(most_y, y)));
    hn::StoreU(hn::IfThenElse(inside, hn::LoadU(d, use + k), zero), d, use + k);
  }
}

}  // namespace pivnp::piv::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::piv {

HWY_EXPORT(sample_line);
HWY_EXPORT(place_line);

void sample_displaced(const SplineImage& image, int column, int row, const float* ux, const float* uy, int count,
                      float* out) {
  HWY_DYNAMIC_DISPATCH(sample_line)(image, column, row, ux, uy, (count + 15) / 16 * 16, out);
}

void place_row(const SplineImage& image, int column, int row, const float* du, const float* dv, float share, int count,
               float* ux, float* uy, float* use) {
  HWY_DYNAMIC_DISPATCH(place_line)(image, column, row, du, dv, share, (count + 15) / 16 * 16, ux, uy, use);
}

}  // namespace pivnp::piv
#endif
