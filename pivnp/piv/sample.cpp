#include "pivnp/piv/sample.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/piv/sample.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include "pivnp/piv/sample_row-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::piv::HWY_NAMESPACE {

void sample_line(const SplineImage& image, int column, int row, const float* ux, const float* uy, int count,
                 float* out) {
  sample_row(image, nullptr, column, row, ux, uy, count, out, nullptr);
}

}  // namespace pivnp::piv::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::piv {

HWY_EXPORT(sample_line);

void sample_displaced(const SplineImage& image, int column, int row, const float* ux, const float* uy, int count,
                      float* out) {
  HWY_DYNAMIC_DISPATCH(sample_line)(image, column, row, ux, uy, (count + 15) / 16 * 16, out);
}

}  // namespace pivnp::piv
#endif
