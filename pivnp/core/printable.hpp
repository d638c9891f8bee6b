// The one rule for names, units and titles: they print. What does not print moves a terminal's cursor, ends an XML
// file, or makes a line read other than it is.
#pragma once

#include <string>
#include <string_view>

namespace pivnp {

/// No control characters (C0, DEL, C1), line separators (U+2028, U+2029) or marks that turn the direction of reading
/// (U+202A to U+202E, U+2066 to U+2069). UTF-8; bytes that are none pass.
bool prints(std::string_view text);

/// With a question mark in place of each byte that does not print; `lines`: new lines and tabs are kept.
std::string printable(std::string_view text, bool lines = false);

}  // namespace pivnp
