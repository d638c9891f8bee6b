// What the loops over a cell's points share.
#pragma once

#include <omp.h>

#include <algorithm>

#include "mpm/grid/grid_state.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/grid/shape.hpp"

namespace pivnp::mpm {

/// The lines of a slot's points; the slot's walls are looked up once.
template <class S>
struct SlotLines {
  static constexpr int W = S::width, N = W * W;
  const GridState& grid;
  bool left, right, down, up;

  SlotLines(const GridState& g, std::size_t slot)
      : grid(g),
        left(g.slot_marks[slot] & fold_left),
        right(g.slot_marks[slot] & fold_right),
        down(g.slot_marks[slot] & fold_down),
        up(g.slot_marks[slot] & fold_up) {}

  static double half(const Particles& p, std::size_t k) {
    if constexpr (S::needs_size) return p.half[k];
    else return 0;
  }
  Line<W> x(const Particles& p, std::size_t k) const { return S::line(grid.natural(p, k).x(), half(p, k), left, right); }
  Line<W> y(const Particles& p, std::size_t k) const { return S::line(grid.natural(p, k).y(), half(p, k), down, up); }
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

/// Calls body(slots, its number) for short runs of the awake slots, for what does not add to nodes.
template <class Body>
void for_pieces(const GridState& g, int threads, Body&& body) {
  for_each(g.pieces.size(), threads, [&](std::size_t r) { body(g.pieces[r], r); });
}

/// Calls body(band, its number) for the even bands, then for the odd ones. A thread always gets the same bands, side by side,
/// with the points and nodes that it has in the sweeps over pieces and nodes too: they stay in its processor's caches.
template <class Body>
void for_whole_bands(const Bands& bands, int threads, Body&& body) {
  const auto own = [&](std::size_t parity, int thread, int of) {
    const std::size_t first = parity == 0 ? 0 : bands.parity[0].size();
    for (std::size_t b = 0; b < bands.parity[parity].size(); ++b)
      if (const Band& band = bands.parity[parity][b]; bands.owner(band, of) == thread) body(band, first + b);
  };
  if (threads <= 1) {
    own(0, 0, 1);
    own(1, 0, 1);
    return;
  }
#pragma omp parallel num_threads(threads)
  {
    own(0, omp_get_thread_num(), omp_get_num_threads());
#pragma omp barrier
    own(1, omp_get_thread_num(), omp_get_num_threads());
  }
}

/// Calls body(slots, run) for the runs of the even bands, then for those of the odd ones: bands of one parity share no
/// node. `run`: its place in Bands::runs.
template <class Body>
void for_bands(const Bands& bands, int threads, Body&& body) {
  for_whole_bands(bands, threads, [&](const Band& band, std::size_t) {
    for (std::size_t r = band.runs.begin; r < band.runs.end; ++r) body(bands.runs[r], r);
  });
}

/// The same, where each band first calls fresh(nodes, band) for the nodes that no other has added to, and at its end
/// finished(nodes, band) for those that no other will add to: what is done at a node before and after the sums is done
/// while the node is in the cache. `nodes`: places in GridState::nodes; `band`: below bands.count().
template <class Fresh, class Body, class Finished>
void for_bands(const Bands& bands, int threads, Fresh&& fresh, Body&& body, Finished&& finished) {
  for_whole_bands(bands, threads, [&](const Band& band, std::size_t b) {
    fresh(band.fresh, b);
    for (std::size_t r = band.runs.begin; r < band.runs.end; ++r) body(bands.runs[r], r);
    finished(band.finished, b);
  });
}

/// Calls body(node, its index) for the active nodes.
template <class Body>
void for_nodes(GridState& g, int threads, Body&& body) {
  for_each(g.nodes.size(), threads, [&](std::size_t a) { body(g.node[g.nodes[a]], g.nodes[a]); });
}

/// Calls body(node) for some of them.
template <class Body>
void for_nodes_in(GridState& g, SlotRange nodes, Body&& body) {
  for (std::size_t a = nodes.begin; a < nodes.end; ++a) body(g.node[g.nodes[a]]);
}

/// Calls body(part, begin, end) for parts of GridState::nodes that do not depend on `threads`: so sums and lists made part
/// by part do not either.
constexpr std::size_t nodes_in_part = 256;
inline std::size_t node_parts(const GridState& g) { return (g.nodes.size() + nodes_in_part - 1) / nodes_in_part; }
template <class Body>
void for_node_parts(const GridState& g, int threads, Body&& body) {
  for_each(node_parts(g), threads, [&](std::size_t part) {
    body(part, part * nodes_in_part, std::min(g.nodes.size(), (part + 1) * nodes_in_part));
  });
}

/// Averages at the corners of what add(slots, run) adds to CellView::average. Without `volumes` all but the corners' values is as
/// the last averages left it: the points have not moved since, and the same ones stand open.
template <class Add>
void average_at_corners(GridState& g, Averaging which, bool volumes, int threads, Add&& add) {
  g.averages.used = true;
  const AverageArrays a = g.averages.arrays();
  const auto clear = [&](SlotRange nodes, std::size_t) {
    for (std::size_t k = nodes.begin; k < nodes.end; ++k) {
      const std::uint32_t n = g.nodes[k];
      if (volumes) {
        a.corners[n] = {};
        a.edges[n] = {};
      } else {
        a.corners[n].value = 0;
      }
    }
  };
  const auto finish = [&](SlotRange nodes, std::size_t) {
    if (volumes) take_edges(a, g.nodes.data() + nodes.begin, nodes.end - nodes.begin);
  };
  for_bands(g.mapped, threads, clear, add, finish);
  const auto for_all = [&](auto&& take) {
    for_node_parts(g, threads, [&](std::size_t, std::size_t begin, std::size_t end) { take(g.nodes.data() + begin, end - begin); });
  };
  if (volumes) for_all([&](const std::uint32_t* nodes, std::size_t size) { take_shares(a, nodes, size); });
  for_all([&](const std::uint32_t* nodes, std::size_t size) {
    take_fluxes(a, which, nodes, size);
    if (threads <= 1) take_means(a, nodes, size);  // while they are in the cache
  });
  if (threads > 1) for_all([&](const std::uint32_t* nodes, std::size_t size) { take_means(a, nodes, size); });
}

}  // namespace pivnp::mpm
