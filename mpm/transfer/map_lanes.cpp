// From the points to the nodes: A.1 (who has left the cell), A.3, A.4.
#include "mpm/transfer/lanes.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/transfer/map_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/transfer/lanes-inl.hpp"
#include "mpm/transfer/moments-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

std::size_t locate_range(const PointView& p, const CellView& c, Range range, std::uint32_t* suspects) {
  std::size_t found = 0;
  for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
    find_suspects(c, cells, t, natural_of(c, cells, t.load(p.x), t.load(p.y)), suspects, found);
  });
  return found;
}

// -integral of (sxx, syy, sxy) through the gradient at an element's centre.
HWY_INLINE void add_centre_force(const CellView& c, Node* base, double sxx, double syy, double sxy) {
  for (int n = 0; n < 4; ++n) {
    const double gx = (n % 2 == 0 ? -0.5 : 0.5) * c.per_hx, gy = (n < 2 ? -0.5 : 0.5) * c.per_hy;
    Node& node = base[n / 2 * c.nx + n % 2];
    node.fx -= sxx * gx + sxy * gy;
    node.fy -= sxy * gx + syy * gy;
  }
}

HWY_INLINE V sum3(V a, V b, V c) { return a + b + c; }

// J times the pressure of the pores over that of the water outside.
template <class Tile>
HWY_INLINE V excess_of(const PointView& p, const Tile& t) {
  if (!p.pressure) return zero();
  const V pressure = t.load(p.pressure);
  return t.load(p.J) * (p.outside != 0 ? pressure - set(p.outside) * hn::Max(zero(), set(p.level) - t.load(p.y)) : pressure);
}
// A normal stress as momentum sees it: less that.
template <class Tile>
HWY_INLINE V normal_stress(const PointView& p, const Tile& t, const double* tau, V excess) {
  return p.pressure ? t.load(tau) - excess : t.load(tau);
}
// Weight of the water that a point displaces. (Pores that open change places with it where they are drained: what they
// hold more is not in the point's mass.)
template <class Tile>
HWY_INLINE V lift_of(const PointView& p, const Tile& t) {
  const V J = p.displacing ? hn::IfThenElse(hn::Eq(t.load(p.displacing), zero()), set(1), t.load(p.J)) : t.load(p.J);
  const V weight = set(p.outside) * t.live(t.load(p.volume0)) * J;
  return hn::IfThenElseZero(hn::Lt(t.load(p.y), set(p.level)), weight);
}

// Sums over a run of elements of V0 times stress: what `selective`, `full` and F-bar of bilinear shapes average.
struct ElementSums {
  static constexpr std::size_t most = 32;  // elements
  double xx[most] = {}, yy[most] = {}, zz[most] = {}, xy[most] = {}, volume[most] = {};

  HWY_INLINE void add(const TileCells& cells, std::size_t first, V v, double* to) {
    double sums[groups];
    group_sums(v, sums);
    for (std::size_t g = 0; g < groups; ++g) to[cells.occupied[g] - first] += sums[g];
  }
};

// The mean stress that F-bar puts in the place of the points' own, in `mean`; the others' force at the nodes.
HWY_INLINE void average_elements(const PointView& p, const CellView& c, Range range, Locking locking, double* mean) {
  ElementSums sums;
  const bool some_open = locking == Locking::fbar && p.opening;
  for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
    const V v = t.live(some_open ? joined_volume(p, t) : t.load(p.volume0));
    const V excess = excess_of(p, t);
    sums.add(cells, range.begin, v * normal_stress(p, t, p.tau_xx, excess), sums.xx);
    sums.add(cells, range.begin, v * normal_stress(p, t, p.tau_yy, excess), sums.yy);
    sums.add(cells, range.begin, v * normal_stress(p, t, p.tau_zz, excess), sums.zz);
    if (locking == Locking::full) sums.add(cells, range.begin, v * t.load(p.tau_xy), sums.xy);
    if (locking == Locking::fbar) sums.add(cells, range.begin, v, sums.volume);
  });
  for (std::size_t s = range.begin; s < range.end; ++s) {
    const std::size_t at = s - range.begin;
    Node* base = c.node + c.index[s];
    const double third = (sums.xx[at] + sums.yy[at] + sums.zz[at]) / 3;
    mean[at] = sums.volume[at] > 0 ? third / sums.volume[at] : 0;  // 0: all its points stand open
    if (locking == Locking::full) add_centre_force(c, base, sums.xx[at], sums.yy[at], sums.xy[at]);
    if (locking == Locking::selective) add_centre_force(c, base, third, third, 0);
  }
}

