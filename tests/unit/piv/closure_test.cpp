// The error that pairs repeat, from given differences of chains: Gaussian errors of known size, with and without it.
//   criterion: independent errors are left alone, also where the stated variance is a ninth of the true one; a repeated
//     error is found, to 15 % of its RMS; a few wild places decide nothing.
#include "pivnp/piv/validation/closure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace pivnp::piv {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double h = 8, correlation = 8, sigma = 0.01;

Grid grid_of(int nx, int ny) { return {Vec2(100, 50), Vec2(h, h), nx, ny}; }

// Differences as steps + 1 independent errors of `sigma` leave them, and (steps - 1) times `repeated` at the node.
template <class Repeated>
std::vector<ClosureChain> chains(const Grid& grid, const std::vector<int>& steps, std::mt19937_64& random,
                                 double true_sigma, const Repeated& repeated) {
  std::vector<ClosureChain> out;
  std::normal_distribution<double> normal;
  for (const int n : steps) {
    ClosureChain& chain = out.emplace_back();
    chain.steps = n;
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const Vec2 b = repeated(i, j);
        const double s = true_sigma * std::sqrt(n + 1.0);
        chain.off.push_back({(n - 1) * b.x() + s * normal(random), (n - 1) * b.y() + s * normal(random)});
        chain.variance.push_back({(n + 1) * sigma * sigma, (n + 1) * sigma * sigma});
      }
  }
  return out;
}

const auto none = [](int, int) { return Vec2(0, 0); };

TEST(Closure, IndependentErrorsAreLeftAlone) {
  const Grid grid = grid_of(24, 18);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::mt19937_64 random(seed);
    EXPECT_TRUE(repeated_error(grid, correlation, chains(grid, {6, 6, 6}, random, sigma, none)).cov.empty()) << seed;
    // errors three times what is stated do not repeat either
    EXPECT_TRUE(repeated_error(grid, correlation, chains(grid, {2, 2}, random, 3 * sigma, none)).cov.empty()) << seed;
  }
}

TEST(Closure, ARepeatedErrorIsFoundWithItsSizeAndDirection) {
  const Grid grid = grid_of(40, 30);
  const auto wave = [](int i, int) {
    const double b = i < 20 ? 0.03 : 0.0;
    return Vec2(b, -0.5 * b);
  };
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 random(seed);
    const RepeatedError found = repeated_error(grid, correlation, chains(grid, {6, 3, 2}, random, sigma, wave));
    ASSERT_EQ(found.cov.size(), grid.node_count()) << seed;
    EXPECT_GT(found.strength, found.threshold);
    double left[3] = {}, right = 0;
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < 17; ++i) {  // two nodes from the edge are averaged over
        for (std::size_t k = 0; k < 3; ++k) left[k] += double(found.cov[grid.node(i, j)][k]) / (17.0 * grid.ny);
        right += double(found.cov[grid.node(39 - i, j)][0]) / (17.0 * grid.ny);
      }
    EXPECT_NEAR(std::sqrt(left[0]), 0.03, 0.15 * 0.03) << seed;
    EXPECT_NEAR(std::sqrt(left[1]), 0.015, 0.15 * 0.015) << seed;
    EXPECT_NEAR(left[2], -0.03 * 0.015, 0.3 * 0.03 * 0.015) << seed;
    EXPECT_LT(std::sqrt(right), 0.2 * 0.03) << seed;
    for (const auto& c : found.cov) EXPECT_LE(c[2] * c[2], c[0] * c[1] * 1.0001f);
  }
}

TEST(Closure, AFewWildPlacesDecideNothing) {
  const Grid grid = grid_of(40, 30);
  std::mt19937_64 random(7);
  const auto wild = [](int i, int j) { return i < 4 && j < 4 ? Vec2(3, 3) : Vec2(0, 0); };
  EXPECT_TRUE(repeated_error(grid, correlation, chains(grid, {4, 4, 4}, random, sigma, wild)).cov.empty());
}

TEST(Closure, NodesThatNoTwoChainsKnowTakeTheirNeighbours) {
  const Grid grid = grid_of(30, 20);
  std::mt19937_64 random(3);
  std::vector<ClosureChain> two = chains(grid, {4, 4}, random, sigma, [](int, int) { return Vec2(0.05, 0.05); });
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 20; i < 30; ++i) two[1].off[grid.node(i, j)] = {nan, nan};
  const RepeatedError found = repeated_error(grid, correlation, two);
  ASSERT_FALSE(found.cov.empty());
  for (const auto& c : found.cov) ASSERT_TRUE(std::isfinite(c[0] + c[1] + c[2]));
  EXPECT_NEAR(std::sqrt(double(found.cov[grid.node(29, 10)][0])), 0.05, 0.02);
  two.pop_back();
  EXPECT_TRUE(repeated_error(grid, correlation, two).cov.empty());
  EXPECT_TRUE(repeated_error(grid, correlation, {}).cov.empty());
}

// Where the vectors of the whole field err alike, one field is a handful of places: by chance more is needed.
TEST(Closure, LongCorrelationAsksForMore) {
  const Grid grid = grid_of(24, 18);
  std::mt19937_64 random(1);
  const auto sample = chains(grid, {6, 6, 6}, random, sigma, none);
  EXPECT_GT(repeated_error(grid, 100 * h, sample).threshold, 2.5);
  EXPECT_EQ(repeated_error(grid, h, sample).threshold, 1);
}

}  // namespace
}  // namespace pivnp::piv
