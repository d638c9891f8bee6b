// Text as HTML and Qt can take it.
#pragma once

#include <string>
#include <string_view>

namespace pivnp::report {

/// Text safe between tags and in quoted attributes. Bytes that are not UTF-8 become U+FFFD, control characters (but
/// tab and newline) vanish.
std::string escape_html(std::string_view text);

/// The same cleaning without the escaping: what Qt and a reader can take.
std::string clean_utf8(std::string_view text);

}  // namespace pivnp::report
