// Text as HTML and Qt can take it.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pivnp::report {

/// Text safe between tags and in quoted attributes. Bytes that are not UTF-8 become U+FFFD, control characters (but
/// tab and newline) vanish.
std::string escape_html(std::string_view text);

/// The same cleaning without the escaping: what Qt and a reader can take.
std::string clean_utf8(std::string_view text);

/// The sections of a case in TOML, a key a line: "[piv]" and "method = ...; window_px = ...". What precedes the first comes
/// under "".
std::vector<std::pair<std::string, std::string>> sections_of(std::string_view toml);

}  // namespace pivnp::report
