// What smoothing takes off a field that bends, along the paths of particles.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "pivnp/core/record/vectors.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::np {

/// Vectors that were smoothed are off by l^2 times the Laplacian of the field, by Taylor's series; where the field
/// bends in the same way in pair after pair, that adds up along a path,
///   b1 = f b0 + K l^2 laplacian(d),   f, K: as in Tracker, to first order in the increment's gradient.
/// l is known by its magnitude alone (its square, what is expected of a share that varies), so that b is one standard
/// deviation with the sign of what is read less what is there. It is not added to any covariance: vectors that state
/// this error hold it in theirs. F loses with it
///   B1 = f B0 + l^2 K grad(laplacian(d)) K F0,
/// of which cov_F holds B^T B: an error of one row as of both. docs/theory/particles_error.md, "What bends lose".
class BendLoss {
 public:
  /// l for vectors of a correlation in windows of that side, in the unit of the field: a quarter of a cell, which is a
  /// quarter of the window, for pairs that were smoothed together (they alone state what bends lose); 0: not known.
  static double length_of(const VectorField& field, double window);

  /// Of so many particles, zero.
  explicit BendLoss(std::size_t count) : lost_(count, Vec2::Zero()), lost_F_(count, Mat2::Zero()), before_(count) {}

  /// Notes where the particles are, and F: to be called before each of the tracker's steps.
  void before_step(const Tracker& tracker);
  /// After the step by `field`. `length`: l, in the unit of the field; 0: not known, nothing is added. Particles that
  /// are alive are flagged where |b| exceeds both least_share l and half of the stated deviation of their place.
  void after_step(Tracker& tracker, const VectorField& field, double length);

  const Vec2& lost(std::size_t p) const { return lost_[p]; }
  /// Of F nothing is known to be lost from here on but what its covariance holds.
  void correct(std::size_t p, const Vec2& lost) { lost_[p] = lost, lost_F_[p].setZero(); }

  /// The state, behind `bytes`; and taken off their end again. Throws InputError for bytes that hold none.
  void save(std::vector<std::byte>& bytes) const;
  void load(std::vector<std::byte>& bytes);

  /// For l a quarter of a cell of the correlation this is 1/64 of the cell, as Tracker::least_bias is of a spacing.
  static constexpr double least_share = 1.0 / 16;

 private:
  void bend(const VectorField& field);

  std::vector<Vec2> lost_;
  std::vector<Mat2> lost_F_;
  struct Before {
    Vec2 x;
    Mat2 F;
  };
  std::vector<Before> before_;
  std::vector<std::array<float, 2>> values_,
      bends_;  // [ny][nx]: displacement, NaN where it is not usable; its Laplacian, sharpened
};

}  // namespace pivnp::np
