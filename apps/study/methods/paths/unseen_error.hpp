// Of the errors of summed paths, what a subset that deforms with them cannot find.
#pragma once

#include <cstddef>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/np/errors/bend_loss.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::app {

/// A subset takes over from the path field how it bends, and finds the affine part A e of the paths' error e alone. At
/// its centre the direct estimate is therefore off by
///   q + S r,    q = (Q - A) e,  r = e - Q e,
/// Q being the quadratic fit over the subset and S the share by which the estimate is put where the path field is
/// beside that fit. Summed paths are off by the same q and r, and by A e, so that the direct estimate tells nothing of
/// q + S r. These are variances of q, of r and their covariance, for errors of variance one whose correlation is
/// exp(-d^2/(2 alike^2)), over an evenly filled square; none where `alike` is 0, not known.
/// docs/theory/particles_error.md, "What a subset cannot find".
struct UnseenShares {
  double bend = 0, mixed = 0, beyond = 0;
};
UnseenShares unseen_shares(double half_side, double alike);

/// The length `alike` of what is summed of such vectors, of a correlation in windows of that side, in the unit of the
/// field. Of pairs that were smoothed together it was measured: with windows of 32 px the variance of the gradient's
/// errors is that of the path's over (7.2 px)^2. Of other pairs it follows from what np::ReadingErrors states of the
/// gradient, 2 C/l^2. Where no l is known, covariances are bounds for errors that neighbours share: 0.
double paths_alike(const VectorField& field, double window);

/// Covariances of q and r (r q^T) of one particle's place.
struct UnseenError {
  Mat2 bend = Mat2::Zero(), mixed = Mat2::Zero(), beyond = Mat2::Zero();

  void add(const UnseenShares& shares, const Mat2& covariance);
  /// Of q + S r.
  Mat2 taken(const Mat2& S) const;
  /// With material whose deformation since is f.
  UnseenError carried(const Mat2& f) const;
  /// What has been added since `before`, which is carried to now.
  UnseenError since(const UnseenError& before) const;
  /// And what has been added since.
  UnseenError with(const UnseenError& since) const;
  /// Of r, M r is left.
  void reduce(const Mat2& M);
};

/// Of all particles of a tracker.
class UnseenErrors {
 public:
  /// What paths have become uncertain by since the last call of mark() is added, but for what bends have lost, which is
  /// known with its sign.
  void grow(const np::Tracker& tracker, const np::BendLoss& lost, const UnseenShares& shares);
  void mark(const np::Tracker& tracker, const np::BendLoss& lost);
  UnseenError& operator[](std::size_t p) { return errors_[p]; }
  const std::vector<UnseenError>& all() const { return errors_; }

 private:
  struct Mark {
    Mat2 F, random;
    Vec2 lost;
  };
  std::vector<UnseenError> errors_;
  std::vector<Mark> marks_;
};

}  // namespace pivnp::app
