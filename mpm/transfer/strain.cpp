#include <algorithm>
#include <vector>

#include "mpm/grid/sweeps.hpp"
#include "mpm/transfer/transfer.hpp"

namespace pivnp::mpm {

namespace {

// The averages spread strain over the rim of what sleeps, which is not strained: V0 m theta there, J/m.
double work_passed_to_sleepers(const Particles& p, GridState& g) {
  const CornerSums* corners = g.averages().view().corners;
  const double* opening = p.view().opening;
  double work = 0;
  for (const Range& range : g.active.mapped.runs)
    for (std::size_t s = range.begin; s < range.end; ++s) {
      if (!g.blocks.sleeps(g.cells.index[s])) continue;
      std::size_t at[most_stencil_nodes];
      g.stencil_nodes(g.cells.index[s], at);
      for (std::uint32_t q = g.cells.begin[s]; q < g.cells.begin[s + 1]; ++q) {
        const std::uint32_t k = g.cells.order[q];
        if (opening && opening[k] > 0) continue;
        const Vec2 at_point = g.natural(p, k);
        const double hx[2] = {0.5 - at_point.x(), 0.5 + at_point.x()}, hy[2] = {0.5 - at_point.y(), 0.5 + at_point.y()};
        double theta = 0;
        for (int n = 0; n < 4; ++n) theta += hx[n % 2] * hy[n / 2] * corners[at[n / 2 * 3 + n % 2]].value;
        work += p.volume0[k] * (p.tau_xx[k] + p.tau_yy[k] + p.tau_zz[k]) / 3 * theta;
      }
    }
  return work;
}

// Axisymmetric: what the radial velocity strains along the hoop.
void strain_hoops(Particles& p, GridState& g, const Scheme& scheme, Where where, double dt, bool record, int threads) {
  if (!scheme.axisymmetric) return;
  const PointView points = p.view();
  const CellView cells = g.view();
  for_pieces(g, threads, [&](Range range, std::size_t) { hoop_lanes(g.shape, where, dt, record, points, cells, range); });
}

// F-bar of three-node shapes: Averages. Returns the work passed to what sleeps, J/m.
double average_strain(const Particles& p, GridState& g, const Scheme& scheme, Where where, double dt, bool volumes, int threads,
                      GatherSums* moved) {
  if (!averages_at_corners(g, scheme)) return 0;
  const PointView points = p.view();
  const CellView cells = g.view();
  if (moved) {
    const MoveJob job = move_job(g, scheme, dt);
    std::vector<GatherSums> results(g.active.mapped.runs.size());
    average_at_corners(g, Averaging::of_strain, volumes, threads, [&](Range range, std::size_t run) {
      results[run] = move_average_lanes(g.shape, job, points, cells, range);
    });
    *moved = sum_of(results);
  } else {
    average_at_corners(g, Averaging::of_strain, volumes, threads, [&](Range range, std::size_t) {
      average_strain_lanes(g.shape, where, dt, volumes, points, cells, range);
    });
  }
  return g.active.resting.empty() ? 0 : work_passed_to_sleepers(p, g);
}

// Increments of a run of range.
class Scratch {
 public:
  StrainIncrements room(std::size_t n) {
    const std::size_t each = n + 8;  // and a tile more
    if (data_.size() < 5 * each) data_.resize(5 * each);
    double* at = data_.data();
    return {at, at + each, at + 2 * each, at + 3 * each, at + 4 * each};
  }

