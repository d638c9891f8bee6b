#include "pivnp/core/printable.hpp"

#include <algorithm>

namespace pivnp {

namespace {

// Bytes at `at` that belong to a character which does not print; 0: it does.
std::size_t unprinted(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return at + k < text.size() ? static_cast<unsigned char>(text[at + k]) : 0u; };
  const unsigned first = byte(0), second = byte(1), third = byte(2);
  if (first < 0x20 || first == 0x7F) return 1;
  if (first == 0xC2 && second >= 0x80 && second < 0xA0) return 2;
  const bool separator = second == 0x80 && third >= 0xA8 && third <= 0xAE, isolate = second == 0x81 && third >= 0xA6 && third <= 0xA9;
  return first == 0xE2 && (separator || isolate) ? 3 : 0;
}

}  // namespace

bool prints(std::string_view text) {
  for (std::size_t k = 0; k < text.size(); ++k)
    if (unprinted(text, k) > 0) return false;
  return true;
}

std::string printable(std::string_view text, bool lines) {
  std::string out(text);
  for (std::size_t k = 0; k < text.size();) {
    const std::size_t bytes = lines && (text[k] == '\n' || text[k] == '\t') ? 0 : unprinted(text, k);
    std::fill_n(out.begin() + std::ptrdiff_t(k), bytes, '?');
    k += std::max<std::size_t>(1, bytes);
  }
  return out;
}

}  // namespace pivnp
