// Lengths of a case in metres.
#pragma once

#include "apps/case/case.hpp"

namespace pivnp::app {

/// Names of the units of length that camera.length_unit converts from.
std::vector<std::string> length_unit_names();

/// Metres of a length in one of them: one rounding, so that 80 mm is the number that 0.08 m is.
double in_metres(double value, const std::string& unit);
bool is_length_unit(const std::string& unit);

/// What the keys with unit m (and m/px) say in camera.length_unit becomes metres, as all that follows is; other names (a length of the
/// scene) and lengths in px stay. Throws InputError for such a name beside a simulation, which runs in metres.
void take_lengths_in_metres(Case& c, const Source& source);

}  // namespace pivnp::app
