// Pairs of synthetic frames with known displacement: blobs drawn at analytically moved places, no image is warped.
// Everything is in pixels of the image: (column, row), row downward.
#pragma once

#include <functional>

#include "pivnp/core/image_view.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"

namespace pivnp::image {

/// Displacement that a particle at a place (column, row) of the first frame undergoes.
using Motion = std::function<Vec2(const Vec2&)>;

Motion uniform(double u, double v);
Motion rotation(double degrees, double cx, double cy);
/// u = slope (y - middle).
Motion plain_shear(double slope, double middle);
/// Triangle wave in y, steepest at 64 px, 192 px ... of its period of 256 px.
Motion triangle_shear(double slope);
/// Shear wave of the named length across its own direction, which is tilted by 5 degrees.
Motion sine(double amplitude, double length);
/// amplitude tanh(s / half_width), s across a line through (cx, cy) tilted by 5 degrees; displacement along the line.
Motion band(double amplitude, double half_width, double cx, double cy);
/// Swirl amplitude (r/radius) exp((1 - r^2/radius^2)/2): fastest, by `amplitude`, at `radius`.
Motion vortex(double amplitude, double radius, double cx, double cy);
/// Extension in x by `far` everywhere, and by `peak` more at (cx, cy), falling as a Gaussian of `sigma` around it.
Motion strain_concentration(double far, double peak, double sigma, double cx, double cy);

/// Displacement that belongs to a place: forward, of the particle there in the first frame; central, of the particle
/// whose mid-point is there (fixed-point iteration; the motion's gradient must stay below 2).
Vec2 displacement_at(const Motion& motion, const Vec2& place, Anchor anchor);

struct SyntheticPair {
  Motion motion;
  int width = 0, height = 0;
  Image first, second;

  Vec2 truth(const Vec2& place, Anchor anchor) const { return displacement_at(motion, place, anchor); }
};

/// Blobs are scattered evenly at random over the image and a margin beyond it, so that they enter where others leave;
/// the margin is 48 px: motions beyond that leave an empty rim. texture.loss of the blobs reappear at random in the
/// second frame. Throws InputError as BlobRenderer does.
SyntheticPair synthetic_pair(Motion motion, int width, int height, const TextureOptions& texture);

}  // namespace pivnp::image
