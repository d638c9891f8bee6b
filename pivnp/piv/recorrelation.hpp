// Where a level's field sits on a wrong match: such places are found and searched again.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/piv/dense/gn_level.hpp"
#include "pivnp/piv/dense/quality.hpp"
#include "pivnp/piv/window_passes.hpp"

namespace pivnp::piv {

/// Points of a lattice that have texture, and those of them whose frames do not match.
struct Mismatch {
  std::vector<std::uint8_t> textured, poor;
  std::size_t count = 0;     // of the poor ones
  bool frames_poor = false;  // so many that the frames are poor, not the match

  Mismatch(const MatchQuality& quality, float rounding);
};

/// Searches points next to poor ones with small windows, from what the matched surroundings say.
class Recorrelation {
 public:
  Recorrelation(const PivOptions& options, int threads);
  /// `u`, `v`: the field at the level's lattice, level pixels; open points get new values.
  void search(const GnLevel& level, const Mismatch& mismatch, std::vector<float>& u, std::vector<float>& v);

 private:
  void find(const GnLevel& level, std::size_t k, WindowTools& tools, const std::vector<std::uint8_t>& textured);

  double median_threshold_, median_floor_px_;
  float min_usable_;
  Anchor anchor_;
  int threads_;
  std::vector<WindowTools> tools_;  // one a thread
  // Of the search in work:
  VectorGrid known_;
  PredictorField around_;
  WarpedPair warped_;
};

}  // namespace pivnp::piv
