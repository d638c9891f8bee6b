#include "mpm/water/pore_borders.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "mpm/grid/sweeps.hpp"
#include "mpm/water/pore_elements.hpp"
#include "mpm/water/pore_water.hpp"

namespace pivnp::mpm {

std::vector<std::uint8_t> kinds_of(const std::vector<PoreSoil>& soils) {
  std::vector<const PoreSoil*> first;
  std::vector<std::uint8_t> kinds;
  for (const PoreSoil& soil : soils) {
    const auto same = [&](const PoreSoil* other) {
      return other->mobility == soil.mobility && other->porosity == soil.porosity && other->kozeny_carman == soil.kozeny_carman &&
             other->constrained_modulus == soil.constrained_modulus;
    };
    const auto found = std::find_if(first.begin(), first.end(), same);
    kinds.push_back(std::uint8_t(std::min<std::ptrdiff_t>(found - first.begin(), several_soils - 2) + 1));
    if (found == first.end()) first.push_back(&soil);
  }
  return kinds;
}

StrainAtBorders::StrainAtBorders(const Particles& p, const GridState& g, const PoreFields& f, std::span<const std::uint8_t> kind_in,
                                 const std::vector<std::uint8_t>& kinds, const std::function<std::uint8_t(std::uint32_t)>& kind,
                                 int threads)
    : row_(std::size_t(f.row)), kinds_(*std::max_element(kinds.begin(), kinds.end())), place_(g.grid.node_count(), 0) {
  for (const std::uint32_t n : g.active.nodes) {
    if (!(f.volume[n] > 0)) continue;
    std::uint8_t found = 0;
    for (const std::size_t beside : {std::size_t(0), std::size_t(1), row_, row_ + 1}) {
      const std::uint8_t in = n >= beside ? kind_in[n - beside] : 0;
      if (in != 0) found = found == 0 || found == in ? in : several_soils;
    }
    if (found != several_soils) continue;
    nodes_.push_back(n);
    place_[n] = std::uint32_t(nodes_.size());
  }
  if (nodes_.empty()) return;
  of_nodes_.resize(nodes_.size() * kinds_);
  element_place_.assign(g.grid.node_count(), 0);
  std::uint32_t elements = 0;
  for (const std::uint32_t n : g.active.nodes)
    if (kind_in[n] != 0 && beside(n)) element_place_[n] = ++elements;
  of_elements_.resize(elements * kinds_);
  for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      const InElement in = element_of(p, g, k);
      const std::uint8_t own = element_place_[in.node] > 0 ? kind(k) : std::uint8_t(0);
      if (own == 0) return;
      const double v = p.volume0[k] * p.J[k], strained = p.volume0[k] * (p.J[k] - p.J_flow[k]);
      Element& e = of_elements_[(element_place_[in.node] - 1) * kinds_ + own - 1u];
      e.along_x += v * in.s * (1 - in.s);
      e.along_y += v * in.t * (1 - in.t);
      for (int c = 0; c < 4; ++c) {
        const std::size_t n = in.node + std::size_t(c % 2) + std::size_t(c / 2) * row_;
        if (!at_border(n)) continue;
        const double w = (c % 2 ? in.s : 1 - in.s) * (c / 2 ? in.t : 1 - in.t);
        Sums& at = sums(n, own);
        at.volume += w * v;
        at.strained += w * strained;
      }
    });
  });
}

void StrainAtBorders::part(const PoreFields& f) const {
  for (const std::uint32_t n : nodes_) f.even[n] = 0;
}

void StrainAtBorders::take(const PoreFields& f) {
  const auto row = std::ptrdiff_t(row_);
  struct Edge {
    std::ptrdiff_t other, first, beside;  // the node at its other end; the elements along it
    bool along_x;
  };
  for (const std::uint32_t n : nodes_) {
    const auto b = std::ptrdiff_t(n);
    const std::array edges = {Edge{b + 1, b, b - row, true}, Edge{b - 1, b - 1, b - 1 - row, true}, Edge{b + row, b, b - 1, false},
                              Edge{b - row, b - row, b - row - 1, false}};
    for (std::size_t kind = 1; kind <= kinds_; ++kind) {
      Sums& here = sums(n, kind);
      if (!(here.volume > 0)) continue;
      const double own = here.strained / here.volume;
      double exchanged = 0;
      for (const Edge& edge : edges) {
        double passes = 0;
        for (const std::ptrdiff_t e : {edge.first, edge.beside})
          if (e >= 0 && element_place_[std::size_t(e)] > 0) {
            const Element& element = of_elements_[(element_place_[std::size_t(e)] - 1) * kinds_ + kind - 1];
            passes += 0.5 * (edge.along_x ? element.along_x : element.along_y);
          }
        if (!(passes > 0)) continue;
        const auto other = std::size_t(edge.other);
        if (at_border(other)) {
          const Sums& there = sums(other, kind);
          if (there.volume > 0) exchanged += passes * (there.strained / there.volume - own);
        } else if (f.volume[other] > 0) {
          exchanged += passes * (f.even[other] - own);
          f.mean[other] -= passes * (own - f.even[n]) / f.volume[other];  // (all points around it are of this kind)
        }
      }
      here.fed = own - exchanged / here.volume;
    }
  }
  for (const std::uint32_t n : nodes_) f.mean[n] = 0;
}

