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

void continue_field(const CellLattice& lattice, const std::vector<std::uint8_t>& known, std::vector<float>& values) {
  struct Squares {
    int nx = 0, ny = 0;
    std::vector<float> value, weight;
    std::size_t at(int i, int j) const { return std::size_t(j) * std::size_t(nx) + std::size_t(i); }
  };
  std::vector<Squares> levels(1);
  levels[0] = {lattice.nx, lattice.ny, values, std::vector<float>(values.size())};
  for (std::size_t k = 0; k < values.size(); ++k) levels[0].weight[k] = known[k] ? 1.0f : 0.0f;
  while (levels.back().nx > 1 || levels.back().ny > 1) {
    const Squares& fine = levels.back();
    Squares coarse{(fine.nx + 1) / 2, (fine.ny + 1) / 2, {}, {}};
    coarse.value.resize(std::size_t(coarse.nx) * std::size_t(coarse.ny)), coarse.weight.resize(coarse.value.size());
    for (int j = 0; j < coarse.ny; ++j)
      for (int i = 0; i < coarse.nx; ++i) {
        float sum = 0, weight = 0;
        for (int b = 2 * j; b < std::min(2 * j + 2, fine.ny); ++b)
          for (int a = 2 * i; a < std::min(2 * i + 2, fine.nx); ++a) {
            const std::size_t k = fine.at(a, b);
            if (fine.weight[k] > 0) sum += fine.weight[k] * fine.value[k], weight += fine.weight[k];
          }
        coarse.value[coarse.at(i, j)] = weight > 0 ? sum / weight : 0;
        coarse.weight[coarse.at(i, j)] = std::min(weight, 1.0f);
      }
    levels.push_back(std::move(coarse));
  }
  if (!(levels.back().weight[0] > 0)) return;
  for (std::size_t l = levels.size() - 1; l-- > 0;) {
    Squares& fine = levels[l];
    const Squares& coarse = levels[l + 1];
    for (int j = 0; j < fine.ny; ++j)
      for (int i = 0; i < fine.nx; ++i) {
        const std::size_t k = fine.at(i, j);
        const float w = fine.weight[k], more = coarse.value[coarse.at(i / 2, j / 2)];
        fine.value[k] = w > 0 ? w * fine.value[k] + (1 - w) * more : more;
      }
  }
  constexpr int sweeps = 16;  // the steps between squares of different size
  std::vector<float>&now = levels[0].value, before;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    before = now;
    for (int j = 0; j < lattice.ny; ++j)
      for (int i = 0; i < lattice.nx; ++i) {
        const std::size_t k = lattice.index(i, j);
        if (known[k]) continue;
        now[k] = 0.25f * (before[lattice.index(std::max(i - 1, 0), j)] + before[lattice.index(std::min(i + 1, lattice.nx - 1), j)] +
                          before[lattice.index(i, std::max(j - 1, 0))] + before[lattice.index(i, std::min(j + 1, lattice.ny - 1))]);
      }
  }
  values = now;
}

}  // namespace pivnp::piv