template <class S, bool affine>
struct Mapping {
  static constexpr int W = S::width;
  const PointView p;
  const CellView c;
  bool momentum;
  double force;  // 1 or 0
  Locking locking;

  // What the mean stress of the tile's points changes by; `mean`: of F-bar's elements, from the occupied cell `first` on.
  template <class Tile>
  HWY_INLINE V mean_change(const Natural& place, const Tile& t, const TileCells& cells, const double* mean,
                           std::size_t first, V excess, V xx, V yy) const {
    const V own = sum3(xx, yy, normal_stress(p, t, p.tau_zz, excess)) * set(-1.0 / 3);
    if constexpr (!S::centred) {
      if (locking != Locking::fbar) return own;
      const V element = of_groups(mean[cells.occupied[0] - first], mean[cells.occupied[groups - 1] - first]);
      return hn::IfThenZeroElse(stands_open(p, t), own + element);
    } else {
      return hn::IfThenZeroElse(stands_open(p, t), own + averaged(c, cells, place.xi, place.eta));
    }
  }

  template <class Tile>
  HWY_INLINE void tile(const Tile& t, const TileCells& cells, double volume_factor, const double* mean,
                       std::size_t first) const {
    const Natural place = natural<S>(p, c, cells, t);
    if constexpr (affine && CellMoments::serve<S>)
      if (CellMoments::hold(cells) && p.outside == 0) return tile_by_moments(t, cells, place, volume_factor);
    const TileLines<S, Tile> l(p, c, cells, t, place);
    V ax[W], ay[W], pm[W], ux[W], uy[W], ex[W], ey[W], fxg[W], fxw[W], fyg[W], fyw[W];
    const V m = momentum ? mass_of(p, t) : zero();
    const V vx = t.load(p.vx), vy = t.load(p.vy);
    if constexpr (affine) {
      l.arms(ax, ay);
      const V cxx = t.load(p.C_xx) * set(c.hx), cyx = t.load(p.C_yx) * set(c.hx);
      const V cxy = t.load(p.C_xy) * set(c.hy), cyy = t.load(p.C_yy) * set(c.hy);
      for (int a = 0; a < W; ++a) {
        ux[a] = hn::MulAdd(cxx, ax[a], vx);
        uy[a] = hn::MulAdd(cyx, ax[a], vy);
        ex[a] = cxy * ay[a];
        ey[a] = cyy * ay[a];
      }
    }
    const V v = t.live(p.mass ? t.load(p.volume0) : t.again(p.volume0)) * set(-volume_factor);
    const V excess = excess_of(p, t);
    V xx = normal_stress(p, t, p.tau_xx, excess), yy = normal_stress(p, t, p.tau_yy, excess);
    if (locking != Locking::none && volume_factor != 0) {
      const V change = mean_change(place, t, cells, mean, first, excess, xx, yy);
      xx = xx + change;
      yy = yy + change;
    }
    const V vgx = v * set(c.per_hx), vgy = v * set(c.per_hy), xy = t.load(p.tau_xy);
    const V sxx = vgx * xx, sxy_x = vgx * xy, sxy_y = vgy * xy, syy = vgy * yy;
    for (int a = 0; a < W; ++a) {
      pm[a] = m * l.x.w[a];
      fxg[a] = sxx * l.x.g[a];
      fxw[a] = sxy_y * l.x.w[a];
      fyg[a] = sxy_x * l.x.g[a];
      fyw[a] = syy * l.x.w[a];
    }
    if (p.outside != 0 && force != 0) {
      const V lift = lift_of(p, t);
      for (int a = 0; a < W; ++a) fyg[a] = hn::MulAdd(lift, l.x.w[a], fyg[a]);
    }
    const auto mass = [&](int n) PIVNP_TILE { return pm[n % W] * l.y.w[n / W]; };
    const auto four = [&](int n) PIVNP_TILE {
      const int a = n % W, b = n / W;
      const V share = mass(n), fx = hn::MulAdd(fxg[a], l.y.w[b], fxw[a] * l.y.g[b]), fy = hn::MulAdd(fyg[a], l.y.w[b], fyw[a] * l.y.g[b]);
      if constexpr (affine) return Four{share * (ux[a] + ex[b]), share * (uy[a] + ey[b]), fx, fy};
      else return Four{share * vx, share * vy, fx, fy};
    };
    add_fives<W * W>(four, mass, [&](std::size_t g, int n) PIVNP_TILE { return &cells.base[g][n / W * cells.nx + n % W].vx; });
  }

