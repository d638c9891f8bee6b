// The displacement that is known before a pass: a smooth field over the image, from the vectors of the pass before.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pivnp/piv/sampling/lattice.hpp"

namespace pivnp::piv {

/// Displacement in pixels of the full image at any place (column, row) of it. Between control points: cubic convolution
/// (Keys 1981), which repeats quadratic fields exactly and is continuous in the first derivative; beyond the outermost
/// control points it goes on linearly. A new field is zero everywhere.
class PredictorField {
 public:
  PredictorField() = default;

  /// Fits the field to vectors measured on an even lattice: at each control point (the lattice's own points) a weighted
  /// least-squares polynomial over 5 x 5 points, quadratic where enough of them are good, else affine (the filter of
  /// Schrijer & Scarano 2008). Weights are Gaussian, of standard deviation `sigma` lattice steps. Points farther than
  /// that from any good vector take the mean of their neighbours, ring by ring.
  void fit(const EvenLattice& lattice, const std::vector<std::array<float, 2>>& displacement,
           const std::vector<std::uint8_t>& good, float sigma, int threads);

  std::array<float, 2> at(float column, float row) const;

  /// Displacements along one row of pixels: at columns first + k step, k < count.
  struct RowPlan {
    struct Run {
      int cell = 0;  // first of four control columns (ghost column included)
      int begin = 0, end = 0;
    };
    std::vector<Run> runs;                       // of places with the same control columns
    std::array<std::vector<float>, 4> weight;    // of each place
    bool empty() const { return runs.empty(); }  // the zero field
  };
  RowPlan plan_row(float first, float step, int count) const;
  void row(const RowPlan& plan, float row, std::vector<float>& scratch, float* du, float* dv) const;

 private:
  struct Axis {
    int cell;
    std::array<float, 4> weight;
  };
  static Axis axis(float position, float origin, float spacing, int points);
  void fill_far_points(std::vector<std::uint8_t>& known);
  void set_ghosts();
  std::array<float, 2>& value(int i, int j) { return values_[std::size_t((j + 1) * (lattice_.nx + 2) + i + 1)]; }
  const std::array<float, 2>& value(int i, int j) const {
    return values_[std::size_t((j + 1) * (lattice_.nx + 2) + i + 1)];
  }

  EvenLattice lattice_;                       // no points: the zero field
  std::vector<std::array<float, 2>> values_;  // with a ring of ghosts, continued linearly
};

}  // namespace pivnp::piv
