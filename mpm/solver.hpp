// The material point method, explicit, plane strain: appendix A of the thesis, as corrected by our errata.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mpm/options.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/core/record/energy.hpp"

namespace pivnp::mpm {

/// Everything a simulation starts from. SI units, except that lengths may be in the case's own unit throughout.
struct Scene {
  Grid grid;                // cells of the simulation (padding and refinement done)
  ParticleSet particles;    // seeded; label k is made of materials[k]
  std::vector<MaterialOptions> materials;
  std::vector<std::pair<std::string, BoundaryOptions>> boundaries;
  std::vector<std::pair<std::string, RigidOptions>> bodies;
};

/// Throws InputError naming the key: missing stiffness or density, polygon and line both given, no node restrained.
class Solver {
 public:
  Solver(const MpmOptions& options, Scene scene, int threads);
  ~Solver();

  /// The damped quasi-static start (MpmOptions::settle). Afterwards velocities, displacements, F and energies are
  /// zeroed, stresses kept. Throws RunError if it does not settle.
  void settle(Progress& progress);

  /// Steps to `time` exactly (the last step is trimmed). Throws RunError, with time and cause, on NaN or blow-up; the
  /// last good state stays readable.
  void advance_to(double time, Progress& progress);

  double time() const;
  std::int64_t steps() const;
  double stable_step() const;  // the step in use, s
  MotionFrame frame() const;   // u, F, status, v, stress, plastic_dev
  const ParticleSet& particles() const;
  EnergyRow energy() const;

  /// Called after every step with the step's length and a function that gives the grid's velocity at a point (bilinear,
  /// zero outside material): what carries synthetic texture. Not called while settling.
  using VelocityAt = std::function<Vec2(const Vec2&)>;
  void on_step(std::function<void(double dt, const VelocityAt&)> observer);

  std::vector<std::byte> save() const;
  void load(const std::vector<std::byte>& checkpoint);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pivnp::mpm
