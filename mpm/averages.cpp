#include "mpm/averages.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/kernel.hpp"

namespace pivnp::mpm {

namespace {

// Where points are too few or too close for a gradient: the least eigenvalue of S, in units of what it is far from
// surfaces (1), is raised to this.
constexpr double least_spread = 0.1;

// The four elements around a node; it is their upper right, upper left, lower right and lower left corner.
struct Around {
  const AveragedCell &ll, &lr, &ul, &ur;
  Around(GridState& g, std::size_t n)
      : ll(g.element(n)[-g.grid.nx - 1]), lr(g.element(n)[-g.grid.nx]), ul(g.element(n)[-1]), ur(g.element(n)[0]) {}
};

void set_shift(GridState& g, std::size_t n) {
  const Around e(g, n);
  const double volume = g.node[n].dy, per_volume = volume > 0 ? 1 / volume : 0;
  AveragedCell& here = *g.element(n);
  here.shift_x = per_volume * (e.ll.high - e.lr.high + (e.ul.low - e.ur.low));
  here.shift_y = per_volume * (e.ll.right - e.ul.right + (e.lr.left - e.ur.left));
}

// S^-1 (or S^-T) F^T of the nodes' means.
void set_flux(GridState& g, std::size_t n, Averaging which) {
  const std::ptrdiff_t row = g.grid.nx;
  AveragedCell& e = *g.element(n);
  const double along_x = e.low + e.high, along_y = e.left + e.right;
  e.flux_x = e.flux_y = 0;
  if (along_x <= 0 && along_y <= 0) return;
  const AveragedCell &a = e, &b = *(&e + 1), &c = *(&e + row), &d = *(&e + row + 1);
  const Node *p = &g.node[n], *q = p + row;
  const double ux = e.low * (p[1].dx - p[0].dx) + e.high * (q[1].dx - q[0].dx);
  const double uy = e.left * (q[0].dx - p[0].dx) + e.right * (q[1].dx - p[1].dx);
  double xx = along_x - e.low * (b.shift_x - a.shift_x) - e.high * (d.shift_x - c.shift_x);
  double yy = along_y - e.left * (c.shift_y - a.shift_y) - e.right * (d.shift_y - b.shift_y);
  double xy = -e.low * (b.shift_y - a.shift_y) - e.high * (d.shift_y - c.shift_y);
  double yx = -e.left * (c.shift_x - a.shift_x) - e.right * (d.shift_x - b.shift_x);
  const double half = 0.5 * (xx * along_y - yy * along_x), mean = 0.5 * (xx * along_y + yy * along_x);
  const double size = along_x * along_y, off = 0.5 * (xy + yx);
  const double lack = least_spread * size - (mean - std::sqrt(half * half + off * off * size));
  if (size <= 0) {  // all on one line of nodes
    const bool is_x = along_x > 0;
    const double along = is_x ? along_x : along_y, s = std::max(is_x ? xx : yy, least_spread * along);
    (is_x ? e.flux_x : e.flux_y) = (is_x ? ux : uy) / s;
    return;
  }
  if (lack > 0) {
    xx += lack / along_y;
    yy += lack / along_x;
  }
  if (which == Averaging::of_strain) std::swap(xy, yx);
  const double per_det = 1 / (xx * yy - xy * yx);
  e.flux_x = per_det * (yy * ux - xy * uy);
  e.flux_y = per_det * (xx * uy - yx * ux);
}

void add_fluxes(GridState& g, std::size_t n) {
  const Around e(g, n);
  Node& node = g.node[n];
  if (node.dy <= 0) return;
  const double sum = e.ll.high * e.ll.flux_x - e.lr.high * e.lr.flux_x + (e.ul.low * e.ul.flux_x - e.ur.low * e.ur.flux_x) +
                     (e.ll.right * e.ll.flux_y - e.ul.right * e.ul.flux_y) +
                     (e.lr.left * e.lr.flux_y - e.ur.left * e.ur.flux_y);
  node.dx += sum / node.dy;
}

}  // namespace

void move_means_to_nodes(GridState& g, Averaging which, int threads) {
  for_nodes(g, threads, [&](Node&, std::uint32_t n) { set_shift(g, n); });
  for_nodes(g, threads, [&](Node&, std::uint32_t n) { set_flux(g, n, which); });
  for_nodes(g, threads, [&](Node&, std::uint32_t n) { add_fluxes(g, n); });
}

}  // namespace pivnp::mpm
