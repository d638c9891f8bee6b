// Units of a comparison's values, written with those of the motions.
#pragma once

#include <string>
#include <string_view>

namespace pivnp::compare {

/// "L/T" and the like with the motions' own units in place of L and T; "1" and "deg" stay.
inline std::string unit_of(std::string_view pattern, const std::string& length, const std::string& time) {
  std::string out;
  for (const char c : pattern) {
    if (c == 'L') out += length;
    else if (c == 'T') out += time;
    else out += c;
  }
  return out;
}

}  // namespace pivnp::compare
