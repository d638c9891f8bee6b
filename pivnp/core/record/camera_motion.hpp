// How a camera that is not at rest moved while it filmed.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp {

/// What is at rest at p in the first frame is at centre + scale R(turn) (p - centre) + shift in a later one. Pixels
/// (column, row) as a lens without distortion would show them; `turn` takes columns to rows (clockwise as one sees it).
struct CameraPlace {
  Vec2 shift = Vec2::Zero();  // px
  double turn = 0;            // rad
  double scale = 1;
  double var_shift = 0;       // of either component of `shift`, px^2
  double var_turn = 0;        // of `turn` and of `scale`, rad^2
  double residual = 0;        // RMS of the points that agree, px
  int points = 0, agree = 0;  // subsets that were found again, and those of them that move alike
};

/// Of all frames of a run; empty: the camera is taken to be at rest.
struct CameraMotion {
  Vec2 centre = Vec2::Zero();  // px; the middle of the image
  std::vector<CameraPlace> at;  // one a frame

  bool empty() const { return at.empty(); }
  /// Maps pixels of the first frame to those of frame `k`, homogeneous coordinates.
  Mat3 matrix(std::size_t k) const {
    const CameraPlace& p = at[k];
    const double c = p.scale * std::cos(p.turn), s = p.scale * std::sin(p.turn);
    Mat3 m;
    m << c, -s, centre.x() + p.shift.x() - c * centre.x() + s * centre.y(),  //
        s, c, centre.y() + p.shift.y() - s * centre.x() - c * centre.y(),    //
        0, 0, 1;
    return m;
  }
  /// Variance of a component of where that map takes `pixel`, px^2.
  double variance(std::size_t k, const Vec2& pixel) const {
    return at[k].var_shift + at[k].var_turn * (pixel - centre).squaredNorm();
  }
};

}  // namespace pivnp
