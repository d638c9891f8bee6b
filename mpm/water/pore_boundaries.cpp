#include "mpm/water/pore_boundaries.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

PoreCondition condition_of(const std::string& key, const BoundaryOptions& o) {
  const int given = int(o.pressure_pa.has_value()) + int(o.drained) + int(o.flux_m_s.has_value()) + int(o.water_level_m.has_value());
  if (given > 1) throw InputError(key + ": found more than one of pressure_pa, water_level_m, drained and flux_m_s, expected one");
  if (o.pressure_pa && !std::isfinite(*o.pressure_pa)) throw InputError(key + ".pressure_pa: expected a finite pressure");
  if (o.flux_m_s && !std::isfinite(*o.flux_m_s)) throw InputError(key + ".flux_m_s: expected a finite flow");
  if (o.pressure_pa) return {PoreCondition::pressure, *o.pressure_pa};
  if (o.water_level_m && !std::isfinite(*o.water_level_m)) throw InputError(key + ".water_level_m: expected a finite height");
  if (o.water_level_m) return {PoreCondition::level, *o.water_level_m};
  if (o.drained) return {PoreCondition::drained};
  if (o.flux_m_s) return {PoreCondition::flux, *o.flux_m_s};
  return {};
}

}  // namespace

PoreBoundaries::PoreBoundaries(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries,
                               const std::vector<Wall>& walls, const GridGeometry& g)
    : first_(g.field_nodes(), -1) {
  for (std::size_t b = 0; b < boundaries.size(); ++b) {
    const std::string key = "boundary." + boundaries[b].first;
    keys_.push_back(key);
    conditions_.push_back(condition_of(key, boundaries[b].second));
    level_ = level_ || conditions_[b].kind == PoreCondition::level;
    if (boundaries[b].second.type == BoundaryType::traction && conditions_[b].kind == PoreCondition::flux) flux_on_tractions_ = true;
    if (conditions_[b].kind == PoreCondition::flux && conditions_[b].value != 0) flux_ = true;
  }
  for (const Wall& wall : walls) {
    const auto b = std::size_t(std::find(keys_.begin(), keys_.end(), wall.key) - keys_.begin());
    const PoreCondition& condition = conditions_[b];
    if (condition.kind == PoreCondition::flux && wall.side == wall_none)
      throw InputError(wall.key + ".flux_m_s: expected a line along the grid, on a line of nodes");
    if (condition.kind == PoreCondition::impervious && wall.side != wall_none) continue;
    for (std::size_t k = 0; k < wall.nodes.size(); ++k)
      nodes_.push_back({wall.nodes[k], std::uint16_t(b), wall.side, wall.release[k]});
  }
  std::stable_sort(nodes_.begin(), nodes_.end(), [&](const AtNode& a, const AtNode& b) {
    if (a.node != b.node) return a.node < b.node;
    return (conditions_[a.boundary].kind != PoreCondition::impervious) > (conditions_[b.boundary].kind != PoreCondition::impervious);
  });
  for (std::size_t k = nodes_.size(); k-- > 0;) first_[nodes_[k].node] = std::int32_t(k);
  for (const AtNode& at : nodes_)
    if (conditions_[at.boundary].kind != PoreCondition::impervious) let_through_.push_back(at.node);
}

const PoreBoundaries::AtNode* PoreBoundaries::standing(std::size_t node, double time) const {
  node %= first_.size();
  if (first_[node] < 0) return nullptr;
  for (auto k = std::size_t(first_[node]); k < nodes_.size() && nodes_[k].node == node; ++k)
    if (time < nodes_[k].until) return &nodes_[k];
  return nullptr;
}

const PoreCondition* PoreBoundaries::at(std::size_t node, double time) const {
  const AtNode* at = standing(node, time);
  return at ? &conditions_[at->boundary] : nullptr;
}

std::uint8_t PoreBoundaries::side(std::size_t node, double time) const {
  const AtNode* at = standing(node, time);
  return at ? at->side : std::uint8_t(wall_none);
}

void PoreBoundaries::refuse_inside(std::size_t boundary) const {
  const char* names[] = {"", ".drained", ".pressure_pa", ".flux_m_s", ".water_level_m"};
  throw InputError(keys_[boundary] + names[conditions_[boundary].kind] +
                   ": the boundary lies inside the material, expected it along an edge");
}

}  // namespace pivnp::mpm
