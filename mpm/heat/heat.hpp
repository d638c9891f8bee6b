// Temperature of the points: plastic work and Darcy's become heat, conduction and flow move it, and it swells water, grains and
// skeleton. docs/theory/mpm_heat.md.
//
// Work becomes heat on its own point; only conduction needs the nodes. What swells in the pores is handed to the water as a volume
// (PoreWater::swell), what swells of the skeleton becomes stress. The step of heat is one of several steps of the waves.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mpm/heat/bands.hpp"
#include "mpm/heat/conduction.hpp"
#include "mpm/heat/heat_soil.hpp"
#include "mpm/heat/options.hpp"
#include "mpm/heat/zone_width.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/transfer/stress_update.hpp"
#include "mpm/water/pore_water.hpp"

namespace pivnp::mpm {

/// How a point that may have a band turned as it sheared, of which the older counts the less.
struct Turning {
  double F_xx = 1, F_xy = 0, F_yx = 0, F_yy = 1;  // at the last look
  double turned = 0, sheared = 0;

  /// Takes note of the deformation since. The sense: spin over the rate of shear, -1 to 1.
  double look(double xx, double xy, double yx, double yy, double forgotten);
};

/// All that heat remembers beside the points' fields; part of a checkpoint.
struct HeatState {
  std::vector<std::int32_t> band_of;  // of each particle of the set, its place among `bands`; -1: none
  std::vector<ShearBand> bands;
  std::vector<Turning> turning;  // of each particle of the set, where any material has bands
  double since = 0;      // time since heat was last conducted, s
  double darcy = 0;      // what the flow dissipated and is heat, J/m
  double crossing = 0;   // greatest rate at which the flow passed a cell then, 1/s
  std::int64_t steps = 0, passes = 0;
};

/// J per metre of thickness.
struct HeatSums {
  double made = 0;       // of work
  double inflow = 0;     // through boundaries, and carried by the flow of the water
  double expansion = 0;  // mechanical energy that swelling gave to water and skeleton

  void add(const HeatSums& more) {
    made += more.made;
    inflow += more.inflow;
    expansion += more.expansion;
  }
};

class Heat {
 public:
  /// `soils`: of each label of `particles`. What is given must outlive this. Throws InputError naming the key.
  Heat(const HeatOptions& options, std::vector<HeatSoil> soils, const ParticleSet& particles, const Materials& materials, GridState& g,
       HeatBoundaries boundaries, const TiedSides& ties);

  /// `temperature`: at time 0, one a particle of the set; empty: the options'.
  void start(Particles& p, HeatState& state, const std::vector<double>& temperature) const;
  bool conducts() const { return conducts_; }
  bool any_bands() const { return bands_; }
  double longest_step(const GridState& g) const { return conduction_.longest_step(g); }

  /// Once a step, after the water has flowed: adds to the time, and when it is due makes heat of the work, conducts,
  /// and advances the bands. `water`: null without. `darcy`: what the flow has dissipated since the start, J/m. `last`:
  /// before a state is written, when it is due in any case.
  HeatSums step(Particles& p, GridState& g, const Materials& materials, const PoreWater* water, HeatState& state,
                double darcy, const Vec2& gravity, double time, double dt, bool last, int threads);
  /// The work done since becomes heat: before a state is written.
  HeatSums take_work(Particles& p, const Materials& materials, const PoreWater* water, HeatState& state, int threads);

  /// Of the points still simulated, from HeatOptions::reference_c, J/m.
  double contained(const Particles& p) const;
  /// Plastic work of a point that is not heat yet, J/m.
  double pending(const Particles& p, std::size_t k) const;
  double contained(const Particles& p, std::size_t k) const { return p.volume0[k] * soil_of(p, k).capacity * (p.temperature[k] - reference_); }

  struct InBand {
    double temperature, pressure;  // of the band; of the point where it has none
  };
  InBand in_band(const Particles& p, const HeatState& state, std::size_t k) const;

 private:
  const HeatSoil& soil_of(const Particles& p, std::size_t k) const { return soils_[std::size_t(set_->label[p.index[k]])]; }
  enum class WithBands { none, that_slip, all };
  HeatSums warm(Particles& p, const Materials& materials, const PoreWater* water, WithBands bands, double dt,
                HeatState& state, int threads);
  void look_at_zones(Particles& p, const GridState& g, HeatState& state, double time);
  void open_bands(const Particles& p, HeatState& state);
  void shift_strength(Particles& p, const HeatState& state, int threads) const;
  double exchange_as_printed(Particles& p, const HeatSoil& soil, std::size_t k, double work, double dt, HeatState& state) const;

  std::vector<HeatSoil> soils_;
  const ParticleSet* set_;
  double initial_, reference_, carried_capacity_;
  bool conducts_ = false, bands_ = false;
  Conduction conduction_;
  std::optional<ZoneWidth> zone_;
  std::vector<double> rise_, work_, sense_;  // of the points, in a pass
};

}  // namespace pivnp::mpm
