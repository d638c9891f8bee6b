// When a motion begins: from one history, and as the offset in time between two motions.
#pragma once

#include <limits>
#include <vector>

#include "pivnp/core/options.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::compare {

struct Onset {
  double time = std::numeric_limits<double>::quiet_NaN();   // NaN: none found
  double sigma = std::numeric_limits<double>::quiet_NaN();  // standard uncertainty
};

/// Onset of a history that starts near 0 and grows: where the line through value^(1/power) against time, fitted by
/// least squares over the rise from 2 to 25 % of the greatest value (up to three points, where fewer lie between),
/// meets zero. power = 2 is exact for constant acceleration from rest, 1 for constant speed. The share of the greatest
/// value, not a length, decides: a history that is larger throughout has the same onset. Uncertainty: of the line's
/// zero by its scatter, and of one time step as a rectangular distribution over 20 (what the fit cannot see).
Onset find_onset(const std::vector<double>& time, const std::vector<double>& value, int power);

/// How far a motion has gone: s(t) = sum u(t).u(T) / sum |u(T)|^2 over the particles followed to the last time T. 0 at
/// rest whatever the noise (its products average out), 1 at the end. With a `zone` of material positions its rigid
/// motion (shift and `turn`) is taken off first.
struct Participation {
  std::vector<double> time, share;
  std::vector<double> sigma;  // of the share, if one error is shared by all particles, by the covariance; 0: not known
  // The same with one of 4 x 4 blocks of the material left out; empty with fewer than four blocks.
  std::vector<std::vector<double>> without;
};
Participation participation(const MotionSource& motion, const Points& zone, bool turn);

/// What has to be added to the second's times so that both onsets agree; both histories are read with the one power (1 or
/// 2) that fits the first better. NaN if an onset is not found. Uncertainty, in squares: the greater of the scatter about
/// both lines and the jackknife over blocks of each motion (errors of a path stay from time to time, so the scatter alone
/// is 1.6 times too small); an error that all particles share, as the covariances state it; and what the offset changes
/// by with the other power, rectangular (motions that begin by different laws have no one offset).
Onset onset_offset(const Participation& first, const Participation& second);

}  // namespace pivnp::compare
