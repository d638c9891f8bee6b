// Births: new particles where material enters and an element has run empty.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/core/particles/seeding.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::np {

/// Watches the elements of one grid. An element that held living particles after the step before, holds none now, and
/// whose four nodes are all valid in this step's pair still shows material: it is seeded anew, `per_element` particles
/// of the label it held last. Elements that never held a particle (outside the regions) stay empty, and so do those
/// whose vectors are masked, rejected or replaced: there the material itself has gone.
class Reseeder {
 public:
  /// `tracker` at its start; ids of the born go on from the greatest so far.
  Reseeder(const Grid& grid, int per_element, SeedPattern pattern, const Tracker& tracker);

  /// After a step by `field`: the particles to be born at tracker.time(), none as a rule. x0 is their place of birth,
  /// F = I there. They count as living from the next call on (Tracker::add).
  ParticleSet births(const Tracker& tracker, const VectorField& field);

 private:
  std::vector<std::int32_t> labels(const Tracker& tracker) const;  // of a living particle in each element; -1: none

  Grid grid_;
  std::vector<Vec2> pattern_;  // natural coordinates, [0, 1]
  std::vector<std::int32_t> before_;
  std::int64_t next_id_ = 0;
};

}  // namespace pivnp::np
