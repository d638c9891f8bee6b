// Motions known in closed form, sampled at nodes as a perfect measurement would see them: the ground truth the tracker
// is judged by. Nothing here uses the tracker, its gather or its shape functions.
#pragma once

#include <functional>

#include "pivnp/core/math.hpp"
#include "pivnp/np/increments.hpp"

namespace pivnp::np {

/// x = A X + b.
struct AffineMap {
  Mat2 A = Mat2::Identity();
  Vec2 b = Vec2::Zero();
};

/// Where the material that is at X at time 0 is at time t, exactly, and how it is deformed.
class AnalyticMotion {
 public:
  virtual ~AnalyticMotion() = default;
  virtual Vec2 position(const Vec2& X, double t) const = 0;
  virtual Mat2 deformation(const Vec2& X, double t) const = 0;  // F
  /// d of the material that is at x at time t0: forward anchor.
  virtual Vec2 forward_increment(const Vec2& x, double t0, double t1) const = 0;
  /// d of the material whose path from t0 to t1 has its mid-point (x0 + x1)/2 at xm: central anchor.
  virtual Vec2 central_increment(const Vec2& xm, double t0, double t1) const = 0;
};

/// A homogeneous motion, given by its map at every time; map(0) need not be the identity.
class AffineMotion final : public AnalyticMotion {
 public:
  explicit AffineMotion(std::function<AffineMap(double t)> map) : map_(std::move(map)) {}

  /// `rate` is the Eulerian increment of one unit of time: x grows by the factor (1 + rate) about x = `fixed`.
  static AffineMotion extension(double rate, double fixed);
  /// u_x = rate t (Y - fixed): simple shear.
  static AffineMotion shear(double rate, double fixed);
  /// A turn by `angle_rate` t about `centre`, which itself moves by `velocity` t.
  static AffineMotion rotation(double angle_rate, const Vec2& centre, const Vec2& velocity = Vec2::Zero());

  Vec2 position(const Vec2& X, double t) const override;
  Mat2 deformation(const Vec2& X, double t) const override;
  Vec2 forward_increment(const Vec2& x, double t0, double t1) const override;
  Vec2 central_increment(const Vec2& xm, double t0, double t1) const override;

 private:
  AffineMap step(double t0, double t1) const;  // from the place at t0 to the place at t1
  std::function<AffineMap(double)> map_;
};

/// A vortex that winds up and unwinds: the material at distance r from the centre is turned by
///   phi(r, t) = turn exp(-(r/radius)^2) sin(pi t / period),
/// so that everything is back, undeformed, at t = period. Distances from the centre are kept, which makes both anchors
/// solvable: the mid-point of a turn by phi lies at r cos(phi/2), half way in angle, and d = 2 tan(phi/2) W xm, W the
/// quarter turn. Valid while one step turns by less than about a radian.
class ReversingVortex final : public AnalyticMotion {
 public:
  ReversingVortex(const Vec2& centre, double radius, double turn, double period)
      : centre_(centre), radius_(radius), turn_(turn), period_(period) {}

  Vec2 position(const Vec2& X, double t) const override;
  Mat2 deformation(const Vec2& X, double t) const override;
  Vec2 forward_increment(const Vec2& x, double t0, double t1) const override;
  Vec2 central_increment(const Vec2& xm, double t0, double t1) const override;

 private:
  double angle(double r, double t) const;
  Vec2 centre_;
  double radius_, turn_, period_;
};

/// A shear band along x about y = middle: u_x = rate t half_width tanh((Y - middle)/half_width), steepest by rate t.
/// Heights are kept, so both anchors are the same.
class ShearBand final : public AnalyticMotion {
 public:
  ShearBand(double rate, double middle, double half_width) : rate_(rate), middle_(middle), half_width_(half_width) {}

  Vec2 position(const Vec2& X, double t) const override;
  Mat2 deformation(const Vec2& X, double t) const override;
  Vec2 forward_increment(const Vec2& x, double t0, double t1) const override;
  Vec2 central_increment(const Vec2& xm, double t0, double t1) const override;

 private:
  double rate_, middle_, half_width_;
};

/// The motion from t0 to t1 at every node, all valid, without covariance.
NodalIncrements sample_increments(const AnalyticMotion& motion, const Grid& grid, Anchor anchor, double t0, double t1);

}  // namespace pivnp::np
