// PIV-NP (Pinyol & Alvarado 2017; Alvarado 2018, chapter 2): numerical particles ride through the measured increments.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/np/fast_step.hpp"
#include "pivnp/np/increments.hpp"
#include "pivnp/np/options.hpp"
#include "pivnp/np/errors/reading_error.hpp"
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
  /// has lost nodes, or on an unsettled mid-point, or if what was read wrongly between the nodes so far exceeds both the
  /// random part of the uncertainty and least_bias spacings; else active. A particle ends, with the time of its last good state,
  /// and keeps x, F and cov of that time: left_grid if its place (x0, or xm) is outside the grid, no_vectors if too few
  /// usable nodes are near it, bad_state if J <= 0 or a number is not finite. A last step may carry a particle out of
  /// the grid: that position is measured, and it ends at the next pair.
  ///
  /// cov_u, to first order in the errors: C1 = f C0 f^T + K E K^T with f = F1 F0^-1, K = I (forward) or (I - G/2)^-1
  /// (central), and E the covariance of the interpolated increment (docs/theory/particles_error.md). Beside it the error
  /// of reading between the nodes (ReadingErrors) is carried as a vector, b1 = f b0 + K b, that adds up along the path;
  /// cov_u = C + b b^T. cov_F: the errors of both rows of F have the covariance R1 = (f:f)/2 R0 + g F0^T F0, g the
  /// variance of a component of the gradient. A pair without cov makes all of it unknown from then on.
  ///
  /// Throws InputError if `time` is not after the present one, or if the field's arrays do not fit its grid.
  void step(const VectorField& field, double time);
  void step(const NodalIncrements& field, double time);
  /// The same with vectors at places of any kind, on linear Delaunay triangles whatever NpOptions::shape. Triangles
  /// with a side above `longest` hold no field, those with one above `usual` flag the step; a particle that no
  /// triangle holds ends with no_vectors.
  void step(const Scattered& field, double usual, double longest, double time);

  /// Puts a living particle where another estimate has it (drift correction), with the random part of its covariance,
  /// its bias and the covariance of a row of F. Throws InputError, the particle as it was, for numbers that are not
  /// finite or det F <= 0.
  struct Correction {
    Vec2 x;
    Mat2 F;
    std::array<double, 3> random{0, 0, 0};
    Vec2 bias = Vec2::Zero();
    std::array<double, 3> cov_F{0, 0, 0};
  };
  void correct(std::size_t p, const Correction& to);
  /// Adds to the covariance of a row of F, xx, yy, xy, for a reason outside the step.
  void widen_F(std::size_t p, const std::array<double, 3>& by);
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
    std::array<double, 3> cov{0, 0, 0};  // uu, vv, uv: random part and bias bias^T
    ParticleStatus status = ParticleStatus::active;
    std::array<double, 3> random{0, 0, 0};
    Vec2 bias = Vec2::Zero();              // of reading between nodes: what is expected less what was read
    std::array<double, 3> cov_F{0, 0, 0};  // xx, yy, xy of a row of F
  };
  /// In spacings: a bias below it is nobody's concern.
  static constexpr double least_bias = 1.0 / 64;
  /// Reads like an array of Particle; held as separate arrays.
  class StateView {
   public:
    explicit StateView(const Tracker& tracker) : tracker_(tracker) {}
    std::size_t size() const { return tracker_.x_.size(); }
    const Vec2& place(std::size_t p) const { return tracker_.x_[p]; }
    const Mat2& F(std::size_t p) const { return tracker_.F_[p]; }
    ParticleStatus status(std::size_t p) const { return tracker_.status_[p]; }
    Particle operator[](std::size_t p) const {
      return {tracker_.x_[p], tracker_.F_[p], tracker_.total(p), tracker_.status_[p],
              tracker_.cov_[p], tracker_.bias_[p], tracker_.cov_F_[p]};
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
  void advance(const Nodes<Real>& given, double time);
  template <class GatherType>
  void carry_fast(const GatherType& gather, const Nodes<float>& nodes,
                  std::span<const std::array<double, 2>> coefficients, double time);
  template <class GatherType>
  void carry(const GatherType& gather, bool central, bool with_cov, double time);
  template <class GatherType>
  void carry_one(const GatherType& gather, std::size_t p, bool central, bool with_cov, double time);
  void finish_step(bool with_cov, double time);
  std::array<double, 3> total(std::size_t p) const;  // covariance of u
  bool biased(std::size_t p) const;
  void end(std::size_t p, EndReason reason);

  NpOptions options_;
  ParticleSet particles_;
  double time_;
  bool cov_known_ = true;
  std::int32_t steps_ = 0;
  std::vector<Vec2> x_;
  std::vector<Mat2> F_;
  std::vector<std::array<double, 3>> cov_;    // random part
  std::vector<Vec2> bias_;
  std::vector<std::array<double, 3>> cov_F_;  // xx, yy, xy of a row
  double bias_limit_ = 0;                     // least_bias, as a length
  std::vector<ParticleStatus> status_;
  SupportMap support_;
  ReadingErrors reading_;
  FastField fast_{};                  // buffers of the vectorised step
  std::vector<std::uint8_t> moved_;   // per particle
  std::vector<std::int32_t> element_;
};

}  // namespace pivnp::np
