// What cells show of a field that their pair's smooth field lacks.
#include <gtest/gtest.h>

#include <cmath>

#include "pivnp/piv/dense/restored.hpp"

namespace pivnp::piv {
namespace {

constexpr int cells = 32;
const CellLattice cells_8px{cells, cells, 0, 0, 8};

// Waves of eight cells along both axes, of which a pair lacks all: its cells show the mean with their hat weights, times .7.
TEST(Restored, AWaveThatThePairLacksComesBack) {
  const double k = M_PI / 4, half = k / 2, hat = std::pow(std::sin(half) / half, 2);
  std::vector<float> wave(cells_8px.size()), measured(cells_8px.size());
  const std::vector<float> nothing(cells_8px.size(), 0.0f);
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      wave[cells_8px.index(i, j)] = float(std::cos(k * i) * std::cos(k * j));
      measured[cells_8px.index(i, j)] = float(.7 * hat * hat) * wave[cells_8px.index(i, j)];
    }
  const std::vector<std::uint8_t> all(cells_8px.size(), 1);
  restore_measured(cells_8px, wave, nothing, all, 2, measured);
  for (int j = 1; j < cells - 1; ++j)
    for (int i = 1; i < cells - 1; ++i) EXPECT_NEAR(measured[cells_8px.index(i, j)], wave[cells_8px.index(i, j)], .04);
}

TEST(Restored, NothingIsAddedWhereThePairLacksNothingOrNothingIsKnown) {
  std::vector<float> field(cells_8px.size()), measured(cells_8px.size(), 1.0f), other(cells_8px.size(), 100.0f);
  for (std::size_t k = 0; k < field.size(); ++k) field[k] = float(k % 7);
  restore_measured(cells_8px, field, field, std::vector<std::uint8_t>(cells_8px.size(), 1), 1, measured);
  restore_measured(cells_8px, other, field, std::vector<std::uint8_t>(cells_8px.size(), 0), 1, measured);
  for (const float v : measured) EXPECT_EQ(v, 1);
}

}  // namespace
}  // namespace pivnp::piv
