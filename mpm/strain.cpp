#include <algorithm>
#include <vector>

#include "mpm/kernel.hpp"
#include "mpm/transfer.hpp"

namespace pivnp::mpm {

namespace {

constexpr std::size_t run = 32;  // slots: what a run touches stays in the first cache

// F-bar of three-node shapes: Node::dx.
void average_strain(const Particles& p, GridState& g, const Scheme& scheme, double dt, int threads) {
  if (g.width == 2 || scheme.locking != Locking::fbar) return;
  const PointView points = p.view();
  const CellView cells = g.view();
  for_nodes(g, threads, [&](Node& node, std::uint32_t) { node.dx = node.dy = 0; });
  for_bands(g, threads,
            [&](SlotRange slots, std::size_t) { average_strain_lanes(g.shape, dt, points, cells, slots); });
  for_nodes(g, threads, [&](Node& node, std::uint32_t) { node.dx = node.dy > 0 ? node.dx / node.dy : 0; });
}

// Increments of a run of slots.
class Scratch {
 public:
  Increments room(std::size_t n) {
    const std::size_t each = n + 4;
    if (data_.size() < 5 * each) data_.resize(5 * each);
    double* at = data_.data();
    return {at, at + each, at + 2 * each, at + 3 * each, at + 4 * each};
  }

 private:
  std::vector<double> data_;
};

// Calls part(body, begin, end) for the parts of a run of `order` that lie together in storage, in one body.
template <class Part>
void for_parts(const Particles& p, const std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end,
               Part&& part) {
  while (begin < end) {
    const std::uint32_t k = order[begin];
    std::size_t body = 0;
    while (p.bodies[body].end <= k) ++body;
    const std::size_t last = std::min(end, begin + (p.bodies[body].end - k));
    std::size_t to = begin + 1;
    while (to < last && order[to] == k + (to - begin)) ++to;
    part(p.bodies[body], begin, to);
    begin = to;
  }
}

// Calls each(begin, end, increments) for runs of slots: places in `order`.
template <class Each>
void strain_runs(const Particles& p, GridState& g, const StrainJob& job, int threads, Each&& each) {
  const PointView points = p.view();
  const CellView cells = g.view();
  for_runs(g, run, threads, [&](SlotRange slots) {
    static thread_local Scratch scratch;
    const std::size_t begin = g.slot_begin[slots.begin], end = g.slot_begin[slots.end];
    const Increments de = scratch.room(end - begin);
    strain_lanes(g.shape, job, points, cells, slots, de);
    each(begin, end, de);
  });
}

}  // namespace

void strain_points(Particles& p, GridState& g, const Scheme& scheme, double dt, bool record, int threads) {
  if (p.de_xx.size() != p.size()) p.resize_increments(p.size());
  average_strain(p, g, scheme, dt, threads);
  strain_runs(p, g, {scheme.locking, dt, record}, threads, [&](std::size_t begin, std::size_t end, const Increments& de) {
    for (std::size_t q = begin; q < end; ++q) {
      const std::size_t k = g.order[q], from = q - begin;
      p.de_xx[k] = de.xx[from];
      p.de_yy[k] = de.yy[from];
      p.de_zz[k] = de.zz[from];
      p.de_xy[k] = de.xy[from];
      p.spin[k] = de.spin[from];
    }
  });
}

void strain_and_update(Particles& p, GridState& g, const Scheme& scheme, double dt, bool record,
                       const UpdateRun& update, int threads) {
  average_strain(p, g, scheme, dt, threads);
  strain_runs(p, g, {scheme.locking, dt, record}, threads, [&](std::size_t begin, std::size_t end, const Increments& de) {
    for_parts(p, g.order, begin, end, [&](const Particles::Body& body, std::size_t from, std::size_t to) {
      const std::size_t at = from - begin;
      StressBatch batch;
      batch.size = to - from;
      batch.de_xx = de.xx + at;
      batch.de_yy = de.yy + at;
      batch.de_zz = de.zz + at;
      batch.de_xy = de.xy + at;
      batch.spin = de.spin + at;
      update(body, g.order[from], batch);
    });
  });
}

}  // namespace pivnp::mpm
