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

// The nodes' updated velocity at a tile's points, its affine part, and the gradient per cell side.
struct Sampled {
  V x, y, xx, xy, yx, yy;
  LaneGradient slope;
};

// By the shape functions of each point.
template <class Lines>
HWY_INLINE Sampled sampled(const Lines& l, const TileCells& cells, const CellView& c) {
  constexpr int W = Lines::W;
  const AffineWeights<Lines> affine(l, cells, c);
  Sampled n{zero(), zero(), zero(), zero(), zero(), zero(), {zero(), zero(), zero(), zero()}};
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
    add(b, &Node::nx, n.x, n.xx, n.xy, n.slope.xx, n.slope.xy);
    add(b, &Node::ny, n.y, n.yx, n.yy, n.slope.yx, n.slope.yy);
  }
  return n;
}

// By the cells' polynomials. As sum w s = xi, sum w s^2 = xi^2 + 1/4 and sum w s^3 = xi, C takes b + c xi (3 - 4 xi^2)
// of the parabola a + b s + c s^2 along an axis.
HWY_INLINE Sampled sampled(const CellPolynomials& v, V xi, V eta, const CellView& c) {
  const V x1 = set(0.5) * xi, y1 = set(0.5) * eta, x2 = xi * xi, y2 = eta * eta;
  const V affine_x = xi * hn::NegMulAdd(set(8), x2, set(6)), affine_y = eta * hn::NegMulAdd(set(8), y2, set(6));
  const auto component = [&](auto&& of, V& value, V& by_x, V& by_y, V& slope_x, V& slope_y) PIVNP_TILE {
    const auto rows = v.rows(of, x1, x2);
    value = rows.up(y1, y2);
    slope_x = set(0.5) * v.across(of, set(4) * xi, y1, y2);
    slope_y = set(0.5) * rows.along(set(4) * eta);
    by_x = set(0.5 * c.per_hx) * v.across(of, affine_x, y1, y2);
    by_y = set(0.5 * c.per_hy) * rows.along(affine_y);
  };
  Sampled n;
  component([](V k) PIVNP_TILE { return first_of_turn(k); }, n.x, n.xx, n.xy, n.slope.xx, n.slope.xy);
  component([](V k) PIVNP_TILE { return second_of_turn(k); }, n.y, n.yx, n.yy, n.slope.yx, n.slope.yy);
  return n;
}

// The nodes' velocity before its update at a tile's points.
HWY_INLINE Velocity mapped_by(const CellPolynomials& v, V xi, V eta) {
  const V x1 = set(0.5) * xi, y1 = set(0.5) * eta, x2 = xi * xi, y2 = eta * eta;
  return {v.rows([](V k) PIVNP_TILE { return first_of_turn(k); }, x1, x2).up(y1, y2),
          v.rows([](V k) PIVNP_TILE { return second_of_turn(k); }, x1, x2).up(y1, y2)};
}

template <class S, TransferKind transfer>
struct MovingStrain {
  using Move = Moving<S, transfer>;
  static constexpr bool changes = transfer != TransferKind::apic;  // the nodes' change of velocity counts
  Move move;
  double sx = move.job.dt * move.c.per_hx, sy = move.job.dt * move.c.per_hy;

