// One data set of a comparison, read frame by frame and counted from the time at which both data sets have begun.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pivnp/core/particles/motion.hpp"

namespace pivnp::compare {

/// The first's times at which the second is known too.
struct CommonTimes {
  double start = 0;           // the later of the two beginnings: displacements count from here
  bool begin_together = true;  // else one data set is under way at the start
  double tolerance = 0;       // times closer than this are the same instant
  std::vector<double> times;  // ascending
};

/// Throws InputError if times do not ascend or nothing is in common.
CommonTimes common_times(const MotionSource& first, const MotionSource& second);

/// A data set at one time.
struct DataSetState {
  double time = 0;
  std::vector<std::uint8_t> followed;       // 1: without a break from the common start to this time
  std::vector<Vec2> u;                      // displacement since the common start; unset where not followed
  std::vector<Mat2> F;                      // deformation gradient since the common start
  std::vector<std::array<double, 3>> cov;   // uu, vv, uv of the displacement; empty if not known
  std::vector<std::array<double, 3>> cov_F;  // xx, yy, xy of the errors of a row of F; empty if not known
};

/// Reads a motion in ascending time, holding two of its frames. Between frames u, F and the covariance are linear in
/// time; a particle is followed there only if both frames have it. Once lost it stays lost.
/// Where one motion begins before the other, a data set that has moved at the common start is counted anew from its state
/// there: X = x0 + u(s), u(t) - u(s), F(t) F(s)^-1; its covariance is kept whole, which bounds that of the difference of
/// positively correlated errors. (A motion whose first frame holds displacements is as well under way as one that began
/// earlier.) Motions that begin together are taken as they are.
class DataSet {
 public:
  DataSet(const MotionSource& motion, const CommonTimes& common);

  const MotionSource& motion() const { return *motion_; }
  std::size_t size() const { return X_.size(); }
  const std::vector<Vec2>& material_position() const { return X_; }  // at the common start
  const std::vector<double>& spacing() const { return spacing_; }    // of each particle to its neighbours
  double median_spacing() const { return median_spacing_; }
  bool counted_anew() const { return !F_start_.empty(); }
  /// Particles that were not there yet at the common start: displacement since x0 would count from another time.
  std::size_t born_later() const { return born_later_; }

  /// `time` not before the one asked for last.
  const DataSetState& at(double time);
  const DataSetState& state() const { return state_; }  // as of the last call; `followed` also before the first

 private:
  struct Held {
    std::size_t index = 0;
    bool filled = false;
    MotionFrame frame;
  };
  const MotionFrame& frame(std::size_t index);
  void read(double time);
  bool has_moved() const;
  void count_anew();
  void find_spacing();

  const MotionSource* motion_;
  double tolerance_;
  std::array<Held, 2> held_;
  DataSetState state_;
  std::vector<Vec2> X_, u_start_;
  std::vector<Mat2> F_start_;  // empty: counted from its own beginning; else the inverse of F at the start
  std::vector<double> spacing_;
  double median_spacing_ = 0;
  std::size_t born_later_ = 0;
};

}  // namespace pivnp::compare
