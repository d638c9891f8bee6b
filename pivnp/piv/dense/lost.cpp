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
  int i, j;           // to the next point of a line: in the same row, or in the next one
  float correlation;  // of noise at neighbours along it
};
constexpr std::array<Direction, 4> directions{{{1, 0, 1.0f / 4}, {0, 1, 1.0f / 4}, {1, 1, 1.0f / 16}, {-1, 1, 1.0f / 16}}};

// Sums from the start of each line of one direction to each point, so that those over any part of it are differences.
struct LineSums {
  double value = 0;       // of what was taken off
  double difference = 0;  // of its squared differences from point to point
  int missing = 0;        // of points that are not wanted, or hold nothing of use
};

class Lines {
 public:
  Lines(const CellLattice& lattice, const std::vector<float>& off, const std::vector<std::uint8_t>& wanted, const Direction& along)
      : lattice_(lattice), along_(along), sums_(std::size_t(lattice.nx + 2) * std::size_t(lattice.ny + 1)) {
    std::vector<float> row(std::size_t(lattice.nx + 2)), before(row.size());
    for (int j = 0; j < lattice.ny; ++j) {
      std::swap(row, before);
      for (int i = 0; i < lattice.nx; ++i) {
        const std::size_t k = lattice.index(i, j);
        const bool use = (wanted.empty() || wanted[k] != 0) && std::abs(off[k]) <= most_off;  // false for what is no number
        const float value = use ? off[k] : 0.0f;
        row[std::size_t(i + 1)] = value;
        const float last = along.j == 0 ? row[std::size_t(i)] : before[std::size_t(i + 1 - along.i)];
        const LineSums& sum = at(i - along.i, j - along.j);
        sums_[place(i, j)] = {sum.value + double(value), sum.difference + double((value - last) * (value - last)), sum.missing + !use};
      }
    }
  }

  // Mean, and mean squared difference of neighbours, of the line of 2 reach + 1 points about each; -1 where one is missing.
  void average(int reach, int threads, std::vector<float>& mean, std::vector<float>& square) const {
    const float count = static_cast<float>(2 * reach + 1);
    const int aside = reach * std::abs(along_.i);
    mean.assign(lattice_.size(), 0.0f), square.assign(lattice_.size(), -1.0f);
#pragma omp parallel for num_threads(threads) schedule(static)
    for (int j = reach * along_.j; j < lattice_.ny - reach * along_.j; ++j)
      for (int i = aside; i < lattice_.nx - aside; ++i) {
        const LineSums &end = at(i + reach * along_.i, j + reach * along_.j), &start = at(i - reach * along_.i, j - reach * along_.j),
                       &ahead = at(i - (reach + 1) * along_.i, j - (reach + 1) * along_.j);
        if (end.missing != ahead.missing) continue;
        const std::size_t k = lattice_.index(i, j);
        mean[k] = static_cast<float>(end.value - ahead.value) / count;
        square[k] = static_cast<float>(end.difference - start.difference) / (count - 1);
      }
  }

 private:
  std::size_t place(int i, int j) const { return std::size_t(j + 1) * std::size_t(lattice_.nx + 2) + std::size_t(i + 1); }
  const LineSums& at(int i, int j) const { return sums_[place(i, j)]; }  // zero one point outside
  const CellLattice& lattice_;
  Direction along_;
  std::vector<LineSums> sums_;
};

// By the means over lines of 2 reach + 1 points in one direction.
void lost_along(const CellLattice& lattice, const Lines& lines, const Direction& along, int reach, int threads,
                std::vector<float>& variance) {
  const float count = static_cast<float>(2 * reach + 1);
  std::vector<float> mean, square;
  lines.average(reach, threads, mean, square);
  // Of the mean of so many values of unit variance, over that of a difference.
  const float share = (1 + 2 * along.correlation * (count - 1) / count) / count / (2 * (1 - along.correlation));
#pragma omp parallel num_threads(threads)
  {
    const std::size_t nx = std::size_t(lattice.nx);
    std::vector<float> sum(nx), number(nx);
#pragma omp for schedule(static)
    for (int j = 0; j < lattice.ny; ++j) {
      std::fill(sum.begin(), sum.end(), 0.0f), std::fill(number.begin(), number.end(), 0.0f);
      for (int s = -beside; s <= beside; ++s) {
        const int b = j + s * along.i, shift = -s * along.j;
        if (b < 0 || b >= lattice.ny) continue;
        for (int i = std::max(0, -shift); i < std::min(lattice.nx, lattice.nx - shift); ++i) {
          const float there = square[lattice.index(i + shift, b)];
          sum[std::size_t(i)] += std::max(there, 0.0f), number[std::size_t(i)] += there >= 0 ? 1.0f : 0.0f;
        }
      }
      for (int i = 0; i < lattice.nx; ++i) {
        const std::size_t k = lattice.index(i, j);
        const float noise = share * sum[std::size_t(i)] / std::max(number[std::size_t(i)], 1.0f), bias = mean[k] * mean[k];
        if (square[k] >= 0 && bias > clear * clear * noise) variance[k] = std::max(variance[k], bias - noise);
      }
    }
  }
}

}  // namespace

void lost_variance(const CellLattice& lattice, const std::vector<float>& off, const std::vector<std::uint8_t>& wanted,
                   int threads, std::vector<float>& variance) {
  variance.assign(lattice.size(), 0.0f);
  for (const Direction& along : directions) {
    const Lines lines(lattice, off, wanted, along);
    for (const int reach : reaches) lost_along(lattice, lines, along, reach, threads, variance);
  }
}

}  // namespace pivnp::piv
