#include "pivnp/piv/window/predictor.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace pivnp::piv {

namespace {

using Vec2f = std::array<float, 2>;

constexpr int predictor_reach = 2;  // 5 x 5 points
constexpr int most_terms = 6;
using Moments = Eigen::Matrix<double, most_terms, most_terms>;
using Sums = Eigen::Matrix<double, most_terms, 2>;
using Terms = Eigen::Matrix<double, most_terms, 1>;

Terms terms(int a, int b) {
  const double x = a, y = b;
  return {1.0, x, y, x * x, x * y, y * y};
}

// Normal equations of the weighted polynomial 1, x, y, xx, xy, yy about one control point, in lattice steps.
struct LocalFit {
  Moments normal = Moments::Zero();
  Sums sums = Sums::Zero();
  int points = 0, columns = 0, rows = 0;  // points used, and in how many different columns and rows they lie

  bool solve(int count, Vec2f& at_centre) const {
    Eigen::LDLT<Eigen::MatrixXd> factor(normal.topLeftCorner(count, count));
    if (factor.info() != Eigen::Success || factor.vectorD().minCoeff() < 1e-6 * normal(0, 0)) return false;
    const Eigen::MatrixXd solution = factor.solve(sums.topRows(count));
    at_centre = {static_cast<float>(solution(0, 0)), static_cast<float>(solution(0, 1))};
    return true;
  }
};

std::array<double, 2 * predictor_reach + 1> axis_weights(float sigma) {
  std::array<double, 2 * predictor_reach + 1> w{};
  for (int k = -predictor_reach; k <= predictor_reach; ++k) w[std::size_t(k + predictor_reach)] = std::exp(-0.5 * k * k / (double(sigma) * sigma));
  return w;
}

// A neighbourhood without gaps: the fit is the same linear combination of its vectors everywhere.
std::array<double, (2 * predictor_reach + 1) * (2 * predictor_reach + 1)> full_kernel(const std::array<double, 2 * predictor_reach + 1>& weight) {
  const auto product = [&](int a, int b) { return weight[std::size_t(a + predictor_reach)] * weight[std::size_t(b + predictor_reach)]; };
  Moments normal = Moments::Zero();
  for (int b = -predictor_reach; b <= predictor_reach; ++b)
    for (int a = -predictor_reach; a <= predictor_reach; ++a) normal += product(a, b) * terms(a, b) * terms(a, b).transpose();
  const Terms first = normal.inverse().row(0).transpose();
  std::array<double, (2 * predictor_reach + 1) * (2 * predictor_reach + 1)> kernel{};
  std::size_t k = 0;
  for (int b = -predictor_reach; b <= predictor_reach; ++b)
    for (int a = -predictor_reach; a <= predictor_reach; ++a) kernel[k++] = product(a, b) * first.dot(terms(a, b));
  return kernel;
}

}  // namespace

