#include "pivnp/np/errors/reading_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pivnp/np/basis.hpp"

namespace pivnp::np {

namespace {

// Mean square error of cos(k x + phase) over a group of cells and all phases, of a wave of unit amplitude.
template <class Basis>
double mean_square(double k, int cells) {
  constexpr int places = 16, phases = 8, nodes = 4 * 6 + 1;
  // A spline through the values of a wave has that wave's coefficients, divided by the response of its samples.
  double response = 1;
  if constexpr (Basis::ghosts > 0) response = Basis::count == 4 ? (2 + std::cos(k)) / 3 : (3 + std::cos(k)) / 4;
  constexpr int start = 12;  // a multiple of 1, 2, 3: the start of a group of cells
  double sum = 0;
  for (int p = 0; p < cells * places; ++p)
    for (int q = 0; q < phases; ++q) {
      const double s = start + (p + 0.5) / places, phase = M_PI * q / phases;
      typename Basis::Weights w, dw;
      const int from = Basis::weigh(s, nodes, w, dw);
      double read = 0;
      for (std::size_t a = 0; a < w.size(); ++a) read += w[a] * std::cos(k * (from + int(a)) + phase) / response;
      const double off = std::cos(k * s + phase) - read;
      sum += off * off;
    }
  return sum / (cells * places * phases);
}

}  // namespace

double wave_reading_error(ShapeFunctions shape, double steepness) {
  const double k = std::acos(std::clamp(1 - steepness / 2, -1.0, 1.0));
  double square = 0;
  switch (shape) {
    case ShapeFunctions::quadratic: square = mean_square<Lagrange<2>>(k, 2); break;
    case ShapeFunctions::cubic: square = mean_square<Lagrange<3>>(k, 3); break;
    case ShapeFunctions::bspline2: square = mean_square<Spline<2>>(k, 2); break;
    case ShapeFunctions::bspline3: square = mean_square<Spline<3>>(k, 1); break;
    case ShapeFunctions::bilinear:
    case ShapeFunctions::triangles: square = mean_square<Lagrange<1>>(k, 1); break;
  }
  return std::sqrt(2 * square);
}

namespace {

// What a polynomial through a group of `degree` cells misses at the middle of its cell number `cell`, along a row of nodes that
// are `stride` apart: there is, by six nodes about the middle; `at` is the cell's first node.
float missed_by_polynomial(const float* at, std::ptrdiff_t stride, int degree, int cell) {
  static constexpr float quadratic[2][3] = {{0.375f, 0.75f, -0.125f}, {-0.125f, 0.75f, 0.375f}};
  static constexpr float cubic[3][4] = {
      {0.3125f, 0.9375f, -0.3125f, 0.0625f}, {-0.0625f, 0.5625f, 0.5625f, -0.0625f}, {0.0625f, -0.3125f, 0.9375f, 0.3125f}};
  const float there = (150 * (at[0] + at[stride]) - 25 * (at[-stride] + at[2 * stride]) + 3 * (at[-2 * stride] + at[3 * stride])) / 256;
  const float* w = degree == 2 ? quadratic[cell] : cubic[cell];
  float read = 0;
  for (int a = 0; a <= degree; ++a) read += w[a] * at[(a - cell) * stride];
  return there - read;
}

}  // namespace

ReadingErrors::ReadingErrors(ShapeFunctions shape)
    : degree_(shape == ShapeFunctions::quadratic ? 2 : shape == ShapeFunctions::cubic ? 3 : 1) {
  for (int n = 1; n <= steps; ++n) {
    const double steepness = 4.0 * n / steps;
    // The mean over an element's nodes lowers a wave by cos(k h/2).
    const double mean = std::max(0.35, std::sqrt(1 - steepness / 4));
    table_[std::size_t(n)] = float(wave_reading_error(shape, steepness) / (steepness * mean));
  }
  table_[0] = std::max(0.0f, 2 * table_[1] - table_[2]);
  table_[steps + 1] = table_[steps];
}

float ReadingErrors::lost(float steepness) const {
  const float at = std::min(steepness, 4.0f) * (steps / 4.0f);
  const auto n = std::size_t(at);
  return table_[n] + (at - float(n)) * (table_[n + 1] - table_[n]);
}

// A row of nodes, with its neighbours -3 ... 3 along one axis. Differences that a gap or the border cuts off (NaN) count
// as those beside them, or nothing.
void ReadingErrors::add_axis(std::size_t count, const std::array<const float*, 7>& rows, float* out) const {
  for (std::size_t i = 0; i < count; ++i) {
    float second[5];
    for (std::size_t k = 0; k < 5; ++k) second[k] = (rows[k][i] + rows[k + 2][i]) - 2 * rows[k + 1][i];
    float squares = 0, fourths = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float fourth = (second[k] + second[k + 2]) - 2 * second[k + 1];
      const bool known = fourth == fourth;
      squares += known ? second[k + 1] * second[k + 1] : 0;
      fourths += known ? fourth * fourth : 0;
    }
    float middle = second[2] == second[2] ? second[2] : second[1] == second[1] ? second[1] : second[3];
    if (!(middle == middle)) continue;
    out[i] -= middle * (squares > 0 ? lost(std::sqrt(fourths / squares)) : lost(2));
  }
}

