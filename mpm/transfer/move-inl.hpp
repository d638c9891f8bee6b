// A.8-A.11 in lanes. Included by the kernels' sources inside Highway's loop over instruction sets.
#if defined(PIVNP_MPM_MOVE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_MOVE_INL
#undef PIVNP_MPM_MOVE_INL
#else
#define PIVNP_MPM_MOVE_INL
#endif

#include "mpm/transfer/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

struct Velocity {
  V x, y;
};

// C = B D^-1 column by column; where the weights are linear, or a node is moved, the gradient (and D would vanish at a
// node).
template <class Lines>
struct AffineWeights {
  using S = typename Lines::Shape;
  static constexpr int W = S::width;
  V x[W], y[W];
  HWY_INLINE AffineWeights(const Lines& l, const TileCells& cells, const CellView& c) {
    V ax[W], ay[W];
    l.arms(ax, ay);
    along(l, l.x, ax, set(c.per_hx), cells, 0, x);
    along(l, l.y, ay, set(c.per_hy), cells, 1, y);
  }

 private:
  static HWY_INLINE void along([[maybe_unused]] const Lines& both, const Line<V, S::width>& l, const V* arm, V per_h,
                               const TileCells& cells, int axis, V* out) {
    if constexpr (S::linear) {
      for (int a = 0; a < W; ++a) out[a] = l.g[a] * per_h;
    } else {
      const V per = S::per_moment(l, arm) * per_h;
      for (int a = 0; a < W; ++a) out[a] = l.w[a] * arm[a] * per;
      if constexpr (Lines::beside_walls) {
        M beside = cells.beside(axis == 0 ? wall_left | wall_right : wall_down | wall_up);
        if (both.moved) beside = hn::Or(beside, both.by_slope[axis]);
        for (int a = 0; a < W; ++a) out[a] = hn::IfThenElse(beside, l.g[a] * per_h, out[a]);
      }
    }
  }
};

template <class S, TransferKind transfer>
struct Moving {
  static constexpr int W = S::width, N = W * W;
  static constexpr bool affine = transfer == TransferKind::apic || transfer == TransferKind::aflip;
  const MoveJob job;
  const PointView p;
  const CellView c;
  V fastest2 = zero(), loss = zero();
  M good = hn::FirstN(D(), n_lanes);

  // Per mass of the affine field, as affine_energy().
  HWY_INLINE V affine_energy(V xx, V xy, V yx, V yy) const {
    return hn::MulAdd(xx * xx + yx * yx, set(0.125 * c.hx * c.hx), (xy * xy + yy * yy) * set(0.125 * c.hy * c.hy));
  }

  // of two members of the nodes.
  template <class Lines>
  static HWY_INLINE Velocity interpolated(const Lines& l, const TileCells& cells, double Node::*x, double Node::*y) {
    V rx[W], ry[W];
    for (int b = 0; b < W; ++b) {
      rx[b] = row_sum<W>(l.x.w, cells, b * cells.nx, x);
      ry[b] = row_sum<W>(l.x.w, cells, b * cells.nx, y);
    }
    return {dot<W>(l.y.w, rx), dot<W>(l.y.w, ry)};
  }
  // of XPIC's velocity.
  template <class Lines>
  HWY_INLINE Velocity filtered(const Lines& l, const TileCells& cells) const {
    Velocity sum{zero(), zero()};
    for (int n = 0; n < N; ++n) {
      const std::ptrdiff_t node = n / W * cells.nx + n % W;
      const double* first = job.filtered + 2 * (cells.base[0] - c.node + node);
      const double* second = job.filtered + 2 * (cells.base[groups - 1] - c.node + node);
      const V w = l.x.w[n % W] * l.y.w[n / W];
      sum.x = hn::MulAdd(w, of_groups(first[0], second[0]), sum.x);
      sum.y = hn::MulAdd(w, of_groups(first[1], second[1]), sum.y);
    }
    return sum;
  }

  // The nodes' updated velocity at the points, and their affine field.
  struct Field {
    V x, y, xx, xy, yx, yy;
  };
  template <class Lines>
  HWY_INLINE Field updated(const Lines& l, const TileCells& cells) const {
    Field out{zero(), zero(), zero(), zero(), zero(), zero()};
    if constexpr (affine) {
      const AffineWeights<Lines> weights(l, cells, c);
      const auto add = [&](int b, double Node::*member, V& v, V& by_x, V& by_y) PIVNP_TILE {
        V value = zero(), moment = zero();
        for (int a = 0; a < W; ++a) {
          const V at = cells.value(b * cells.nx + a, member);
          value = hn::MulAdd(l.x.w[a], at, value);
          moment = hn::MulAdd(weights.x[a], at, moment);
        }
        v = hn::MulAdd(l.y.w[b], value, v);
        by_x = hn::MulAdd(l.y.w[b], moment, by_x);
        by_y = hn::MulAdd(weights.y[b], value, by_y);
      };
      for (int b = 0; b < W; ++b) {
        add(b, &Node::nx, out.x, out.xx, out.xy);
        add(b, &Node::ny, out.y, out.yx, out.yy);
      }
    } else {
      const Velocity n = interpolated(l, cells, &Node::nx, &Node::ny);
      out.x = n.x;
      out.y = n.y;
    }
    return out;
  }

