#include "pivnp/piv/dense/corrections.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pivnp/piv/dense/lattice_filter.hpp"

namespace pivnp::piv {

namespace {

constexpr float most_step = 1.5f;  // level pixels: beyond it the linearisation means nothing

void limit_step(float& du, float& dv) {
  const float size = std::hypot(du, dv);
  if (size > most_step) du *= most_step / size, dv *= most_step / size;
}

// Gauss-Newton in one window: `terms` polynomial terms a component, about lattice point (i, j).
template <int terms>
bool solve_window(const CellSums& sums, int i, int j, int reach, const std::vector<float>& weight, Corrections& out) {
  constexpr int size = 2 * terms;
  using Matrix = Eigen::Matrix<double, size, size>;
  using Vector = Eigen::Matrix<double, size, 1>;
  const CellLattice& lattice = sums.lattice;
  Matrix normal = Matrix::Zero(), scatter = Matrix::Zero();
  Vector right = Vector::Zero();
  double whole = 0;
  for (int b = std::max(-reach, -j); b <= std::min(reach, lattice.ny - 1 - j); ++b)
    for (int a = std::max(-reach, -i); a <= std::min(reach, lattice.nx - 1 - i); ++a) {
      const std::size_t k = lattice.index(i + a, j + b);
      const double w = double(weight[std::size_t(a + reach)]) * weight[std::size_t(b + reach)];
      Eigen::Matrix<double, terms, 1> p;
      p[0] = 1;
      if constexpr (terms > 1) p[1] = a, p[2] = b;
      if constexpr (terms > 3) p[3] = a * a, p[4] = a * b, p[5] = b * b;
      const Eigen::Matrix<double, terms, terms> pp = w * p * p.transpose();
      normal.template block<terms, terms>(0, 0) += double(sums[CellSums::gxx][k]) * pp;
      normal.template block<terms, terms>(0, terms) += double(sums[CellSums::gxy][k]) * pp;
      normal.template block<terms, terms>(terms, terms) += double(sums[CellSums::gyy][k]) * pp;
      Vector cell;
      cell.template head<terms>() = w * double(sums[CellSums::gxe][k]) * p;
      cell.template tail<terms>() = w * double(sums[CellSums::gye][k]) * p;
      right += cell;
      // Hats overlap: a cell's noise is shared with its neighbours', 9/4 of its own variance in all.
      scatter += 2.25 * cell * cell.transpose();
      whole += double(sums[CellSums::usable][k]);
    }
  normal.template block<terms, terms>(terms, 0) = normal.template block<terms, terms>(0, terms).transpose();
  if (!(whole > 0)) return false;
  const Eigen::LDLT<Matrix> factor(normal);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-6 * factor.vectorD().maxCoeff()))
    return false;
  const Vector step = factor.solve(right);
  const Matrix inverse = factor.solve(Matrix::Identity());
  const Matrix covariance = inverse * scatter * inverse;
  const std::size_t k = lattice.index(i, j);
  out.u[k] = static_cast<float>(step[0]), out.v[k] = static_cast<float>(step[terms]);
  // Earlier passes have already followed part of the noise that is left in the residuals no more: measured factor, on
  // uniformly moved frames with 5 and 10 % noise (2.7 to 3 squared, orders 0 to 2).
  constexpr double followed = 7.8;
  out.variance_u[k] = static_cast<float>(followed * covariance(0, 0));
  out.variance_v[k] = static_cast<float>(followed * covariance(terms, terms));
  limit_step(out.u[k], out.v[k]);
  return true;
}

}  // namespace

