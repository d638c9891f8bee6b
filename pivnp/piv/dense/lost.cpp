#include "pivnp/piv/dense/lost.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pivnp::piv {

namespace {

constexpr int beside = 2;
constexpr std::array reaches{4, 8, 16};  // points to either side
constexpr float clear = 3.5f;  // standard errors
constexpr float most_off = 2;      // level pixels that noise or a smoothed band may be off by; more is a wrong match, or air

struct Direction {
  int i, j;
  float correlation;  // of noise at neighbours along it
};
constexpr std::array<Direction, 4> directions{{{1, 0, 1.0f / 4}, {0, 1, 1.0f / 4}, {1, 1, 1.0f / 16}, {1, -1, 1.0f / 16}}};

// By the means over lines of 2 reach + 1 points in one direction.
void lost_along(const CellLattice& lattice, const std::vector<float>& off, const std::vector<std::uint8_t>& wanted,
                const Direction& along, int reach, int threads, std::vector<float>& variance) {
  const float count = static_cast<float>(2 * reach + 1);
  std::vector<float> mean(lattice.size()), square(lattice.size());
  const auto inside = [&](int i, int j) {
    return i >= 0 && j >= 0 && i < lattice.nx && j < lattice.ny && (wanted.empty() || wanted[lattice.index(i, j)] != 0);
  };
  // Sums along the line through each point; -1: the line leaves what is wanted.
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      float sum = 0, differences = 0, before = 0;
      bool whole = true;
      for (int s = -reach; s <= reach && whole; ++s) {
        const int a = i + s * along.i, b = j + s * along.j;
        whole = inside(a, b);
        if (!whole) break;
        const float value = off[lattice.index(a, b)];
        whole = std::abs(value) <= most_off;  // false for what is no number
        if (s > -reach) differences += (value - before) * (value - before);
        sum += value, before = value;
      }
      mean[k] = sum / count;
      square[k] = whole ? differences / (count - 1) : -1.0f;
    }
  // Of the mean of so many values of unit variance, over that of a difference.
  const float share = (1 + 2 * along.correlation * (count - 1) / count) / count / (2 * (1 - along.correlation));
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      if (square[k] < 0) continue;
      float sum = 0, lines = 0;
      for (int s = -beside; s <= beside; ++s) {
        const int a = i - s * along.j, b = j + s * along.i;
        if (!inside(a, b) || square[lattice.index(a, b)] < 0) continue;
        sum += square[lattice.index(a, b)], ++lines;
      }
      const float noise = share * sum / lines, bias = mean[k] * mean[k];
      if (bias > clear * clear * noise) variance[k] = std::max(variance[k], bias - noise);
    }
}

}  // namespace

void lost_variance(const CellLattice& lattice, const std::vector<float>& off, const std::vector<std::uint8_t>& wanted,
                   int threads, std::vector<float>& variance) {
  variance.assign(lattice.size(), 0.0f);
  for (const Direction& along : directions)
    for (const int reach : reaches) lost_along(lattice, off, wanted, along, reach, threads, variance);
}

}  // namespace pivnp::piv
