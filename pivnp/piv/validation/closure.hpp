// The error that every pair repeats at a place, found by closure: displacements summed over a chain of steps against
// the direct correlation of its first and last frame.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pivnp/core/grid/grid.hpp"

namespace pivnp::piv {

/// One chain of `steps` pairs, for every node of the grid: where the material that was at the node in the first frame
/// is in the last one, by the steps in turn less by one direct pair. NaN where either of them does not hold.
struct ClosureChain {
  int steps = 2;
  std::vector<std::array<double, 2>> off;  // length
  std::vector<std::array<double, 2>>
      variance;  // of either component as stated: steps and direct pair together, length^2
};

struct RepeatedError {
  double strength = 0;   // mean over nodes and components of (repeated variance) / (its standard error), each within 10
  double threshold = 0;  // what strength must pass
  std::vector<std::array<float, 3>>
      cov;  // at the nodes: uu, vv, uv, length^2; empty: closure agrees with what is stated
};

/// A pair's error is modelled as e + b: e independent from pair to pair (its variance is stated), b the same at a place
/// in every pair: what stands still in the picture (lamps, reflections, dirt on the glass), grains too fine for the
/// pixels, structure below the noise. A chain of n steps has n b, its direct pair, a pair like any other, b: they
/// differ by (n - 1) b and by independent errors. Products of the differences of *different* chains, which share no
/// pair, have the expectation (n - 1)(m - 1) b b^T, whatever the size of e. Averaged over pairs of chains and over 5 x
/// 5 nodes they estimate b b^T (a component of variance, as by analysis of variance); its standard error follows from
/// the stated variances, with the 25 nodes counted as one.
///
/// Nothing is found unless the mean strength passes max(1, 4/sqrt(places)), places = 2 x area of the nodes / (2
/// correlation_length)^2. Where it does, a component counts at places where it is above its own standard error; nodes
/// that no two chains know take the mean of their neighbours', from the rim inward. Source of the idea: closure of
/// triplets in metrology (Gray & Allan 1974, "three-cornered hat"); the estimate as DerSimonian & Laird 1986.
RepeatedError repeated_error(const Grid& grid, double correlation_length, std::span<const ClosureChain> chains);

}  // namespace pivnp::piv
