// How a step moves one particle, whatever the shape functions: Tracker's templates and their arithmetic.
#pragma once

#include <cmath>
#include <limits>

#include "pivnp/np/gather.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::np {

constexpr std::size_t few = 4096;  // particles not worth waking threads for

// The inner loop works on plain numbers: a matrix written number by number and read back as a packet stalls.
struct Tensor {
  double xx, xy, yx, yy;
};

inline Tensor tensor(const Mat2& m) { return {m(0, 0), m(0, 1), m(1, 0), m(1, 1)}; }

inline Tensor operator*(const Tensor& a, const Tensor& b) {
  return {a.xx * b.xx + a.xy * b.yx, a.xx * b.xy + a.xy * b.yy, a.yx * b.xx + a.yy * b.yx, a.yx * b.xy + a.yy * b.yy};
}

// f = F1 F0^-1 of one step. Central: (I - G/2)^-1 (I + G/2); in the plane, with A = G/2, that is
// ((1 - tr A - det A) I + 2 A) / (1 - tr A + det A). NaN if a half step turns the material inside out.
inline Tensor step_gradient(const Reading& r, bool central) {
  if (!central) return {1 + r.gxx, r.gxy, r.gyx, 1 + r.gyy};
  const double trace = 0.5 * (r.gxx + r.gyy), det = 0.25 * (r.gxx * r.gyy - r.gxy * r.gyx);
  const double below = 1 - trace + det;
  const double s = below > 0 ? 1 / below : std::numeric_limits<double>::quiet_NaN();
  const double diagonal = 1 - trace - det;
  return {(diagonal + r.gxx) * s, r.gxy * s, r.gyx * s, (diagonal + r.gyy) * s};
}

// A C A^T of a symmetric C = (uu, vv, uv).
inline std::array<double, 3> carried(const Tensor& A, const std::array<double, 3>& C) {
  const double u0 = A.xx * C[0] + A.xy * C[2], u1 = A.xx * C[2] + A.xy * C[1];
  const double v0 = A.yx * C[0] + A.yy * C[2], v1 = A.yx * C[2] + A.yy * C[1];
  return {u0 * A.xx + u1 * A.xy, v0 * A.yx + v1 * A.yy, u0 * A.yx + u1 * A.yy};
}

inline bool good_state(double x, double y, const Tensor& F) {
  const double J = F.xx * F.yy - F.xy * F.yx;
  // One test for all: a number that is not finite makes the sum so.
  return J > 0 && std::isfinite(J + (x + y) + (F.xx + F.xy) + (F.yx + F.yy));
}

inline EndReason reason_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::left_grid: return EndReason::left_grid;
    case Outcome::no_vectors: return EndReason::no_vectors;
    case Outcome::no_solution: return EndReason::bad_state;
    case Outcome::good:
    case Outcome::unsettled: break;
  }
  return EndReason::none;
}

template <class GatherType>
void Tracker::carry_one(const GatherType& gather, std::size_t p, bool central, bool with_cov, double time) {
  if (status_[p] == ParticleStatus::ended) return;
  if (status_[p] == ParticleStatus::unborn) {
    if (particles_.born[p] <= time) status_[p] = ParticleStatus::active;
    return;
  }
  const Reading r = central ? gather.central(x_[p]) : gather.forward(x_[p]);
  if (const EndReason reason = reason_of(r.outcome); reason != EndReason::none) return end(p, reason);
  const double x = x_[p].x() + r.dx, y = x_[p].y() + r.dy;
  const Tensor f = step_gradient(r, central), F = f * tensor(F_[p]);
  if (!good_state(x, y, F)) return end(p, EndReason::bad_state);
  if (with_cov) {
    // K = (I - G/2)^-1 = (I + f)/2 for central vectors
    const Tensor K = central ? Tensor{0.5 + 0.5 * f.xx, 0.5 * f.xy, 0.5 * f.yx, 0.5 + 0.5 * f.yy} : Tensor{1, 0, 0, 1};
    const auto before = carried(f, cov_[p]), added = central ? carried(K, r.cov) : r.cov;
    for (std::size_t k = 0; k < 3; ++k) cov_[p][k] = before[k] + added[k];
    bias_[p] = {(f.xx * bias_[p].x() + f.xy * bias_[p].y()) + (K.xx * r.bx + K.xy * r.by),
                (f.yx * bias_[p].x() + f.yy * bias_[p].y()) + (K.yx * r.bx + K.yy * r.by)};
    const double grown = 0.5 * ((f.xx * f.xx + f.xy * f.xy) + (f.yx * f.yx + f.yy * f.yy)), g = r.gradient_variance;
    const Tensor F0 = tensor(F_[p]);
    cov_F_[p] = {grown * cov_F_[p][0] + g * (F0.xx * F0.xx + F0.yx * F0.yx),
                 grown * cov_F_[p][1] + g * (F0.xy * F0.xy + F0.yy * F0.yy),
                 grown * cov_F_[p][2] + g * (F0.xx * F0.xy + F0.yx * F0.yy)};
  }
  x_[p] = {x, y};
  F_[p](0, 0) = F.xx;
  F_[p](0, 1) = F.xy;
  F_[p](1, 0) = F.yx;
  F_[p](1, 1) = F.yy;
  const bool good = r.support == Support::measured && r.outcome == Outcome::good && !biased(p);
  status_[p] = good ? ParticleStatus::active : ParticleStatus::flagged;
}

template <class GatherType>
void Tracker::carry(const GatherType& gather, bool central, bool with_cov, double time) {
#pragma omp parallel for schedule(static) if (x_.size() > few)
  for (std::ptrdiff_t n = 0; n < std::ptrdiff_t(x_.size()); ++n)
    carry_one(gather, std::size_t(n), central, with_cov, time);
  finish_step(with_cov, time);
}

}  // namespace pivnp::np
