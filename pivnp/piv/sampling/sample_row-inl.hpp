// Rows of pixels sampled from a spline image at moved places. Included once for each instruction set (Highway).
#include <algorithm>

#include "pivnp/piv/sampling/pixel_flags.hpp"
#include "pivnp/piv/sampling/spline_image.hpp"

#if defined(PIVNP_PIV_SAMPLE_ROW_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_PIV_SAMPLE_ROW_INL
#undef PIVNP_PIV_SAMPLE_ROW_INL
#else
#define PIVNP_PIV_SAMPLE_ROW_INL
#endif

#include <hwy/highway.h>

#include "pivnp/piv/sampling/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::piv::HWY_NAMESPACE {

constexpr int taps = 6;

// Weights of the taps floor(x) - 2 ... floor(x) + 3 of the quintic B-spline at fraction t.
template <class V>
HWY_INLINE void quintic_weights(V t, V* w) {
  const hn::DFromV<V> d;
  const V s = hn::Set(d, 1.0f / 120.0f), one = hn::Set(d, 1.0f);
  const V t2 = hn::Mul(t, t), r = hn::Sub(one, t), r2 = hn::Mul(r, r);
  w[5] = hn::Mul(s, hn::Mul(t, hn::Mul(t2, t2)));
  w[0] = hn::Mul(s, hn::Mul(r, hn::Mul(r2, r2)));
  // 26 + 50 t + 20 t2 - 20 t3 - 20 t4 + 10 t5 is tap 3 at t and tap 2's neighbour mirrored
  const auto inner =
      [&](V x) {  // tap 3 at x: (26 + 50 x + 20 x^2 - 20 x^3 - 20 x^4 + 10 x^5) / 120 is tap at distance 1 - x
        V p = hn::MulAdd(hn::Set(d, 10.0f), x, hn::Set(d, -20.0f));
        p = hn::MulAdd(p, x, hn::Set(d, -20.0f));
        p = hn::MulAdd(p, x, hn::Set(d, 20.0f));
        p = hn::MulAdd(p, x, hn::Set(d, 50.0f));
        return hn::Mul(s, hn::MulAdd(p, x, hn::Set(d, 26.0f)));
      };
  const auto outer = [&](V x) {  // tap 4 at x
    V p = hn::MulAdd(hn::Set(d, -5.0f), x, hn::Set(d, 5.0f));
    p = hn::MulAdd(p, x, hn::Set(d, 10.0f));
    p = hn::MulAdd(p, x, hn::Set(d, 10.0f));
    p = hn::MulAdd(p, x, hn::Set(d, 5.0f));
    return hn::Mul(s, hn::MulAdd(p, x, one));
  };
  w[3] = inner(t);
  w[2] = inner(r);
  w[4] = outer(t);
  w[1] = outer(r);
}

