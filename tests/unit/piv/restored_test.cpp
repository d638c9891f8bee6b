// What cells show of a field that their pair's smooth field lacks.
#include <gtest/gtest.h>

#include <cmath>

#include "pivnp/piv/dense/restored.hpp"

namespace pivnp::piv {
namespace {

constexpr int cells = 32;
const CellLattice lattice{cells, cells, 0, 0, 8};

// Waves of eight cells along both axes, of which a pair lacks all: its cells show the mean with their hat weights, times .7.
TEST(Restored, AWaveThatThePairLacksComesBack) {
  const double k = M_PI / 4, half = k / 2, hat = std::pow(std::sin(half) / half, 2);
  std::vector<float> wave(lattice.size()), measured(lattice.size());
  const std::vector<float> nothing(lattice.size(), 0.0f);
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      wave[lattice.index(i, j)] = float(std::cos(k * i) * std::cos(k * j));
      measured[lattice.index(i, j)] = float(.7 * hat * hat) * wave[lattice.index(i, j)];
    }
  const std::vector<std::uint8_t> all(lattice.size(), 1);
  restore_measured(lattice, wave, nothing, all, 2, measured);
  for (int j = 1; j < cells - 1; ++j)
    for (int i = 1; i < cells - 1; ++i) EXPECT_NEAR(measured[lattice.index(i, j)], wave[lattice.index(i, j)], .04);
}

TEST(Restored, NothingIsAddedWhereThePairLacksNothingOrNothingIsKnown) {
  std::vector<float> field(lattice.size()), measured(lattice.size(), 1.0f), other(lattice.size(), 100.0f);
  for (std::size_t k = 0; k < field.size(); ++k) field[k] = float(k % 7);
  restore_measured(lattice, field, field, std::vector<std::uint8_t>(lattice.size(), 1), 1, measured);
  restore_measured(lattice, other, field, std::vector<std::uint8_t>(lattice.size(), 0), 1, measured);
  for (const float v : measured) EXPECT_EQ(v, 1);
}

}  // namespace
}  // namespace pivnp::piv
