#include "pivnp/np/spline_filter.hpp"

#include <cassert>
#include <cmath>

namespace pivnp::np {

namespace {

using Value = std::array<double, 2>;

// A line of values, `step` apart in memory.
struct Line {
  Value* data;
  std::ptrdiff_t step;
  Value& operator[](int k) const { return data[k * step]; }
};

// Solves below c[k-1] + diagonal c[k] + c[k+1] = right[k] for k = first ... last, where the first and the last row may
// have their own diagonal; c holds `right` on entry. Thomas' algorithm; diagonally dominant.
void solve(const Line& c, int first, int last, double diagonal, double first_diagonal, double last_diagonal,
           std::vector<double>& factor) {
  if (last < first) return;
  factor.resize(std::size_t(last) + 1);
  double pivot = first == last ? std::min(first_diagonal, last_diagonal) : first_diagonal;
  for (int k = first; k <= last; ++k) {
    if (k > first) {
      factor[std::size_t(k)] = 1 / pivot;
      pivot = (k == last ? last_diagonal : diagonal) - factor[std::size_t(k)];
      for (std::size_t q = 0; q < 2; ++q) c[k][q] -= factor[std::size_t(k)] * c[k - 1][q];
    }
    if (k == last)
      for (std::size_t q = 0; q < 2; ++q) c[k][q] /= pivot;
  }
  // Pivots follow from the factors: pivot of row k is 1 / factor[k + 1].
  for (int k = last - 1; k >= first; --k)
    for (std::size_t q = 0; q < 2; ++q) c[k][q] = (c[k][q] - c[k + 1][q]) * factor[std::size_t(k) + 1];
}

// Values f in place -> coefficients c[0 ... n-1], and the ghosts c[-1], c[n].
void cubic(const Line& c, int n, std::vector<double>& factor) {
  const int e = n - 1;
  for (std::size_t q = 0; q < 2; ++q) {
    // The ends' polynomial leaves these two known at once.
    const double f0 = c[0][q], fe = c[e][q];
    const double second = (8 * c[1][q] - f0 - c[2][q]) / 6, before = (8 * c[e - 1][q] - fe - c[e - 2][q]) / 6;
    const double f1 = c[1][q], fb = c[e - 1][q];
    for (int k = 2; k <= e - 2; ++k) c[k][q] *= 6;
    c[1][q] = second;
    c[e - 1][q] = before;
    if (e - 2 >= 2) {
      c[2][q] -= second;
      c[e - 2][q] -= before;
    }
    c[0][q] = 6 * f1 - 4 * second;   // completed below, once its neighbour is known
    c[e][q] = 6 * fb - 4 * before;
    c[-1][q] = 6 * f0;
    c[n][q] = 6 * fe;
  }
  solve(c, 2, e - 2, 4, 4, 4, factor);
  for (std::size_t q = 0; q < 2; ++q) {
    c[0][q] -= c[2][q];
    c[e][q] -= c[e - 2][q];
    c[-1][q] -= 4 * c[0][q] + c[1][q];
    c[n][q] -= 4 * c[e][q] + c[e - 1][q];
  }
}

void quadratic(const Line& c, int n, std::vector<double>& factor) {
  const int e = n - 1;
  for (std::size_t q = 0; q < 2; ++q) {
    const double start = c[0][q] - c[1][q], stop = c[e][q] - c[e - 1][q];  // c0 - c1 = f0 - f1 at the ends
    for (int k = 1; k < e; ++k) c[k][q] *= 8;
    c[1][q] -= start;
    c[e - 1][q] -= stop;
    c[0][q] = start;
    c[e][q] = stop;
  }
  if (n == 3) {  // one row: c0 + 6 c1 + c2
    for (std::size_t q = 0; q < 2; ++q) c[1][q] /= 8;
  } else {
    solve(c, 1, e - 1, 6, 7, 7, factor);
  }
  for (std::size_t q = 0; q < 2; ++q) {
    c[0][q] += c[1][q];
    c[e][q] += c[e - 1][q];
    c[-1][q] = 3 * (c[0][q] - c[1][q]) + c[2][q];
    c[n][q] = 3 * (c[e][q] - c[e - 1][q]) + c[e - 2][q];
  }
}

}  // namespace

std::vector<Value> interpolate(int degree, int nx, int ny, const std::vector<Value>& values) {
  assert((degree == 2 || degree == 3) && nx > degree && ny > degree);
  const int wide = nx + 2;
  std::vector<Value> c(std::size_t(wide) * std::size_t(ny + 2), Value{0, 0});
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      c[std::size_t(j + 1) * std::size_t(wide) + std::size_t(i + 1)] =
          values[std::size_t(j) * std::size_t(nx) + std::size_t(i)];
  const auto filter = [&](const Line& line, int n, std::vector<double>& factor) {
    degree == 3 ? cubic(line, n, factor) : quadratic(line, n, factor);
  };
#pragma omp parallel
  {
    std::vector<double> factor;
#pragma omp for schedule(static)
    for (int j = 1; j <= ny; ++j) filter({&c[std::size_t(j) * std::size_t(wide) + 1], 1}, nx, factor);
#pragma omp for schedule(static)
    for (int i = 0; i < wide; ++i) filter({&c[std::size_t(wide) + std::size_t(i)], wide}, ny, factor);
  }
  return c;
}

WeightSums cardinal_sums(int degree, const double* w) {
  // The inverse filter is gain z^|k|; z^9 < 1e-5.
  constexpr int reach = 8;
  const double z = degree == 3 ? std::sqrt(3.0) - 2 : 2 * std::sqrt(2.0) - 3;
  const double gain = -(degree == 3 ? 6 : 8) * z / (1 - z * z);
  std::array<double, reach + 4> power{};
  power[0] = gain;
  for (std::size_t k = 1; k < power.size(); ++k) power[k] = power[k - 1] * z;
  WeightSums sums;
  for (int node = -reach; node <= reach + degree; ++node) {
    double weight = 0;
    for (int k = 0; k <= degree; ++k) {
      const int apart = std::abs(node - k);
      if (apart < int(power.size())) weight += w[k] * power[std::size_t(apart)];
    }
    sums.square += weight * weight;
  }
  return sums;
}

}  // namespace pivnp::np