  // The same from the sums of powers over each cell.
  template <class Tile>
  HWY_INLINE void tile_by_moments(const Tile& t, const TileCells& cells, const Natural& place, double volume_factor) const {
    const V m = momentum ? mass_of(p, t) : zero(), mx = m * set(c.hx), my = m * set(c.hy);
    const V v = t.live(p.mass ? t.load(p.volume0) : t.again(p.volume0)) * set(-volume_factor);
    const V excess = excess_of(p, t);
    V xx = normal_stress(p, t, p.tau_xx, excess), yy = normal_stress(p, t, p.tau_yy, excess);
    if (locking != Locking::none && volume_factor != 0) {
      const V change = mean_change(place, t, cells, nullptr, 0, excess, xx, yy);
      xx = xx + change;
      yy = yy + change;
    }
    const V vx = v * set(c.per_hx), vy = v * set(c.per_hy), xy = t.load(p.tau_xy);
    CellMoments sums(place.xi, place.eta);
    sums.take_mass(m);
    sums.take_momentum({m * t.load(p.vx), m * t.load(p.vy)}, {mx * t.load(p.C_xx), mx * t.load(p.C_yx)},
                       {my * t.load(p.C_xy), my * t.load(p.C_yy)});
    sums.take_force({vx * xx, vx * xy}, {vy * xy, vy * yy});
    sums.add([&](std::size_t g, std::ptrdiff_t i, std::ptrdiff_t j) PIVNP_TILE { return &cells.base[g][j * cells.nx + i].vx; });
  }

  HWY_INLINE void run(Range range) const {
    double mean[ElementSums::most];
    const bool average = !S::centred && locking != Locking::none && force != 0;
    const double factor = average && locking == Locking::full ? 0 : force;
    const std::size_t each = average ? ElementSums::most : range.end - range.begin;
    while (range.begin < range.end) {
      const Range part{range.begin, std::min(range.end, range.begin + each)};
      if (average) average_elements(p, c, part, locking, mean);
      for_tiles(c, part, [&](const auto& t, const TileCells& cells) PIVNP_TILE { tile(t, cells, factor, mean, part.begin); });
      range.begin = part.end;
    }
  }
};

void map_range(ShapeKind shape, bool affine, bool momentum, bool force, Locking locking, const PointView& p,
               const CellView& c, Range range) {
  Shapes::with(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    if (affine) {
      Mapping<S, true>{p, c, momentum, force ? 1.0 : 0.0, locking}.run(range);
    } else {
      Mapping<S, false>{p, c, momentum, force ? 1.0 : 0.0, locking}.run(range);
    }
  });
}

