// A displacement field as a cubic B-spline on an even lattice of whole pixels: what the dense warps follow.
#pragma once

#include <array>
#include <vector>

namespace pivnp::piv {

/// Points (x0 + i step, y0 + j step), 0 <= i < nx, 0 <= j < ny, in pixels of a level, row downward. They may lie
/// outside the image.
struct CellLattice {
  int nx = 0, ny = 0;
  int x0 = 0, y0 = 0, step = 8;
  std::size_t size() const { return std::size_t(nx) * std::size_t(ny); }
  std::size_t index(int i, int j) const { return std::size_t(j) * std::size_t(nx) + std::size_t(i); }
};

/// Interpolates vectors given at the lattice's points, twice continuously differentiable; natural ends (no curvature at
/// the outermost points), beyond which it goes on linearly. Source: Unser, Aldroubi & Eden 1993.
class SplineField {
 public:
  /// `u`, `v`: components at the points, [ny][nx].
  void interpolate(const CellLattice& lattice, const std::vector<float>& u, const std::vector<float>& v,
                   int threads);
  /// Components at (x, y), level pixels.
  std::array<float, 2> at(float x, float y) const;

  const CellLattice& lattice() const { return lattice_; }
  /// Coefficients in columns of the lattice, from one ghost before the first to one behind the last, of the spline
  /// along x at row y (pixels); each line holds nx + 2 values.
  void row_coefficients(float y, float* u, float* v) const;

 private:
  CellLattice lattice_;
  std::vector<float> u_, v_;  // [ny + 2][nx + 2], one ring of ghosts
};

/// Cubic B-spline weights of the four coefficients about a place `t` in 0 ... 1 of its cell.
std::array<float, 4> cubic_weights(float t);

}  // namespace pivnp::piv