void PredictorField::fit(const EvenLattice& lattice, const std::vector<Vec2f>& displacement,
                         const std::vector<std::uint8_t>& good, float sigma, int threads) {
  lattice_ = lattice;
  values_.assign(std::size_t(lattice.nx + 2) * std::size_t(lattice.ny + 2), {0, 0});
  std::vector<std::uint8_t> known(displacement.size(), 0);
  const auto weight = axis_weights(sigma);

  constexpr int side = 2 * predictor_reach + 1;
  const auto full = full_kernel(weight);

#pragma omp parallel for num_threads(threads) schedule(static)
  for (int j = 0; j < lattice.ny; ++j) {
    for (int i = 0; i < lattice.nx; ++i) {
      const auto index = [&](int a, int b) {
        return std::size_t(j + b) * std::size_t(lattice.nx) + std::size_t(i + a);
      };
      bool whole = i >= predictor_reach && j >= predictor_reach && i + predictor_reach < lattice.nx && j + predictor_reach < lattice.ny;
      for (int b = -predictor_reach; whole && b <= predictor_reach; ++b)
        for (int a = -predictor_reach; a <= predictor_reach; ++a) whole = whole && good[index(a, b)] != 0;
      if (whole) {
        double u = 0, v = 0;
        for (int b = -predictor_reach; b <= predictor_reach; ++b)
          for (int a = -predictor_reach; a <= predictor_reach; ++a) {
            const double w = full[std::size_t((b + predictor_reach) * side + a + predictor_reach)];
            u += w * displacement[index(a, b)][0], v += w * displacement[index(a, b)][1];
          }
        value(i, j) = {static_cast<float>(u), static_cast<float>(v)};
        known[index(0, 0)] = 1;
        continue;
      }
      LocalFit fit;
      unsigned columns = 0, rows = 0;
      for (int b = std::max(-predictor_reach, -j); b <= std::min(predictor_reach, lattice.ny - 1 - j); ++b)
        for (int a = std::max(-predictor_reach, -i); a <= std::min(predictor_reach, lattice.nx - 1 - i); ++a) {
          if (!good[index(a, b)]) continue;
          const double w = weight[std::size_t(a + predictor_reach)] * weight[std::size_t(b + predictor_reach)];
          const Terms p = terms(a, b);
          fit.normal += w * p * p.transpose();
          fit.sums.col(0) += w * displacement[index(a, b)][0] * p;
          fit.sums.col(1) += w * displacement[index(a, b)][1] * p;
          ++fit.points;
          columns |= 1u << (a + predictor_reach), rows |= 1u << (b + predictor_reach);
        }
      fit.columns = __builtin_popcount(columns), fit.rows = __builtin_popcount(rows);
      Vec2f& out = value(i, j);
      const bool curved = fit.points >= 12 && fit.columns >= 3 && fit.rows >= 3 && good[index(0, 0)];
      const bool sloped = fit.points >= 4 && fit.columns >= 2 && fit.rows >= 2;
      if ((curved && fit.solve(6, out)) || (sloped && fit.solve(3, out)) || (fit.points > 0 && fit.solve(1, out)))
        known[index(0, 0)] = 1;
    }
  }
  fill_far_points(known);
  set_ghosts();
}

void PredictorField::fill_far_points(std::vector<std::uint8_t>& known) {
  const auto index = [&](int i, int j) { return std::size_t(j) * std::size_t(lattice_.nx) + std::size_t(i); };
  for (bool grown = true; grown;) {
    grown = false;
    const std::vector<std::uint8_t> before = known;
    for (int j = 0; j < lattice_.ny; ++j)
      for (int i = 0; i < lattice_.nx; ++i) {
        if (before[index(i, j)]) continue;
        float u = 0, v = 0;
        int count = 0;
        for (int b = std::max(0, j - 1); b <= std::min(lattice_.ny - 1, j + 1); ++b)
          for (int a = std::max(0, i - 1); a <= std::min(lattice_.nx - 1, i + 1); ++a)
            if (before[index(a, b)]) u += value(a, b)[0], v += value(a, b)[1], ++count;
        if (count == 0) continue;
        value(i, j) = {u / static_cast<float>(count), v / static_cast<float>(count)};
        known[index(i, j)] = 1;
        grown = true;
      }
  }
}

void PredictorField::set_ghosts() {
  const auto beyond = [](const Vec2f& edge, const Vec2f& inner) {
    return Vec2f{2 * edge[0] - inner[0], 2 * edge[1] - inner[1]};
  };
  const int nx = lattice_.nx, ny = lattice_.ny;
  for (int j = 0; j < ny; ++j) {
    value(-1, j) = beyond(value(0, j), value(std::min(1, nx - 1), j));
    value(nx, j) = beyond(value(nx - 1, j), value(std::max(nx - 2, 0), j));
  }
  for (int i = -1; i <= nx; ++i) {
    value(i, -1) = beyond(value(i, 0), value(i, std::min(1, ny - 1)));
    value(i, ny) = beyond(value(i, ny - 1), value(i, std::max(ny - 2, 0)));
  }
}

