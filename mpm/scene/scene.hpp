// What a simulation starts from.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mpm/constraint/options.hpp"
#include "mpm/heat/options.hpp"
#include "mpm/material/options.hpp"
#include "mpm/scene/centrifuge.hpp"
#include "mpm/water/options.hpp"
#include "pivnp/core/grid/grid.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::mpm {

/// Everything a simulation starts from. SI units, except that lengths may be in the case's own unit throughout.
struct Scene {
  Grid grid;                // cells of the simulation (padding and refinement done)
  ParticleSet particles;    // seeded; label k is made of materials[k]
  std::vector<MaterialOptions> materials;
  std::vector<std::pair<std::string, BoundaryOptions>> boundaries;
  std::vector<std::pair<std::string, RigidOptions>> bodies;
  std::vector<std::pair<std::string, ContactOptions>> contacts;  // between labels, by ParticleSet::label_names
  std::optional<WaterOptions> water;           // in the pores of materials that have a porosity
  std::optional<HeatOptions> heat;             // temperature
  std::optional<CentrifugeOptions> centrifuge;  // acceleration from place to place
  std::vector<Vec2> v0;                        // velocity at time 0, one a particle; empty: at rest
  // Its gradient, xx xy yx yy (xy: of v_x along y), 1/s, one a particle; empty: zero. Of transfers that carry an affine velocity:
  // without it their first step loses the motion within the cells (10 % of the spin of a block of five cells).
  std::vector<std::array<double, 4>> grad_v0;
  // Cauchy stress at time 0 (effective, with water), xx yy zz xy; empty: none; NaN: none of this particle. Where the initial
  // equilibrium is sought, the first guess.
  std::vector<std::array<double, 4>> stress0;
  // Pressure of the water in its pores at time 0, Pa, one a particle; empty: that of WaterOptions::start; NaN: likewise
  // of this one.
  std::vector<double> pressure0;
  std::vector<double> temperature0;            // at time 0, one a particle; empty: HeatOptions::initial_c
  /// Acceleration of a particle (index in `particles`) at a time, beside gravity; empty: none. For manufactured
  /// solutions; not part of a checkpoint.
  std::function<Vec2(std::size_t particle, double time)> body_force;
};

}  // namespace pivnp::mpm
