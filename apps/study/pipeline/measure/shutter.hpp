// What the time that an exposure and the read-out of the rows take does to vectors.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/record/remark.hpp"
#include "pivnp/image/frames/frames.hpp"

namespace pivnp::app {

/// Brings the vectors of a camera that reads its rows one after the other (rolling shutter) to the times of the frames, which
/// are those of the middle row. Row r is exposed later than the middle row by tau (r - r_m), tau = camera.row_time_s. A vector
/// that leads from row a to row b therefore took dt + tau (b - a), and was measured tau (r - r_m) late, r the row of its anchor
/// (forward: a, central: the mean of both). Its velocity is the displacement by that duration; the velocity of the frames' own
/// time is interpolated at the node between the velocities of the pair before, this and the next, each at its own time (Lagrange,
/// exact where velocity is quadratic in time; linear or none where neighbours have no vector). The variances go along with the weights.
class RowClock {
 public:
  /// `frames`: of the whole sequence, with times in s.
  RowClock(double row_time_s, const Setting& setting, const std::vector<Frame>& frames);

  /// Fields of pairs (k, k + 1) in their order as measured; returns those that are finished, at most one.
  std::vector<VectorField> add(VectorField raw);
  /// The last.
  std::vector<VectorField> finish();
  /// Of a pair alone: the duration is corrected, the time of measurement is not.
  VectorField alone(const VectorField& raw) const;

 private:
  struct Timed {
    VectorField field;
    std::vector<double> duration, middle;  // of each vector, s
  };
  Timed timed(VectorField raw) const;
  VectorField corrected(const Timed* before, const Timed& now, const Timed* after) const;

  double row_time_s_;
  const Setting& setting_;
  std::vector<double> time_;
  std::deque<Timed> held_;
};

/// How far the fastest material moves while a picture is exposed and read: one sentence each where exposure_s or row_time_s is
/// given. `pair`: of frames k and k + 1.
std::vector<Remark> shutter_remarks(const Case& c, const Setting& setting, const std::vector<Frame>& frames, std::size_t pairs,
                                         const std::function<VectorField(std::size_t)>& pair);

}  // namespace pivnp::app
