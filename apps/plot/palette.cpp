#include "apps/plot/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pivnp::plot {

namespace {

constexpr std::array<Rgb, 33> viridis = {
    0x440154, 0x470d60, 0x48186a, 0x482374, 0x472d7b, 0x453681, 0x424086, 0x3f4989, 0x3b528b, 0x375a8d, 0x33638d,
    0x2f6a8e, 0x2c728e, 0x297a8e, 0x26818e, 0x23898e, 0x21908c, 0x1f988b, 0x1f9f88, 0x21a685, 0x28ae80, 0x31b57b,
    0x3ebc74, 0x4cc26c, 0x5dc963, 0x6ece58, 0x82d34c, 0x96d83f, 0xabdc32, 0xc0df24, 0xd5e21a, 0xeae51a, 0xfde725,
};

constexpr std::array<Rgb, 33> cool_warm = {
    0x3b4cc0, 0x405bce, 0x466adb, 0x4d79e7, 0x5687f1, 0x6095fa, 0x6ba2ff, 0x77afff, 0x84bbff, 0x91c6ff, 0x9fd0ff,
    0xadd9ff, 0xbbe0ff, 0xc9e7ff, 0xd7ebff, 0xe4eff9, 0xf1f1f1, 0xf7ece2, 0xfbe5d3, 0xffddc4, 0xffd4b4, 0xffc9a5,
    0xffbe96, 0xffb188, 0xfba47a, 0xf7956d, 0xf18660, 0xe97654, 0xe16549, 0xd7533f, 0xcc4036, 0xc1292e, 0xb40426,
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

}  // namespace pivnp::plot
