// What the loops over a cell's points share.
#pragma once

#include "mpm/grid_state.hpp"
#include "mpm/particles.hpp"
#include "mpm/shape.hpp"

namespace pivnp::mpm {

/// The lines of a slot's points; the slot's walls are looked up once.
template <class S>
struct SlotLines {
  static constexpr int W = S::width, N = W * W;
  bool left, right, down, up;

  SlotLines(const GridState& g, std::size_t slot)
      : left(g.slot_fold[slot] & fold_left),
        right(g.slot_fold[slot] & fold_right),
        down(g.slot_fold[slot] & fold_down),
        up(g.slot_fold[slot] & fold_up) {}

  static double half(const Particles& p, std::size_t k) {
    if constexpr (S::needs_size) return p.half[k];
    else return 0;
  }
  Line<W> x(const Particles& p, std::size_t k) const { return S::line(p.xi[k], half(p, k), left, right); }
  Line<W> y(const Particles& p, std::size_t k) const { return S::line(p.eta[k], half(p, k), down, up); }
  /// Are the functions linear along the axis here (so that the affine field is their gradient)?
  bool linear_x() const { return S::linear || left || right; }
  bool linear_y() const { return S::linear || down || up; }
};

/// Distances of a line's nodes from the point, in cells, and the second moment of the weights.
template <class S>
struct Arms {
  double d[S::width];
  double moment = 0;
  Arms(double xi, const Line<S::width>& line) {
    for (int a = 0; a < S::width; ++a) {
      d[a] = a + S::first - xi;
      moment += line.w[a] * d[a] * d[a];
    }
  }
};

/// Kinetic energy per mass of a point's affine field, 1/2 C D C^T with the spline's second moment D = h^2/4 I for every
/// shape: one number for the books whatever the point's place in its cell.
inline double affine_energy(const Particles& p, const Vec2& h, std::size_t k) {
  if (p.C_xx.empty()) return 0;
  return 0.125 * ((p.C_xx[k] * p.C_xx[k] + p.C_yx[k] * p.C_yx[k]) * h.x() * h.x() +
                  (p.C_xy[k] * p.C_xy[k] + p.C_yy[k] * p.C_yy[k]) * h.y() * h.y());
}

/// Calls body(k) for k < n, on `threads` threads; `threads` does not change any bit. (One thread opens no parallel
/// region: in small scenes that would cost more than the loop.)
template <class Body>
void for_each(std::size_t size, int threads, Body&& body) {
  const auto n = std::ptrdiff_t(size);
  if (threads <= 1) {
    for (std::ptrdiff_t k = 0; k < n; ++k) body(std::size_t(k));
    return;
  }
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::ptrdiff_t k = 0; k < n; ++k) body(std::size_t(k));
}

template <class Body>
void for_slots(const GridState& g, int threads, Body&& body) {
  for_each(g.slots(), threads, body);
}

/// Adds the slots' quantities first ... first + Q - 1 at every active node, in a fixed order; put(node, sums).
template <int Q, class Put>
void for_nodes(GridState& g, int first, int threads, Put&& put) {
  const int N = g.stencil;
  for_each(g.nodes.size(), threads, [&](std::size_t a) {
    double sum[Q] = {};
    const std::uint32_t* slots = g.node_slots.data() + a * std::size_t(N);
    for (int c = 0; c < N; ++c) {
      const double* from = g.slot_sums(slots[c]) + first * N + c;
      for (int q = 0; q < Q; ++q) sum[q] += from[q * N];
    }
    put(g.nodes[a], sum);
  });
}

}  // namespace pivnp::mpm
