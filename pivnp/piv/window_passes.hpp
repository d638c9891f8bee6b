// Passes of cross-correlated windows on even lattices, from large windows to small: they find the predictor.
#pragma once

#include <span>
#include <vector>

#include "pivnp/piv/piv.hpp"
#include "pivnp/piv/sampling/extent.hpp"
#include "pivnp/piv/validation/median_test.hpp"
#include "pivnp/piv/window/correlate.hpp"
#include "pivnp/piv/window/uncertainty.hpp"
#include "pivnp/piv/window/warp.hpp"

namespace pivnp::piv {

/// What one thread needs for windows of one side.
struct WindowTools {
  WindowTools(int side, bool far) : window(side), near(side), uncertainty(side) {
    if (far) fft.emplace_back(side);
  }
  Window window;
  NearCorrelator near;
  std::vector<FftCorrelator> fft;  // one, if this side is searched far
  UncertaintyEstimator uncertainty;

  Peak find(Search search) { return search == Search::far ? fft.front().find(window) : near.find(window); }
};

/// One window size: the resolution its images are taken at, and the even lattice its predictor is measured on.
struct WindowStage {
  int side = 0;  // pixels of the full image
  int decimation = 1;
  EvenLattice lattice;
  NodeLattice points;
  int passes = 0;                  // on the even lattice
  bool searches = false;           // the first of them searches far; the others refine
  std::vector<WindowTools> tools;  // one a thread

  int level_side() const { return side / decimation; }
};

/// Sides of the windows in pixels of the full image, first to last. `first_window_px` = 0: four times the last window,
/// at least 128 px, at most half the image's shorter side.
std::vector<int> window_sides(const PivOptions& options, int width, int height);

/// Decimation at which about 32 pixels of a window are left; the last window always sees the full image.
int decimation_of(int side, int last_side);

class WindowPasses {
 public:
  WindowPasses(const PivOptions& options, const Extent& extent, int threads);

  /// A stage after those before it: `step` is its lattice's spacing in pixels.
  void add(int side, int decimation, float step, int passes, bool searches);
  bool empty() const { return stages_.empty(); }
  WindowStage& last() { return stages_.back(); }

  /// As Method::set_first_mask.
  void set_first_mask(const MaskView& mask);

  /// As Method::start_from: find() then leaves out the windows that are larger than the last one.
  void start_from(std::span<const std::array<float, 2>> displacement, std::span<const std::uint8_t> known);

  /// Takes the frames and runs every stage from a predictor of zero, or from where it was told to start.
  const PredictorField& find(const ImageView& first, const ImageView& second);
  /// The same for the mean of several pairs.
  const PredictorField& find(std::span<const FramePair> pairs);
  const PredictorField& predictor() const { return predictor_; }

  /// Both frames warped by the predictor at the stage's resolution, over what its windows see.
  const WarpedPair& warp(const WindowStage& stage);
  /// The frames as last taken at a decimation that a stage has; else null.
  const Level* images(int decimation) const;
  bool enough(const Window& window) const { return window.usable >= static_cast<float>(options_.min_usable); }
  bool textured(const Window& window) const;
  float rounding_variance() const { return rounding_variance_; }
  /// Takes the frames of another pair of those that go together.
  void take_images(const ImageView& first, const ImageView& second);
  void take_images(const FramePair& pair);
  /// Of the mean of `count` pairs: what would be noise in one of them is less in their mean.
  float least_score(std::size_t count) const;

 private:
  std::vector<std::uint8_t> mask_at(const MaskView& mask, int decimation) const;
  const Level& level(const WindowStage& stage) const { return *images(stage.decimation); }
  void improve_predictor(WindowStage& stage);
  float measure(WindowStage& stage, Search search, VectorGrid& found);
  float measure_mean(WindowStage& stage, Search search, VectorGrid& found);

  std::span<const FramePair> pairs_;  // while several are looked at together; else empty
  PivOptions options_;
  Extent extent_;
  int threads_;
  Anchor anchor_;
  std::vector<WindowStage> stages_;
  std::vector<Level> levels_;
  PredictorField predictor_, start_;
  bool started_ = false;
  WarpedPair warped_;
  float rounding_variance_ = 0;  // grey^2
};

}  // namespace pivnp::piv
