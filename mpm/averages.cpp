#include "mpm/averages.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "mpm/kernel.hpp"

namespace pivnp::mpm {

namespace {

// Where points are too few or too close for a gradient: the least eigenvalue of S, in units of what it is far from
// surfaces (1), is raised to this.
constexpr double least_spread = 0.05;

double share(double edge, double across, double other) {
  const double both = across + other;
  return both > 0 ? edge * (across / both) : 0;
}

// S^-1 F^T (or S^-T F^T) of the corners' means, and F times that: what the cell moves from corner to corner.
void set_flux(GridState& g, std::size_t n, Averaging which) {
  const std::ptrdiff_t row = g.grid.nx;
  AveragedCell* at = g.averaged_cell(n);
  const AveragedCell &a = *at, &b = at[1], &c = at[row], &d = at[row + 1];
  const double low = share(a.edge_x, c.edge_x, at[-row].edge_x), high = share(c.edge_x, a.edge_x, at[2 * row].edge_x);
  const double left = share(a.edge_y, b.edge_y, at[-1].edge_y), right = share(b.edge_y, a.edge_y, at[2].edge_y);
  at->low = at->high = at->left = at->right = 0;
  const double along_x = low + high, along_y = left + right, size = along_x * along_y;
  if (along_x <= 0 && along_y <= 0) return;
  const Node *p = &g.node[n], *q = p + row;
  const double ux = low * (p[1].dx - p[0].dx) + high * (q[1].dx - q[0].dx);
  const double uy = left * (q[0].dx - p[0].dx) + right * (q[1].dx - p[1].dx);
  double xx = along_x - low * (b.shift_x - a.shift_x) - high * (d.shift_x - c.shift_x);
  double yy = along_y - left * (c.shift_y - a.shift_y) - right * (d.shift_y - b.shift_y);
  double x = 0, y = 0;
  if (size > 0) {
    double xy = -low * (b.shift_y - a.shift_y) - high * (d.shift_y - c.shift_y);
    double yx = -left * (c.shift_x - a.shift_x) - right * (d.shift_x - b.shift_x);
    const double mean = 0.5 * (xx * along_y + yy * along_x), half = 0.5 * (xx * along_y - yy * along_x);
    const double off = 0.5 * (xy + yx), lack = least_spread * size - (mean - std::sqrt(half * half + off * off * size));
    if (lack > 0) {
      xx += lack / along_y;
      yy += lack / along_x;
    }
    if (which == Averaging::of_strain) std::swap(xy, yx);
    const double per_det = 1 / (xx * yy - xy * yx);
    x = per_det * (yy * ux - xy * uy);
    y = per_det * (xx * uy - yx * ux);
  } else if (along_x > 0) {  // all on one line
    x = ux / std::max(xx, least_spread * along_x);
  } else {
    y = uy / std::max(yy, least_spread * along_y);
  }
  at->low = low * x;
  at->high = high * x;
  at->left = left * y;
  at->right = right * y;
}

void add_fluxes(GridState& g, std::size_t n) {
  const std::ptrdiff_t row = g.grid.nx;
  const AveragedCell* at = g.averaged_cell(n);
  const AveragedCell &upper_right = at[0], &upper_left = at[-1], &lower_right = at[-row], &lower_left = at[-row - 1];
  Node& node = g.node[n];
  const double x = (upper_left.low - upper_right.low) + (lower_left.high - lower_right.high);
  const double y = (lower_right.left - upper_right.left) + (lower_left.right - upper_left.right);
  if (node.dy > 0) node.dx += (x + y) / node.dy;
}

}  // namespace

void take_means(GridState& g, SlotRange nodes) {
  const std::ptrdiff_t row = g.grid.nx;
  for (std::size_t a = nodes.begin; a < nodes.end; ++a) {
    const std::size_t n = g.nodes[a];
    Node& node = g.node[n];
    AveragedCell* at = g.averaged_cell(n);
    const double per_volume = node.dy > 0 ? 1 / node.dy : 0;
    node.dx *= per_volume;
    const double right = at[0].low + at[-row].high, up = at[0].left + at[-1].right;
    at->edge_x = right;
    at->edge_y = up;
    at->shift_x = per_volume * ((at[-1].low + at[-row - 1].high) - right);
    at->shift_y = per_volume * ((at[-row].left + at[-row - 1].right) - up);
  }
}

void move_means_to_corners(GridState& g, Averaging which, int threads) {
  for_nodes(g, threads, [&](Node&, std::uint32_t n) { set_flux(g, n, which); });
  for_nodes(g, threads, [&](Node&, std::uint32_t n) { add_fluxes(g, n); });
}

}  // namespace pivnp::mpm
