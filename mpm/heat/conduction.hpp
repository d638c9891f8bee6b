// Conduction, and what the flow of the water carries, by hats between the nodes. docs/theory/mpm_heat.md.
//
// Points give nodes the mean of their temperatures by heat capacity; heat moves along the edges between nodes, the two-point
// flux of finite volumes, and nodes give their points what came, so that heat is conserved to round-off. What of the points'
// temperatures no node sees evens out at the rate of a cell, as the water's potentials do (water/pore_water.hpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "mpm/constraint/tied_sides.hpp"
#include "mpm/grid/grid_state.hpp"
#include "mpm/heat/heat_boundaries.hpp"
#include "mpm/heat/heat_soil.hpp"
#include "mpm/water/pore_water.hpp"

namespace pivnp::mpm {

class Conduction {
 public:
  /// `soils`: of each label of `particles`. What is given must outlive this.
  Conduction(const std::vector<HeatSoil>& soils, const ParticleSet& particles, GridState& g, HeatBoundaries boundaries, const TiedSides& ties);

  struct Sums {
    double inflow = 0;    // through boundaries, and what the flow of the water carried, J/m
    double darcy = 0;     // made by the flow of what was asked for, J/m
    double crossing = 0;  // greatest rate at which the flow passes a cell, 1/s
  };
  /// Adds to `rise` (of the points, K) what a step of `dt` gives. `water`: null without; its flow is that of the last
  /// step. `darcy`: what the flow dissipated meanwhile, J/m; it becomes heat where the flow of the last step does so,
  /// unless that has come to rest.
  Sums conduct(const Particles& p, GridState& g, const PoreWater* water, double carried_capacity, double darcy,
               const Vec2& gravity, double time, double dt, std::vector<double>& rise, int threads);
  /// The longest stable step, s; infinite where nothing conducts.
  double longest_step(const GridState& g) const;

 private:
  struct Edge {
    double conducts = 0, passed = 0;  // J/(m K), in a step
  };
  const HeatSoil& soil_of(const Particles& p, std::size_t k) const { return (*soils_)[std::size_t(set_->label[p.index[k]])]; }
  void map(const Particles& p, GridState& g, int threads);
  void take_means(const GridState& g, int threads);
  void join_ties(double time);
  double give_temperatures(const GridState& g, double rate, double time, double dt);
  void add_edges(const GridState& g, const PoreWater* water, double carried_capacity, double rate, double dt, int threads, Sums& sums);
  void give_darcy(const Particles& p, GridState& g, const PoreWater& water, double darcy, const Vec2& gravity,
                  std::vector<double>& rise, int threads, Sums& sums);
  Edge edge(const GridState& g, std::size_t n, bool along_x, double rate, double dt) const;

  double diffusivity_of(const HeatSoil& soil) const { return std::max(soil.diffusivity(), least_diffusivity_); }

  const std::vector<HeatSoil>* soils_;
  const ParticleSet* set_;
  HeatBoundaries boundaries_;
  const TiedSides* ties_;
  double least_diffusivity_;  // above zero: so that every node has a mean
  HeatNode* nodes_;
  std::ptrdiff_t row_;
  std::vector<std::uint8_t> is_given_;  // of every node
  std::vector<std::uint32_t> given_;
  struct Joined {
    std::uint32_t node[2];
    double share[2], mean[2];  // of each one's own points in both, and their temperature
  };
  std::vector<Joined> joined_;
  std::vector<double> evening_;  // of the points, W/m
};

}  // namespace pivnp::mpm