void StrainAtBorders::feed(Particles& p, const GridState& g, const std::function<std::uint8_t(std::uint32_t)>& kind,
                           int threads) const {
  for_flowing(g, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      const InElement in = element_of(p, g, k);
      const std::uint8_t own = element_place_[in.node] > 0 ? kind(k) : std::uint8_t(0);
      if (own == 0) return;
      double fed = 0;
      for (int c = 0; c < 4; ++c) {
        const std::size_t n = in.node + std::size_t(c % 2) + std::size_t(c / 2) * row_;
        if (at_border(n)) fed += (c % 2 ? in.s : 1 - in.s) * (c / 2 ? in.t : 1 - in.t) * sums(n, own).fed;
      }
      p.content[k] -= p.J[k] * fed;
    });
  });
}

// Layers in series conduct by the harmonic mean, beside each other by the arithmetic one. Points of a mixed element have the first,
// and along the border the edge on the pervious side has what lacks to the second.
void PoreWater::mix_at_borders(Particles& p, const GridState& g, int threads) {
  mixed_.clear();
  if (p.mobility.empty() || soils_.size() < 2) return;
  soil_in_.assign(g.grid.node_count(), 0);
  const std::vector<std::uint8_t> kinds = kinds_of(soils_);
  const auto for_water = [&](auto&& each) {
    for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
      for_points_of(g, range, [&](std::uint32_t k) {
        if (flows(p, k)) each(k, element_of(p, g, k));
      });
    });
  };
  for_water([&](std::uint32_t k, const InElement& in) {
    const PoreSoil& soil = soil_of(p, k);
    if (!soil.kozeny_carman && !by_temperature()) p.mobility[k] = soil.mobility;
    std::uint8_t& found = soil_in_[in.node];
    const std::uint8_t own = kinds[std::size_t(set_->label[p.index[k]])];
    found = found == 0 || found == own ? own : several_soils;
  });
  for (const std::uint32_t n : g.active.nodes)
    if (soil_in_[n] == several_soils) mixed_.push_back({n});
  if (mixed_.empty()) return;
  const auto find = [&](std::size_t element) {
    return soil_in_[element] == several_soils
               ? &*std::lower_bound(mixed_.begin(), mixed_.end(), element, [](const Mixed& m, std::size_t at) { return m.element < at; })
               : nullptr;
  };
  for_water([&](std::uint32_t k, const InElement& in) {
    Mixed* m = find(in.node);
    if (!m) return;
    const double v = p.volume0[k] * p.J[k], mobility = std::max(p.mobility[k], 1e-300), log = std::log(mobility);
    m->volume += v;
    m->conducting += v * mobility;
    m->resisting += v / mobility;
    m->s += v * in.s;
    m->t += v * in.t;
    m->log += v * log;
    m->log_s += v * log * in.s;
    m->log_t += v * log * in.t;
  });
  for_water([&](std::uint32_t k, const InElement& in) {
    if (const Mixed* m = find(in.node)) p.mobility[k] = m->volume / m->resisting;
  });
}

void PoreWater::conduct_along_borders(const GridState& g, double dt) {
  for (const Mixed& m : mixed_) {
    if (!(m.volume > 0)) continue;
    const double more = 0.5 * dt * (m.conducting - m.volume * m.volume / m.resisting);
    const double x = m.log_s - m.log * m.s / m.volume, y = m.log_t - m.log * m.t / m.volume, square = x * x + y * y;
    const double across_x = square > 0 ? x * x / square : 0.5;  // of the border's normal
    const auto add = [&](std::ptrdiff_t first, std::ptrdiff_t other, double by, float* flow, double* inert) {
      if (!(field_.volume[first] > 0) || !(field_.volume[other] > 0)) return;
      flow[first] += float(by);
      if (inert) inert[first] += by;
    };
    const std::ptrdiff_t e = m.element, row = field_.row;
    const double along_x = 2 * more * (1 - across_x) * g.per_hx * g.per_hx, along_y = 2 * more * across_x * g.per_hy * g.per_hy;
    const std::ptrdiff_t low = y > 0 ? e + row : e, left = x > 0 ? e + 1 : e;
    add(low, low + 1, along_x, field_.flow_x, field_.inert_x);
    add(left, left + row, along_y, field_.flow_y, field_.inert_y);
  }
}

void PoreWater::take_pores(const Particles& p, const GridState& g, int threads) {
  if (!alike_.own) return;
  pores_.resize(g.grid.node_count());
  for (const std::uint32_t n : g.active.nodes) pores_[n] = 0;
  for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      if (!flows(p, k)) return;
      const InElement in = element_of(p, g, k);
      const double pores = p.volume0[k] * pores_of(p, k, soil_of(p, k));
      for (int c = 0; c < 4; ++c)
        pores_[in.node + std::size_t(c % 2) + std::size_t(c / 2) * std::size_t(field_.row)] +=
            (c % 2 ? in.s : 1 - in.s) * (c / 2 ? in.t : 1 - in.t) * pores;
    });
  });
}

}  // namespace pivnp::mpm
