// Which vectors disagree with their neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace pivnp::piv {

/// Vectors on a lattice of nx x ny points, flat index j*nx + i.
struct VectorGrid {
  int nx = 0, ny = 0;
  std::vector<std::array<float, 2>> displacement;
  std::vector<std::uint8_t> good;  // 1: takes part
};

/// Normalised median test (Westerweel & Scarano 2005) over 5 x 5 neighbours, freed of the local gradient first (median
/// differences of adjacent vectors), so that a steep but even gradient is no outlier: a vector fails where
///   | d - median | / (median |d_k - median| + bend + floor) > threshold   (norm over both components),
/// bend being the lower quartile of the neighbours' second differences: what curvature alone makes d deviate by.
/// A vector with fewer than three good neighbours is not tested. Two rounds: the second tests every candidate against
/// the survivors of the first, so that good vectors that an outlier had failed come back. Clears `good` of those that
/// fail.
void median_test(VectorGrid& vectors, double threshold, double floor_px, int threads);

}  // namespace pivnp::piv
