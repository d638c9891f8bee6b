#include "pivnp/np/fast_step.hpp"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/np/fast_step.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "pivnp/np/fast_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::np::HWY_NAMESPACE {

// One component in an element, as Bilinear of gather.hpp: a + b xi + c eta + e xi eta.
struct Component {
  V a, b, c, e;
};

struct Cell {
  V i, j;  // lower left node
  Component u, v;
};

HWY_INLINE V at(const Component& f, V xi, V eta) {
  return hn::Add(hn::Add(f.a, hn::Mul(f.b, xi)), hn::Mul(hn::Add(f.c, hn::Mul(f.e, xi)), eta));
}

HWY_INLINE Component component(V lower_left, V lower_right, V upper_left, V upper_right) {
  const V b = hn::Sub(lower_right, lower_left);
  return {lower_left, b, hn::Sub(upper_left, lower_left), hn::Sub(hn::Sub(upper_right, upper_left), b)};
}

HWY_INLINE void load(const FastField& f, Cell& cell) {
  const D d;
  const hn::Vec<DI64> n = hn::PromoteTo(
      DI64(), hn::DemoteTo(DI32(), hn::Add(hn::Mul(cell.j, hn::Set(d, double(f.nx))), cell.i)));
  const DU64 du;
  const std::uint64_t* nodes = f.nodes.data();
  V u[4], v[4];
  split(hn::GatherIndex(du, nodes, n), u[0], v[0]);
  split(hn::GatherIndex(du, nodes + 1, n), u[1], v[1]);
  split(hn::GatherIndex(du, nodes + f.nx, n), u[2], v[2]);
  split(hn::GatherIndex(du, nodes + f.nx + 1, n), u[3], v[3]);
  cell.u = component(u[0], u[1], u[2], u[3]);
  cell.v = component(v[0], v[1], v[2], v[3]);
}

// Newton's method for m = s + d(m)/2 as in Gather::central; true lanes have settled.
HWY_INLINE M mid_point(const FastField& f, const Limits& l, V sx, V sy, M wanted, Cell& cell, V& mx, V& my) {
  const D d;
  const V hx = hn::Set(d, 0.5 * f.per_spacing_x), hy = hn::Set(d, 0.5 * f.per_spacing_y);
  const V tolerance = hn::Add(hn::Set(d, 1e-14), hn::Mul(hn::Set(d, 4 * std::numeric_limits<double>::epsilon()),
                                                         hn::Add(sx, sy)));
  M settled = hn::Not(wanted);  // what is not wanted shall not keep the loop going
  M found = hn::And(wanted, hn::Not(wanted));
  mx = sx;
  my = sy;
  for (int n = 0; n < 8; ++n) {
    if (n > 0) {
      const M in = inside(l, mx, my);
      const V i = hn::IfThenElse(hn::Or(settled, hn::Not(in)), cell.i, hn::Min(hn::Floor(mx), l.cells_x));
      const V j = hn::IfThenElse(hn::Or(settled, hn::Not(in)), cell.j, hn::Min(hn::Floor(my), l.cells_y));
      const M moved = hn::Or(hn::Ne(i, cell.i), hn::Ne(j, cell.j));
      if (!hn::AllFalse(d, moved)) {
        cell.i = i;
        cell.j = j;
        load(f, cell);
      }
    }
    const V xi = hn::Sub(mx, cell.i), eta = hn::Sub(my, cell.j);
    const V rx = hn::Sub(hn::Add(sx, hn::Mul(hx, at(cell.u, xi, eta))), mx);
    const V ry = hn::Sub(hn::Add(sy, hn::Mul(hy, at(cell.v, xi, eta))), my);
    const V a = hn::Sub(l.one, hn::Mul(hx, hn::Add(cell.u.b, hn::Mul(cell.u.e, eta))));
    const V b = hn::Mul(hx, hn::Add(cell.u.c, hn::Mul(cell.u.e, xi)));  // the negatives of b and c in the scalar step
    const V c = hn::Mul(hy, hn::Add(cell.v.b, hn::Mul(cell.v.e, eta)));
    const V e = hn::Sub(l.one, hn::Mul(hy, hn::Add(cell.v.c, hn::Mul(cell.v.e, xi))));
    const V inverse = hn::Div(l.one, hn::Sub(hn::Mul(a, e), hn::Mul(b, c)));
    const V px = hn::Mul(hn::Add(hn::Mul(e, rx), hn::Mul(b, ry)), inverse);
    const V py = hn::Mul(hn::Add(hn::Mul(a, ry), hn::Mul(c, rx)), inverse);
    mx = hn::IfThenElse(settled, mx, hn::Add(mx, px));
    my = hn::IfThenElse(settled, my, hn::Add(my, py));
    const V left = hn::Mul(hn::Max(hn::Abs(hn::Mul(hx, cell.u.e)), hn::Abs(hn::Mul(hy, cell.v.e))),
                           hn::Abs(hn::Mul(px, py)));
    const M now = hn::And(hn::AndNot(settled, hn::Le(left, tolerance)),
                          contains(l, hn::Sub(mx, cell.i), hn::Sub(my, cell.j)));
    found = hn::Or(found, now);
    settled = hn::Or(settled, now);
    if (hn::AllTrue(d, settled)) break;
  }
  return found;
}

HWY_INLINE Read read_bilinear(const FastField& f, const Limits& l, V sx, V sy, M wanted) {
  const D d;
  Cell cell;  // lanes that are not wanted read the first element
  cell.i = hn::IfThenElseZero(wanted, hn::Min(hn::Floor(sx), l.cells_x));
  cell.j = hn::IfThenElseZero(wanted, hn::Min(hn::Floor(sy), l.cells_y));
  load(f, cell);
  V mx = sx, my = sy;
  if (f.central) wanted = mid_point(f, l, sx, sy, wanted, cell, mx, my);
  const V xi = hn::Sub(mx, cell.i), eta = hn::Sub(my, cell.j);
  const V gx = f.centre_gradient ? hn::Set(d, 0.5) : xi, gy = f.centre_gradient ? hn::Set(d, 0.5) : eta;
  const V ihx = hn::Set(d, f.per_spacing_x), ihy = hn::Set(d, f.per_spacing_y);
  return {cell.i, cell.j, xi, eta, at(cell.u, xi, eta), at(cell.v, xi, eta),
          {hn::Mul(hn::Add(cell.u.b, hn::Mul(cell.u.e, gy)), ihx), hn::Mul(hn::Add(cell.u.c, hn::Mul(cell.u.e, gx)), ihy),
           hn::Mul(hn::Add(cell.v.b, hn::Mul(cell.v.e, gy)), ihx), hn::Mul(hn::Add(cell.v.c, hn::Mul(cell.v.e, gx)), ihy)},
          wanted};
}

void StepAll(const FastField& f, const FastParticles& particles) {
  const Limits l = limits_of(f);
  step_all(f, l, particles, [&](V sx, V sy, M wanted) HWY_ATTR { return read_bilinear(f, l, sx, sy, wanted); });
}

}  // namespace pivnp::np::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::np {

HWY_EXPORT(StepAll);

void fast_step(const FastField& field, const FastParticles& particles) { HWY_DYNAMIC_DISPATCH(StepAll)(field, particles); }

}  // namespace pivnp::np
#endif
