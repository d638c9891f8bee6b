#include "pivnp/core/hash.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace pivnp {

namespace {

constexpr std::uint64_t prime1 = 0x9e3779b185ebca87u, prime2 = 0xc2b2ae3d27d4eb4fu, prime3 = 0x165667b19e3779f9u,
                        prime4 = 0x85ebca77c2b2ae63u, prime5 = 0x27d4eb2f165667c5u;

// Little-endian, whatever the machine.
template <class T> std::uint64_t number_at(const unsigned char* p) {
  if constexpr (std::endian::native == std::endian::little) {
    T value;
    std::memcpy(&value, p, sizeof value);
    return value;
  } else {
    std::uint64_t value = 0;
    for (std::size_t k = sizeof(T); k-- > 0;) value = value << 8 | p[k];
    return value;
  }
}

std::uint64_t round_of(std::uint64_t lane, std::uint64_t input) {
  return std::rotl(lane + input * prime2, 31) * prime1;
}

void stripe(std::array<std::uint64_t, 4>& lanes, const unsigned char* p) {
  for (std::size_t k = 0; k < 4; ++k) lanes[k] = round_of(lanes[k], number_at<std::uint64_t>(p + 8 * k));
}

}  // namespace

void Hash64::add(const void* data, std::size_t bytes) {
  const auto* p = static_cast<const unsigned char*>(data);
  if (bytes == 0) return;
  const std::size_t held = total_ % 32;
  total_ += bytes;
  if (held > 0) {
    const std::size_t some = std::min(bytes, 32 - held);
    std::memcpy(rest_.data() + held, p, some);
    p += some;
    bytes -= some;
    if (held + some < 32) return;
    stripe(lanes_, rest_.data());
  }
  for (; bytes >= 32; p += 32, bytes -= 32) stripe(lanes_, p);
  std::memcpy(rest_.data(), p, bytes);
}

std::uint64_t Hash64::value() const {
  std::uint64_t h = prime5;
  if (total_ >= 32) {
    h = std::rotl(lanes_[0], 1) + std::rotl(lanes_[1], 7) + std::rotl(lanes_[2], 12) + std::rotl(lanes_[3], 18);
    for (const std::uint64_t lane : lanes_) h = (h ^ round_of(0, lane)) * prime1 + prime4;
  }
  h += total_;
  const unsigned char* p = rest_.data();
  const unsigned char* end = p + total_ % 32;
  for (; end - p >= 8; p += 8) h = std::rotl(h ^ round_of(0, number_at<std::uint64_t>(p)), 27) * prime1 + prime4;
  for (; end - p >= 4; p += 4) h = std::rotl(h ^ number_at<std::uint32_t>(p) * prime1, 23) * prime2 + prime3;
  for (; p < end; ++p) h = std::rotl(h ^ *p * prime5, 11) * prime1;
  h = (h ^ h >> 33) * prime2;
  h = (h ^ h >> 29) * prime3;
  return h ^ h >> 32;
}

std::uint64_t hash64(std::string_view bytes) {
  Hash64 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

std::string hexadecimal(std::uint64_t value) {
  std::string text(16, '0');
  for (std::size_t k = 16; k-- > 0; value >>= 4) text[k] = "0123456789abcdef"[value & 15];
  return text;
}

}  // namespace pivnp
