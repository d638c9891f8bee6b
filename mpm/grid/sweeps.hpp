// Loops over cells, nodes and single points.
#pragma once

#include <omp.h>

#include <algorithm>

#include "mpm/grid/grid_state.hpp"
#include "mpm/grid/shape.hpp"
#include "mpm/state/particles.hpp"

namespace pivnp::mpm {

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

/// Calls body(cells, its number) for short runs of the awake cells, for what does not add to nodes.
template <class Body>
void for_pieces(const GridState& g, int threads, Body&& body) {
  for_each(g.active.pieces.size(), threads, [&](std::size_t r) { body(g.active.pieces[r], r); });
}

/// The same with the rim of what sleeps: water flows there.
template <class Body>
void for_flowing(const GridState& g, int threads, Body&& body) {
  for_each(g.active.flowing.size(), threads, [&](std::size_t r) { body(g.active.flowing[r], r); });
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

/// Calls body(cells, run) for the runs of the even bands, then for those of the odd ones: bands of one parity share no
/// node. `run`: its place in Bands::runs.
template <class Body>
void for_bands(const Bands& bands, int threads, Body&& body) {
  for_whole_bands(bands, threads, [&](const Band& band, std::size_t) {
    for (std::size_t r = band.runs.begin; r < band.runs.end; ++r) body(bands.runs[r], r);
  });
}

/// The same, where each band first calls fresh(nodes, band) for the nodes that no other has added to, and at its end
/// finished(nodes, band) for those that no other will add to: what is done at a node before and after the sums is done
/// while the node is in the cache. `nodes`: places in ActiveCells::nodes; `band`: below bands.count().
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
  for_each(g.active.nodes.size(), threads, [&](std::size_t a) { body(g.node[g.active.nodes[a]], g.active.nodes[a]); });
}

/// Calls body(node) for some of them.
template <class Body>
void for_nodes_in(GridState& g, Range nodes, Body&& body) {
  for (std::size_t a = nodes.begin; a < nodes.end; ++a) body(g.node[g.active.nodes[a]]);
}

/// Calls body(part, begin, end) for parts of ActiveCells::nodes that do not depend on `threads`: so sums and lists made part
/// by part do not either.
constexpr std::size_t nodes_in_part = 256;
inline std::size_t node_parts(const GridState& g) { return (g.active.nodes.size() + nodes_in_part - 1) / nodes_in_part; }
template <class Body>
void for_node_parts(const GridState& g, int threads, Body&& body) {
  for_each(node_parts(g), threads, [&](std::size_t part) {
    body(part, part * nodes_in_part, std::min(g.active.nodes.size(), (part + 1) * nodes_in_part));
  });
}

/// Calls each(n) for the nodes n of a part of the list; the second with ahead(n) for one that is wanted soon: a step
/// goes through more arrays than the processor follows by itself.
template <class Each>
void for_nodes_listed(const GridState& g, Range part, Each&& each) {
  for (std::size_t a = part.begin; a < part.end; ++a) each(g.active.nodes[a]);
}
template <class Ahead, class Each>
void for_nodes_ahead(const GridState& g, Range part, Ahead&& ahead, Each&& each) {
  constexpr std::size_t distance = 24;
  for (std::size_t a = part.begin; a < part.end; ++a) {
    if (a + distance < g.active.nodes.size()) ahead(g.active.nodes[a + distance]);
    each(g.active.nodes[a]);
  }
}

/// Averages at the corners of what add(cells, run) adds to CellView::average. Without `volumes` all but the corners' values is as
/// the last averages left it: the points have not moved since, and the same ones stand open.
template <class Add>
void average_at_corners(GridState& g, Averaging which, bool volumes, int threads, Add&& add) {
  g.averaged = true;
  const AverageArrays a = g.averages();
  const auto clear = [&](Range nodes, std::size_t) {
    if (!volumes) return for_nodes_listed(g, nodes, [&](std::uint32_t n) { a.corners[n].value = 0; });
    const auto ahead = [&](std::uint32_t n) {
      __builtin_prefetch(a.corners + n, 1);
      __builtin_prefetch(a.edges + n, 1);
    };
    for_nodes_ahead(g, nodes, ahead, [&](std::uint32_t n) {
      a.corners[n] = {};
      a.edges[n] = {};
    });
  };
  const auto finish = [&](Range nodes, std::size_t) {
    if (volumes) take_edges(a, g.active.nodes.data() + nodes.begin, nodes.end - nodes.begin);
  };
  for_bands(g.active.mapped, threads, clear, add, finish);
  const auto for_all = [&](auto&& take) {
    for_node_parts(g, threads, [&](std::size_t, std::size_t begin, std::size_t end) { take(g.active.nodes.data() + begin, end - begin); });
  };
  if (volumes) for_all([&](const std::uint32_t* nodes, std::size_t size) { take_shares(a, nodes, size); });
  for_all([&](const std::uint32_t* nodes, std::size_t size) {
    take_fluxes(a, which, nodes, size);
    if (threads <= 1) take_means(a, nodes, size);  // while they are in the cache
  });
  if (threads > 1) for_all([&](const std::uint32_t* nodes, std::size_t size) { take_means(a, nodes, size); });
}

/// Calls each(k, nodes, x, y) for those points of some occupied cells of which wanted(k) holds: the indices of their nodes, and
/// their shape functions along both axes (Line).
template <class S, class Wanted, class Each>
void for_points(const Particles& p, const GridState& g, Range cells, Wanted&& wanted, Each&& each) {
  for (std::size_t s = cells.begin; s < cells.end; ++s) {
    std::size_t at[most_stencil_nodes];
    g.stencil_nodes(g.cells.index[s], at);
    const unsigned walls = g.marks[s];
    const MovedNodes* moved = g.moved_in(g.cells.index[s]);
    for (std::uint32_t q = g.cells.begin[s]; q < g.cells.begin[s + 1]; ++q) {
      const std::uint32_t k = g.cells.order[q];
      if (!wanted(k)) continue;
      const Vec2 place = g.natural(p, k);
      const double half = S::needs_size ? p.half[k] : 0;
      each(k, at, line_of<S>(place.x(), half, walls & wall_left, walls & wall_right, moved, 0),
           line_of<S>(place.y(), half, walls & wall_down, walls & wall_up, moved, 1));
    }
  }
}
/// The same for all points.
template <class S, class Each>
void for_points(const Particles& p, const GridState& g, Range cells, Each&& each) {
  for_points<S>(p, g, cells, [](std::uint32_t) { return true; }, each);
}

}  // namespace pivnp::mpm
