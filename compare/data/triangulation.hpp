// Scattered particles as a piece of material: the Delaunay triangles that do not bridge gaps.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::compare {

/// A point of the material, written by the particles around it.
struct Location {
  std::array<int, 3> vertex{-1, -1, -1};  // indices into the points; -1 where the weight is zero
  std::array<double, 3> weight{0, 0, 0};  // not negative, sum 1
  Vec2 beyond = Vec2::Zero();             // from the point so written to the one asked for; zero inside the material
};

/// A point of the material, written by all particles whose Voronoi cells it would take from.
struct Natural {
  struct Share {
    int point;
    double weight;  // above zero, sum 1
    Vec2 from;      // to the point so written
  };
  struct Term {
    int point;
    double weight;
  };
  std::vector<Share> shares;
  /// For fields whose gradient is not carried: sum w_i f_i plus these terms (sum 0) is exact to the second degree. They
  /// are sum w_i grad f_i . from / 2 with the gradients that the particles around i give (gradient_stencil, two rings
  /// of triangles). Empty where one of them is not to be had.
  std::vector<Term> curving;
  Vec2 beyond = Vec2::Zero();  // as in Location

  /// Whether all particles that it is written by are marked.
  bool rests_on(const std::vector<std::uint8_t>& marked) const;
  /// Point k becomes index[k].
  void renumber(const std::vector<int>& index);
};

/// The alpha complex of a set of points (Edelsbrunner, Kirkpatrick & Seidel 1983): the Delaunay triangles (CGAL) whose
/// circumradius is at most `alpha_ratio` times the mean spacing of their three points. On a square lattice this spans a
/// hole of one lost particle, or of two neighbours, and no larger one. Coinciding points count once.
class MaterialMesh {
 public:
  static constexpr double alpha_ratio = 1.2;

  /// `spacing`: one positive length a point, its distance to its neighbours.
  MaterialMesh(std::vector<Vec2> points, std::vector<double> spacing);
  ~MaterialMesh();
  MaterialMesh(MaterialMesh&&) noexcept;
  MaterialMesh& operator=(MaterialMesh&&) noexcept;

  /// Linear weights in the triangle that holds `x`; else those of the nearest point of the material's edge, if that is
  /// nearer than half the local spacing; else nothing. Quick if consecutive points are near each other.
  std::optional<Location> find(const Vec2& x) const;

  /// The same by natural neighbours: Sibson's coordinates (Sibson 1981; CGAL), each neighbour weighted by the area that
  /// a point at `x` would take from its Voronoi cell. No choice between the diagonals of a square. Only inside the
  /// material: where a circle through three neighbours reaches over a triangle that is not kept (a gap, the edge), the
  /// weights are those of find(). Not from several threads at once: gradients are kept.
  std::optional<Natural> find_natural(const Vec2& x) const;

  const std::vector<Vec2>& points() const;
  /// Triangles kept, counter-clockwise.
  const std::vector<std::array<int, 3>>& triangles() const;
  /// Sides that belong to one triangle only. A point without any triangle appears as (a, a).
  const std::vector<std::array<int, 2>>& boundary() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Median distance of a point to its nearest neighbour; 0 for fewer than two points.
double median_neighbour_distance(const std::vector<Vec2>& points);

}  // namespace pivnp::compare
