// PIV-NP (Pinyol & Alvarado 2017; Alvarado 2018, chapter 2): numerical particles ride through the measured increments.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/np/fast_step.hpp"
#include "pivnp/np/increments.hpp"
#include "pivnp/np/options.hpp"
#include "pivnp/np/support.hpp"

namespace pivnp::np {

struct Scattered;  // triangle_gather.hpp

/// Follows particles through pairs of consecutive frames. State is double precision. Shape functions
/// (thesis, equations 2.1-2.4, 2.3 as corrected in docs/theory/particles.md): bilinear, or by NpOptions::shape of higher
/// order (basis.hpp) or on triangles, on the same nodes. Same bits for any number of threads.
class Tracker {
 public:
  /// `particles` are placed at x0 at `start_time` with F = I; those born later wait, unborn, until the first step that
  /// reaches their time of birth. Throws InputError for an option out of its range, arrays of unequal length or a position
  /// that is not finite.
  Tracker(const NpOptions& options, ParticleSet particles, double start_time);

  /// One pair: moves every living particle by the rule of the field's anchor,
  ///   forward: x1 = x0 + d(x0),   G at x0,                F1 = (I + G) F0
  ///   central: x1 = x0 + d(xm),   G at xm = (x0 + x1)/2,  F1 = (I - G/2)^-1 (I + G/2) F0
  /// The thesis moves by the first rule whatever the windows (2.9, 2.14) and sums small strains (2.7); why that is not
  /// enough: docs/theory/particles.md. xm is solved to 1e-14 spacings (and to the round-off of the position); if 50 iterations
  /// do not get there, the step is taken and flagged.
  ///
  /// Status of the step: flagged if it rests on a replaced vector, on a local affine fit (LocalFit) where the element
  /// has lost nodes, or on an unsettled mid-point; else active. A particle ends, with the time of its last good state,
  /// and keeps x, F and cov of that time: left_grid if its place (x0, or xm) is outside the grid, no_vectors if too few
  /// usable nodes are near it, bad_state if J <= 0 or a number is not finite. A last step may carry a particle out of
  /// the grid: that position is measured, and it ends at the next pair.
  ///
  /// cov_u, to first order in the errors: C1 = f C0 f^T + K E K^T with f = F1 F0^-1, K = I (forward) or (I - G/2)^-1
  /// (central), and E the covariance of the interpolated increment (docs/theory/particles_error.md). A pair without cov makes cov_u
  /// unknown from then on.
  ///
  /// Throws InputError if `time` is not after the present one, or if the field's arrays do not fit its grid.
  void step(const VectorField& field, double time);
  void step(const NodalIncrements& field, double time);
  /// The same with vectors at places of any kind, on linear Delaunay triangles whatever NpOptions::shape. Triangles
  /// with a side above `longest` hold no field, those with one above `usual` flag the step; a particle that no
  /// triangle holds ends with no_vectors.
  void step(const Scattered& field, double usual, double longest, double time);

  /// Puts a living particle where another estimate has it (drift correction). Throws InputError, the particle as it
  /// was, for numbers that are not finite or det F <= 0.
  void correct(std::size_t p, const Vec2& x, const Mat2& F, const std::array<double, 3>& cov);
  /// Particles that join at the present time, alive, with F = I. Throws InputError as the constructor.
  void add(const ParticleSet& born);
  /// Flags this frame's state of a living particle, for a reason outside the step.
  void flag(std::size_t p);

  const ParticleSet& particles() const { return particles_; }
  double time() const { return time_; }
  MotionFrame frame() const;  // the present state; cov_u empty if unknown

  // The state in full precision, for tests and for going on after a break.
  struct Particle {
    Vec2 x;
    Mat2 F;
    std::array<double, 3> cov{0, 0, 0};  // uu, vv, uv
    ParticleStatus status = ParticleStatus::active;
  };
  /// Reads like an array of Particle; held as separate arrays.
  class StateView {
   public:
    explicit StateView(const Tracker& tracker) : tracker_(tracker) {}
    std::size_t size() const { return tracker_.x_.size(); }
    Particle operator[](std::size_t p) const {
      return {tracker_.x_[p], tracker_.F_[p], tracker_.cov_[p], tracker_.status_[p]};
    }

   private:
    const Tracker& tracker_;
  };
  StateView state() const { return StateView(*this); }

  /// Everything needed to go on bit for bit, in this machine's byte order, with version, sizes and checksums.
  std::vector<std::byte> save() const;
  /// Into a tracker made with the same options and particles as the saved one. Throws InputError, leaving this tracker
  /// as it was, if the bytes are no such state, are damaged, or belong to other options or particles.
  void load(const std::vector<std::byte>& bytes);

 private:
  template <class Real>
  void advance(const Nodes<Real>& nodes, double time);
  void advance_fast(const Nodes<float>& nodes, double time);
  template <class GatherType>
  void carry(const GatherType& gather, bool central, bool with_cov, double time);
  template <class GatherType>
  void carry_one(const GatherType& gather, std::size_t p, bool central, bool with_cov, double time);
  void finish_step(bool with_cov, double time);
  void end(std::size_t p, EndReason reason);

  NpOptions options_;
  ParticleSet particles_;
  double time_;
  bool cov_known_ = true;
  std::vector<Vec2> x_;
  std::vector<Mat2> F_;
  std::vector<std::array<double, 3>> cov_;
  std::vector<ParticleStatus> status_;
  SupportMap support_;
  FastField fast_{};                  // buffers of the vectorised step
  std::vector<std::uint8_t> moved_;   // per particle
  std::vector<std::int32_t> element_;
};

}  // namespace pivnp::np