// Of the hoop stress, which pulls towards the axis.
template <class S>
HWY_INLINE void map_hoop_of(Locking locking, const PointView& p, const CellView& c, Range range) {
  constexpr int W = S::width, N = W * W;
  const Mapping<S, false> mapping{p, c, false, 1.0, locking};
  double mean[ElementSums::most];
  const bool average = !S::centred && locking != Locking::none;
  const std::size_t each = average ? ElementSums::most : range.end - range.begin;
  while (range.begin < range.end) {
    const Range part{range.begin, std::min(range.end, range.begin + each)};
    if (average) average_elements(p, c, part, locking, mean);
    for_tiles(c, part, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
      const auto l = lines_of<S>(p, c, cells, t);
      const V excess = excess_of(p, t);
      V zz = normal_stress(p, t, p.tau_zz, excess);
      if (locking != Locking::none)
        zz = zz + mapping.mean_change({l.xi, l.eta}, t, cells, mean, part.begin, excess, normal_stress(p, t, p.tau_xx, excess),
                                      normal_stress(p, t, p.tau_yy, excess));
      const V f = t.live(t.load(p.volume0)) * zz / radius_of(c, cells, l.xi);
      V fx[N];
      for (int n = 0; n < N; ++n) fx[n] = hn::Neg(f * l.x.w[n % W] * l.y.w[n / W]);
      add_each<N>(fx, [&](std::size_t g, int n) PIVNP_TILE { return &cells.base[g][n / W * cells.nx + n % W].fx; });
    });
    range.begin = part.end;
  }
}
void map_hoop_range(ShapeKind shape, Locking locking, const PointView& p, const CellView& c, Range range) {
  Shapes::with(shape, [&](auto kind) HWY_ATTR { map_hoop_of<decltype(kind)>(locking, p, c, range); });
}

void average_stress_range(const PointView& p, const CellView& c, Range range) {
  for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
    const V excess = excess_of(p, t);
    const V mean = sum3(normal_stress(p, t, p.tau_xx, excess), normal_stress(p, t, p.tau_yy, excess), normal_stress(p, t, p.tau_zz, excess)) * set(1.0 / 3);
    const Natural at = natural<BSplineShape>(p, c, cells, t);
    add_to_averages(c, cells, true, at.xi, at.eta, joined_volume(p, t), mean);
  });
}

void project_range(ShapeKind shape, const double* v, double* out, const PointView& p, const CellView& c,
                   Range range) {
  Shapes::with(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    constexpr int W = S::width, N = W * W;
    for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
      std::ptrdiff_t base[groups];
      for (std::size_t g = 0; g < groups; ++g) base[g] = cells.base[g] - c.node;
      const auto at = [&](std::size_t g, int n) PIVNP_TILE { return 2 * (base[g] + n / W * cells.nx + n % W); };
      const auto l = lines_of<S>(p, c, cells, t);
      const V m = mass_of(p, t);
      V w[N], vx = zero(), vy = zero(), px[N], py[N];
      for (int n = 0; n < N; ++n) {
        const double *first = v + at(0, n), *second = v + at(groups - 1, n);
        w[n] = l.x.w[n % W] * l.y.w[n / W];
        vx = hn::MulAdd(w[n], of_groups(first[0], second[0]), vx);
        vy = hn::MulAdd(w[n], of_groups(first[1], second[1]), vy);
      }
      for (int n = 0; n < N; ++n) {
        px[n] = m * w[n] * vx;
        py[n] = m * w[n] * vy;
      }
      add_pairs<N>(px, py, [&](std::size_t g, int n) PIVNP_TILE { return out + at(g, n); });
    });
  });
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(locate_range);
HWY_EXPORT(map_range);
HWY_EXPORT(map_hoop_range);
HWY_EXPORT(average_stress_range);
HWY_EXPORT(project_range);

std::size_t locate_lanes(const PointView& p, const CellView& c, Range range, std::uint32_t* suspects) {
  return HWY_DYNAMIC_DISPATCH(locate_range)(p, c, range, suspects);
}
void map_lanes(ShapeKind shape, bool affine, bool momentum, bool force, Locking locking, const PointView& p,
               const CellView& c, Range range) {
  HWY_DYNAMIC_DISPATCH(map_range)(shape, affine, momentum, force, locking, p, c, range);
}
void map_hoop_lanes(ShapeKind shape, Locking locking, const PointView& p, const CellView& c, Range range) {
  HWY_DYNAMIC_DISPATCH(map_hoop_range)(shape, locking, p, c, range);
}
void average_stress_lanes(const PointView& p, const CellView& c, Range range) {
  HWY_DYNAMIC_DISPATCH(average_stress_range)(p, c, range);
}
void project_lanes(ShapeKind shape, const double* v, double* out, const PointView& p, const CellView& c,
                   Range range) {
  HWY_DYNAMIC_DISPATCH(project_range)(shape, v, out, p, c, range);
}

}  // namespace pivnp::mpm
#endif
