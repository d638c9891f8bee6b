#include "mpm/kernel.hpp"
#include "mpm/transfer.hpp"

namespace pivnp::mpm {

void strain_points(Particles& p, GridState& g, const Scheme& scheme, double dt, bool record, int threads) {
  const PointView points = p.view();
  const CellView cells = g.view();
  if (g.width == 3 && scheme.locking == Locking::fbar) {
    for_nodes(g, threads, [&](Node& node, std::uint32_t) { node.dx = node.dy = 0; });
    for_bands(g, threads,
              [&](SlotRange slots, std::size_t) { average_strain_lanes(g.shape, dt, points, cells, slots); });
    for_nodes(g, threads, [&](Node& node, std::uint32_t) { node.dx = node.dy > 0 ? node.dx / node.dy : 0; });
  }
  const StrainJob job{scheme.locking, dt, record};
  for_runs(g, threads, [&](SlotRange slots) { strain_lanes(g.shape, job, points, cells, slots); });
}

}  // namespace pivnp::mpm
