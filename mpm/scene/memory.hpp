// What a simulation takes of memory, counted from the lists of fields before any of it is allocated.
#pragma once

#include "mpm/scene/scene.hpp"
#include "mpm/state/node_fields.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/state/scheme.hpp"
#include "mpm/transfer/stress_update.hpp"

namespace pivnp::mpm {

/// What of a scene asks for fields that not every scene has.
struct SceneNeeds {
  bool several = false;  // particles of several materials
  bool water = false;
  bool soils = false;    // its mobility is not the same everywhere
  bool collapses = false;  // as water comes
  bool drains = false;     // some pores are drained
  bool tied = false;
  bool loads = false;    // body forces, tractions
  bool heat = false;
  bool bands = false;    // embedded
};

/// Of what a scene's own keys ask for; `soils`, `collapses` and `drains` lie in the pores, which PoreWater fills at the start.
SceneNeeds needs_of(const Scene& scene);

/// The fields that the points and the nodes of such a simulation have.
ParticleNeeds particle_needs(const Scheme& scheme, const Materials& materials, const SceneNeeds& scene);
NodeNeeds node_needs(const Scheme& scheme, const Materials& materials, const SceneNeeds& scene);

/// Bytes that all fields of a point take; `materials`: the largest history of them.
double bytes_a_point(const ParticleNeeds& needs, const Materials& materials);
/// What embedded bands take beside the fields: of every point of a scene that has any, and of a point that has yielded.
struct BandBytes {
  double a_point = 0, a_band = 0;
};
BandBytes band_bytes(const SceneNeeds& scene);
/// Bytes that all fields of a node take, where there is material.
double bytes_a_node(const NodeNeeds& needs);

}  // namespace pivnp::mpm