  template <class Tile>
  HWY_INLINE void tile(const Tile& t, const TileCells& cells) {
    const auto l = lines_of<S>(p, c, cells, t);
    const Field n = updated(l, cells);
    if (job.keep) {
      t.store(l.xi, p.xi);
      t.store(l.eta, p.eta);
    }
    const Velocity u = move(
        t, n, [&] PIVNP_TILE { return interpolated(l, cells, &Node::vx, &Node::vy); },
        [&] PIVNP_TILE { return filtered(l, cells); });
    if (job.remap)
      map_again(l, cells, mass_of(p, t), u.x, u.y, n.xx * set(c.hx), n.xy * set(c.hy), n.yx * set(c.hx),
                n.yy * set(c.hy));
  }

  // By the nodes' velocity at the points, of which nothing is read after the first number is stored: the compiler would
  // read the nodes once more. `mapped_at`, `filtered_at`: the nodes' velocity before its update, and XPIC's, at the
  // points. Returns the points' new velocity.
  template <class Tile, class Mapped, class Filtered>
  HWY_INLINE Velocity move(const Tile& t, const Field& n, [[maybe_unused]] Mapped&& mapped_at,
                           [[maybe_unused]] Filtered&& filtered_at) {
    const V m = mass_of(p, t);
    const V vx = t.load(p.vx), vy = t.load(p.vy), half = set(0.5);
    const V nx = n.x, ny = n.y;
    t.store(hn::MulAdd(set(job.dt), nx, t.again(p.x)), p.x);
    t.store(hn::MulAdd(set(job.dt), ny, t.again(p.y)), p.y);
    V ux, uy;
    V before = half * hn::MulAdd(vx, vx, vy * vy), after = zero();
    if constexpr (affine) {
      before = before + affine_energy(t.load(p.C_xx), t.load(p.C_xy), t.load(p.C_yx), t.load(p.C_yy));
      t.store(n.xx, p.C_xx);
      t.store(n.xy, p.C_xy);
      t.store(n.yx, p.C_yx);
      t.store(n.yy, p.C_yy);
      after = affine_energy(n.xx, n.xy, n.yx, n.yy);
    }
    if constexpr (transfer == TransferKind::apic) {
      ux = nx;
      uy = ny;
    } else {
      const Velocity mapped = mapped_at();
      if constexpr (transfer == TransferKind::xpic) {
        const Velocity smooth = filtered_at();
        ux = smooth.x + (nx - mapped.x);
        uy = smooth.y + (ny - mapped.y);
      } else {
        const V flip_x = vx + (nx - mapped.x), flip_y = vy + (ny - mapped.y), pic = set(job.pic);
        ux = hn::MulAdd(pic, nx - flip_x, flip_x);
        uy = hn::MulAdd(pic, ny - flip_y, flip_y);
      }
    }
    t.store(ux, p.vx);
    t.store(uy, p.vy);
    const V speed2 = hn::MulAdd(ux, ux, uy * uy), reach2 = set(job.reach2);
    loss = hn::MulAdd(m, before - hn::MulAdd(half, speed2, after), loss);
    // False for NaN too.
    good = hn::And(good, hn::And(hn::Le(t.live(speed2), reach2), hn::Le(t.live(hn::MulAdd(nx, nx, ny * ny)), reach2)));
    fastest2 = hn::Max(fastest2, t.live(speed2));
    return {ux, uy};
  }

  template <class Lines>
  HWY_INLINE void map_again(const Lines& l, const TileCells& cells, V m, V ux, V uy, V cxx, V cxy, V cyx, V cyy) {
    V ax[W], ay[W], px[N], py[N];
    l.arms(ax, ay);
    for (int n = 0; n < N; ++n) {
      const V mass = m * l.x.w[n % W] * l.y.w[n / W];
      V x = ux, y = uy;
      if constexpr (affine) {
        x = hn::MulAdd(cxx, ax[n % W], hn::MulAdd(cxy, ay[n / W], x));
        y = hn::MulAdd(cyx, ax[n % W], hn::MulAdd(cyy, ay[n / W], y));
      }
      px[n] = mass * x;
      py[n] = mass * y;
    }
    add_pairs<N>(px, py, [&](std::size_t g, int n) PIVNP_TILE { return c.strain_velocity + 2 * (cells.base[g] - c.node + n / W * cells.nx + n % W); });
  }
};

HWY_INLINE GatherSums sums_of(V fastest2, V loss, M good) {
  GatherSums sums;
  sums.fastest2 = hn::GetLane(hn::MaxOfLanes(D(), fastest2));
  sums.kinetic_loss = sum_of(loss);
  sums.good = hn::AllTrue(D(), good);
  return sums;
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
