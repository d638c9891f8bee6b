#include "pivnp/io/files/quoting.hpp"

#include "pivnp/core/printable.hpp"

namespace pivnp::io {

std::string printable_part(std::string_view text, std::size_t most) {
  return pivnp::printable(text.substr(0, most));
}

std::string shown(std::string_view text) {
  return printable_part(text, 40) + (text.size() > 40 ? "..." : "");
}

}  // namespace pivnp::io
