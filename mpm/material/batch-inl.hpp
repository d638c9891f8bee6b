// Tiles of a batch, the stress as the step's rotation leaves it, polynomials: what the laws in lanes share. Included by
// their sources inside Highway's loop over instruction sets.
#if defined(PIVNP_MPM_BATCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_BATCH_INL
#undef PIVNP_MPM_BATCH_INL
#else
#define PIVNP_MPM_BATCH_INL
#endif

#include "mpm/material/lanes.hpp"
#include "mpm/simd/series-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// An elastic law in all lanes, formed once for a batch.
struct LaneElastic {
  V shear, two_shear, lambda, two_lambda;
  V own, shared;                // of C^-1: (1 + nu)/E and nu/E
  V per_two_shear;              // 1/(2 G)

  explicit HWY_INLINE LaneElastic(const Elastic& law)
      : shear(set(law.shear)),
        two_shear(set(2 * law.shear)),
        lambda(set(law.lambda)),
        two_lambda(set(2 * law.lambda)),
        own(set((1 + law.poisson) / law.young)),
        shared(set(law.poisson / law.young)),
        per_two_shear(set(0.5 / law.shear)) {}
};

// Calls body(tile, step) for the tile of a batch that begins at point k: where its state and its increments are.
template <class Body>
HWY_INLINE void with_tile(const StressBatch& b, std::size_t k, Body&& body) {
  const auto first = std::uint32_t(k);
  const std::size_t n = b.size - k < n_lanes ? b.size - k : n_lanes;
  if (HWY_LIKELY(n == n_lanes)) {
    if (!b.places) return body(FullTile{first}, FullTile{first});
    // (A stretch as long as its number of points may still be out of order.)
    std::uint32_t other = 0;
    for (std::size_t l = 0; l < n_lanes; ++l) other |= b.places[k + l] ^ (b.places[k] + std::uint32_t(l));
    if (HWY_LIKELY(other == 0)) return body(FullTile{b.places[k]}, FullTile{first});
  }
  std::uint32_t steps[n_lanes];
  for (std::size_t l = 0; l < n_lanes; ++l) steps[l] = first + std::uint32_t(l);
  const PartTile step(steps, n);
  body(b.places ? PartTile(b.places + k, n) : step, step);
}

// Calls body(tile, step, k) for the batch; `k` is the tile's first point.
template <class Body>
HWY_INLINE void for_batch(const StressBatch& b, Body&& body) {
  for (std::size_t k = 0; k < b.size; k += n_lanes)
    with_tile(b, k, [&](const auto& t, const auto& step) PIVNP_TILE { body(t, step, k); });
}

// Appends the lanes of `which` to a list.
HWY_INLINE void list(M which, std::size_t k, std::size_t size, std::uint32_t* rare, std::size_t& n) {
  HWY_ALIGN double in[n_lanes];
  hn::Store(hn::IfThenElseZero(which, set(1)), D(), in);
  for (std::size_t l = 0; l < n_lanes && k + l < size; ++l)
    if (in[l] != 0) rare[n++] = std::uint32_t(k + l);
}

// Stress turned by the step's rotation: mean and half difference in the plane, out of it, shear.
struct Turned {
  V mean, half, zz, xy;
  V size2;  // half^2 + xy^2, which waits for no rotation
};
template <class Tile, class Step>
HWY_INLINE Turned turned(const StressBatch& b, const Tile& t, const Step& step) {
  const V r = set(0.5) * step.load(b.spin), r2 = r * r, scale = set(1) / (set(1) + r2);
  const V c = (set(1) - r2) * scale, s = set(2) * r * scale;
  const V c2 = hn::NegMulAdd(s, s, c * c), s2 = set(2) * c * s;
  const V xx = t.load(b.xx), yy = t.load(b.yy), xy = t.load(b.xy);
  const V half = set(0.5) * (xx - yy);
  return {set(0.5) * (xx + yy), hn::NegMulAdd(s2, xy, c2 * half), t.load(b.zz), hn::MulAdd(s2, half, c2 * xy),
          hn::MulAdd(half, half, xy * xy)};
}

// sin x for 0 <= x <= pi/2, to the last bits.
constexpr double sine_series[] = {1,
                                  -1.0 / 6,
                                  1.0 / 120,
                                  -1.0 / 5040,
                                  1.0 / 362880,
                                  -1.0 / 39916800,
                                  1.0 / 6227020800,
                                  -1.0 / 1307674368000,
                                  1.0 / 355687428096000,
                                  -1.0 / 121645100408832000};
HWY_INLINE V sine(V x) { return x * polynomial<10>(x * x, sine_series); }

// Points that have separated once carry no tension any more.
HWY_INLINE M has_separated(const StressBatch& b, std::size_t k) {
  HWY_ALIGN double flag[n_lanes];
  for (std::size_t l = 0; l < n_lanes; ++l) {
    const std::size_t at = k + l < b.size ? k + l : b.size - 1;
    flag[l] = b.flags[plastic::separated][b.places ? b.places[at] : at];
  }
  return hn::Ne(hn::Load(D(), flag), zero());
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
