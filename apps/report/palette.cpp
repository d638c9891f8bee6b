#include "apps/report/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pivnp::report {

namespace {

constexpr std::array<Rgb, 33> viridis = {
    0x440154, 0x470d60, 0x48186a, 0x482374, 0x472d7b, 0x453681, 0x424086, 0x3f4989, 0x3b528b, 0x375a8d, 0x33638d,
    0x2f6a8e, 0x2c728e, 0x297a8e, 0x26818e, 0x23898e, 0x21908c, 0x1f988b, 0x1f9f88, 0x21a685, 0x28ae80, 0x31b57b,
    0x3ebc74, 0x4cc26c, 0x5dc963, 0x6ece58, 0x82d34c, 0x96d83f, 0xabdc32, 0xc0df24, 0xd5e21a, 0xeae51a, 0xfde725,
};

constexpr std::array<Rgb, 33> cool_warm = {
    0x3b4cc0, 0x445acc, 0x4d68d7, 0x5775e1, 0x6282ea, 0x6c8ef1, 0x779af7, 0x82a5fb, 0x8db0fe, 0x98b9ff, 0xa3c2ff,
    0xaec9fd, 0xb8d0f9, 0xc2d5f4, 0xccd9ee, 0xd5dbe6, 0xdddddd, 0xe5d8d1, 0xecd3c5, 0xf1ccb9, 0xf5c4ad, 0xf7bba0,
    0xf7b194, 0xf7a687, 0xf49a7b, 0xf18d6f, 0xec7f63, 0xe57058, 0xde604d, 0xd55042, 0xcb3e38, 0xc0282f, 0xb40426,
};

}  // namespace

Rgb colour_at(Colours map, double t) {
  if (std::isnan(t)) return no_value;
  const auto& table = map == Colours::sequential ? viridis : cool_warm;
  const double place = std::clamp(t, 0.0, 1.0) * double(table.size() - 1);
  const std::size_t k = std::min(std::size_t(place), table.size() - 2);
  const double f = place - double(k);
  Rgb mixed = 0;
  for (int shift : {16, 8, 0}) {
    const double a = (table[k] >> shift) & 0xff, b = (table[k + 1] >> shift) & 0xff;
    mixed |= Rgb(std::lround(a + f * (b - a))) << shift;
  }
  return mixed;
}

}  // namespace pivnp::report
