// How readers of other programs' files read a number.
#pragma once

#include <optional>
#include <string_view>

namespace pivnp::io {

/// The number that `text` is, whole; a plus sign, Fortran's D and its three-digit exponent without a letter (1.0-100)
/// count. Too small for double precision: 0; too large: infinite. Nothing: it is no number.
std::optional<double> read_number(std::string_view text);

}  // namespace pivnp::io
