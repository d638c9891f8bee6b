// What changes with time by the case's will: gravity, the field of a centrifuge, densities, strengths, material taken
// out, tractions. (Gates and moving plates are restraints: constraint/restraints.hpp.) Functions of time alone, so that a restart
// needs no more than the time.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "mpm/constraint/tractions.hpp"
#include "mpm/scene/centrifuge.hpp"
#include "mpm/scene/options.hpp"
#include "mpm/scene/scene.hpp"
#include "mpm/state/particles.hpp"

namespace pivnp::mpm {

class Loading {
 public:
  /// Of materials that make_material() accepts. Throws InputError naming the key.
  Loading(const MpmOptions& options, const Scene& scene);

  /// Linear from gravity_from_m_s2 at time 0 to gravity_m_s2 at gravity_ramp_s.
  Vec2 gravity(double time) const;
  double greatest_gravity() const { return std::max(from_.norm(), to_.norm()); }
  bool gravity_changes() const { return ramp_ > 0; }
  /// Acts beside gravity, from place to place; null: none.
  const Centrifuge* centrifuge() const { return centrifuge_ ? &*centrifuge_ : nullptr; }
  /// What is at rest at x falls with.
  Vec2 gravity_at(const Vec2& x, double time) const { return centrifuge_ ? Vec2(gravity(time) + centrifuge_->acceleration(x, time)) : gravity(time); }
  double greatest_gravity_at(const Vec2& x) const { return greatest_gravity() + (centrifuge_ ? centrifuge_->greatest(x) : 0.0); }
  /// Density of a material over that at time 0: linear between density_from_s and density_until_s.
  double density_ratio(std::size_t material, double time) const;
  bool any_density() const { return any_density_; }
  /// Factor by which cohesion and tan(friction) are divided: 1 before reduction_from_s, reduction_factor from
  /// reduction_until_s on, linear between.
  double reduction(std::size_t material, double time) const;
  bool any_reduction() const { return any_reduction_; }
  /// Time at which a material is taken out; infinite: never.
  double removal(std::size_t material) const;
  const Tractions& tractions() const { return tractions_; }

  /// The first time after `time` at which something starts or ends.
  double next_change(double time) const;
  bool changing_after(double time) const { return time < last_; }

 private:
  Vec2 from_, to_;
  double ramp_ = 0;
  std::vector<MaterialOptions> materials_;
  Tractions tractions_;
  std::optional<Centrifuge> centrifuge_;
  std::vector<double> changes_;
  double last_ = 0;
  bool any_density_ = false, any_reduction_ = false;
};

}  // namespace pivnp::mpm
