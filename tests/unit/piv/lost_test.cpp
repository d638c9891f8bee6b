// The bias that smoothing leaves, told from noise.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pivnp/piv/dense/lattice_filter.hpp"
#include "pivnp/piv/dense/lost.hpp"
#include "pivnp/piv/dense/shrink.hpp"

namespace pivnp::piv {
namespace {

constexpr int cells_along = 96;
const CellLattice lattice{cells_along, cells_along, 0, 0, 8};

// Noise as cells with hat weights show it: of white values, weights 1/4, 1/2, 1/4 twice removed (neighbours correlate by 1/4).
std::vector<float> noise(double sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  // A moving average a, b with a b/(a^2 + b^2) = 1/4 along both axes.
  const float a = std::sqrt((2 + std::sqrt(3.0f)) / 4), b = std::sqrt((2 - std::sqrt(3.0f)) / 4);
  std::vector<float> white((cells_along + 1) * (cells_along + 1)), out(lattice.size());
  for (float& w : white) w = normal(random);
  for (int j = 0; j < cells_along; ++j)
    for (int i = 0; i < cells_along; ++i) {
      const float* at = &white[std::size_t(j * (cells_along + 1) + i)];
      out[lattice.index(i, j)] = float(sigma) * (a * (a * at[0] + b * at[1]) + b * (a * at[cells_along + 1] + b * at[cells_along + 2]));
    }
  return out;
}

TEST(Lost, NoiseHasNoBias) {
  std::size_t found = 0;
  for (const unsigned seed : {1u, 2u, 3u}) {
    std::vector<float> variance;
    lost_variance(lattice, noise(.05, seed), {}, 2, variance);
    for (const float v : variance) found += v > 0;
  }
  EXPECT_LT(double(found) / (3 * cells_along * cells_along), .01);
}

TEST(Lost, NothingOutsideOfWhatIsWanted) {
  std::vector<float> off(lattice.size(), 1.0f), variance;
  std::vector<std::uint8_t> wanted(lattice.size(), 0);
  for (int j = 0; j < cells_along; ++j)
    for (int i = 0; i < 30; ++i) wanted[lattice.index(i, j)] = 1;
  lost_variance(lattice, off, wanted, 1, variance);
  EXPECT_NEAR(variance[lattice.index(10, 40)], 1, 1e-6);
  EXPECT_EQ(variance[lattice.index(40, 40)], 0);
}

// What is stated of a group's mean is what shrinkage is off by, in noise alone and with what stands clear of it; terms
// next to the threshold counted twelve times are five times as much and more.
TEST(Lost, TheRiskOfShrinkageIsWhatItIsOffBy) {
  constexpr float caution = .45f;
  const Shrinker shrinker(lattice);
  for (const bool bump : {false, true}) {
    double square = 0, risk = 0, cautious = 0;
    for (const unsigned seed : {1u, 2u, 3u}) {
      std::vector<float> truth(lattice.size()), value = noise(1, seed);
      for (int j = 0; j < cells_along && bump; ++j)
        for (int i = 0; i < cells_along; ++i) {
          const double x = i - cells_along / 2, y = j - cells_along / 2;
          truth[lattice.index(i, j)] = 3 * float(std::tanh((y + .1 * x) / 2));
        }
      for (std::size_t k = 0; k < value.size(); ++k) value[k] += truth[k];
      SmoothedField smooth;
      shrinker.run(value, {}, 1, smooth, caution);
      for (const float v : smooth.variance) cautious += double(v);
      shrinker.run(value, {}, 1, smooth, caution, true);
      for (std::size_t k = 0; k < value.size(); ++k) {
        const double off = double(smooth.value[k] - truth[k]);
        square += off * off, risk += double(smooth.variance[k]);
      }
    }
    EXPECT_GT(risk / square, .9) << bump;
    EXPECT_LT(risk / square, 1.6) << bump;
    EXPECT_GT(cautious / square, 4) << bump;
  }
}

// A band too narrow for what its noise lets shrinkage keep: with what is stated as lost, errors in it are covered.
TEST(Lost, IsStatedInABand) {
  for (const double angle : {0.0, 45.0}) {
    const double c = std::cos(angle * M_PI / 180), s = std::sin(angle * M_PI / 180);
    double square = 0, random = 0, stated = 0, outside = 0, count = 0, others = 0;
    for (unsigned seed = 1; seed <= 6; ++seed) {
      std::vector<float> truth(lattice.size()), value = noise(.06, seed), lost;
      for (int j = 0; j < cells_along; ++j)
        for (int i = 0; i < cells_along; ++i) {
          const double across = c * (j - cells_along / 2 + .3) - s * (i - cells_along / 2);
          truth[lattice.index(i, j)] = .25f * float(std::tanh(across / 1.25));
          value[lattice.index(i, j)] += truth[lattice.index(i, j)];
        }
      SmoothedField smooth;
      Shrinker(lattice).run(value, {}, 2, smooth);
      std::vector<float> off(lattice.size());
      for (std::size_t k = 0; k < off.size(); ++k) off[k] = value[k] - smooth.value[k];
      lost_variance(lattice, off, {}, 2, lost);
      for (int j = 12; j < cells_along - 12; ++j)
        for (int i = 12; i < cells_along - 12; ++i) {
          const std::size_t k = lattice.index(i, j);
          const double across = c * (j - cells_along / 2 + .3) - s * (i - cells_along / 2);
          if (std::abs(across) > 8) outside += lost[k] > 0, ++others;
          if (std::abs(across) > 2) continue;
          square += std::pow(smooth.value[k] - truth[k], 2), random += double(smooth.variance[k]);
          stated += double(smooth.variance[k] + lost[k]), ++count;
        }
    }
    SCOPED_TRACE(angle);
    RecordProperty("error", std::to_string(std::sqrt(square / count)));
    std::printf("[ figure   ] %.0f degrees: error %.4f, stated before %.4f, with what is lost %.4f; elsewhere %.4f of points\n", angle,
                std::sqrt(square / count), std::sqrt(random / count), std::sqrt(stated / count), outside / others);
    // A bias below 3.5 standard errors of the longest line (here .04) is not seen.
    if (angle > 0) {
      EXPECT_GT(random, .1 * square);
      EXPECT_LT(random, .3 * square);
      EXPECT_GT(stated, .8 * square);
    }
    EXPECT_GT(stated, 1.3 * random);
    EXPECT_LT(stated, 2 * square);
    EXPECT_LT(outside / others, .02);
  }
}

// Beyond what is known a field goes on without a jump, and within its range.
TEST(ContinuedField, GoesOnFromWhatIsKnown) {
  std::vector<float> values(lattice.size(), 1e9f);
  std::vector<std::uint8_t> known(lattice.size(), 0);
  for (int j = 0; j < cells_along; ++j)
    for (int i = 0; i < 40; ++i) known[lattice.index(i, j)] = 1, values[lattice.index(i, j)] = 3 + .05f * float(i) + .02f * float(j);
  const std::vector<float> before = values;
  continue_field(lattice, known, values);
  for (int j = 0; j < cells_along; ++j)
    for (int i = 0; i < cells_along; ++i) {
      const std::size_t k = lattice.index(i, j);
      if (known[k]) { ASSERT_EQ(values[k], before[k]); }
      ASSERT_GE(values[k], 3);
      ASSERT_LE(values[k], 3 + .05f * 39 + .02f * 95);
      if (i > 0) { ASSERT_LT(std::abs(values[k] - values[k - 1]), .25f) << i << ", " << j; }
    }
  std::vector<float> nothing(lattice.size(), 7);
  continue_field(lattice, std::vector<std::uint8_t>(lattice.size(), 0), nothing);
  EXPECT_EQ(nothing, std::vector<float>(lattice.size(), 7));
}

}  // namespace
}  // namespace pivnp::piv
