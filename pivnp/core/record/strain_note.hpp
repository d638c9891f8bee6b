// What is stated with every measured strain: over which length, and what a still specimen would have shown.
#pragma once

#include <array>
#include <limits>

#include "pivnp/core/choice.hpp"

namespace pivnp {

/// What the noise floor was measured on; records hold the names.
enum class StrainFloor { not_measured, still_zone, still_frames };
inline constexpr std::array strain_floor_names{NamedValue{"not measured", StrainFloor::not_measured},
                                               NamedValue{"still zone", StrainFloor::still_zone},
                                               NamedValue{"still frames", StrainFloor::still_frames}};
constexpr const auto& names_of(StrainFloor) { return strain_floor_names; }

struct StrainNote {
  double gauge_length = std::numeric_limits<double>::quiet_NaN();  // length unit of the record
  StrainFloor floor_source = StrainFloor::not_measured;
  // RMS where nothing moved, at the motion's last frame; NaN: not measured.
  double floor_dev = std::numeric_limits<double>::quiet_NaN();   // of strain_dev
  double floor_vol = std::numeric_limits<double>::quiet_NaN();   // of strain_vol
  double floor_path = std::numeric_limits<double>::quiet_NaN();  // of strain_dev_path
};

}  // namespace pivnp
