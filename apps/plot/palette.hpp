// Colour maps, perceptually even, and the few colours that figures share.
#pragma once

#include <cstdint>

namespace pivnp::plot {

using Rgb = std::uint32_t;  // 0xRRGGBB

enum class Colours { sequential, diverging };

/// Colour at `t` in [0, 1], clamped; NaN gives `no_value`.
/// Sequential: viridis (S. van der Walt and N. Smith, CC0). Diverging: the cool-warm map of K. Moreland, "Diverging
/// color maps for scientific visualization", ISVC 2009, with a lighter middle (M = 95) that greys stand out from.
Rgb colour_at(Colours map, double t);

constexpr Rgb no_value = 0xb0b0b0;
constexpr Rgb ended_colour = 0xd6d6d6;  // pale grey: particles that are no longer followed

// Distinct for the colour blind and in grey print (after M. Okabe and K. Ito).
constexpr Rgb ink = 0x1a1a1a;
constexpr Rgb faint = 0x8a8a8a;
constexpr Rgb blue = 0x0072b2;
constexpr Rgb vermilion = 0xd55e00;
constexpr Rgb green = 0x009e73;
constexpr Rgb orange = 0xe69f00;
constexpr Rgb purple = 0xa0528a;
constexpr Rgb sky = 0x56b4e9;
constexpr Rgb red = 0xc8102e;

}  // namespace pivnp::plot