void cell_corrections(const CellSums& sums, float rounding, Corrections& out) {
  constexpr float prior = 0.3f;
  constexpr int reach = 4;  // cells that count as "around"
  const std::size_t count = sums.lattice.size();
  const auto& gxx = sums[CellSums::gxx];
  const auto& gyy = sums[CellSums::gyy];
  const auto& gxy = sums[CellSums::gxy];
  std::vector<float> texture(count), around;
  // A cell that is no number would spread over the whole field, by the running sums of the mean and by the smoothing.
  const auto known = [&](std::size_t k) { return std::isfinite(gxx[k]) && std::isfinite(gyy[k]); };
  for (std::size_t k = 0; k < count; ++k) texture[k] = known(k) ? 0.5f * (gxx[k] + gyy[k]) : 0.0f;
  box_mean(sums.lattice, texture, reach, around);
  out.u.resize(count);
  out.v.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const float mu = prior * around[k] + 1e-3f * rounding, a = gxx[k] + mu, b = gxy[k], c = gyy[k] + mu;
    const float x = sums[CellSums::gxe][k], y = sums[CellSums::gye][k], scale = (1 + prior) / (a * c - b * b);
    out.u[k] = (c * x - b * y) * scale, out.v[k] = (a * y - b * x) * scale;
    if (!std::isfinite(out.u[k]) || !std::isfinite(out.v[k])) out.u[k] = out.v[k] = 0;
    limit_step(out.u[k], out.v[k]);
  }
}

void window_corrections(const CellSums& sums, int order, float window_px, const std::vector<std::uint8_t>& wanted,
                        int threads, Corrections& out) {
  const CellLattice& lattice = sums.lattice;
  const auto step = static_cast<float>(lattice.step);
  // A Gaussian averages noise like an even window of 2 sqrt(pi) sigma a side; the hats themselves add step^2 / 6.
  const float sigma = window_px / (2 * std::sqrt(static_cast<float>(M_PI)));
  const float own = std::sqrt(std::max(sigma * sigma - step * step / 6, 0.04f * step * step)) / step;
  const int reach = std::max(1, static_cast<int>(std::ceil(3 * own)));
  std::vector<float> weight;
  for (int k = -reach; k <= reach; ++k) weight.push_back(std::exp(-0.5f * static_cast<float>(k * k) / (own * own)));
  for (auto* v : {&out.u, &out.v}) v->assign(lattice.size(), 0.0f);
  for (auto* v : {&out.variance_u, &out.variance_v}) v->assign(lattice.size(), 1.0f);
#pragma omp parallel for num_threads(threads) schedule(dynamic, 4)
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      if (!wanted.empty() && !wanted[lattice.index(i, j)]) continue;
      // The highest order that the texture determines.
      if (order >= 2 && solve_window<6>(sums, i, j, reach, weight, out)) continue;
      if (order >= 1 && solve_window<3>(sums, i, j, reach, weight, out)) continue;
      solve_window<1>(sums, i, j, reach, weight, out);
    }
}

void residual_scale(const CellSums& sums, const std::vector<float>& u, const std::vector<float>& v, float rounding,
                    std::vector<float>& noise, std::vector<float>& tolerance) {
  // Weights 1 / (1 + (e/3s)^2)^2 lower the variance of normal residuals to 0.733 s^2.
  constexpr float reach = 9.0f / 0.733f, least_px = 0.1f, share = 0.1f;
  const CellLattice& lattice = sums.lattice;
  std::vector<float> weight;
  binomial_mean(lattice, sums[CellSums::wee], noise);
  binomial_mean(lattice, sums[CellSums::weight], weight);
  tolerance.resize(lattice.size());
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      noise[k] = reach * noise[k] / std::max(weight[k], 1e-3f) + rounding;
      const std::size_t left = lattice.index(std::max(i - 1, 0), j),
                        right = lattice.index(std::min(i + 1, lattice.nx - 1), j);
      const std::size_t above = lattice.index(i, std::max(j - 1, 0)),
                        below = lattice.index(i, std::min(j + 1, lattice.ny - 1));
      const auto square = [](float x) { return x * x; };
      const float change = 0.5f * std::sqrt(square(u[right] - u[left]) + square(v[right] - v[left]) +
                                            square(u[below] - u[above]) + square(v[below] - v[above]));
      tolerance[k] = square(least_px + share * change);
    }
}

}  // namespace pivnp::piv