// Four control points, the first of them `cell` counted with the ghost column, and their weights.
PredictorField::Axis PredictorField::axis(float position, float origin, float spacing, int points) {
  const float s = (position - origin) / spacing;
  const int cell = std::clamp(static_cast<int>(std::floor(s)), 0, std::max(points - 2, 0));
  const float t = s - static_cast<float>(cell);
  if (points == 1) return {0, {0, 1, 0, 0}};
  if (t < 0 || t > 1) return {cell, {0, 1 - t, t, 0}};
  const float t2 = t * t, t3 = t2 * t;
  return {cell,
          {0.5f * (-t + 2 * t2 - t3), 0.5f * (2 - 5 * t2 + 3 * t3), 0.5f * (t + 4 * t2 - 3 * t3), 0.5f * (t3 - t2)}};
}

Vec2f PredictorField::at(float column, float row) const {
  if (values_.empty()) return {0, 0};
  const Axis x = axis(column, lattice_.x0, lattice_.dx, lattice_.nx);
  const Axis y = axis(row, lattice_.y0, lattice_.dy, lattice_.ny);
  float u = 0, v = 0;
  for (int a = 0; a < 4; ++a) {
    if (x.weight[std::size_t(a)] == 0) continue;  // also: a lattice of one column has three only
    float cu = 0, cv = 0;
    for (int b = 0; b < 4; ++b) {
      if (y.weight[std::size_t(b)] == 0) continue;
      const Vec2f& p = value(x.cell - 1 + a, y.cell - 1 + b);
      cu += y.weight[std::size_t(b)] * p[0], cv += y.weight[std::size_t(b)] * p[1];
    }
    u += x.weight[std::size_t(a)] * cu, v += x.weight[std::size_t(a)] * cv;
  }
  return {u, v};
}

PredictorField::RowPlan PredictorField::plan_row(float first, float step, int count) const {
  RowPlan plan;
  if (values_.empty()) return plan;
  for (auto& w : plan.weight) w.resize(std::size_t(count));
  for (int k = 0; k < count; ++k) {
    const Axis a = axis(first + static_cast<float>(k) * step, lattice_.x0, lattice_.dx, lattice_.nx);
    for (std::size_t c = 0; c < 4; ++c) plan.weight[c][std::size_t(k)] = a.weight[c];
    if (plan.runs.empty() || plan.runs.back().cell != a.cell) plan.runs.push_back({a.cell, k, k});
    plan.runs.back().end = k + 1;
  }
  return plan;
}

void PredictorField::row(const RowPlan& plan, float row, std::vector<float>& scratch, float* du, float* dv) const {
  const std::size_t columns = std::size_t(lattice_.nx) + 2;
  const Axis y = axis(row, lattice_.y0, lattice_.dy, lattice_.ny);
  scratch.assign(2 * (columns + 1), 0.0f);  // one more: a lattice of one column reads a fourth with weight 0
  float* u = scratch.data();
  float* v = u + columns + 1;
  for (int b = 0; b < 4; ++b) {
    const float w = y.weight[std::size_t(b)];
    if (w == 0) continue;
    const Vec2f* in = values_.data() + std::size_t(y.cell + b) * columns;
    for (std::size_t i = 0; i < columns; ++i) u[i] += w * in[i][0], v[i] += w * in[i][1];
  }
  const float *w0 = plan.weight[0].data(), *w1 = plan.weight[1].data(), *w2 = plan.weight[2].data(),
              *w3 = plan.weight[3].data();
  for (const RowPlan::Run& run : plan.runs) {
    const float u0 = u[run.cell], u1 = u[run.cell + 1], u2 = u[run.cell + 2], u3 = u[run.cell + 3];
    const float v0 = v[run.cell], v1 = v[run.cell + 1], v2 = v[run.cell + 2], v3 = v[run.cell + 3];
#pragma omp simd
    for (int k = run.begin; k < run.end; ++k) {
      du[k] = w0[k] * u0 + w1[k] * u1 + w2[k] * u2 + w3[k] * u3;
      dv[k] = w0[k] * v0 + w1[k] * v1 + w2[k] * v2 + w3[k] * v3;
    }
  }
}

}  // namespace pivnp::piv
