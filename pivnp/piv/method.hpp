// What every correlation method does, and what they share. A method is one file and one row of the list in methods.cpp;
// PairCorrelator makes it anew for every other mask.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "pivnp/piv/dense/spline_field.hpp"
#include "pivnp/piv/piv.hpp"
#include "pivnp/piv/sampling/anchor_shares.hpp"
#include "pivnp/piv/validation/vector_validation.hpp"

namespace pivnp::piv {

/// The field that a pair's vectors were taken from, at a lattice of cells in pixels of a level of its method's frames.
struct DenseField {
  CellLattice lattice;
  int decimation = 1;
  std::vector<float> u, v;                // as measured, cell by cell
  std::vector<float> smooth_u, smooth_v;  // what smoothing made of it
  std::vector<float> variance_u, variance_v;  // that smoothing leaves
  std::vector<std::uint8_t> trusted;
  const std::vector<std::uint8_t>* wanted = nullptr;  // points near nodes that are on; empty: all
};

class Method {
 public:
  virtual ~Method() = default;
  /// Fills displacement, status, cov, score and correlation_px. As it gets them nothing is measured: values NaN, status
  /// masked where a node is off, failed elsewhere.
  virtual void correlate(const ImageView& first, const ImageView& second, PixelVectors& vectors) = 0;
  /// What of the first frame may be used from now on, in place of the mask that the method was made with; empty: that mask.
  /// Lattices and nodes stay as they are. The data belong to the caller.
  virtual void set_first_mask(const MaskView&) = 0;
  /// Where the next correlate() begins, in place of nothing known: vectors at the nodes, of those that are `known`.
  virtual void start_from(std::span<const std::array<float, 2>> /*displacement*/, std::span<const std::uint8_t> /*known*/) {}
  /// The mean displacement of several pairs; false: the method cannot average them.
  virtual bool correlate_mean(std::span<const FramePair>, PixelVectors&) { return false; }
  /// Puts the nodes elsewhere, by no more than a few pixels; false: the method must be made anew for that.
  virtual bool place(const NodeLattice&) { return false; }
  /// Of the last pair, of methods that smooth as far as noise asks for; null of others.
  virtual const DenseField* field() const { return nullptr; }
};

inline ValidationLimits limits_of(const PivOptions& options) {
  return {options.median_threshold, options.median_floor_px, options.min_score,
          options.max_sigma_px,     options.min_usable,      options.replace};
}

/// Variance of a grey value's rounding, grey^2.
inline float rounding_variance(const ImageView& image) {
  return image.depth == PixelDepth::f32 ? 1e-14f * image.white * image.white : 1.0f / 12.0f;
}

}  // namespace pivnp::piv
