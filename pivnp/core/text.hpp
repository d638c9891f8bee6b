// Words for messages.
#pragma once

#include <string>
#include <vector>

namespace pivnp {

/// "; did you mean 'window_px'?" with the known name nearest to `found` by edit distance, or "; known: a, b, c" if none
/// is near.
std::string did_you_mean(const std::string& found, const std::vector<std::string>& known);

/// "a", "a or b", "a, b or c".
std::string one_of(const std::vector<std::string>& names);

/// A number as a person writes it: `digits` significant ones, no trailing zeros.
std::string number(double value, int digits = 6);

}  // namespace pivnp
