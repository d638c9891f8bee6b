// The quasi-static start: stresses that carry the weight, before time 0.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "mpm/constraint/contact.hpp"
#include "mpm/constraint/restraints.hpp"
#include "mpm/constraint/rigid_body.hpp"
#include "mpm/state/scheme.hpp"
#include "mpm/transfer/stress_update.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "mpm/water/pore_water.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::mpm {

struct EquilibriumOptions {
  Vec2 gravity;      // where it varies, that at the particles' centroid
  double damping;    // Cundall's, of the pseudo-time
  double tolerance;  // sum |unbalanced| / sum |weight|, and kinetic over elastic energy
  double wanted;     // at most the tolerance: sought on to, in a bounded number of iterations more
  int threads;
  std::optional<double> k0 = {};  // horizontal over vertical stress of the first guess; nu/(1 - nu) without
  std::span<const std::array<double, 4>> given = {};  // Scene::stress0: the first guess where it is a number
  std::function<Vec2(const Vec2&)> variation = {};  // of gravity from place to place; empty: none
  bool goes_on = false;  // from the stresses that there are
  bool leads_on = false;        // another search goes on from what is found: it may move still under balanced forces
};

/// What is brought to rest; its parts change.
struct StaticSystem {
  const Scheme& scheme;
  const Materials& materials;
  const std::vector<double>& density;  // of each material now, kg/m^3
  Restraints& restraints;
  Contacts& contacts;
  RigidBodies& bodies;
  Particles& particles;
  GridState& grid;
  const ParticleSet& set;  // where the particles come from
  const PoreWater* water = nullptr;
};

/// Adaptive dynamic relaxation (Underwood 1983; Cundall's local damping) in the reference configuration: the points do
/// not move, so their shape functions, the nodal masses and the equilibrium found are those of x0. Nodal masses are
/// fictitious, from Gershgorin's bound of the stiffness, so that the pseudo-step 1 is stable in every cell. The force
/// and strain transfers and the laws are those of the run, with the strength of the start (nothing softens with plastic strain
/// on the way): nothing is out of balance when the run starts, but for the
/// tolerance. Starts from the stresses given, elsewhere from K0
/// stresses (stress_from_columns()) where gravity is vertical. Returns the number of
/// iterations; throws InputError at once where material may move along gravity because nothing holds it
/// (require_held()). Minus that number where forces have long been balanced but points move on, which `leads_on` bears.
/// From where the tolerance is met on, it goes on to `wanted` for up to four times as many iterations (or 4,000), and
/// keeps the state that met the tolerance if what follows does not. RunError if `tolerance` is not met in a bounded
/// number, or a pseudo-step strains a point by more than half.
int relax_to_equilibrium(const EquilibriumOptions& options, const StaticSystem& system, Progress& progress);

/// Throws InputError, with the lowest place, for material that hangs together through its nodes and that no wall or
/// body keeps from moving along gravity. `gripped`: nodes that rigid bodies hold; `set`: where the particles come from.
void require_held(const Particles& particles, const GridState& grid, const Restraints& restraints,
                  const std::vector<std::uint32_t>& gripped, const Vec2& gravity, const ParticleSet& set);

/// Vertical stress from the mass above each point in its column of cells, the horizontal ones `k0` (nu/(1 - nu) without)
/// times it. For vertical gravity. With water: effective stress, and the mass less that of the water displaced.
void stress_from_columns(Particles& particles, const Materials& materials, const GridState& grid, double gravity_y,
                         std::optional<double> k0, const PoreWater* water = nullptr);

}  // namespace pivnp::mpm
