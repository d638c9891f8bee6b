#include "pivnp/np/errors/bend_loss.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "pivnp/core/error.hpp"
#include "pivnp/core/grid/bends.hpp"
#include "pivnp/core/particles/alive.hpp"

namespace pivnp::np {

namespace {

bool usable(const VectorField& field, std::size_t n) {
  const bool measured = field.status[n] == VectorStatus::valid || field.status[n] == VectorStatus::replaced;
  return measured && std::isfinite(field.displacement[n][0]) && std::isfinite(field.displacement[n][1]);
}

// Second difference at node k of a row of n; beside gaps and borders that of the nearest node of the row that has one,
// else zero.
template <class Value>
float second_difference(const Value& value, int k, int n) {
  for (const int at : {k, k - 1, k + 1, k - 2, k + 2}) {
    if (at < 1 || at > n - 2) continue;
    const float d = (value(at - 1) + value(at + 1)) - 2 * value(at);
    if (d == d) return d;
  }
  return 0;
}

}  // namespace

double BendLoss::length_of(const VectorField& field, double window) {
  return field.path_factor.empty() ? 0 : window / 16;
}

void BendLoss::before_step(const Tracker& tracker) {
  const auto state = tracker.state();
  lost_.resize(state.size(), Vec2::Zero());
  lost_F_.resize(state.size(), Mat2::Zero());
  before_.resize(state.size());
  const Vec2 nowhere = Vec2::Constant(nan_value);  // not born yet: the step to its birth does not carry a particle
#pragma omp parallel for schedule(static) if (state.size() > 4096)
  for (std::ptrdiff_t n = 0; n < std::ptrdiff_t(state.size()); ++n) {
    const auto p = std::size_t(n);
    before_[p] = {alive(state.status(p)) ? state.place(p) : nowhere, state.F(p)};
  }
}

void BendLoss::bend(const VectorField& field) {
  const Grid& grid = field.grid;
  const int nx = grid.nx, ny = grid.ny;
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  values_.resize(grid.node_count());
  bends_.resize(grid.node_count());
  for (std::size_t n = 0; n < values_.size(); ++n)
    values_[n] = usable(field, n) ? field.displacement[n] : std::array<float, 2>{none, none};
  const auto per_x = float(1 / (grid.spacing.x() * grid.spacing.x())),
             per_y = float(1 / (grid.spacing.y() * grid.spacing.y()));
#pragma omp parallel for schedule(static) if (grid.node_count() > 4096)
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      for (std::size_t c = 0; c < 2; ++c) {
        const auto along_row = [&](int k) { return values_[grid.node(k, j)][c]; };
        const auto along_column = [&](int k) { return values_[grid.node(i, k)][c]; };
        bends_[grid.node(i, j)][c] =
            per_x * second_difference(along_row, i, nx) + per_y * second_difference(along_column, j, ny);
      }
  sharpen_bends(nx, ny, bends_);
}

void BendLoss::after_step(Tracker& tracker, const VectorField& field, double length) {
  if (!(length > 0) || field.cov.empty()) return;
  bend(field);
  const Grid& grid = field.grid;
  const bool central = field.anchor == Anchor::central;
  const double square = length * length, least = least_share * length;
  const auto state = tracker.state();
  const std::size_t count = std::min(before_.size(), state.size());
#pragma omp parallel for schedule(static) if (count > 4096)
  for (std::ptrdiff_t n = 0; n < std::ptrdiff_t(count); ++n) {
    const auto p = std::size_t(n);
    if (!alive(state.status(p))) continue;
    const Vec2 at = central ? Vec2(0.5 * (before_[p].x + state.place(p))) : before_[p].x;
    const double sx = (at.x() - grid.origin.x()) / grid.spacing.x(), sy = (at.y() - grid.origin.y()) / grid.spacing.y();
    if (!(sx >= 0 && sy >= 0 && sx <= grid.nx - 1 && sy <= grid.ny - 1)) continue;
    const int i = std::min(int(sx), grid.nx - 2), j = std::min(int(sy), grid.ny - 2);
    const double xi = sx - i, eta = sy - j;
    const std::array<std::size_t, 4> nodes{grid.node(i, j), grid.node(i + 1, j), grid.node(i, j + 1),
                                           grid.node(i + 1, j + 1)};
    const std::array<double, 4> w{(1 - xi) * (1 - eta), xi * (1 - eta), (1 - xi) * eta, xi * eta};
    const std::array<double, 4> wx{eta - 1, 1 - eta, -eta, eta}, wy{xi - 1, -xi, 1 - xi, xi};
    Vec2 bent = Vec2::Zero();
    Mat2 G = Mat2::Zero(), bent_G = Mat2::Zero();
    for (std::size_t a = 0; a < 4; ++a) {
      const std::array<float, 2>&value = values_[nodes[a]], &b = bends_[nodes[a]];
      for (int c = 0; c < 2; ++c) {
        bent[c] += w[a] * double(b[std::size_t(c)]);
        const Eigen::RowVector2d slope(wx[a] / grid.spacing.x(), wy[a] / grid.spacing.y());
        G.row(c) += double(value[std::size_t(c)]) * slope;
        bent_G.row(c) += double(b[std::size_t(c)]) * slope;
      }
    }
    if (!G.allFinite()) G.setZero();  // beside a gap
    const Vec2 added = square * bent, before = lost_[p];
    lost_[p] = before + G * before + added;
    if (central) lost_[p] += 0.5 * (G * added);
    const Mat2& F0 = before_[p].F;
    const Mat2 f = state.F(p) * F0.inverse(), K = central ? Mat2(0.5 * (Mat2::Identity() + f)) : Mat2::Identity(),
               before_F = lost_F_[p];
    lost_F_[p] = f * before_F + square * K * bent_G * K * F0;
    // What was added before has grown with the covariance.
    const Mat2 more = lost_F_[p].transpose() * lost_F_[p] -
                      0.5 * f.squaredNorm() * before_F.transpose() * before_F;
    tracker.widen_F(p, {more(0, 0), more(1, 1), more(0, 1)});
    const double most = lost_[p].norm();
    if (most <= least) continue;
    const auto cov = state[p].cov;
    if (most * most > 0.25 * (cov[0] + cov[1])) tracker.flag(p);
  }
}

void BendLoss::save(std::vector<std::byte>& bytes) const {
  const std::size_t at = bytes.size(), place = lost_.size() * sizeof(Vec2), gradient = lost_F_.size() * sizeof(Mat2);
  bytes.resize(at + place + gradient + sizeof(std::uint64_t));
  if (place > 0) std::memcpy(bytes.data() + at, static_cast<const void*>(lost_.data()), place);
  if (gradient > 0) std::memcpy(bytes.data() + at + place, static_cast<const void*>(lost_F_.data()), gradient);
  const std::uint64_t count = lost_.size();
  std::memcpy(bytes.data() + at + place + gradient, &count, sizeof count);
}

void BendLoss::load(std::vector<std::byte>& bytes) {
  std::uint64_t count = 0;
  const std::size_t place = lost_.size() * sizeof(Vec2), gradient = lost_F_.size() * sizeof(Mat2),
                    size = place + gradient;
  if (bytes.size() >= size + sizeof count)
    std::memcpy(&count, bytes.data() + bytes.size() - sizeof count, sizeof count);
  if (count != lost_.size() || bytes.size() < size + sizeof count)
    throw InputError("np: saved state: found none of what bends lose for " + std::to_string(lost_.size()) +
                     " particles, expected one written by this version");
  const std::size_t at = bytes.size() - size - sizeof count;
  if (place > 0) std::memcpy(static_cast<void*>(lost_.data()), bytes.data() + at, place);
  if (gradient > 0) std::memcpy(static_cast<void*>(lost_F_.data()), bytes.data() + at + place, gradient);
  bytes.resize(at);
}

}  // namespace pivnp::np
