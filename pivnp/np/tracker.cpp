#include "pivnp/np/tracker.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/np/gather.hpp"

namespace pivnp::np {

namespace {

constexpr std::size_t few = 4096;  // particles not worth waking threads for

void check_options(const NpOptions& options) {
  if (options.gradient != "particle" && options.gradient != "element")
    throw InputError("np.gradient: found '" + options.gradient + "', expected particle or element");
  if (!(options.error_correlation >= 0 && options.error_correlation <= 1))
    throw InputError("np.error_correlation: found " + std::to_string(options.error_correlation) + ", expected 0 to 1");
}

void check_particles(const ParticleSet& set) {
  const std::size_t count = set.size();
  if (set.x0.size() != count || set.label.size() != count || set.area.size() != count || set.born.size() != count ||
      set.end.size() != count || set.end_reason.size() != count)
    throw InputError("np: particle set: arrays of unequal length, expected " + std::to_string(count) + " entries each");
  for (std::size_t p = 0; p < count; ++p)
    if (!set.x0[p].allFinite())
      throw InputError("np: particle " + std::to_string(set.id[p]) + ": its position is not a finite number");
}

template <class Field>
void check_field(const Field& field) {
  const Grid& g = field.grid;
  if (g.nx < 2 || g.ny < 2 || !(g.spacing.x() > 0) || !(g.spacing.y() > 0))
    throw InputError("np: vectors: found a grid of " + std::to_string(g.nx) + " x " + std::to_string(g.ny) +
                     " nodes, expected at least 2 x 2 and spacings above zero");
  const std::size_t count = g.node_count();
  if (field.displacement.size() != count || field.status.size() != count ||
      (!field.cov.empty() && field.cov.size() != count))
    throw InputError("np: vectors: found " + std::to_string(field.displacement.size()) + " displacements, " +
                     std::to_string(field.status.size()) + " status values and " + std::to_string(field.cov.size()) +
                     " covariances, expected " + std::to_string(count) + " of each");
}

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

EndReason reason_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::left_grid: return EndReason::left_grid;
    case Outcome::no_vectors: return EndReason::no_vectors;
    case Outcome::no_solution: return EndReason::bad_state;
    case Outcome::good:
    case Outcome::unsettled: break;
  }
  return EndReason::none;
}

}  // namespace

Tracker::Tracker(const NpOptions& options, ParticleSet particles, double start_time)
    : options_(options), particles_(std::move(particles)), time_(start_time) {
  check_options(options_);
  check_particles(particles_);
  const std::size_t count = particles_.size();
  x_ = particles_.x0;
  F_.assign(count, Mat2::Identity());
  cov_.assign(count, {0, 0, 0});
  status_.resize(count);
  for (std::size_t p = 0; p < count; ++p)
    status_[p] = particles_.end_reason[p] != EndReason::none ? ParticleStatus::ended
                 : particles_.born[p] > start_time           ? ParticleStatus::unborn
                                                             : ParticleStatus::active;
}

void Tracker::step(const VectorField& field, double time) {
  check_field(field);
  advance(Nodes<float>{field.grid, field.anchor, field.displacement.data(), field.status.data(),
                       field.cov.empty() ? nullptr : field.cov.data()},
          time);
}

void Tracker::step(const Increments& field, double time) {
  check_field(field);
  advance(Nodes<double>{field.grid, field.anchor, field.displacement.data(), field.status.data(),
                        field.cov.empty() ? nullptr : field.cov.data()},
          time);
}

void Tracker::end(std::size_t p, EndReason reason) {
  status_[p] = ParticleStatus::ended;
  particles_.end[p] = time_;
  particles_.end_reason[p] = reason;
}

template <class Real>
void Tracker::advance(const Nodes<Real>& nodes, double time) {
  if (!(time > time_))
    throw InputError("np: a step to time " + std::to_string(time) + ", expected one after " + std::to_string(time_));
  support_.build(nodes);
  const Gather<Real> gather(nodes, support_, options_.gradient == "element", options_.error_correlation);
  const bool central = nodes.anchor == Anchor::central, with_cov = nodes.cov != nullptr;

#pragma omp parallel for schedule(static) if (x_.size() > few)
  for (std::ptrdiff_t n = 0; n < std::ptrdiff_t(x_.size()); ++n) {
    const std::size_t p = std::size_t(n);
    if (status_[p] == ParticleStatus::ended) continue;
    if (status_[p] == ParticleStatus::unborn) {
      if (particles_.born[p] <= time) status_[p] = ParticleStatus::active;
      continue;
    }
    const Reading r = central ? gather.central(x_[p]) : gather.forward(x_[p]);
    if (const EndReason reason = reason_of(r.outcome); reason != EndReason::none) {
      end(p, reason);
      continue;
    }
    const double x = x_[p].x() + r.dx, y = x_[p].y() + r.dy;
    const Tensor f = step_gradient(r, central), F = f * tensor(F_[p]);
    if (!good_state(x, y, F)) {
      end(p, EndReason::bad_state);
      continue;
    }
    if (with_cov) {
      const auto before = carried(f, cov_[p]);
      // K = (I - G/2)^-1 = (I + f)/2 for central vectors
      const auto added = central ? carried({0.5 + 0.5 * f.xx, 0.5 * f.xy, 0.5 * f.yx, 0.5 + 0.5 * f.yy}, r.cov) : r.cov;
      for (std::size_t k = 0; k < 3; ++k) cov_[p][k] = before[k] + added[k];
    }
    x_[p] = {x, y};
    F_[p](0, 0) = F.xx;
    F_[p](0, 1) = F.xy;
    F_[p](1, 0) = F.yx;
    F_[p](1, 1) = F.yy;
    status_[p] = r.support == Support::measured && r.outcome == Outcome::good ? ParticleStatus::active
                                                                             : ParticleStatus::doubtful;
  }
  time_ = time;
  cov_known_ = cov_known_ && with_cov;
}

MotionFrame Tracker::frame() const {
  MotionFrame out;
  const std::size_t count = x_.size();
  out.time = time_;
  out.status = status_;
  out.u.resize(count);
  out.F.resize(count);
  if (cov_known_) out.cov_u.resize(count);
  for (std::size_t p = 0; p < count; ++p) {
    const Vec2 u = x_[p] - particles_.x0[p];
    out.u[p] = {float(u.x()), float(u.y())};
    out.F[p] = {float(F_[p](0, 0)), float(F_[p](0, 1)), float(F_[p](1, 0)), float(F_[p](1, 1))};
    if (cov_known_) out.cov_u[p] = {float(cov_[p][0]), float(cov_[p][1]), float(cov_[p][2])};
  }
  return out;
}

}  // namespace pivnp::np
