#include "pivnp/np/tracker.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/np/carry.hpp"
#include "pivnp/np/tensor_field.hpp"
#include "pivnp/np/triangle_gather.hpp"

namespace pivnp::np {

namespace {

void check_options(const NpOptions& options) {
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
  if constexpr (std::is_same_v<Field, VectorField>)
    if (!field.path_factor.empty() && field.path_factor.size() != count)
      throw InputError("np: vectors: found " + std::to_string(field.path_factor.size()) + " path factors, expected " + std::to_string(count) + " or none");
}

const float* field_factor(const VectorField& field) { return field.path_factor.empty() ? nullptr : field.path_factor.data(); }

}  // namespace

Tracker::Tracker(const NpOptions& options, ParticleSet particles, double start_time)
    : options_(options), particles_(std::move(particles)), time_(start_time), reading_(options.shape) {
  check_options(options_);
  check_particles(particles_);
  const std::size_t count = particles_.size();
  x_ = particles_.x0;
  F_.assign(count, Mat2::Identity());
  cov_.assign(count, {0, 0, 0});
  bias_.assign(count, Vec2::Zero());
  cov_F_.assign(count, {0, 0, 0});
  status_.resize(count);
  for (std::size_t p = 0; p < count; ++p)
    status_[p] = particles_.end_reason[p] != EndReason::none ? ParticleStatus::ended
                 : particles_.born[p] > start_time           ? ParticleStatus::unborn
                                                             : ParticleStatus::active;
}

void Tracker::step(const VectorField& field, double time) {
  check_field(field);
  advance(Nodes<float>{field.grid, field.anchor, field.displacement.data(), field.status.data(),
                       field.cov.empty() ? nullptr : field.cov.data(), field.correlation_length, 1, field_factor(field)},
          time);
}

void Tracker::step(const NodalIncrements& field, double time) {
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
void Tracker::advance(const Nodes<Real>& given, double time) {
  if (!(time > time_))
    throw InputError("np: a step to time " + std::to_string(time) + ", expected one after " + std::to_string(time_));
  support_.build(given);
  Nodes<Real> nodes = given;
  nodes.step = ++steps_;
  if (nodes.cov != nullptr) nodes.errors = reading_.of(nodes, support_).data();
  bias_limit_ = least_bias * nodes.grid.spacing.minCoeff();
  const bool centre = options_.gradient == GradientPlace::element, central = nodes.anchor == Anchor::central;
  const bool with_cov = nodes.cov != nullptr;
  const double correlation = options_.error_correlation;
  const auto with = [&](const auto& gather) { carry(gather, central, with_cov, time); };
  if (options_.shape == ShapeFunctions::quadratic)
    with(TensorGather<Lagrange<2>, Real>(nodes, support_, centre, correlation));
  else if (options_.shape == ShapeFunctions::cubic)
    with(TensorGather<Lagrange<3>, Real>(nodes, support_, centre, correlation));
  else if (options_.shape == ShapeFunctions::bspline2)
    with(TensorGather<Spline<2>, Real>(nodes, support_, centre, correlation));
  else if (options_.shape == ShapeFunctions::triangles)
    with(GridTriangles<Real>(nodes, support_, centre, correlation));
  else if (options_.shape == ShapeFunctions::bspline3) {
    const TensorGather<Spline<3>, Real> gather(nodes, support_, centre, correlation);
    if constexpr (std::is_same_v<Real, float>)
      if (gather.smooth() && (!with_cov || correlation == 1)) return carry_fast(gather, nodes, gather.coefficients(), time);
    with(gather);
  } else {
    const Gather<Real> gather(nodes, support_, centre, correlation);
    if constexpr (std::is_same_v<Real, float>) return carry_fast(gather, nodes, {}, time);
    with(gather);
  }
}

namespace {

std::uint64_t packed(float lower, float upper) {
  return std::uint64_t(std::bit_cast<std::uint32_t>(upper)) << 32 | std::bit_cast<std::uint32_t>(lower);
}

}  // namespace

// Whole blocks at a time, and one by one whatever these leave. `coefficients` of cubic splines; none: bilinear.
template <class GatherType>
void Tracker::carry_fast(const GatherType& gather, const Nodes<float>& nodes,
                         std::span<const std::array<double, 2>> coefficients, double time) {
  const Grid& grid = nodes.grid;
  fast_.origin_x = grid.origin.x(), fast_.origin_y = grid.origin.y();
  fast_.per_spacing_x = 1 / grid.spacing.x(), fast_.per_spacing_y = 1 / grid.spacing.y();
  fast_.nx = grid.nx, fast_.ny = grid.ny;
  fast_.central = nodes.anchor == Anchor::central;
  fast_.centre_gradient = options_.gradient == GradientPlace::element;
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  const bool spline = !coefficients.empty();
  if (spline) {
    fast_.nodes.resize(coefficients.size());
    for (std::size_t n = 0; n < coefficients.size(); ++n)
      fast_.nodes[n] = packed(float(coefficients[n][0]), float(coefficients[n][1]));
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i)
        if (support_.node_class(grid.node(i, j)) > 1)
          fast_.nodes[std::size_t(j + 1) * std::size_t(grid.nx + 2) + std::size_t(i + 1)] = packed(none, none);
  } else {
    fast_.nodes.resize(grid.node_count());
    for (std::size_t n = 0; n < grid.node_count(); ++n)
      fast_.nodes[n] = support_.node_class(n) > 1 ? packed(none, none)
                                                  : packed(nodes.displacement[n][0], nodes.displacement[n][1]);
  }
  const bool with_cov = nodes.cov != nullptr;
  fast_.error_correlation = options_.error_correlation;
  fast_.errors.resize(with_cov ? 3 * grid.element_count() : 0);
  for (std::size_t n = 0; with_cov && n < grid.element_count(); ++n) {
    const ElementError& e = nodes.errors[n];
    fast_.errors[3 * n] = packed(e.uu, e.vv);
    fast_.errors[3 * n + 1] = packed(e.uv, e.gradient);
    fast_.errors[3 * n + 2] = packed(e.u, e.v);
  }
  const std::size_t count = x_.size();
  moved_.resize(count);
  element_.resize(count);
  constexpr std::size_t block = 1024;
  static_assert(sizeof(Vec2) == 2 * sizeof(double) && sizeof(Mat2) == 4 * sizeof(double) && sizeof(ParticleStatus) == 1);
#pragma omp parallel for schedule(static) if (count > few)
  for (std::ptrdiff_t b = 0; b < std::ptrdiff_t((count + block - 1) / block); ++b) {
    const std::size_t from = std::size_t(b) * block, to = std::min(from + block, count);
    const FastParticles particles{x_[from].data(), F_[from].data(), cov_[from].data(), bias_[from].data(),
                                  cov_F_[from].data(), reinterpret_cast<const std::uint8_t*>(&status_[from]),
                                  to - from, &moved_[from], &element_[from]};
    spline ? fast_spline_step(fast_, particles) : fast_step(fast_, particles);
    for (std::size_t p = from; p < to; ++p) {
      if (moved_[p])
        status_[p] = gather.measured(std::size_t(element_[p])) && !biased(p) ? ParticleStatus::active
                                                                            : ParticleStatus::flagged;
      else
        carry_one(gather, p, fast_.central, with_cov, time);
    }
  }
  finish_step(with_cov, time);
}

std::array<double, 3> Tracker::total(std::size_t p) const {
  const Vec2& b = bias_[p];
  return {cov_[p][0] + b.x() * b.x(), cov_[p][1] + b.y() * b.y(), cov_[p][2] + b.x() * b.y()};
}

bool Tracker::biased(std::size_t p) const {
  const double square = bias_[p].squaredNorm();
  return square > bias_limit_ * bias_limit_ && square > cov_[p][0] + cov_[p][1];
}

void Tracker::finish_step(bool with_cov, double time) {
  time_ = time;
  cov_known_ = cov_known_ && with_cov;
}

void Tracker::step(const Scattered& field, double usual, double longest, double time) {
  const std::size_t count = field.place.size();
  if (field.displacement.size() != count || field.status.size() != count ||
      (!field.cov.empty() && field.cov.size() != count))
    throw InputError("np: vectors: found " + std::to_string(field.displacement.size()) + " displacements, " +
                     std::to_string(field.status.size()) + " status values and " + std::to_string(field.cov.size()) +
                     " covariances, expected " + std::to_string(count) + " of each");
  if (!(time > time_))
    throw InputError("np: a step to time " + std::to_string(time) + ", expected one after " + std::to_string(time_));
  carry(TriangleGather(field, usual, longest, options_.error_correlation), field.anchor == Anchor::central,
        !field.cov.empty(), time);
}

void Tracker::correct(std::size_t p, const Correction& to) {
  if (!good_state(to.x.x(), to.x.y(), tensor(to.F)))
    throw InputError("np: particle " + std::to_string(particles_.id[p]) + ": a correction that is no state");
  if (!alive(status_[p])) return;
  x_[p] = to.x;
  F_[p] = to.F;
  cov_[p] = to.random;
  bias_[p] = to.bias;
  cov_F_[p] = to.cov_F;
}

void Tracker::widen_F(std::size_t p, const std::array<double, 3>& by) {
  for (std::size_t k = 0; k < 3; ++k) cov_F_[p][k] += by[k];
}

void Tracker::add(const ParticleSet& born) {
  check_particles(born);
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(particles_.id, born.id);
  append(particles_.label, born.label);
  append(particles_.x0, born.x0);
  append(particles_.area, born.area);
  append(particles_.born, born.born);
  append(particles_.end, born.end);
  append(particles_.end_reason, born.end_reason);
  append(x_, born.x0);
  F_.resize(x_.size(), Mat2::Identity());
  cov_.resize(x_.size(), {0, 0, 0});
  bias_.resize(x_.size(), Vec2::Zero());
  cov_F_.resize(x_.size(), {0, 0, 0});
  status_.resize(x_.size(), ParticleStatus::active);
}

void Tracker::flag(std::size_t p) {
  if (status_[p] == ParticleStatus::active) status_[p] = ParticleStatus::flagged;
}

MotionFrame Tracker::frame() const {
  MotionFrame out;
  const std::size_t count = x_.size();
  out.time = time_;
  out.status = status_;
  out.u.resize(count);
  out.F.resize(count);
  std::span<float> cov_F;
  if (cov_known_) out.cov_u.resize(count), cov_F = out.add("cov_F", count);
  for (std::size_t p = 0; p < count; ++p) {
    const Vec2 u = x_[p] - particles_.x0[p];
    out.u[p] = {float(u.x()), float(u.y())};
    out.F[p] = {float(F_[p](0, 0)), float(F_[p](0, 1)), float(F_[p](1, 0)), float(F_[p](1, 1))};
    if (!cov_known_) continue;
    const std::array<double, 3> cov = total(p);
    out.cov_u[p] = {float(cov[0]), float(cov[1]), float(cov[2])};
    for (std::size_t k = 0; k < 3; ++k) cov_F[3 * p + k] = float(cov_F_[p][k]);
  }
  return out;
}

}  // namespace pivnp::np