// Beside gaps and borders, where six nodes are not known, the nodes' estimate is kept.
void ReadingErrors::take_polynomial_error(const Grid& grid, int i, int j, ElementError& e) const {
  const std::ptrdiff_t wide = grid.nx + 6;
  const int x = i - std::min(i / degree_ * degree_, grid.nx - 1 - degree_), y = j - std::min(j / degree_ * degree_, grid.ny - 1 - degree_);
  if (grid.nx <= degree_ || grid.ny <= degree_) return;
  const auto missed = [&](std::size_t component) {
    const float* at = values_[component].data() + (j + 3) * wide + i + 3;
    return 0.5f * (missed_by_polynomial(at, 1, degree_, x) + missed_by_polynomial(at + wide, 1, degree_, x) +
                   missed_by_polynomial(at, wide, degree_, y) + missed_by_polynomial(at + 1, wide, degree_, y));
  };
  const float u = missed(0), v = missed(1);
  if (u == u) e.u = u;
  if (v == v) e.v = v;
}

template <class Real>
const std::vector<ElementError>& ReadingErrors::of(const Nodes<Real>& nodes, const SupportMap& support) {
  errors_.clear();
  if (nodes.cov == nullptr) return errors_;
  const Grid& grid = nodes.grid;
  const std::size_t nx = std::size_t(grid.nx), ny = std::size_t(grid.ny), wide = nx + 6;
  for (std::size_t c = 0; c < 2; ++c) {
    values_[c].assign(wide * (ny + 6), std::numeric_limits<float>::quiet_NaN());
    biases_[c].assign(nx * ny, 0);
  }
  errors_.resize(grid.element_count());
  const double h = grid.spacing.minCoeff(), alike = double(nodes.correlation_length);
  // Pairs that are smoothed together share a part of their errors: n of them add up to n^2 times its variance.
  const double shared = (2 * std::min(nodes.step, smoothed_together) - 1) / (shared_spacings * shared_spacings * h * h);
  const auto per_variance =
      float(alike > 0 ? std::min(4.0 / 3 / (h * h), 2 / (alike * alike)) + shared : 4.0 / 3 / (h * h));
#pragma omp parallel if (grid.node_count() > 4096)
  {
#pragma omp for schedule(static)
    for (std::ptrdiff_t row = 0; row < std::ptrdiff_t(ny); ++row)
      for (std::size_t i = 0; i < nx; ++i) {
        const std::size_t n = std::size_t(row) * nx + i;
        if (support.node_class(n) > 1) continue;
        for (std::size_t c = 0; c < 2; ++c) values_[c][(std::size_t(row) + 3) * wide + i + 3] = float(nodes.displacement[n][c]);
      }
#pragma omp for schedule(static)
    for (std::ptrdiff_t row = 0; row < std::ptrdiff_t(ny); ++row)
      for (std::size_t c = 0; c < 2; ++c) {
        const float* first = values_[c].data() + (std::size_t(row) + 3) * wide + 3;
        std::array<const float*, 7> x, y;
        for (int k = -3; k <= 3; ++k) x[std::size_t(k + 3)] = first + k, y[std::size_t(k + 3)] = first + k * std::ptrdiff_t(wide);
        float* out = biases_[c].data() + std::size_t(row) * nx;
        add_axis(nx, x, out);
        add_axis(nx, y, out);
      }
#pragma omp for schedule(static)
    for (std::ptrdiff_t row = 0; row < std::ptrdiff_t(ny) - 1; ++row)
      for (std::size_t i = 0; i + 1 < nx; ++i) {
        const std::size_t n = std::size_t(row) * nx + i;
        ElementError& e = errors_[std::size_t(row) * (nx - 1) + i];
        e = {};
        float both = 0;  // of a pair by itself, for the gradient, whose shared part has a measure of its own
        for (const std::size_t at : {n, n + 1, n + nx, n + nx + 1}) {
          const float along = 0.25f * (nodes.path_factor != nullptr ? nodes.path_factor[at] : 1.0f);
          e.uu += along * nodes.cov[at][0], e.vv += along * nodes.cov[at][1], e.uv += along * nodes.cov[at][2];
          both += 0.25f * nodes.cov[at][0] + 0.25f * nodes.cov[at][1];
          e.u += 0.25f * biases_[0][at], e.v += 0.25f * biases_[1][at];
        }
        if (degree_ > 1) take_polynomial_error(grid, int(i), int(row), e);
        e.gradient = 0.5f * per_variance * both;
      }
  }
  return errors_;
}

template const std::vector<ElementError>& ReadingErrors::of(const Nodes<float>&, const SupportMap&);
template const std::vector<ElementError>& ReadingErrors::of(const Nodes<double>&, const SupportMap&);

}  // namespace pivnp::np
