// A rigid body without texture of its own, followed by its outline.
#pragma once

#include <string>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/core/record/camera_motion.hpp"

namespace pivnp::image {

/// The grey values in a band along the outline, from 8 px inside to 5 px outside, are found again in later frames: those of the
/// first frame, averaged along the outline over strips of 8 px (which lessens what the texture outside, which moves, has to say),
/// are compared with those under a shift and a turn, with gain and offset of the light left free. First by whole pixels (greatest
/// correlation of the band within `search_px`), then by Gauss-Newton steps with Tukey's weights on the images smoothed by 2.5 and
/// then by 1 px (Lucas & Kanade 1981; Baker & Matthews 2004, the forward additive form; the band as in contour-based tracking,
/// Drummond & Cipolla 2002). Where the outline shows no turn (a circle), none is sought.
class OutlineFollower {
 public:
  /// `outline`: where the body's edge is in `first`, to about 3 px. Throws InputError (begun by `what`) if the band holds no edge
  /// (a step of less than 2 % of white), or if the edge shows motion in one direction alone.
  OutlineFollower(const ImageView& first, std::vector<Vec2> outline, int search_px, const std::string& what);

  const Vec2& centre() const { return centre_; }
  bool turns() const { return turns_; }
  /// Of `before`, the place in the frame before. points: strips of the outline within the image; agree: those that fit. points = 0:
  /// lost (fewer than half agree, or the band does not correlate clearly better than it does at other places of the
  /// first frame, at least by .6).
  CameraPlace place(const ImageView& image, const CameraPlace& before) const;

 private:
  struct Patch;
  struct Solution;
  Vec2 moved(const CameraPlace& place, const Vec2& p) const;
  Patch patch_about(const ImageView& image, const CameraPlace& place, double margin, double sigma) const;
  std::vector<double> band(const Patch& patch, const CameraPlace& place, std::vector<Vec2>* slope = nullptr, std::size_t every = 1) const;
  Solution refine(const Patch& patch, const std::vector<double>& reference, CameraPlace place, int steps) const;

  std::vector<Vec2> points_;                 // px, first frame; strip by strip, across by across, along by along
  std::vector<double> fine_, coarse_;        // means over the strips in the first frame
  Vec2 centre_ = Vec2::Zero();
  double step_ = 0;                          // of grey between both sides of the edge
  double least_score_ = 0;
  int search_px_ = 0;
  bool turns_ = true;
};

}  // namespace pivnp::image
