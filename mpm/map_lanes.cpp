// From the points to the nodes: A.1 (natural coordinates), A.3, A.4.
#include "mpm/lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/map_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

std::size_t locate_slots(ShapeKind shape, const PointView& p, const CellView& c, SlotRange slots,
                         std::uint32_t* suspects) {
  const D d;
  const bool element = shape == ShapeKind::bilinear;
  const double place = element ? 0 : 1;  // of the cell's origin, from its lower left node
  // The square around a node on the domain's edge ends there.
  const auto low = [&](int i) { return element || i == 0 ? 0.0 : -0.5; };
  const auto high = [&](int i, int n) { return element ? 1.0 : i == n - 3 ? 0.0 : 0.5; };
  const V per_x = set(c.per_hx), per_y = set(c.per_hy), ox = set(c.origin_x), oy = set(c.origin_y);
  std::size_t found = 0;
  std::int32_t row = 0, row_end = 0;  // the first cell of the row, and that of the next one
  V j0 = zero(), low_y = zero(), high_y = zero();
  for (std::size_t s = slots.begin; s < slots.end; ++s) {
    const std::int32_t cell = c.slot_cell[s];
    if (HWY_UNLIKELY(cell >= row_end)) {
      int j = cell / c.nx;
      row = j * c.nx;
      row_end = row + c.nx;
      if (j >= c.sheet_rows) j %= c.sheet_rows;
      j0 = set(j + place);
      low_y = set(low(j));
      high_y = set(high(j, c.ny));
    }
    const int i = cell - row;
    const V i0 = set(i + place), low_x = set(low(i)), high_x = set(high(i, c.nx));
    std::uint32_t at = c.slot_begin[s];
    for_tiles(c, s, [&](const auto& t) PIVNP_TILE {
      const V xi = (t.load(p.x) - ox) * per_x - i0, eta = (t.load(p.y) - oy) * per_y - j0;
      const M inside = hn::And(hn::And(hn::Ge(xi, low_x), hn::Lt(xi, high_x)),
                               hn::And(hn::Ge(eta, low_y), hn::Lt(eta, high_y)));
      t.store(xi, p.xi);
      t.store(eta, p.eta);
      if (HWY_UNLIKELY(!hn::AllTrue(d, inside))) {
        HWY_ALIGN double in[n_lanes];
        hn::Store(hn::IfThenElseZero(inside, set(1)), d, in);
        for (std::uint32_t l = 0; l < n_lanes && at + l < c.slot_begin[s + 1]; ++l)
          if (in[l] == 0) suspects[found++] = at + l;
      }
      at += n_lanes;
    });
  }
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

// The element's sums of V0 times stress: what `selective`, `full` and F-bar of bilinear shapes average. Returns the mean
// stress that F-bar puts in the place of the points' own.
HWY_INLINE double average_element(const PointView& p, const CellView& c, std::size_t slot, Locking locking, Node* base) {
  V xx = zero(), yy = zero(), xy = zero(), zz = zero(), volume = zero();
  for_tiles(c, slot, [&](const auto& t) PIVNP_TILE {
    const V v = locking == Locking::fbar ? joined_volume(p, t) : t.live(t.load(p.volume0));
    xx = hn::MulAdd(v, t.load(p.tau_xx), xx);
    yy = hn::MulAdd(v, t.load(p.tau_yy), yy);
    zz = hn::MulAdd(v, t.load(p.tau_zz), zz);
    xy = hn::MulAdd(v, t.load(p.tau_xy), xy);
    volume = volume + v;
  });
  const double mean = sum_of(sum3(xx, yy, zz)) / 3;
  if (locking == Locking::full) add_centre_force(c, base, sum_of(xx), sum_of(yy), sum_of(xy));
  if (locking == Locking::selective) add_centre_force(c, base, mean, mean, 0);
  return mean / sum_of(volume);
}

template <class S, bool affine>
struct Mapping {
  static constexpr int W = S::W;
  const PointView p;
  const CellView c;
  bool momentum;
  double force;  // 1 or 0
  Locking locking;

  // What the mean stress of the tile's points changes by.
  template <class Tile>
  HWY_INLINE V mean_change(const TileLines<S>& l, const Tile& t, const Node* base, double element, V xx, V yy) const {
    const V own = sum3(xx, yy, t.load(p.tau_zz)) * set(-1.0 / 3);
    if constexpr (W == 2) {
      return locking == Locking::fbar ? hn::IfThenZeroElse(stands_open(p, t), own + set(element)) : own;
    } else {
      return hn::IfThenZeroElse(stands_open(p, t), own + averaged(c, std::int32_t(base - c.node), l.xi, l.eta));
    }
  }

  template <class Tile>
  HWY_INLINE void tile(const Tile& t, Node* base, unsigned fold, double volume_factor, double element) const {
    const TileLines<S> l(p, fold, t);
    V ax[W], ay[W], pm[W], ux[W], uy[W], ex[W], ey[W], fxg[W], fxw[W], fyg[W], fyw[W];
    const V m = momentum ? t.live(t.load(p.mass)) : zero();
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
    const V v = t.live(t.load(p.volume0)) * set(-volume_factor);
    V xx = t.load(p.tau_xx), yy = t.load(p.tau_yy);
    if (locking != Locking::none) {
      const V change = mean_change(l, t, base, element, xx, yy);
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
    V fy[W][W];
    for (int b = 0; b < W; ++b) {
      Node* row = base + b * c.nx;
      for (int a = 0; a < W; ++a) {
        const V mass = pm[a] * l.y.w[b];
        V px, py;
        if constexpr (affine) {
          px = mass * (ux[a] + ex[b]);
          py = mass * (uy[a] + ey[b]);
        } else {
          px = mass * vx;
          py = mass * vy;
        }
        Four{mass, px, py, hn::MulAdd(fxg[a], l.y.w[b], fxw[a] * l.y.g[b])}.add_to(&row[a].mass);
        fy[b][a] = hn::MulAdd(fyg[a], l.y.w[b], fyw[a] * l.y.g[b]);
      }
    }
    HWY_ALIGN double sums[4];
    if constexpr (W == 2) {
      Four{fy[0][0], fy[0][1], fy[1][0], fy[1][1]}.get(sums);
      for (int n = 0; n < 4; ++n) base[n / 2 * c.nx + n % 2].fy += sums[n];
    } else {
      for (int b = 0; b < W; ++b) {
        Four{fy[b][0], fy[b][1], fy[b][2], zero()}.get(sums);
        for (int a = 0; a < W; ++a) base[b * c.nx + a].fy += sums[a];
      }
    }
  }

  HWY_INLINE void slot(std::size_t s) const {
    Node* base = c.node + c.slot_cell[s];
    double element = 0, factor = force;
    if constexpr (W == 2) {
      if (locking != Locking::none && force != 0) element = average_element(p, c, s, locking, base);
      if (locking == Locking::full) factor = 0;
    }
    for_tiles(c, s, [&](const auto& t) PIVNP_TILE { tile(t, base, c.slot_fold[s], factor, element); });
  }
};

void map_slots(ShapeKind shape, bool affine, bool momentum, bool force, Locking locking, const PointView& p,
               const CellView& c, SlotRange slots) {
  with_lanes(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    if (affine) {
      const Mapping<S, true> map{p, c, momentum, force ? 1.0 : 0.0, locking};
      for (std::size_t s = slots.begin; s < slots.end; ++s) map.slot(s);
    } else {
      const Mapping<S, false> map{p, c, momentum, force ? 1.0 : 0.0, locking};
      for (std::size_t s = slots.begin; s < slots.end; ++s) map.slot(s);
    }
  });
}

void average_stress_slots(const PointView& p, const CellView& c, SlotRange slots) {
  for (std::size_t s = slots.begin; s < slots.end; ++s) {
    for_tiles(c, s, [&](const auto& t) PIVNP_TILE {
      const V mean = sum3(t.load(p.tau_xx), t.load(p.tau_yy), t.load(p.tau_zz)) * set(1.0 / 3);
      add_to_averages(c, c.slot_cell[s], true, t.load(p.xi), t.load(p.eta), joined_volume(p, t), mean);
    });
  }
}

void project_slots(ShapeKind shape, const double* v, double* out, const PointView& p, const CellView& c,
                   SlotRange slots) {
  with_lanes(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    constexpr int W = S::W, N = W * W;
    for (std::size_t s = slots.begin; s < slots.end; ++s) {
      const std::ptrdiff_t base = c.slot_cell[s];
      const auto at = [&](int n) { return 2 * (base + n / W * c.nx + n % W); };
      for_tiles(c, s, [&](const auto& t) PIVNP_TILE {
        const TileLines<S> l(p, c.slot_fold[s], t);
        const V m = t.live(t.load(p.mass));
        V w[N], vx = zero(), vy = zero(), px[N], py[N];
        for (int n = 0; n < N; ++n) {
          w[n] = l.x.w[n % W] * l.y.w[n / W];
          vx = hn::MulAdd(w[n], set(v[at(n)]), vx);
          vy = hn::MulAdd(w[n], set(v[at(n) + 1]), vy);
        }
        for (int n = 0; n < N; ++n) {
          px[n] = m * w[n] * vx;
          py[n] = m * w[n] * vy;
        }
        add_pairs<N>(px, py, [&](int n) { return out + at(n); });
      });
    }
  });
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(locate_slots);
HWY_EXPORT(map_slots);
HWY_EXPORT(average_stress_slots);
HWY_EXPORT(project_slots);

std::size_t locate_lanes(ShapeKind shape, const PointView& p, const CellView& c, SlotRange slots,
                         std::uint32_t* suspects) {
  return HWY_DYNAMIC_DISPATCH(locate_slots)(shape, p, c, slots, suspects);
}
void map_lanes(ShapeKind shape, bool affine, bool momentum, bool force, Locking locking, const PointView& p,
               const CellView& c, SlotRange slots) {
  HWY_DYNAMIC_DISPATCH(map_slots)(shape, affine, momentum, force, locking, p, c, slots);
}
void average_stress_lanes(const PointView& p, const CellView& c, SlotRange slots) {
  HWY_DYNAMIC_DISPATCH(average_stress_slots)(p, c, slots);
}
void project_lanes(ShapeKind shape, const double* v, double* out, const PointView& p, const CellView& c,
                   SlotRange slots) {
  HWY_DYNAMIC_DISPATCH(project_slots)(shape, v, out, p, c, slots);
}

}  // namespace pivnp::mpm
#endif
