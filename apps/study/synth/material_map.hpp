// Where the material between material points goes: what carries a texture with a simulation's own points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::app {

/// The map X -> x(X, t) through the displacements of material points, in their reference configuration: modified
/// Shepard interpolation (Franke & Nielson 1980, Renka 1988) of each point's own linear expansion,
///   u(X) = sum w_i (u_i + G_i (X - X_i)) / sum w_i,   w_i = ((R - r_i) / (R r_i))^2 for r_i < R, else 0,
/// with G_i the least-squares gradient over the points around i, weights 1/r^2. Exact at every material point (there the
/// map is that of the simulation to the last bit of its record) and for linear fields, and smooth between. R and the
/// reach of G_i are 1.7 and 2.3 spacings. Points of another label take no part: material does not stick across a contact.
class MaterialMap {
 public:
  explicit MaterialMap(const ParticleSet& points);

  /// What a place of the material is carried by; fixed as long as its points are followed.
  struct Stencil {
    Vec2 X = Vec2::Zero();
    std::vector<std::uint32_t> point;
    std::vector<double> weight;  // not yet normalised: points that end are left out
  };
  /// Nothing farther than R from every point.
  std::optional<Stencil> stencil(const Vec2& X) const;

  /// The points at one time.
  void set(const MotionFrame& frame);
  /// NaN where none of the points is followed any more.
  Vec2 at(const Stencil& stencil) const;
  /// Deformation gradient: the points' own, by the same weights; identity where at() is NaN.
  Mat2 F(const Stencil& stencil) const;

  double spacing() const { return spacing_; }

 private:
  std::vector<std::uint32_t> around(const Vec2& X, double reach) const;

  std::vector<Vec2> X_;
  std::vector<std::int32_t> label_;
  double spacing_ = 1;
  Vec2 lower_ = Vec2::Zero();
  int nx_ = 1, ny_ = 1;
  std::vector<std::vector<std::uint32_t>> cells_;      // of 2.3 spacings
  std::vector<std::vector<std::uint32_t>> neighbours_;  // of each point, for its gradient

  std::vector<Vec2> u_;
  std::vector<Mat2> G_, F_;
  std::vector<std::uint8_t> followed_;
};

}  // namespace pivnp::app
