// Shape functions of the simulation at single points; their list is that of scheme_rows.hpp.
#pragma once

#include <algorithm>
#include <cstdint>

#include "mpm/state/scheme_rows.hpp"

namespace pivnp::mpm {

/// Which neighbours of a node lie behind a wall.
enum WallSide : std::uint8_t { wall_none = 0, wall_left = 1, wall_right = 2, wall_down = 4, wall_up = 8 };
/// Beside them among the marks of a cell: strained by velocities of its nodes' own (GridState::separate_strain_velocities()).
constexpr std::uint8_t strained_apart = 16;
/// The square around a node on the domain's edge, which ends there.
constexpr std::uint8_t at_edge = 32;

template <class T>
inline T constant(double value) {
  return value;
}
inline double MulAdd(double a, double b, double c) { return a * b + c; }
inline double NegMulAdd(double a, double b, double c) { return c - a * b; }
inline double Neg(double a) { return -a; }
inline double Min(double a, double b) { return std::min(a, b); }
inline double Max(double a, double b) { return std::max(a, b); }

#define PIVNP_NUMBERS inline
#define PIVNP_NUMBERS_LAMBDA
#include "mpm/grid/shape_functions.hpp"
#undef PIVNP_NUMBERS
#undef PIVNP_NUMBERS_LAMBDA

static_assert(std::all_of(shape_rows.begin(), shape_rows.end(), [](const ShapeRow& row) {
  return Shapes::with(row.value, [&row]<class S>(S) {
    return S::width == row.nodes && S::centred == row.centred() && S::needs_size == row.sized;
  });
}));

constexpr int most_stencil_nodes = 9;  // of any shape

/// The functions beside the walls that there are.
template <class S>
Line<double, S::width> line_of(double xi, double half, [[maybe_unused]] bool low, [[maybe_unused]] bool high) {
  if constexpr (S::centred)
    if (low || high) return S::line_at_wall(xi, half, low);
  return S::line(xi, half);
}

}  // namespace pivnp::mpm
