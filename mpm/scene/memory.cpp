#include "mpm/scene/memory.hpp"

#include <algorithm>
#include <type_traits>

#include "mpm/heat/heat.hpp"
#include "mpm/state/particle_fields.hpp"
#include "mpm/state/scheme_rows.hpp"

namespace pivnp::mpm {

namespace {

bool any_averages(const Materials& materials) {
  return std::any_of(materials.begin(), materials.end(), [](const auto& m) { return m->nonlocal_length() > 0; });
}

}  // namespace

SceneNeeds needs_of(const Scene& scene) {
  const auto& label = scene.particles.label;
  const auto any = [&](BoundaryType type) {
    return std::any_of(scene.boundaries.begin(), scene.boundaries.end(), [&](const auto& b) { return b.second.type == type; });
  };
  return {.several = std::any_of(label.begin(), label.end(), [&](auto l) { return l != label.front(); }),
          .water = scene.water.has_value(),
          .tied = any(BoundaryType::tied),
          .loads = scene.body_force || scene.centrifuge || any(BoundaryType::traction),
          .heat = scene.heat.has_value(),
          .bands = scene.heat && std::any_of(scene.materials.begin(), scene.materials.end(), [](const auto& m) { return m.band_thickness_m.has_value(); })};
}

ParticleNeeds particle_needs(const Scheme& scheme, const Materials& materials, const SceneNeeds& scene) {
  return {.own_mass = scene.several || scene.water,
          .affine = row_of(scheme.transfer).affine,
          .sized = row_of(scheme.shape).sized,
          .tied = scene.tied,
          .kept = scheme.stress != StressUpdate::usf && !scheme.takes_updated(),
          .averaged = any_averages(materials),
          .wet = scene.water,
          .soils = scene.water && (scene.several || scene.soils),
          .collapses = scene.collapses,
          .drains = scene.drains,
          .heated = scene.heat,
          .swells = scene.heat && scene.water,
          .banded = scene.bands,
          .axisymmetric = scheme.axisymmetric};
}

NodeNeeds node_needs(const Scheme& scheme, const Materials& materials, const SceneNeeds& scene) {
  return {.own_strain_velocity = true,  // at nodes of small mass by every scheme
          .averages = scheme.locking == Locking::fbar && row_of(scheme.shape).centred(),
          .filtered = scheme.transfer == TransferKind::xpic,
          .loads = scene.loads,
          .wet = scene.water,
          .wet_rings = scene.water && scheme.axisymmetric,
          .wet_soils = scene.water && (scene.several || scene.soils),
          .heated = scene.heat,
          .averaged = any_averages(materials)};
}

double bytes_a_point(const ParticleNeeds& needs, const Materials& materials) {
  std::size_t bytes = 0, history = 0;
  for_each_particle_field([&](const ParticleField& field, const auto&... column) {
    const auto add = [&]<class Values>(const Column<Values>&) { bytes += sizeof(typename Values::value_type); };
    if (!field.need || needs.*field.need) (add(column), ...);
  });
  for (const auto& material : materials) history = std::max(history, material->history().size() * sizeof(double));
  return double(bytes + history);
}

BandBytes band_bytes(const SceneNeeds& scene) {
  if (!scene.bands) return {};
  return {.a_point = sizeof(std::int32_t) + sizeof(Turning) + 2 * sizeof(double),  // HeatState; work and sense of the last look
          .a_band = sizeof(ShearBand)};
}

double bytes_a_node(const NodeNeeds& needs) {
  std::size_t bytes = sizeof(Node);
  for_each_node_field([&](const NodeField& field, const auto&... member) {
    const auto add = [&]<class Values, class Owner>(Values Owner::*) {
      if constexpr (std::is_same_v<Owner, NodeArrays>)
        if (needs.*field.need) bytes += sizeof(typename Values::value_type);
    };
    (add(member), ...);
  });
  return double(bytes);
}

}  // namespace pivnp::mpm
