// What a colour means.
#pragma once

#include <vector>

#include "apps/plot/palette.hpp"

namespace pivnp::plot {

struct Scale {
  Colours map = Colours::sequential;
  double lower = 0, upper = 1;
  bool below = false, above = false;  // values beyond the ends exist
  Rgb at(double value) const { return colour_at(map, (value - lower) / (upper - lower)); }
};

/// Covers the finite values but for the outermost 0.5 %: from 0 if they are not negative, symmetric and diverging if
/// both signs occur or `signed_values` is set. Never empty.
Scale scale_for(const std::vector<double>& values, bool signed_values);
/// From zero, so that the noise of a uniform motion is not spread over all colours.
Scale scale_of_magnitude(const std::vector<double>& values);

}  // namespace pivnp::plot
