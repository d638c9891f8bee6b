// Where an element has lost nodes: an affine field fitted to the usable nodes around it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "pivnp/core/math.hpp"

namespace pivnp::np {

/// Weighted least squares of an affine field over the usable nodes among the 4 x 4 of an element and the ring around
/// it. Coordinates are natural: (xi, eta) in spacings from the element's lower left node. The weight of a node at
/// distance r from the element's centre is 1 / (1 + r^2)^2, so the fit belongs to the element, not to the particle:
/// all its particles see one affine field. Exact for affine fields whichever nodes are left.
struct LocalFit {
  /// Position of node `k` = 4 b + a of the 4 x 4: (a - 1, b - 1).
  static Vec2 place(int k) { return {k % 4 - 1.0, k / 4 - 1.0}; }
  static double weight(int k);

  /// Fits `values` (those whose bit is set in `nodes`; the others are not read). Nothing if fewer than three nodes are
  /// given or if they lie on one line.
  static std::optional<LocalFit> of(std::uint16_t nodes, const std::array<std::array<double, 2>, 16>& values);

  /// How far, in spacings, a particle outside the hull of the fitted nodes may be from the nearest of them: the
  /// diagonal of an element, so that one node left in the particle's own element is enough.
  static constexpr double reach = 1.4142135623730951;

  /// True if (xi, eta) lies in the convex hull of the fitted nodes or within `reach` of one of them; further out would
  /// be free extrapolation.
  bool reaches(double xi, double eta) const;

  /// How much node `k` counts at (xi, eta): the fitted value there is sum influence_k value_k; they sum to 1.
  double influence(int k, double xi, double eta) const;

  std::uint16_t nodes = 0;               // bit k: node k is used
  Vec2 centroid = Vec2::Zero();          // weighted, natural
  Mat2 inverse_scatter = Mat2::Zero();   // of the weighted positions about the centroid
  double weight_sum = 0;
  Vec2 value = Vec2::Zero();             // at the centroid, length
  Mat2 slope = Mat2::Zero();             // column 0 per unit of xi, column 1 per unit of eta, length
  std::array<double, 3> misfit{0, 0, 0};  // covariance of what the affine field leaves (uu, vv, uv); 0 with 3 nodes
};

}  // namespace pivnp::np
