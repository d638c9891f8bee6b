// All that changes during a run, in one value: what is saved and restored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mpm/constraint/reaction.hpp"
#include "mpm/heat/heat.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/step/energy.hpp"
#include "mpm/step/momentum.hpp"
#include "mpm/step/sleep.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::mpm {

struct SolverState {
  Particles particles;
  EnergyBalance balance;
  struct Ended {
    double time;
    std::uint32_t particle;  // in the ParticleSet
    EndReason reason;
    std::uint8_t unused[3] = {};  // saved as it lies: nothing is left to chance
  };
  static_assert(sizeof(Ended) == 16 && sizeof(EndReason) == 1);
  std::vector<Ended> ended;
  double time = 0;
  double last_step = 0;   // s: velocities are those of half of it ago (half_step.hpp); 0: those of `time`
  double fastest = 0;     // speed of the fastest point, m/s
  double wave_speed = 0;  // of the fastest compression wave, m/s
  double own_frequency2 = 12;  // the greatest of a point against its nodes' masses (own_frequency.hpp); a lone one's where it is not asked for
  double diffusivity = 0;  // of pore pressure, the greatest, m^2/s
  double peak_kinetic = 0;  // greatest kinetic energy of the nodes so far, J/m
  double calm_since = 0;    // time since which it has been a small share of that
  std::int64_t calm_looks = 0;  // at the balance since then
  struct OfPores {  // PoreWater::Sums
    double excess = 0, excess2 = 0;
  };
  OfPores peak_excess, calm_excess;  // greatest so far, and when it became calm
  bool at_rest = false;     // motion has ended: nothing is stepped any more
  bool far = false;         // MpmOptions::end_displacement_m is reached: likewise
  std::vector<double> pressure_change;  // of every node in the last step, where pressure is projected
  std::vector<TouchedNode> touched;  // by rigid bodies, in the last step
  std::vector<double> water_inertia;    // of every node, where water has inertia: acceleration, and flow along the edges right and up
  std::vector<double> body_motion;   // RigidBodies::motion()
  std::vector<Impulse> impulses;     // on the material, of each wall, traction's boundary and rigid body (Solver::Impl)
  std::int64_t steps = 0;
  double not_stepped = 0;  // time that went on without steps, at rest or far, s
  SleepState sleep;
  HeatState heat;
  std::int64_t since_sort = 0;  // points that changed cells since the storage was last sorted
};

std::vector<std::byte> to_bytes(const SolverState& state);
/// Overwrites `state`, which must be of the same scene. Throws InputError otherwise, `state` untouched.
void from_bytes(const std::vector<std::byte>& bytes, SolverState& state);

}  // namespace pivnp::mpm
