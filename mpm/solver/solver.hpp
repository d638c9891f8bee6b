// The material point method, explicit, plane strain: appendix A of the thesis, with the departures that docs/theory/mpm.md lists.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "mpm/scene/options.hpp"
#include "mpm/scene/scene.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/core/record/energy.hpp"
#include "pivnp/core/record/reactions.hpp"

namespace pivnp::mpm {

/// Plane strain, unit thickness; explicit; schemes in transfer.hpp, laws in material/. The bits of a run do not
/// depend on `threads`, the most that are used (thread_choice.hpp: on a busy machine, fewer). A particle that leaves
/// the grid is ended (EndReason::left_grid) with the values of its last good time; it is never fatal. So is one whose F
/// is singular or stretched beyond a thousandfold (EndReason::bad_state). Nodes on the grid's edge are free unless
/// restrained.
class Solver {
 public:
  /// Throws InputError naming the key: missing stiffness or density, polygon and line both given or neither, no node
  /// restrained, a particle inside a rigid body (cut the region there), a particle outside the grid.
  Solver(const MpmOptions& options, Scene scene, int threads);
  ~Solver();

  /// The damped quasi-static start (initial_equilibrium.hpp); call it before the first step, if MpmOptions::initial_equilibrium says so. The
  /// particles stay where they are: equilibrium is sought in the reference configuration, so that x0 is the place of
  /// the loaded material. Afterwards velocities, displacements, F, plastic strain and the accumulated energies are
  /// zero and the stresses stay. Restraints with until_s > 0 count as in place. Throws RunError, naming the ratio
  /// reached, if none is found.
  void find_initial_equilibrium(Progress& progress);
  /// Throws InputError for material that nothing holds against gravity, as find_initial_equilibrium() does (which sees
  /// what rigid bodies hold too: beside them nothing is said here).
  void require_held() const;

  /// Steps to `time` exactly (the last steps are trimmed). Throws RunError, with time and cause, on NaN or blow-up (a
  /// point that moves a cell in a step, or an energy residual beyond MpmOptions::energy_limit of the energy supplied);
  /// time(), steps() and energy() are then of the last state whose balance was sound, at most 100 steps old; frame() and
  /// what goes on from the state throw RunError: the frames given out before are the caller's. Once motion has ended (at_rest) and
  /// MpmOptions::end_at_rest is set, only the time goes on.
  void advance_to(double time, Progress& progress);
  /// Motion has ended: for a tenth of the run the nodes' kinetic energy has been below 1e-3 of its peak, the fastest node
  /// would not cover a hundredth of a cell in the time run so far, and no restraint or body changes any more. (Kinetic
  /// energy of the points will not do: FLIP keeps noise there that moves nothing.)
  bool at_rest() const;

  double time() const;
  std::int64_t steps() const;
  double stable_step() const;  // the step in use, s
  MotionFrame frame() const;   // u, F, status, v, stress, plastic_dev
  const ParticleSet& particles() const;
  /// Elastic energy is that stored now; all else counts from the start of the run. `damping` holds what local damping
  /// and the transfer between points and nodes took; what the stress update and the step's finite length lose or gain
  /// is the residual.
  EnergyRow energy() const;
  /// Impulse on the material by a body since time 0, N s/m; index in Scene::bodies.
  Vec2 body_impulse(std::size_t body) const;
  /// What boundaries (but tied ones), bodies and contacts have done, and the names of those, "boundary.NAME", "body.NAME" and
  /// "contact.NAME". Tractions count as given; walls as they act on what is awake; contacts on the regions that they list.
  std::vector<std::string> reaction_names() const;
  ReactionRow reactions() const;
  /// Of a body's centre since time 0, m; its mass now, kg/m (0: its motion is prescribed).
  Vec2 body_displacement(std::size_t body) const;
  double body_mass(std::size_t body) const;
  /// What sleeping left out so far (mpm/step/sleep.hpp).
  struct Slept {
    double share = 0;           // of the points' steps, not made
    double displacement_m = 0;  // no particle's displacement is off by more
    double energy = 0;          // kinetic energy taken, J/m; part of `damping`
  };
  Slept slept() const;
  /// Why pore pressure is explicit or projected, where the options leave it open and there is water; else empty.
  const std::string& pressure_choice() const;
  /// Particles that have left the grid.
  std::size_t ended() const;
  Vec2 momentum() const;       // of the particles still simulated, kg m/s per metre of thickness

  /// Called after every step with the step's length and a function that gives the grid's velocity at a point (by the shape
  /// functions, of the step just made and the cells at its start; beyond material that of the nearest, two cells away at most, else
  /// zero): what carries synthetic texture. Not called for the initial equilibrium.
  using VelocityAt = std::function<Vec2(const Vec2&)>;
  void on_step(std::function<void(double dt, const VelocityAt&)> observer);

  /// The whole state, to go on with identical bits in a Solver made from the same options and scene. load() throws
  /// InputError if the bytes are of another scene or damaged.
  std::vector<std::byte> save() const;
  void load(const std::vector<std::byte>& checkpoint);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pivnp::mpm
