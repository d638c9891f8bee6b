// Deformation gradients of particles whose source gives displacements only.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp {

/// F = I + du/dX by least squares over the neighbours of each particle in the material configuration: the affine field
/// that fits u_q - u_p of the `neighbours` nearest best, weighted by exp(-2 r^2 / R^2), R the distance of the furthest.
/// Exact for affine motions; its gauge length is about the diameter of twelve neighbours, two and a half spacings of a
/// square lattice. NaN where fewer than three neighbours can be used or they lie on a line.
class DisplacementGradient {
 public:
  static constexpr int neighbours = 12;

  explicit DisplacementGradient(const std::vector<Vec2>& X);

  /// `u`: displacements; `since`: the time that u counts from, by a number above 0; 0 where u is not known (NaN there).
  /// Only displacements since the same time are held against each other. F: xx xy yx yy.
  std::vector<std::array<float, 4>> gradients(const std::vector<std::array<float, 2>>& u,
                                              const std::vector<std::int32_t>& since) const;

 private:
  std::vector<Vec2> X_;
  std::vector<std::array<std::int32_t, neighbours>> nearest_;  // -1: fewer
};

}  // namespace pivnp