  // Moves a tile; the gradient of its step.
  template <class Tile>
  HWY_INLINE LaneGradient tile(const Tile& t, const Natural& at, const TileCells& cells) {
    if constexpr (CellPolynomials::are_of<S> && !Tile::marked) {
      return by_polynomials(t, at, cells);
    } else {
      if constexpr (CellPolynomials::are_of<S>)
        if (CellPolynomials::hold(cells) && !(cells.any_mark() & strained_apart)) return by_polynomials(t, at, cells);
      const TileLines<S, Tile> l(move.p, move.c, cells, t, at);
      const Sampled n = sampled(l, cells, move.c);
      Velocity mapped{zero(), zero()};
      if constexpr (changes) mapped = Move::interpolated(l, cells, &Node::vx, &Node::vy);
      const LaneGradient own = moved(t, n, mapped);
      if constexpr (Tile::marked)
        if (cells.any_mark() & strained_apart) return of_own(t, gradient(l, move.c, cells, sx, sy));
      return own;
    }
  }
  template <class Tile>
  HWY_INLINE LaneGradient by_polynomials(const Tile& t, const Natural& at, const TileCells& cells) {
    const Sampled n = sampled(CellPolynomials(StrainVelocityAt<false>(move.c, cells), cells), at.xi, at.eta, move.c);
    Velocity mapped{zero(), zero()};
    if constexpr (changes) mapped = mapped_by(CellPolynomials(MappedVelocityAt(cells), cells), at.xi, at.eta);
    return moved(t, n, mapped);
  }
  template <class Tile>
  HWY_INLINE LaneGradient moved(const Tile& t, const Sampled& n, const Velocity& mapped) {
    move.move(
        t, {n.x, n.y, n.xx, n.xy, n.yx, n.yy}, [&] PIVNP_TILE { return mapped; },
        [] PIVNP_TILE { return Velocity{zero(), zero()}; });
    const V x = set(sx), y = set(sy);
    return of_own(t, {n.slope.xx * x, n.slope.xy * y, n.slope.yx * x, n.slope.yy * y});
  }
};

template <class S, TransferKind transfer>
HWY_INLINE GatherSums move_strain_of(const MoveJob& job, const StrainJob& strain, const PointView& p, const CellView& c, Range range,
                                     const StrainIncrements& out, std::uint32_t* suspects) {
  MovingStrain<S, transfer> both{{job, p, c}};
  std::size_t found = 0;
  const Straining<S> straining{strain, p, c, out, c.begin[range.begin]};
  for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
    const Natural at = natural<S>(p, c, cells, t);
    straining.tile(t, at, cells, both.tile(t, at, cells), nullptr, 0);
    find_suspects(c, cells, t, natural_of(c, cells, t.again(p.x), t.again(p.y)), suspects, found);
  });
  GatherSums sums = sums_of(both.move.fastest2, both.move.loss, both.move.good);
  sums.suspects = found;
  return sums;
}

template <class S, TransferKind transfer>
HWY_INLINE GatherSums move_average_of(const MoveJob& job, const PointView& p, const CellView& c, Range range) {
  MovingStrain<S, transfer> both{{job, p, c}};
  for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
    const Natural at = natural<S>(p, c, cells, t);
    if (job.keep) {
      t.store(at.xi, p.xi);
      t.store(at.eta, p.eta);
    }
    const LaneGradient G = both.tile(t, at, cells);
    add_to_averages(c, cells, false, at.xi, at.eta, joined_volume(p, t), t.live(lane_log_det(G)));
  });
  return sums_of(both.move.fastest2, both.move.loss, both.move.good);
}

GatherSums move_strain_range(ShapeKind shape, const MoveJob& job, const StrainJob& strain, const PointView& p, const CellView& c,
                             Range range, const StrainIncrements& out, std::uint32_t* suspects) {
  return Shapes::with(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    if constexpr (!S::centred) return GatherSums{};
    else
      return job.transfer == TransferKind::apic
                 ? move_strain_of<S, TransferKind::apic>(job, strain, p, c, range, out, suspects)
                 : move_strain_of<S, TransferKind::aflip>(job, strain, p, c, range, out, suspects);
  });
}

GatherSums move_average_range(ShapeKind shape, const MoveJob& job, const PointView& p, const CellView& c, Range range) {
  return Shapes::with(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    if constexpr (!S::centred) return GatherSums{};
    else
      return job.transfer == TransferKind::apic ? move_average_of<S, TransferKind::apic>(job, p, c, range)
                                                : move_average_of<S, TransferKind::aflip>(job, p, c, range);
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
