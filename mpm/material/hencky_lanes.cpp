// Hencky's law in lanes.
#include "mpm/material/lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/material/hencky_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/material/batch-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// With d, e the deviators in the plane of the step and of the elastic strain, exp(d) exp(2e) exp(d) has the deviator
// M = S e + 2 b (a C + b S d.e) d, where a = cosh|d|, b = sinh|d|/|d|, C = cosh 2|e|, S = sinh 2|e|/|e|, and half the
// logarithm's deviator is M arsinh|M|/(2|M|). All are series in squares: no root, no quotient.
constexpr double cosh_series[] = {1, 1.0 / 2, 1.0 / 24, 1.0 / 720, 1.0 / 40320, 1.0 / 3628800, 1.0 / 479001600};
constexpr double sinh_series[] = {1,          1.0 / 6,       1.0 / 120,       1.0 / 5040,
                                  1.0 / 362880, 1.0 / 39916800, 1.0 / 6227020800};
constexpr double arsinh_series[] = {1,
                                    -1.0 / 6,
                                    3.0 / 40,
                                    -5.0 / 112,
                                    35.0 / 1152,
                                    -63.0 / 2816,
                                    231.0 / 13312,
                                    -143.0 / 10240,
                                    6435.0 / 557056,
                                    -12155.0 / 1245184,
                                    46189.0 / 5505024,
                                    -88179.0 / 12058624,
                                    676039.0 / 104857600,
                                    -1300075.0 / 226492416};
constexpr double most_step2 = 1e-4, few_terms = 1e-3, most_terms = 0.06;  // |d|^2; (2|e|)^2 and |M|^2

// M over the elastic strain and over the step's, its square, and shear arsinh|M|/|M|.
struct Combined {
  V mh, mx, m2, factor;
};
template <int hyperbolic, int arsinh>
HWY_INLINE Combined combined(V dh, V dx, V eh, V ex, V d2, V R2, V shear) {
  const V a = polynomial<4>(d2, cosh_series), b = polynomial<4>(d2, sinh_series);
  const V C = polynomial<hyperbolic>(R2, cosh_series), S = set(2) * polynomial<hyperbolic>(R2, sinh_series);
  const V along = set(2) * b * hn::MulAdd(a, C, b * S * hn::MulAdd(dh, eh, dx * ex));
  const V mh = hn::MulAdd(S, eh, along * dh), mx = hn::MulAdd(S, ex, along * dx);
  const V m2 = hn::MulAdd(mh, mh, mx * mx);
  return {mh, mx, m2, shear * polynomial<arsinh>(m2, arsinh_series)};
}

std::size_t hencky(const Elastic& law, const StressBatch& b, std::uint32_t* rare) {
  std::size_t n = 0;
  const D d;
  const LaneElastic elastic(law);
  const V shear = elastic.shear, per2 = set(1 / (law.shear * law.shear));
  for_batch(b, [&](const auto& t, const auto& step, std::size_t k) PIVNP_TILE {
    const Turned s = turned(b, t, step);
    const V dxx = step.load(b.de_xx), dyy = step.load(b.de_yy), dzz = step.load(b.de_zz);
    const V volumetric = elastic.lambda * (dxx + dyy + dzz);
    const V dh = set(0.5) * (dxx - dyy), dx = step.load(b.de_xy);
    const V eh = s.half * elastic.per_two_shear, ex = s.xy * elastic.per_two_shear;
    const V d2 = hn::MulAdd(dh, dh, dx * dx), R2 = per2 * s.size2;
    const bool few = hn::AllTrue(d, hn::Le(R2, set(few_terms)));
    Combined m = few ? combined<5, 6>(dh, dx, eh, ex, d2, R2, shear) : combined<7, 14>(dh, dx, eh, ex, d2, R2, shear);
    if (HWY_UNLIKELY(few && !hn::AllTrue(d, hn::Le(m.m2, set(few_terms))))) m = combined<7, 14>(dh, dx, eh, ex, d2, R2, shear);
    V mean = hn::MulAdd(shear, dxx + dyy, s.mean + volumetric), half = m.factor * m.mh, xy = m.factor * m.mx;
    V xx = mean + half, yy = mean - half, zz = hn::MulAdd(elastic.two_shear, dzz, s.zz + volumetric);
    const M common = hn::And(hn::Le(d2, set(most_step2)), hn::Le(hn::Max(R2, m.m2), set(most_terms)));
    if (HWY_UNLIKELY(!hn::AllTrue(d, common))) {
      list(hn::Not(common), k, b.size, rare, n);
      xx = hn::IfThenElse(common, xx, t.load(b.xx));
      yy = hn::IfThenElse(common, yy, t.load(b.yy));
      zz = hn::IfThenElse(common, zz, t.load(b.zz));
      xy = hn::IfThenElse(common, xy, t.load(b.xy));
    }
    t.store(xx, b.xx);
    t.store(yy, b.yy);
    t.store(zz, b.zz);
    t.store(xy, b.xy);
  });
  return n;
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(hencky);

std::size_t hencky_lanes(const Elastic& elastic, const StressBatch& batch, std::uint32_t* rare) {
  return HWY_DYNAMIC_DISPATCH(hencky)(elastic, batch, rare);
}

}  // namespace pivnp::mpm
#endif
