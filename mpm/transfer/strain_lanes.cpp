// A.12: log strain and rotation of the step at the points, and the averages against locking.
#include "mpm/transfer/lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/transfer/strain_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/transfer/strain-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

template <bool round>
HWY_INLINE void average_strain_of(ShapeKind shape, Where where, double dt, bool volumes, const PointView& p, const CellView& c,
                          Range range) {
  Shapes::with(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    if constexpr (S::centred)
      for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
        const auto l = lines_of<S>(p, c, cells, t, where, dt);
        const double sx = dt * c.per_hx, sy = dt * c.per_hy;
        add_to_averages(c, cells, volumes, l.xi, l.eta, joined_volume(p, t), dilation<round>(p, t, l, c, cells, sx, sy));
      });
  });
}

void average_strain_range(ShapeKind shape, Where where, double dt, bool volumes, const PointView& p, const CellView& c,
                          Range range) {
  p.hoop ? average_strain_of<true>(shape, where, dt, volumes, p, c, range) : average_strain_of<false>(shape, where, dt, volumes, p, c, range);
}

void hoop_range(ShapeKind shape, Where where, double dt, bool record, const PointView& p, const CellView& c, Range range) {
  Shapes::with(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
      const auto l = lines_of<S>(p, c, cells, t, where, dt);
      const StrainVelocityAt<std::decay_t<decltype(l)>::marked> u(c, cells);
      V v = zero();
      for (int b = 0; b < S::width; ++b) {
        V row = zero();
        for (int a = 0; a < S::width; ++a) row = hn::MulAdd(l.x.w[a], u(b * cells.nx + a, 0), row);
        v = hn::MulAdd(l.y.w[b], row, v);
      }
      const V G = t.own(set(dt) * v / radius_of(c, cells, l.xi));
      t.store(lane_log1p(G), p.hoop);
      if (!record) return;
      const V F = t.load(p.F_zz);
      t.store(hn::MulAdd(F, G, F), p.F_zz);
    });
  });
}

std::size_t strain_range(ShapeKind shape, const StrainJob& job, const PointView& p, const CellView& c, Range range,
                         const StrainIncrements& out, std::uint32_t* suspects) {
  return Shapes::with(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    if (p.hoop) return Straining<S, true>{job, p, c, out, c.begin[range.begin]}.run(range, suspects);
    return Straining<S>{job, p, c, out, c.begin[range.begin]}.run(range, suspects);
  });
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(average_strain_range);
HWY_EXPORT(hoop_range);
HWY_EXPORT(strain_range);

void average_strain_lanes(ShapeKind shape, Where where, double dt, bool volumes, const PointView& p, const CellView& c,
                          Range range) {
  HWY_DYNAMIC_DISPATCH(average_strain_range)(shape, where, dt, volumes, p, c, range);
}
void hoop_lanes(ShapeKind shape, Where where, double dt, bool record, const PointView& p, const CellView& c, Range range) {
  HWY_DYNAMIC_DISPATCH(hoop_range)(shape, where, dt, record, p, c, range);
}
std::size_t strain_lanes(ShapeKind shape, const StrainJob& job, const PointView& p, const CellView& c, Range range,
                         const StrainIncrements& out, std::uint32_t* suspects) {
  return HWY_DYNAMIC_DISPATCH(strain_range)(shape, job, p, c, range, out, suspects);
}

}  // namespace pivnp::mpm
#endif