// Samples `image` at (column + k + ux[k], row + uy[k]) for k < count (a multiple of the vector length; places outside
// the image are moved to its edge and clear use[k]); flagged pixels nearest to a place clear use[k] as well. `use` may
// be null if `flags` is.
static HWY_NOINLINE void sample_row(const SplineImage& image, const PixelFlags* flags, int column, int row,
                                    const float* ux, const float* uy, int count, float* out, float* use) {
  using D = hn::CappedTag<float, 16>;
  using V = hn::Vec<D>;
  const D d;
  const hn::RebindToSigned<D> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const float last_column = static_cast<float>(image.width() - 1), last_row = static_cast<float>(image.height() - 1);
  const V least_y = hn::Set(d, static_cast<float>(-row)), most_y = hn::Set(d, last_row - static_cast<float>(row));
  HWY_ALIGN int ox[16], oy[16];
  HWY_ALIGN float wx_lane[taps][16], wy_lane[taps][16];
  using T = hn::CappedTag<float, 8>;
  const T t;
  HWY_ALIGN float wx_taps[16][8] = {};  // of six taps; the image's padding has two more
  for (int k = 0; k < count; k += lanes) {
    const V lane = hn::Iota(d, static_cast<float>(column + k));
    const V least_x = hn::Sub(zero, lane), most_x = hn::Sub(hn::Set(d, last_column), lane);
    const V x_asked = hn::LoadU(d, ux + k), y_asked = hn::LoadU(d, uy + k);
    const V x = hn::Min(hn::Max(x_asked, least_x), most_x), y = hn::Min(hn::Max(y_asked, least_y), most_y);
    const auto inside = hn::And(hn::Eq(x, x_asked), hn::Eq(y, y_asked));
    if (use != nullptr && !hn::AllTrue(d, inside))
      hn::StoreU(hn::IfThenElseZero(inside, hn::LoadU(d, use + k)), d, use + k);
    const V whole_x = hn::Floor(x), whole_y = hn::Floor(y);
    V wx[taps], wy[taps];
    quintic_weights(hn::Sub(x, whole_x), wx);
    quintic_weights(hn::Sub(y, whole_y), wy);
    const float fx0 = hn::GetLane(whole_x), fy0 = hn::GetLane(whole_y);
    V sum = zero;
    if (hn::AllTrue(d, hn::And(hn::Eq(whole_x, hn::Set(d, fx0)), hn::Eq(whole_y, hn::Set(d, fy0))))) {
      const int left = column + k + static_cast<int>(fx0) - 2, top = row + static_cast<int>(fy0) - 2;
      for (int j = 0; j < taps; ++j) {
        const float* in = image.coefficient(left, top + j);
        V along = hn::Mul(wx[0], hn::LoadU(d, in));
        for (int i = 1; i < taps; ++i) along = hn::MulAdd(wx[i], hn::LoadU(d, in + i), along);
        sum = hn::MulAdd(wy[j], along, sum);
      }
    } else {
      const V low_x = hn::MinOfLanes(d, whole_x), low_y = hn::MinOfLanes(d, whole_y);
      const V high_x = hn::Sub(whole_x, low_x), high_y = hn::Sub(whole_y, low_y);
      if (hn::AllTrue(d, hn::And(hn::Le(high_x, one), hn::Le(high_y, one)))) {
        // Two whole offsets at most: seven common taps, a later pixel's weights moved by one.
        const auto later_x = hn::Gt(high_x, zero), later_y = hn::Gt(high_y, zero);
        V sx[taps + 1], sy[taps + 1];
        sx[0] = hn::IfThenZeroElse(later_x, wx[0]);
        sy[0] = hn::IfThenZeroElse(later_y, wy[0]);
        for (int i = 1; i < taps; ++i) {
          sx[i] = hn::IfThenElse(later_x, wx[i - 1], wx[i]);
          sy[i] = hn::IfThenElse(later_y, wy[i - 1], wy[i]);
        }
        sx[taps] = hn::IfThenElseZero(later_x, wx[taps - 1]);
        sy[taps] = hn::IfThenElseZero(later_y, wy[taps - 1]);
        const int left = column + k + static_cast<int>(hn::GetLane(low_x)) - 2,
                  top = row + static_cast<int>(hn::GetLane(low_y)) - 2;
        for (int j = 0; j <= taps; ++j) {
          const float* in = image.coefficient(left, top + j);
          V along = hn::Mul(sx[0], hn::LoadU(d, in));
          for (int i = 1; i <= taps; ++i) along = hn::MulAdd(sx[i], hn::LoadU(d, in + i), along);
          sum = hn::MulAdd(sy[j], along, sum);
        }
      } else {
        hn::Store(hn::ConvertTo(di, whole_x), di, ox);
        hn::Store(hn::ConvertTo(di, whole_y), di, oy);
        for (int i = 0; i < taps; ++i) hn::Store(wx[i], d, wx_lane[i]), hn::Store(wy[i], d, wy_lane[i]);
        for (int l = 0; l < lanes; ++l)
          for (int i = 0; i < taps; ++i) wx_taps[l][i] = wx_lane[i][l];
        for (int l = 0; l < lanes; ++l) {  // each place by itself, its taps side by side
          const float* in = image.coefficient(column + k + l + ox[l] - 2, row + oy[l] - 2);
          hn::Vec<T> value = hn::Zero(t);
          for (int i = 0; i < 8; i += static_cast<int>(hn::Lanes(t))) {
            hn::Vec<T> down = hn::Zero(t);
            for (int j = 0; j < taps; ++j)
              down = hn::MulAdd(hn::Set(t, wy_lane[j][l]), hn::LoadU(t, in + j * image.stride() + i), down);
            value = hn::MulAdd(hn::LoadU(t, wx_taps[l] + i), down, value);
          }
          out[k + l] = hn::GetLane(hn::SumOfLanes(t, value));
        }
        sum = hn::LoadU(d, out + k);
      }
    }
    hn::StoreU(sum, d, out + k);
    if (flags == nullptr) continue;
    const int left = column + k + static_cast<int>(hn::GetLane(hn::MinOfLanes(d, whole_x)));
    const int right = column + k + lanes + static_cast<int>(hn::GetLane(hn::MaxOfLanes(d, whole_x)));
    const int above = row + static_cast<int>(hn::GetLane(hn::MinOfLanes(d, whole_y)));
    const int below = row + static_cast<int>(hn::GetLane(hn::MaxOfLanes(d, whole_y))) + 1;
    if (!flags->any(left, above, right, below)) continue;
    const V half = hn::Set(d, 0.5f);
    hn::Store(hn::ConvertTo(di, hn::Floor(hn::Add(x, half))), di, ox);
    hn::Store(hn::ConvertTo(di, hn::Floor(hn::Add(y, half))), di, oy);
    for (int l = 0; l < lanes; ++l)
      if (flags->at(std::clamp(column + k + l + ox[l], 0, image.width() - 1),
                    std::clamp(row + oy[l], 0, image.height() - 1)))
        use[k + l] = 0;
  }
}

}  // namespace pivnp::piv::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // PIVNP_PIV_SAMPLE_ROW_INL
