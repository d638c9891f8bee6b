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

template <class S>
constexpr bool is_as_listed(ShapeKind kind) {
  return S::width == row_of(kind).nodes && S::centred == row_of(kind).centred() && S::needs_size == row_of(kind).sized;
}
static_assert(is_as_listed<BilinearShape>(ShapeKind::bilinear) && is_as_listed<GimpShape>(ShapeKind::gimp) &&
              is_as_listed<BSplineShape>(ShapeKind::bspline));

constexpr int most_stencil_nodes = 9;  // of any shape

/// The functions beside the walls that there are.
template <class S>
Line<double, S::width> line_of(double xi, double half, [[maybe_unused]] bool low, [[maybe_unused]] bool high) {
  if constexpr (S::centred)
    if (low || high) return S::line_at_wall(xi, half, low);
  return S::line(xi, half);
}

}  // namespace pivnp::mpm
