#include "pivnp/io/files/quoting.hpp"

namespace pivnp::io {

std::string printable(std::string_view text, std::size_t most) {
  std::string out(text.substr(0, most));
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
  return out;
}

std::string shown(std::string_view text) {
  return printable(text, 40) + (text.size() > 40 ? "..." : "");
}

}  // namespace pivnp::io
