// Motions that are known: what carries synthetic texture, and the truth that measurements are judged by.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"

namespace pivnp::app {

/// The same affine increment every frame: x -> centre + A (x - centre) + shift, world.
struct AffineMotion {
  Mat2 A = Mat2::Identity();
  Vec2 centre = Vec2::Zero(), shift = Vec2::Zero();

  Vec2 next(const Vec2& x) const { return centre + A * (x - centre) + shift; }
  Vec2 at(Vec2 x, int frame) const {
    for (int k = 0; k < frame; ++k) x = next(x);
    return x;
  }
  Mat2 F(int frame) const {
    Mat2 f = Mat2::Identity();
    for (int k = 0; k < frame; ++k) f = A * f;
    return f;
  }
};
AffineMotion affine_motion(const SynthOptions& synth, const Setting& setting);

/// A slope in a centrifuge, staged in closed form like section 2.4 of Alvarado (2018): first third of the time, gravity
/// rises and the slope settles (uniform vertical strain); second third, a wetting front rises from the base and what is
/// behind it collapses (vertical strain over a smooth front); last third, a body slips on a circle, turning about its
/// centre by an angle that fades over a band and grows as the square of time. Not a simulation: no stresses.
struct StagedSlope {
  double base = 0, height = 1;              // of the material at the start, world
  double settlement = 0, collapse = 0;      // vertical strains, shortening
  double front = 1;                         // half width of the wetting front, length
  Vec2 centre = Vec2::Zero();
  double radius = 1, band = 1, turn = 0;    // length, length, rad

  /// Where the material that was at X is at `time`, 0 to 1.
  Vec2 at(const Vec2& X, double time) const;
  /// By differences of at(): error about 1e-8.
  Mat2 F(const Vec2& X, double time) const;
};
StagedSlope staged_slope(const SynthOptions& synth, const Setting& setting);

/// How the camera of [synth.camera] moves; at rest in the first frame.
CameraMotion drawn_camera(const Case& c);

/// Counter-based random numbers in [0, 1): the same on every platform. Splitmix64 (Steele, Lea & Flood 2014).
double uniform(std::uint64_t seed, std::uint64_t index);

/// Points scattered evenly over a polygon's box and kept inside it; `per_area` a unit area.
std::vector<Vec2> scatter(const std::vector<Region>& regions, double per_area, std::uint64_t seed);

}  // namespace pivnp::app
