// Loads on faces of the material.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "mpm/constraint/options.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::mpm {

/// Of a particle: it keeps its share of the load as it moves.
struct Traction {
  Vec2 acceleration;  // of its mass at time 0, m/s^2; to be multiplied by share()
  double rise, until;
  double face;             // of the loaded line, m
  std::uint16_t boundary;  // its number in the scene
  double share(double time) const { return time >= until ? 0 : rise > 0 ? std::min(1.0, time / rise) : 1.0; }
};

class Tractions {
 public:
  /// The particles next to a line have equal shares of its force. `density`: of each label at time 0, kg/m^3. Throws
  /// InputError naming boundary.<name>.<key>; faces must be apart.
  Tractions(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const ParticleSet& particles,
            const std::vector<double>& density);

  bool any() const { return !loads_.empty(); }
  /// Of a particle of the set; null: none.
  const Traction* of(std::size_t particle) const;
  /// Times at which one is complete or ends, in no order.
  const std::vector<double>& changes() const { return changes_; }

 private:
  void add(const std::string& key, const BoundaryOptions& options, std::size_t boundary, const ParticleSet& particles,
           const std::vector<double>& density);

  std::vector<Traction> loads_;
  std::vector<std::int32_t> at_;  // of every particle: its place among them; -1: none
  std::vector<double> changes_;
};

}  // namespace pivnp::mpm
