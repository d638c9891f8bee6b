// One-dimensional shape functions of higher order on evenly spaced nodes; in the plane they are multiplied.
// A basis says, for a place s in spacings from node 0 of n nodes, which nodes count, how much, and how that changes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace pivnp::np {

/// Lagrange polynomials over groups of `degree` cells: in the plane the element of 9 nodes (degree 2) or 16 (degree 3),
/// thesis section 2.2.3. Where the number of cells is no multiple of the degree, the last group is moved back to end at
/// the last node; the field stays continuous, as two groups share all nodes of their common side. Order of values
/// degree + 1, of gradients degree.
template <int degree>
struct Lagrange {
  static constexpr int count = degree + 1;
  static constexpr int ghosts = 0;  // coefficients beyond either end
  static constexpr int least_nodes = degree + 1;
  using Weights = std::array<double, std::size_t(count)>;

  static int first(double s, int n) {
    const int cell = std::clamp(int(s), 0, n - 2);
    return std::min(cell / degree * degree, n - 1 - degree);
  }
  /// Where the gradient of "element" is taken.
  static double centre(double s, int n) { return first(s, n) + 0.5 * degree; }

  static int weigh(double s, int n, Weights& w, Weights& dw) {
    const int from = first(s, n);
    const double t = s - from;
    for (int a = 0; a < count; ++a) {
      double value = 1, slope = 0;
      for (int b = 0; b < count; ++b) {
        if (b == a) continue;
        const double over = 1.0 / (a - b);
        slope = slope * (t - b) * over + value * over;
        value *= (t - b) * over;
      }
      w[std::size_t(a)] = value;
      dw[std::size_t(a)] = slope;
    }
    return from;
  }
};

/// B-splines through the nodal values (coefficients by interpolate() in spline_filter.hpp): continuous to the
/// derivative of degree - 1 over the whole grid. Order of values degree + 1, of gradients degree.
template <int degree>
struct Spline {
  static_assert(degree == 2 || degree == 3);
  static constexpr int count = degree + 1;
  static constexpr int ghosts = 1;
  static constexpr int least_nodes = degree + 1;
  using Weights = std::array<double, std::size_t(count)>;

  static double centre(double s, int n) { return std::clamp(int(s), 0, n - 2) + 0.5; }

  static int weigh(double s, int n, Weights& w, Weights& dw) {
    if constexpr (degree == 2) {
      const int middle = std::clamp(int(std::floor(s + 0.5)), 0, n - 1);  // the nearest node
      const double t = s - middle;
      w = {0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)};
      dw = {t - 0.5, -2 * t, t + 0.5};
      return middle - 1;
    } else {
      const int cell = std::clamp(int(std::floor(s)), 0, n - 2);
      const double t = s - cell, r = 1 - t;
      constexpr double sixth = 1.0 / 6;
      w = {r * r * r * sixth, (4 - 6 * t * t + 3 * t * t * t) * sixth, (4 - 6 * r * r + 3 * r * r * r) * sixth,
           t * t * t * sixth};
      dw = {-0.5 * r * r, (-2 + 1.5 * t) * t, (2 - 1.5 * r) * r, 0.5 * t * t};
      return cell - 1;
    }
  }
};

}  // namespace pivnp::np
