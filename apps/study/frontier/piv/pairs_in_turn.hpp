// Correlators that measure known pairs in turn: what each takes, and what it finds.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "apps/study/frontier/front.hpp"
#include "apps/study/methods/frames/known_pairs.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/piv/piv.hpp"

namespace pivnp::app {

/// What a setting finds of a pair, over the places where it is judged.
struct Scored {
  double rms = NAN, bias = NAN, noise = NAN, gain = NAN;  // px; gain: share of the displacement that is found
  double valid = 0, wrong = 0;                            // shares of these places
};

/// Sums up errors over places. `valid` places alone count in errors; wrong are those of them that are more than .5 px off.
class Scores {
 public:
  void add(const Vec2& got, const Vec2& truth);
  void add_none() { ++all_; }
  Scored result() const;

 private:
  double sum_[2] = {0, 0}, square_[2] = {0, 0};
  double cross_ = 0, truths_ = 0, valid_ = 0, wrong_ = 0, all_ = 0;
};

/// A setting that takes part.
struct PivRun {
  FrontierPoint point;  // name, keys and marks are given; the rest is found
  piv::PivOptions options;
  piv::NodeLattice nodes;
  std::function<Scored(const KnownPair&, const piv::PixelVectors&)> score;
};

/// Measures every pair `repeats` times by each run, runs in turn, on `threads` threads. The points get times (a repeat's time is the
/// median over the pairs), memory, error (root mean square over the pairs from `first_compared` on) and the columns of
/// pair_columns(), and go to stage.points; what cannot be run goes to stage.left_out.
void measure_in_turn(std::vector<PivRun> runs, const KnownPairs& known, std::size_t first_compared, int repeats, int threads, Progress& progress,
                     FrontierStage& stage);
std::vector<FrontierColumn> pair_columns();
/// Column `valid` of these.
inline constexpr std::size_t valid_column = 1;

/// What rejects more than `reference` (by .02 of the places) has an easier task: it is on no front. Then finds the front.
void compare_alike(const FrontierPoint* reference, std::vector<FrontierPoint>& points);

}  // namespace pivnp::app
