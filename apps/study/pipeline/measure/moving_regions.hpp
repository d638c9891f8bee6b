// Regions that move with their material, as masks of the frames that are correlated.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/study/pipeline/measure/moving_outline.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/record/remark.hpp"

namespace pivnp::app {

/// Follows the outlines of a case's regions and leaves out what lies beyond them, pair by pair, where that is shown to be no
/// material: it has texture that stands still while the material beside it moves. Elsewhere nothing is left out, so that a
/// region that ends within material, or before plain ground, changes nothing. Points of the outline are carried by weighted affine fits of the
/// vectors inside (docs/theory/frames.md). Within a group of pairs (SequenceCorrelator) they are carried by each pair's
/// own vectors, from group to group by those that are kept: a run that is taken up again finds the same masks.
class MovingRegions {
 public:
  /// `window_px`: of [piv]. `on`: false follows nothing. `row_time_s`: where it is not 0, the vectors that are kept are those of the
  /// frames' own times (RowClock), of `times`, while outlines are seen row by row.
  MovingRegions(const Setting& setting, int window_px, bool on, double row_time_s = 0, std::vector<double> times = {});
  bool any() const { return !now_.empty(); }

  /// Looks beyond the outlines in pair (frame, frame + 1): mask() is then what of its first frame may be material; empty: all.
  void look(int frame, const ImageView& first, const ImageView& second);
  MaskView mask() const;
  /// With the pair's own vectors: true if they show something else outside than was known, so that the pair should be
  /// measured again with what mask() returns now.
  bool revise(const VectorField& own, const ImageView& first, const ImageView& second);
  /// The outlines to the pair's second frame.
  void carry(const VectorField& own);
  /// The same without vectors: all goes on as in the pair before.
  void carry_on();

  /// The vectors that are kept, pair by pair from the first on; begin_group() goes on from what they say, as in the pair before
  /// where the last pair is not kept yet.
  void keep(const VectorField& kept);
  void begin_group(bool one_more = false);

  const std::vector<MovingOutline>& outlines() const { return now_; }
  /// Of all points and pairs so far: the share beside which something was left out.
  double left_out() const { return judged_ > 0 ? double(masked_) / double(judged_) : 0; }
  /// Sentences on what was left out, and on regions that were lost.
  std::vector<Remark> remarks() const;

 private:
  const Setting& setting_;
  int window_px_;
  double row_time_s_;
  std::vector<double> times_;
  bool kept_moves_ = false;  // a pair was kept, so that points know what they moved by
  std::vector<MovingOutline> now_, kept_;
  std::vector<std::uint8_t> mask_;
  std::vector<std::string> lost_;
  std::size_t judged_ = 0, masked_ = 0;
};

/// The outlines of the case's regions in the first frame.
std::vector<MovingOutline> outlines_of_regions(const Setting& setting);

/// To the second frame of that pair, by its vectors; false if one is lost. carry_outlines() adds points where they have moved apart,
/// drops those that have come together, and leaves none where a region is lost.
bool move_outlines(const VectorField& field, const Setting& setting, int window_px, std::vector<MovingOutline>& outlines);
void carry_outlines(const VectorField& field, const Setting& setting, int window_px, std::vector<MovingOutline>& outlines);

/// Pixels whose centres lie inside any of the outlines (by winding number: an outline may fold), as seen in that frame; one byte a pixel.
std::vector<std::uint8_t> inside_outlines(const std::vector<MovingOutline>& outlines, const image::Camera& camera, int width, int height);

/// Moves of the outline's points in that pair, by the vectors that start inside (bytes of inside_outlines); false if vectors are
/// found beside less than half of the points that have nodes near.
bool find_moves(const VectorField& field, const std::vector<std::uint8_t>& inside, const Setting& setting, double reach, MovingOutline& outline);

}  // namespace pivnp::app
