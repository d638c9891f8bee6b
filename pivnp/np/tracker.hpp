// PIV-NP (Pinyol & Alvarado 2017): numerical particles ride through the measured increments.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pivnp/core/options.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/record/vectors.hpp"

namespace pivnp::np {

struct NpOptions {
  int per_element = 4;
  std::string seeding = "even";
  std::string gradient = "particle";

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("per_element", self.per_element,
          OptionInfo{.text = "numerical particles per occupied element: 1, 4, 9, 16 ...", .min = 1, .max = 400});
    visit("seeding", self.seeding,
          OptionInfo{.text = "pattern of the particles in an element", .choices = {"even", "gauss"}});
    visit("gradient", self.gradient,
          OptionInfo{.text = "where the gradient is taken: at the particle, or at the element's centre (the thesis)", .choices = {"particle", "element"}});
  }
};

/// Follows particles through pairs of consecutive frames. State is double precision.
class Tracker {
 public:
  /// `particles` are placed at x0 at `start_time` with F = I.
  Tracker(const NpOptions& options, ParticleSet particles, double start_time);

  /// One pair: moves every living particle by the rule of the field's anchor,
  ///   forward: x1 = x0 + d(x0),              F1 = (I + G) F0
  ///   central: x1 = x0 + d((x0 + x1)/2),     F1 = (I - G/2)^-1 (I + G/2) F0
  /// (errata to the thesis' 2.9 and 2.14). A particle outside the grid, or with too few usable nodes around it, ends
  /// with time and reason and keeps its last good state; where an element has lost nodes a local affine fit of the
  /// usable ones stands in and the step is marked doubtful. cov_u grows by the gathered covariance of the increments.
  void step(const VectorField& field, double time);

  const ParticleSet& particles() const { return particles_; }
  MotionFrame frame() const;  // the present state

  // The state in full precision, for tests and for going on after a break.
  struct Particle {
    Vec2 x;
    Mat2 F;
    std::array<double, 3> cov{0, 0, 0};
    ParticleStatus status = ParticleStatus::active;
  };
  const std::vector<Particle>& state() const { return state_; }
  std::vector<std::byte> save() const;
  void load(const std::vector<std::byte>& bytes);

 private:
  NpOptions options_;
  ParticleSet particles_;
  double time_;
  std::vector<Particle> state_;
};

}  // namespace pivnp::np
