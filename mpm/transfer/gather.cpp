#include <algorithm>
#include <cmath>

#include "mpm/grid/sweeps.hpp"
#include "mpm/transfer/transfer.hpp"

namespace pivnp::mpm {

namespace {

// The momentum mapped again becomes the velocity that strains the material.
void over_mass(GridState& g, Range nodes) {
  for (std::size_t a = nodes.begin; a < nodes.end; ++a) {
    const std::uint32_t n = g.active.nodes[a];
    const double per_mass = g.node[n].mass > 0 ? 1 / g.node[n].mass : 0;
    const GridState::StrainVelocity u = g.strain_velocity(n);
    u.x *= per_mass;
    u.y *= per_mass;
  }
}

}  // namespace

MoveJob move_job(const GridState& g, const Scheme& scheme, double dt) {
  return {dt,
          scheme.pic_per_s > 0 ? 1 - std::exp(-scheme.pic_per_s * dt) : 0,
          std::pow(g.grid.spacing.minCoeff() / dt, 2),
          scheme.transfer == TransferKind::xpic ? &g.arrays.filtered.data()->x : nullptr,
          scheme.transfer,
          scheme.stress == StressUpdate::musl,
          scheme.stress != StressUpdate::usf && !scheme.takes_updated()};
}

GatherSums sum_of(const std::vector<GatherSums>& parts) {
  GatherSums sums;
  for (const GatherSums& part : parts) {
    sums.kinetic_loss += part.kinetic_loss;
    sums.good = sums.good && part.good;
    sums.fastest2 = std::max(sums.fastest2, part.fastest2);
  }
  return sums;
}

GatherSums gather_velocity(Particles& p, GridState& g, const Scheme& scheme, double dt, int threads) {
  const MoveJob job = move_job(g, scheme, dt);
  const PointView points = p.view();
  const CellView cells = g.view();
  std::vector<GatherSums> results(g.active.awake.runs.size());
  const auto nothing = [](Range, std::size_t) {};
  const auto move = [&](Range range, std::size_t run) { results[run] = move_lanes(g.shape, job, points, cells, range); };
  for_bands(g.active.awake, threads, nothing, move, [&](Range nodes, std::size_t) {
    if (job.remap) over_mass(g, nodes);
  });
  return sum_of(results);
}

void filtered_velocity(const Particles& p, GridState& g, int order, int threads) {
  OfGrid<NodeVelocity>& out = g.arrays.filtered;
  std::vector<double> rest(2 * g.grid.node_count(), 0.0), projected(rest.size(), 0.0);
  for (const std::uint32_t n : g.active.nodes) {
    rest[2 * n] = out[n].x = g.node[n].vx;
    rest[2 * n + 1] = out[n].y = g.node[n].vy;
  }
  const PointView points = p.view();
  const CellView cells = g.view();
  for (int l = 1; l < order; ++l) {
    for (const std::uint32_t n : g.active.nodes) projected[2 * n] = projected[2 * n + 1] = 0;
    for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
      project_lanes(g.shape, rest.data(), projected.data(), points, cells, range);
    });
    for_nodes(g, threads, [&](Node& node, std::uint32_t n) {
      const double per_mass = node.mass > 0 ? 1 / node.mass : 0;
      const std::size_t c = 2 * std::size_t(n);
      out[n].x += rest[c] -= per_mass * projected[c];
      out[n].y += rest[c + 1] -= per_mass * projected[c + 1];
    });
  }
}

double hourglass_energy(const Particles& p, const GridState& g) {
  if (g.shape != ShapeKind::bilinear) return 0;
  double sum = 0;
  for (std::size_t s = 0; s < g.cells.size(); ++s) {
    std::size_t at[most_stencil_nodes];
    g.stencil_nodes(g.cells.index[s], at);
    const Node &a = g.node[at[0]], &b = g.node[at[1]], &c = g.node[at[2]], &d = g.node[at[3]];
    const double x = 0.25 * (a.vx - b.vx - c.vx + d.vx), y = 0.25 * (a.vy - b.vy - c.vy + d.vy);
    double mass = 0;
    for (std::uint32_t q = g.cells.begin[s]; q < g.cells.begin[s + 1]; ++q) mass += p.mass_of(g.cells.order[q]);
    sum += 0.5 * mass * (x * x + y * y);
  }
  return sum;
}

}  // namespace pivnp::mpm
