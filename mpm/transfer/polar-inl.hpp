// Logarithmic strain and rotation of a step's gradient in lanes. Included by the kernels' sources inside Highway's loop
// over instruction sets.
#if defined(PIVNP_MPM_POLAR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_POLAR_INL
#undef PIVNP_MPM_POLAR_INL
#else
#define PIVNP_MPM_POLAR_INL
#endif

#include <cmath>

#include "mpm/simd/series-inl.hpp"
#include "mpm/transfer/finite_strain.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

struct LaneGradient {
  V xx, xy, yx, yy;
};
struct LanePolar {
  V trace, half, xy, spin;  // of the log strain; half: (xx - yy)/2
};

// Up to here the series hold to the last bits: of volume; of the squares of the distortion and of the rotation's
// tangent.
constexpr double small_change = 0.02, small_square = 1e-3;

HWY_INLINE V det_change(const LaneGradient& G) { return G.xx + G.yy + hn::NegMulAdd(G.xy, G.yx, G.xx * G.yy); }

// Larger steps, point by point.
template <class Each>
HWY_INLINE void for_lanes(const LaneGradient& G, Each&& each) {
  const D d;
  HWY_ALIGN double xx[n_lanes], xy[n_lanes], yx[n_lanes], yy[n_lanes];
  hn::Store(G.xx, d, xx);
  hn::Store(G.xy, d, xy);
  hn::Store(G.yx, d, yx);
  hn::Store(G.yy, d, yy);
  for (std::size_t l = 0; l < n_lanes; ++l) each(l, Gradient{xx[l], xy[l], yx[l], yy[l]});
}
HWY_NOINLINE inline void log_det_by_points(LaneGradient G, double* out) {
  for_lanes(G, [&](std::size_t l, const Gradient& g) { out[l] = log_det(g); });
}
HWY_NOINLINE inline void polar_by_points(LaneGradient G, double* trace, double* half, double* xy, double* spin) {
  for_lanes(G, [&](std::size_t l, const Gradient& g) {
    const Polar e = polar(g);
    trace[l] = e.xx + e.yy;
    half[l] = 0.5 * (e.xx - e.yy);
    xy[l] = e.xy;
    spin[l] = e.spin;
  });
}

// The first `n` terms of a series: pairs of terms by x, pairs of those by x^2, and so on (Estrin), the shortest chain;
// only the chain of one tile is in this.
template <int n, std::size_t size>
HWY_INLINE V terms(const double (&c)[size], int first, const V* powers) {
  if constexpr (n == 1) {
    return set(c[first]);
  } else {
    constexpr int level = n > 8 ? 3 : n > 4 ? 2 : n > 2 ? 1 : 0, half = 1 << level;
    return hn::MulAdd(terms<n - half>(c, first + half, powers), powers[level], terms<half>(c, first, powers));
  }
}
template <int n, std::size_t size>
HWY_INLINE V paired(V x, const double (&c)[size]) {
  static_assert(n >= 2 && n <= 16 && n <= int(size));
  V powers[4] = {x};
  for (int k = 1; k < 4; ++k) powers[k] = powers[k - 1] * powers[k - 1];
  return terms<n>(c, 0, powers);
}

constexpr double log1p_series[] = {1, -1.0 / 2, 1.0 / 3, -1.0 / 4, 1.0 / 5, -1.0 / 6, 1.0 / 7, -1.0 / 8, 1.0 / 9};
constexpr double exp_series[] = {1, 1, 1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720, 1.0 / 5040};
// Of artanh(x)/(2 x) and 2 tan(atan(x)/2)/x, in squares.
constexpr double half_artanh_series[] = {0.5, 0.5 / 3, 0.5 / 5, 0.5 / 7, 0.5 / 9};
constexpr double half_angle_series[] = {1, -1.0 / 4, 1.0 / 8, -5.0 / 64, 7.0 / 128};

// ln(1 + x) of small x.
HWY_INLINE V small_log1p(V x) { return x * paired<9>(x, log1p_series); }

HWY_INLINE V lane_log_det(const LaneGradient& G) {
  const D d;
  const V x = det_change(G);
  if (HWY_LIKELY(hn::AllTrue(d, hn::Le(hn::Abs(x), set(small_change))))) return small_log1p(x);
  HWY_ALIGN double out[n_lanes];
  log_det_by_points(G, out);
  return hn::Load(d, out);
}

// ln(1 + x), point by point beyond small steps.
HWY_INLINE V lane_log1p(V x) {
  const D d;
  if (HWY_LIKELY(hn::AllTrue(d, hn::Le(hn::Abs(x), set(small_change))))) return small_log1p(x);
  HWY_ALIGN double out[n_lanes];
  hn::Store(x, d, out);
  for (double& v : out) v = std::log1p(v);
  return hn::Load(d, out);
}

HWY_INLINE V lane_exp(V x) {
  const D d;
  if (HWY_LIKELY(hn::AllTrue(d, hn::Le(hn::Abs(x), set(small_change))))) return paired<8>(x, exp_series);
  HWY_ALIGN double out[n_lanes];
  hn::Store(x, d, out);
  for (double& v : out) v = std::exp(v);
  return hn::Load(d, out);
}

// polar() in lanes. ln V is half the logarithm of f f^T: with M the deviator of that over its mean, its deviator is
// M artanh|M|/(2 |M|), so the rotation is not needed for it.
HWY_INLINE LanePolar lane_polar(const LaneGradient& G, V change) {
  const D d;
  const V half_of = set(0.5), sum = G.xx + G.yy, shear = G.xy + G.yx, turn = G.yx - G.xy, part = half_of * sum;
  const V squares = hn::MulAdd(G.xx, G.xx, G.yy * G.yy) + hn::MulAdd(G.xy, G.xy, G.yx * G.yx);
  const V mean = hn::MulAdd(half_of, squares, sum), per_mean = per_one_and(mean);  // of f f^T, less 1
  const V half = hn::MulAdd(half_of, hn::MulSub(G.xx - G.yy, sum, turn * shear), G.xx - G.yy) * per_mean;
  const V xy = hn::MulAdd(G.xx, G.yx, hn::MulAdd(G.xy, G.yy, shear)) * per_mean;
  const V m2 = hn::MulAdd(half, half, xy * xy), tan = half_of * turn * per_one_and(part), t2 = tan * tan;
  const M parts = hn::Le(hn::Max(hn::Abs(mean), hn::Abs(part)), set(small_part));
  const M small =
      hn::And(hn::And(parts, hn::Le(hn::Abs(change), set(small_change))), hn::Le(hn::Max(m2, t2), set(small_square)));
  if (HWY_LIKELY(hn::AllTrue(d, small))) {
    const V artanh = paired<5>(m2, half_artanh_series), half_angle = paired<5>(t2, half_angle_series);
    return {small_log1p(change), artanh * half, artanh * xy, half_angle * tan};
  }
  HWY_ALIGN double trace_of[n_lanes], half_lane[n_lanes], xy_of[n_lanes], spin_of[n_lanes];
  polar_by_points(G, trace_of, half_lane, xy_of, spin_of);
  return {hn::Load(d, trace_of), hn::Load(d, half_lane), hn::Load(d, xy_of), hn::Load(d, spin_of)};
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
