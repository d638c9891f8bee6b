// What heat can be told.
#pragma once

#include <optional>

#include "pivnp/core/options.hpp"

namespace pivnp::mpm {

/// Its presence turns heat on. What materials, water and boundaries add stands with them.
struct HeatOptions {
  double initial_c = 20;
  std::optional<double> reference_c;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("initial_c", self.initial_c, OptionInfo{.unit = "degC", .text = "temperature at the start", .min = -273.15});
    visit("reference_c", self.reference_c, OptionInfo{.unit = "degC", .text = "temperature from which heat is counted; default: initial_c", .min = -273.15});
  }
};

}  // namespace pivnp::mpm
