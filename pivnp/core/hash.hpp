// A fast 64-bit hash to tell by whether bytes are the same. No protection against somebody who wants them to look so.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pivnp {

/// XXH64 with seed 0 (Y. Collet, "xxHash fast digest algorithm", specification 0.1.1), fed piece by piece: how the bytes
/// are cut into pieces does not matter, nor does the machine's byte order.
class Hash64 {
 public:
  void add(const void* data, std::size_t bytes);
  std::uint64_t value() const;

 private:
  std::array<std::uint64_t, 4> lanes_ = {0x60ea27eeadc0b5d6u, 0xc2b2ae3d27d4eb4fu, 0, 0x61c8864e7a143579u};
  std::array<unsigned char, 32> rest_{};
  std::uint64_t total_ = 0;
};

std::uint64_t hash64(std::string_view bytes);

/// 16 digits, lower case.
std::string hexadecimal(std::uint64_t value);

}  // namespace pivnp
