// One number of a comparison, with what it takes to read it.
#pragma once

#include <string>

namespace pivnp {

struct Metric {
  std::string name;        // for example displacement_rms
  double value = 0;
  std::string unit;
  double uncertainty = 0;  // standard uncertainty of the value from the measurement; NaN if not known
  std::string definition;  // one line
  std::string verdict;     // "", "within limit", "over limit", "not distinguishable at this u_val"
};

}  // namespace pivnp
