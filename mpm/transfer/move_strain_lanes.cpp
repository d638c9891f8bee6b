// A.8-A.12 in one sweep, where the updated velocity strains the material (usl) and the points carry the affine field: a tile's
// nodes are read and its shape functions formed once.
#include "mpm/transfer/lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/transfer/move_strain_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/transfer/move-inl.hpp"
#include "mpm/transfer/strain-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

template <class S>
struct MovingStrain {
  static constexpr int W = S::width;
  using Move = Moving<S, TransferKind::apic>;
  Move move;
  double sx = move.job.dt * move.c.per_hx, sy = move.job.dt * move.c.per_hy;

  // Moves a tile; the gradient of its step.
  template <class Tile, class Lines>
  HWY_INLINE LaneGradient tile(const Tile& t, const Lines& l, const TileCells& cells) {
    const AffineWeights<Lines> affine(l, cells, move.c);
    typename Move::Field n{zero(), zero(), zero(), zero(), zero(), zero()};
    LaneGradient G{zero(), zero(), zero(), zero()};
    const auto add = [&](int b, double Node::*member, V& v, V& by_x, V& by_y, V& slope_x, V& slope_y) PIVNP_TILE {
      V value = zero(), moment = zero(), slope = zero();
      for (int a = 0; a < W; ++a) {
        const V at = cells.value(b * cells.nx + a, member);
        value = hn::MulAdd(l.x.w[a], at, value);
        moment = hn::MulAdd(affine.x[a], at, moment);
        slope = hn::MulAdd(l.x.g[a], at, slope);
      }
      v = hn::MulAdd(l.y.w[b], value, v);
      by_x = hn::MulAdd(l.y.w[b], moment, by_x);
      by_y = hn::MulAdd(affine.y[b], value, by_y);
      slope_x = hn::MulAdd(l.y.w[b], slope, slope_x);
      slope_y = hn::MulAdd(l.y.g[b], value, slope_y);
    };
    for (int b = 0; b < W; ++b) {
      add(b, &Node::nx, n.x, n.xx, n.xy, G.xx, G.xy);
      add(b, &Node::ny, n.y, n.yx, n.yy, G.yx, G.yy);
    }
    move.move(t, l, cells, n);
    if constexpr (Tile::marked)
      if (cells.any_mark() & strained_apart) return of_own(t, gradient(l, move.c, cells, sx, sy));
    return of_own(t, {G.xx * set(sx), G.xy * set(sy), G.yx * set(sx), G.yy * set(sy)});
  }
};

GatherSums move_strain_range(ShapeKind shape, const MoveJob& job, const StrainJob& strain, const PointView& p, const CellView& c,
                             Range range, const StrainIncrements& out, std::uint32_t* suspects) {
  return Shapes::with(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    if constexpr (!S::centred) return GatherSums{};
    else {
      MovingStrain<S> both{{job, p, c}};
      std::size_t found = 0;
      const Straining<S> straining{strain, p, c, out, c.begin[range.begin]};
      for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
        const auto l = lines_of<S>(p, c, cells, t);
        straining.strain(t, l, cells, both.tile(t, l, cells), nullptr, 0);
        find_suspects(c, cells, t, natural_of(c, cells, t.again(p.x), t.again(p.y)), suspects, found);
      });
      GatherSums sums = sums_of(both.move.fastest2, both.move.loss, both.move.good);
      sums.suspects = found;
      return sums;
    }
  });
}

GatherSums move_average_range(ShapeKind shape, const MoveJob& job, const PointView& p, const CellView& c, Range range) {
  return Shapes::with(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    if constexpr (!S::centred) return GatherSums{};
    else {
      MovingStrain<S> both{{job, p, c}};
      for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
        const auto l = lines_of<S>(p, c, cells, t);
        const V theta = t.live(lane_log_det(both.tile(t, l, cells)));
        add_to_averages(c, cells, false, l.xi, l.eta, joined_volume(p, t), theta);
      });
      return sums_of(both.move.fastest2, both.move.loss, both.move.good);
    }
  });
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(move_strain_range);
HWY_EXPORT(move_average_range);

GatherSums move_strain_lanes(ShapeKind shape, const MoveJob& job, const StrainJob& strain, const PointView& p, const CellView& c,
                             Range range, const StrainIncrements& out, std::uint32_t* suspects) {
  return HWY_DYNAMIC_DISPATCH(move_strain_range)(shape, job, strain, p, c, range, out, suspects);
}
GatherSums move_average_lanes(ShapeKind shape, const MoveJob& job, const PointView& p, const CellView& c, Range range) {
  return HWY_DYNAMIC_DISPATCH(move_average_range)(shape, job, p, c, range);
}

}  // namespace pivnp::mpm
#endif
