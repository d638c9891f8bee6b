// Embedded shear bands, thinner than any cell. docs/theory/mpm_heat.md.
//
// Temperature and pressure are split into the mean, which the points carry, and a deviation across the width w into which the cells
// localise, zero in the mean: T = mean + t(y), p = mean + d(y), |y| <= w/2,
//   C dt/dt = Gamma t'' + h(y) - mean h,   S dd/dt = (K/gamma) d'' + beta dt/dt,   no flux at 0 and w/2,
// h the plastic work of the point times w/L_B inside the band, S = m + n/K_w. Means exchange nothing with bands: heat and water are
// conserved whatever a band does, and bands may start, stop and change their width freely. Strength sees mean plus deviation.
// The pores' smoothed strain spreads some of what the zone swells by over the cells beside it (HeatSoil::spread): d reaches as far, with
// that much less taken off inside and as much taken off there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mpm/heat/heat_soil.hpp"

namespace pivnp::mpm {

/// What a band carries: of the volumes from its middle outward, temperature (K) and pressure (Pa) over the mean. Of a band that
/// exchanges as printed, the first of each alone: its own temperature over that at the start of its surroundings', and its pressure.
struct ShearBand {
  static constexpr std::size_t inside = 3, volumes = 16;  // in the half band, and in half the width
  static constexpr std::size_t beside = 3, pressures = volumes + beside;  // of what is spread over a cell
  std::array<double, volumes> temperature{};
  std::array<double, pressures> pressure{};
  double width = 0, growth = 0;  // of the zone; of the volumes, one over the one before
  double waited = 0;             // time not advanced over, in which nothing slipped, s

  /// Over the mean, inside the band.
  double hotter(double thickness) const { return mean(temperature.data(), thickness); }
  double over_pressure(double thickness) const { return mean(pressure.data(), thickness); }

 private:
  double mean(const double* of, double thickness) const;
};

/// A step of the deviation in a zone of this width, in which a unit of volume has taken `work` (J/m^3). `from_c`, `to_c`: the mean
/// temperature before and after, which water whose properties follow its temperature asks for. What water and grains swell by, of a unit
/// of volume, over the zone.
double advance_band(ShearBand& band, const HeatSoil& soil, double width, double work, double dt, double from_c = 0, double to_c = 0);
/// The widths of the volumes, the thickness's half first, then the rest of the zone's half.
std::array<double, ShearBand::volumes> volumes_of(double thickness, double width, double growth);
/// Growth of the volumes outside that fills the zone. `near`: one near it, 0 if none is known.
double growth_of(double thickness, double width, double near = 0);

}  // namespace pivnp::mpm