 private:
  std::vector<double> data_;
};

// Calls part(body, begin, end) for the parts of a run of `order` that belong to one body.
template <class Part>
void for_bodies(const Particles& p, const std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end, Part&& part) {
  if (p.bodies.size() == 1) return part(p.bodies[0], begin, end);
  while (begin < end) {
    std::size_t body = 0, to = begin + 1;
    while (p.bodies[body].end <= order[begin]) ++body;
    const Particles::Body& of = p.bodies[body];
    while (to < end && order[to] >= of.begin && order[to] < of.end) ++to;
    part(of, begin, to);
    begin = to;
  }
}

// Calls strain(range, piece, increments) and then each(begin, end, increments) for runs of range: places in `order`.
template <class Strain, class Each>
void strain_runs(GridState& g, int threads, Strain&& strain, Each&& each) {
  for_pieces(g, threads, [&](Range range, std::size_t piece) {
    static thread_local Scratch scratch;
    const std::size_t begin = g.cells.begin[range.begin], end = g.cells.begin[range.end];
    const StrainIncrements de = scratch.room(end - begin);
    strain(range, piece, de);
    each(begin, end, de);
  });
}

}  // namespace

void strain_points(Particles& p, GridState& g, const Scheme& scheme, double dt, bool record, int threads) {
  if (p.de_xx.size() != p.size()) p.resize_increments(p.size());
  strain_hoops(p, g, scheme, Where::now, dt, record, threads);
  average_strain(p, g, scheme, Where::now, dt, true, threads, nullptr);
  const PointView points = p.view();
  const CellView cells = g.view();
  const auto strain = [&](Range range, std::size_t, const StrainIncrements& de) {
    strain_lanes(g.shape, {scheme.locking, dt, record}, points, cells, range, de, nullptr);
  };
  strain_runs(g, threads, strain, [&](std::size_t begin, std::size_t end, const StrainIncrements& de) {
    for (std::size_t q = begin; q < end; ++q) {
      const std::size_t k = g.cells.order[q], from = q - begin;
      p.de_xx[k] = de.xx[from];
      p.de_yy[k] = de.yy[from];
      p.de_zz[k] = de.zz[from];
      p.de_xy[k] = de.xy[from];
      p.spin[k] = de.spin[from];
    }
  });
}

double strain_and_update(Particles& p, GridState& g, const Scheme& scheme, double dt, bool record,
                         const UpdateRun& update, int threads, GatherSums* moved) {
  // The stress has been averaged before, at the same places, where it was mapped before.
  const Where where = scheme.stress == StressUpdate::usf ? Where::now : scheme.takes_updated() ? Where::before : Where::kept;
  strain_hoops(p, g, scheme, where, dt, record, threads);
  const double passed = average_strain(p, g, scheme, where, dt, scheme.stress == StressUpdate::usf, threads, moved);
  const PointView points = p.view();
  const CellView cells = g.view();
  const StrainJob job{scheme.locking, dt, record, where};
  const MoveJob move = move_job(g, scheme, dt);
  const bool together = moved && scheme.locking == Locking::none;
  std::vector<GatherSums> results(together ? g.active.pieces.size() : 0);
  g.relocation.done = scheme.strains_as_it_moves();
  if (g.relocation.done) {
    g.relocation.suspects.resize(g.cells.order.size());
    g.relocation.found.resize(g.active.pieces.size());
  }
  const auto strain = [&](Range range, std::size_t piece, const StrainIncrements& de) {
    const std::size_t first = g.cells.begin[range.begin];
    std::uint32_t* room = g.relocation.done ? g.relocation.suspects.data() + first : nullptr;
    std::size_t found = 0;
    if (together) {
      results[piece] = move_strain_lanes(g.shape, move, job, points, cells, range, de, room);
      found = results[piece].suspects;
    } else {
      found = strain_lanes(g.shape, job, points, cells, range, de, room);
    }
    if (g.relocation.done) g.relocation.found[piece] = {first, first + found};
  };
  strain_runs(g, threads, strain, [&](std::size_t begin, std::size_t end, const StrainIncrements& de) {
    for_bodies(p, g.cells.order, begin, end, [&](const Particles::Body& body, std::size_t from, std::size_t to) {
      const std::size_t at = from - begin;
      StressBatch batch;
      batch.size = to - from;
      batch.de_xx = de.xx + at;
      batch.de_yy = de.yy + at;
      batch.de_zz = de.zz + at;
      batch.de_xy = de.xy + at;
      batch.spin = de.spin + at;
      update(body, g.cells.order.data() + from, batch);
    });
  });
  if (together) *moved = sum_of(results);
  return passed;
}

bool moves_with_strain(const GridState& g, const Scheme& scheme) {
  return g.centred && scheme.strains_as_it_moves() && !scheme.axisymmetric &&
         (scheme.locking == Locking::none || (scheme.locking == Locking::fbar && g.active.resting.empty()));
}

}  // namespace pivnp::mpm
