#include "mpm/heat/heat_boundaries.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

std::optional<HeatCondition> heat_condition_of(const std::string& key, const BoundaryOptions& o) {
  for (const auto& [name, value] : {std::pair{".temperature_c", o.temperature_c}, {".heat_flux_w_m2", o.heat_flux_w_m2}, {".heat_transfer_w_m2_k", o.heat_transfer_w_m2_k}})
    if (value && !std::isfinite(*value)) throw InputError(key + name + ": expected a finite number");
  if (o.temperature_c && o.heat_flux_w_m2) throw InputError(key + ": found both temperature_c and heat_flux_w_m2, expected one");
  if (o.heat_transfer_w_m2_k && !o.temperature_c) throw InputError(key + ".heat_transfer_w_m2_k: given without temperature_c, expected both or neither");
  if (o.heat_transfer_w_m2_k) return HeatCondition{HeatCondition::convective, *o.temperature_c, *o.heat_transfer_w_m2_k};
  if (o.temperature_c) return HeatCondition{HeatCondition::temperature, *o.temperature_c};
  if (o.heat_flux_w_m2) return HeatCondition{HeatCondition::flux, *o.heat_flux_w_m2};
  return std::nullopt;
}

}  // namespace

HeatBoundaries::HeatBoundaries(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const std::vector<Wall>& walls) {
  for (const auto& [name, options] : boundaries) {
    const std::string key = "boundary." + name;
    const std::optional<HeatCondition> condition = heat_condition_of(key, options);
    if (!condition) continue;
    const char* given = options.temperature_c ? ".temperature_c" : ".heat_flux_w_m2";
    if (options.type == BoundaryType::traction || options.type == BoundaryType::tied)
      throw InputError(key + given + ": given with type \"" + std::string(name_of(options.type)) + "\", expected a wall");
    for (const Wall& wall : walls) {
      if (wall.key != key) continue;
      if (wall.side == wall_none && condition->kind != HeatCondition::temperature)
        throw InputError(key + given + ": expected a line along the grid, on a line of nodes");
      for (std::size_t k = 0; k < wall.nodes.size(); ++k) nodes_.push_back({wall.nodes[k], *condition, wall.side, wall.release[k]});
    }
  }
  std::stable_sort(nodes_.begin(), nodes_.end(), [](const AtNode& a, const AtNode& b) {
    if (a.node != b.node) return a.node < b.node;
    return a.condition.kind < b.condition.kind;
  });
}

void refuse_heat_keys(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries) {
  for (const auto& [name, b] : boundaries) {
    const char* given = b.temperature_c ? ".temperature_c" : b.heat_flux_w_m2 ? ".heat_flux_w_m2" : b.heat_transfer_w_m2_k ? ".heat_transfer_w_m2_k" : nullptr;
    if (given) throw InputError("boundary." + name + given + ": given without [heat], expected both or neither");
  }
}

}  // namespace pivnp::mpm
