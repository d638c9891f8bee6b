// What is stated with every measured strain: over which length, and what a still specimen would have shown.
#pragma once

#include <limits>
#include <string>

namespace pivnp {

struct StrainNote {
  double gauge_length = std::numeric_limits<double>::quiet_NaN();  // length unit of the record
  std::string floor_source = "not measured";                       // or "still zone", "still frames"
  // RMS where nothing moved, at the motion's last frame; NaN: not measured.
  double floor_dev = std::numeric_limits<double>::quiet_NaN();   // of strain_dev
  double floor_vol = std::numeric_limits<double>::quiet_NaN();   // of strain_vol
  double floor_path = std::numeric_limits<double>::quiet_NaN();  // of strain_dev_path
};

}  // namespace pivnp
