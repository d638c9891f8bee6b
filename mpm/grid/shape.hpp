// Shape functions of the simulation, along one axis; a point's weights are products of two.
//
// Sources: bilinear: Sulsky, Chen & Schreyer 1994. uGIMP: Bardenhagen & Kober 2004 (CMES 5:477), points as squares that
// keep their size. Quadratic B-spline: Steffen, Kirby & Berzins 2008 (Int. J. Numer. Meth. Engng 76:922).
//
// A line holds the weights of W nodes and their derivatives (per cell side). Bilinear: the two nodes of the element,
// the coordinate xi in [0, 1] from the first. uGIMP and B-spline: the nearest node and its two neighbours, xi in
// [-1/2, 1/2] from the nearest.
//
// Walls. Where the nearest node lies on a wall along the grid, the node behind the wall is no unknown: its value is
// extrapolated linearly, v(-1) = 2 v(0) - v(1), that is, its weight is folded into the other two. The functions are
// then linear in the half cell next to the wall, still of one piece (C1) with the splines beyond, reproduce linear
// fields, stay positive, and the material at the wall moves with the wall's node. (Steffen et al.'s splines with a
// repeated knot serve the same end.)
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "mpm/state/scheme.hpp"

namespace pivnp::mpm {

template <int W>
struct Line {
  double w[W];  // weights, sum 1
  double g[W];  // derivatives per cell side, sum 0
};

/// Which neighbours of a node lie behind a wall.
enum Fold : std::uint8_t { fold_none = 0, fold_left = 1, fold_right = 2, fold_down = 4, fold_up = 8 };
/// Beside them among the marks of a slot: strained by velocities of its nodes' own (GridState::strain_apart()).
constexpr std::uint8_t strained_apart = 16;
/// The square around a node on the domain's edge, which ends there.
constexpr std::uint8_t at_edge = 32;

inline void fold_line(Line<3>& line, int behind, int ahead) {
  line.w[1] += 2 * line.w[behind];
  line.g[1] += 2 * line.g[behind];
  line.w[ahead] -= line.w[behind];
  line.g[ahead] -= line.g[behind];
  line.w[behind] = line.g[behind] = 0;
}

struct BilinearShape {
  static constexpr int width = 2, first = 0;  // nodes an axis; the first one's place relative to xi's origin
  static constexpr bool linear = true, needs_size = false;
  static Line<2> line(double xi, double, bool, bool) { return {{1 - xi, xi}, {-1, 1}}; }
};

struct BSplineShape {
  static constexpr int width = 3, first = -1;
  static constexpr bool linear = false, needs_size = false;
  static Line<3> line(double xi, double, bool low, bool high) {
    if (low) {
      xi = std::max(xi, 0.0);
      return {{0, 1 - xi, xi}, {0, -1, 1}};
    }
    if (high) {
      xi = std::min(xi, 0.0);
      return {{-xi, 1 + xi, 0}, {-1, 1, 0}};
    }
    const double a = 0.5 - xi, b = 0.5 + xi;
    return {{0.5 * a * a, 0.75 - xi * xi, 0.5 * b * b}, {-a, -2 * xi, b}};
  }
};

struct GimpShape {
  static constexpr int width = 3, first = -1;
  static constexpr bool linear = false, needs_size = true;
  /// `half`: half the point's side over the cell's, at most 1/2.
  static Line<3> line(double xi, double half, bool low, bool high) {
    if (low) xi = std::max(xi, 0.0);
    if (high) xi = std::min(xi, 0.0);
    Line<3> out;
    for (int a = 0; a < 3; ++a) {
      const double x = xi - (a - 1), d = std::abs(x), sign = x < 0 ? -1.0 : 1.0;
      if (d < half) {
        out.w[a] = 1 - (d * d + half * half) / (2 * half);
        out.g[a] = -x / half;
      } else if (d <= 1 - half) {
        out.w[a] = 1 - d;
        out.g[a] = -sign;
      } else if (d < 1 + half) {
        const double left = 1 + half - d;
        out.w[a] = left * left / (4 * half);
        out.g[a] = -sign * left / (2 * half);
      } else {
        out.w[a] = out.g[a] = 0;
      }
    }
    if (low) fold_line(out, 0, 2);
    if (high) fold_line(out, 2, 0);
    return out;
  }
};

/// Calls `action` with an object of the shape's type: the one place where run time turns into compile time.
template <class Action>
decltype(auto) with_shape(ShapeKind kind, Action&& action) {
  switch (kind) {
    case ShapeKind::bilinear: return action(BilinearShape{});
    case ShapeKind::gimp: return action(GimpShape{});
    default: return action(BSplineShape{});
  }
}

}  // namespace pivnp::mpm
