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
/// Its stencil has nodes that are moved onto a wall (MovedNodes).
constexpr std::uint8_t wall_moved = 64;

/// By how much, in cells inwards, the nodes of a cell's walls, or of walls one cell further, are moved at the low and
/// the high end of each axis.
struct MovedNodes {
  double low[2] = {}, high[2] = {};
};

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
Line<double, S::width> line_of(double xi, double half, [[maybe_unused]] bool low, [[maybe_unused]] bool high,
                               [[maybe_unused]] const MovedNodes* moved = nullptr, [[maybe_unused]] int axis = 0) {
  if constexpr (S::centred) {
    const double s_low = moved ? moved->low[axis] : 0.0, s_high = moved ? moved->high[axis] : 0.0;
    auto line = low || high ? S::line_at_wall(xi, half, low, low ? s_low : s_high) : S::line(xi, half);
    if (s_low != 0) move_node(line, low ? 1 : 0, low ? 2 : 1, s_low / (1 - s_low));
    if (s_high != 0) move_node(line, high ? 1 : 2, high ? 0 : 1, s_high / (1 - s_high));
    return line;
  } else {
    return S::line(xi, half);
  }
}

}  // namespace pivnp::mpm
