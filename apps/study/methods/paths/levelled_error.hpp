// What a levelled measurement is off by itself, in its uncertainty.
#pragma once

#include <cstddef>
#include <memory>

#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::app {

/// The simulation that moved the texture of levelled frames is the truth of what is measured in them. Where the
/// measurement departs from it by more than three of its stated standard deviations, what it states is refuted, and the
/// departure, squared, is added to its covariances: of u, and of F by the deviatoric strain.
class LevelledMotion final : public MotionSource {
 public:
  /// `against`: the comparison of `levelled` (first) with the simulation, whose fields hold the departures.
  LevelledMotion(std::unique_ptr<MotionSource> levelled, const Comparison& against);

  const std::string& name() const override { return levelled_->name(); }
  const std::string& length_unit() const override { return levelled_->length_unit(); }
  const std::string& time_unit() const override { return levelled_->time_unit(); }
  const ParticleSet& particles() const override { return levelled_->particles(); }
  const std::vector<double>& times() const override { return levelled_->times(); }
  MotionFrame frame(std::size_t index) const override;

 private:
  std::unique_ptr<MotionSource> levelled_;
  std::vector<double> time_;
  std::vector<std::ptrdiff_t> column_;  // of a particle in a row of the fields, -1: not compared
  std::size_t columns_ = 0;
  std::vector<float> x_, y_, dev_;
};

}  // namespace pivnp::app
