#include "pivnp/piv/dense/spline_field.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::piv {

namespace {

// Coefficients c with (c[k-1] + 4 c[k] + c[k+1]) / 6 = value[k], `count` samples `stride` apart, for `lanes` lines side
// by side. Natural ends: c[0] and c[count-1] are the values themselves. Thomas' algorithm.
void solve_lines(float* data, int count, std::ptrdiff_t stride, int lanes) {
  if (count < 3) return;
  const auto line = [&](int k) { return data + k * stride; };
  std::vector<float> upper(static_cast<std::size_t>(count));
  upper[0] = 0;
  for (int k = 1; k + 1 < count; ++k) {
    const float scale = 1 / (4 - upper[std::size_t(k - 1)]);
    upper[std::size_t(k)] = scale;
    const float* before = line(k - 1);
    float* now = line(k);
    for (int l = 0; l < lanes; ++l) now[l] = (6 * now[l] - before[l]) * scale;
  }
  for (int k = count - 2; k >= 1; --k) {
    const float* after = line(k + 1);
    float* now = line(k);
    for (int l = 0; l < lanes; ++l) now[l] -= upper[std::size_t(k)] * after[l];
  }
}

}  // namespace

std::array<float, 4> cubic_weights(float t) {
  const float s = 1 - t, t2 = t * t, t3 = t2 * t;
  return {s * s * s / 6, (3 * t3 - 6 * t2 + 4) / 6, (-3 * t3 + 3 * t2 + 3 * t + 1) / 6, t3 / 6};
}

void SplineField::interpolate(const CellLattice& lattice, const std::vector<float>& u, const std::vector<float>& v,
                              int threads) {
  lattice_ = lattice;
  const int nx = lattice.nx, ny = lattice.ny;
  const std::ptrdiff_t stride = nx + 2;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int component = 0; component < 2; ++component) {
    const std::vector<float>* values = component == 0 ? &u : &v;
    std::vector<float>* coefficients = component == 0 ? &u_ : &v_;
    std::vector<float> line(static_cast<std::size_t>(nx) * 8);
    coefficients->assign(std::size_t(stride) * std::size_t(ny + 2), 0.0f);
    float* inner = coefficients->data() + stride + 1;
    for (int j = 0; j < ny; ++j)
      std::copy_n(values->data() + std::ptrdiff_t(j) * nx, nx, inner + std::ptrdiff_t(j) * stride);
    solve_lines(inner, ny, stride, nx);
    for (int j = 0; j < ny; j += 8) {  // transposed, so that eight rows advance together
      const int lanes = std::min(8, ny - j);
      for (int l = 0; l < lanes; ++l)
        for (int i = 0; i < nx; ++i) line[std::size_t(i * 8 + l)] = inner[(j + l) * stride + i];
      solve_lines(line.data(), nx, 8, lanes);
      for (int l = 0; l < lanes; ++l)
        for (int i = 0; i < nx; ++i) inner[(j + l) * stride + i] = line[std::size_t(i * 8 + l)];
    }
    const auto ghost = [&](float* at, std::ptrdiff_t inward, int count) {
      at[0] = count > 1 ? 2 * at[inward] - at[2 * inward] : at[inward];
    };
    for (int j = 0; j < ny; ++j) {
      ghost(inner + j * stride - 1, 1, nx);
      ghost(inner + j * stride + nx, -1, nx);
    }
    for (int i = -1; i <= nx; ++i) {
      ghost(inner - stride + i, stride, ny);
      ghost(inner + ny * stride + i, -stride, ny);
    }
  }
}

std::array<float, 2> SplineField::at(float x, float y) const {
  const auto axis = [](float s, int points, int& cell) -> std::array<float, 4> {
    cell = std::clamp(static_cast<int>(std::floor(s)), 0, std::max(points - 2, 0));
    const float t = s - static_cast<float>(cell);
    if (t < 0) return {-t / 2 + 1.0f / 6, 4.0f / 6, t / 2 + 1.0f / 6, 0};  // the spline's tangent at the end
    if (t > 1) return {0, -(t - 1) / 2 + 1.0f / 6, 4.0f / 6, (t - 1) / 2 + 1.0f / 6};
    return cubic_weights(t);
  };
  int ci = 0, cj = 0;
  const auto step = static_cast<float>(lattice_.step);
  const auto wx = axis((x - static_cast<float>(lattice_.x0)) / step, lattice_.nx, ci);
  const auto wy = axis((y - static_cast<float>(lattice_.y0)) / step, lattice_.ny, cj);
  const int columns = lattice_.nx + 2, rows = lattice_.ny + 2;
  float u = 0, v = 0;
  for (int b = 0; b < 4; ++b) {
    const int row = std::min(cj + b, rows - 1);  // a lattice of one point has three coefficients
    for (int a = 0; a < 4; ++a) {
      const std::size_t k = std::size_t(row) * std::size_t(columns) + std::size_t(std::min(ci + a, columns - 1));
      const float w = wx[std::size_t(a)] * wy[std::size_t(b)];
      u += w * u_[k], v += w * v_[k];
    }
  }
  return {u, v};
}

void SplineField::row_coefficients(float y, float* u, float* v) const {
  const int columns = lattice_.nx + 2;
  const float s = (y - static_cast<float>(lattice_.y0)) / static_cast<float>(lattice_.step);
  const int cell = std::clamp(static_cast<int>(std::floor(s)), 0, std::max(lattice_.ny - 2, 0));
  const auto w = cubic_weights(s - static_cast<float>(cell));
  std::fill_n(u, columns, 0.0f);
  std::fill_n(v, columns, 0.0f);
  for (int b = 0; b < 4; ++b) {
    const std::ptrdiff_t start = std::ptrdiff_t(std::min(cell + b, lattice_.ny + 1)) * columns;
    for (int i = 0; i < columns; ++i) {
      u[i] += w[std::size_t(b)] * u_[std::size_t(start + i)];
      v[i] += w[std::size_t(b)] * v_[std::size_t(start + i)];
    }
  }
}

}  // namespace pivnp::piv
