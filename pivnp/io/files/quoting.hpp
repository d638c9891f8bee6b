// What messages quote of a file: a message is one line, whatever the file holds.
#pragma once

#include <string>
#include <string_view>

namespace pivnp::io {

/// The first `most` bytes of a text, with question marks for what does not print.
std::string printable_part(std::string_view text, std::size_t most);

/// At most 40 characters, those that print, and dots for the rest.
std::string shown(std::string_view text);

}  // namespace pivnp::io
