#include "pivnp/piv/dense/lattice_filter.hpp"

#include <algorithm>

namespace pivnp::piv {

void binomial_mean(const CellLattice& lattice, const std::vector<float>& in, std::vector<float>& out) {
  const int nx = lattice.nx, ny = lattice.ny;
  std::vector<float> half(in.size());
  out.resize(in.size());
  for (int j = 0; j < ny; ++j) {
    const float* row = in.data() + lattice.index(0, j);
    float* to = half.data() + lattice.index(0, j);
    for (int i = 1; i + 1 < nx; ++i) to[i] = 0.25f * (row[i - 1] + row[i + 1]) + 0.5f * row[i];
    to[0] = 0.75f * row[0] + 0.25f * row[std::min(1, nx - 1)];
    to[nx - 1] = 0.75f * row[nx - 1] + 0.25f * row[std::max(nx - 2, 0)];
  }
  for (int j = 0; j < ny; ++j) {
    const float* above = half.data() + lattice.index(0, std::max(j - 1, 0));
    const float* here = half.data() + lattice.index(0, j);
    const float* below = half.data() + lattice.index(0, std::min(j + 1, ny - 1));
    float* to = out.data() + lattice.index(0, j);
    for (int i = 0; i < nx; ++i) to[i] = 0.25f * (above[i] + below[i]) + 0.5f * here[i];
  }
}

void box_mean(const CellLattice& lattice, const std::vector<float>& in, int reach, std::vector<float>& out) {
  const int nx = lattice.nx, ny = lattice.ny;
  std::vector<float> half(in.size());
  out.resize(in.size());
  for (int j = 0; j < ny; ++j) {
    const float* row = in.data() + lattice.index(0, j);
    float* to = half.data() + lattice.index(0, j);
    double sum = 0;
    for (int i = 0; i < std::min(reach, nx); ++i) sum += row[i];
    for (int i = 0; i < nx; ++i) {
      if (i + reach < nx) sum += row[i + reach];
      if (i > reach) sum -= row[i - reach - 1];
      to[i] = static_cast<float>(sum / (std::min(i + reach, nx - 1) - std::max(i - reach, 0) + 1));
    }
  }
  std::vector<double> column(static_cast<std::size_t>(nx), 0.0);
  const auto add = [&](int j, double sign) {
    const float* row = half.data() + lattice.index(0, j);
    for (int i = 0; i < nx; ++i) column[std::size_t(i)] += sign * static_cast<double>(row[i]);
  };
  for (int j = 0; j < std::min(reach, ny); ++j) add(j, 1);
  for (int j = 0; j < ny; ++j) {
    if (j + reach < ny) add(j + reach, 1);
    if (j > reach) add(j - reach - 1, -1);
    const double share = 1.0 / (std::min(j + reach, ny - 1) - std::max(j - reach, 0) + 1);
    float* to = out.data() + lattice.index(0, j);
    for (int i = 0; i < nx; ++i) to[i] = static_cast<float>(share * column[std::size_t(i)]);
  }
}

}  // namespace pivnp::piv
