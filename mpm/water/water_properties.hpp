// Density and viscosity of water as they depend on temperature, at atmospheric pressure.
#pragma once

#include <algorithm>
#include <cmath>

namespace pivnp::mpm {

/// Between them the fits are taken; colder and hotter water is as at these ends. degC.
inline constexpr double least_water_c = 0, most_water_c = 150;

/// kg/m^3. Kell 1975 (J. Chem. Eng. Data 20:97), from -30 to 150 degC.
inline double water_density(double celsius) {
  const double t = std::clamp(celsius, least_water_c, most_water_c);
  return (999.83952 + t * (16.945176 + t * (-7.9870401e-3 + t * (-46.170461e-6 + t * (105.56302e-9 - t * 280.54253e-12))))) /
         (1 + 16.879850e-3 * t);
}

/// Pa s. IAPWS SR6-08 (Patek et al. 2009, J. Phys. Chem. Ref. Data 38:21), stated from -20 to 110 degC; at 150 degC it is within
/// 0.2 % of IAPWS 2008 for saturated water.
inline double water_viscosity(double celsius) {
  const double of_300 = (std::clamp(celsius, least_water_c, most_water_c) + 273.15) / 300;
  return 1e-6 * (280.68 * std::pow(of_300, -1.9) + 511.45 * std::pow(of_300, -7.7) + 61.131 * std::pow(of_300, -19.6) +
                 0.45903 * std::pow(of_300, -40.0));
}

}  // namespace pivnp::mpm
