// The area a data set covers: triangles of its particles, grown by half a spacing, on a fine lattice; and its outline.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "compare/data/data_set.hpp"
#include "compare/data/rigid.hpp"
#include "compare/data/triangulation.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::compare {

/// A data set's particles as a piece of material, where they are at its present state, in the frame of the comparison.
MaterialMesh present_mesh(const DataSet& set, const RigidMotion& frame);

/// Square cells; cell (i, j) has its centre at first + (i, j) cell.
struct Lattice {
  Vec2 first = Vec2::Zero();
  double cell = 1;
  int nx = 0, ny = 0;

  Vec2 centre(int i, int j) const { return first + cell * Vec2(i, j); }
  std::size_t index(int i, int j) const { return std::size_t(j) * std::size_t(nx) + std::size_t(i); }
};

/// Lattice around both meshes with a margin for `grow` and for closed outlines; cells are made larger if there would be
/// more than 2^22. With `base_y`, that height lies between two rows of cells.
Lattice lattice_around(const MaterialMesh& first, const MaterialMesh& second, double cell, double grow,
                       std::optional<double> base_y);

/// `grow` minus the distance of each cell's centre from the mesh's triangles; -2 cells wherever it is less. The outline
/// is where it is zero. Points without a triangle cover nothing.
struct Cover {
  Lattice lattice;
  std::vector<float> level;

  /// Share of the cell that is covered, from the level at its centre: exact for an edge along the lattice.
  double share(std::size_t index) const;
};
Cover cover(const MaterialMesh& mesh, double grow, const Lattice& lattice);

/// Area common to both and area of either, length^2. The lattices must be the same.
struct Overlap {
  double common = 0, either = 0;
};
Overlap overlap(const Cover& first, const Cover& second);

/// The zero line of the level by marching squares, linear between cell centres. Each ring ends on its first point and
/// keeps the material to its left.
std::vector<std::vector<Vec2>> outline(const Cover& cover);
double length_of(const std::vector<std::vector<Vec2>>& rings);

/// Points on the rings, at most `step` apart, each side's first end included.
std::vector<Vec2> points_along(const std::vector<std::vector<Vec2>>& rings, double step);

}  // namespace pivnp::compare
