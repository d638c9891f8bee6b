// What figures of material points against time have in common.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "apps/plot/marks.hpp"

namespace pivnp::report {

inline constexpr std::array<plot::Rgb, 3> point_colours = {plot::blue, plot::vermilion, plot::green};
inline constexpr std::array<plot::Marker, 3> point_markers = {plot::Marker::circle, plot::Marker::square, plot::Marker::triangle};

/// A, B, C ...
inline std::string letter_of(std::size_t point) { return std::string(1, char('A' + int(point % 26))); }

inline std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

}  // namespace pivnp::report
