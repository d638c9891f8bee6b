// What of a frame may be material, for direct pairs of frames of a sequence that is measured.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "apps/study/pipeline/measure/moving_outline.hpp"
#include "apps/study/pipeline/scene/scene.hpp"

namespace pivnp::app {

/// The regions of a case as masks of frames any distance apart (closure, steps over dropped frames): their outlines
/// are carried by the vectors that were measured (moving_regions.hpp), and what lies beyond them is told from the two frames
/// themselves, by the whole way between them. Frames are best asked for in order: an earlier one is followed to anew.
class MaterialMasks {
 public:
  /// `pair` k: the vectors of frames k and k + 1.
  MaterialMasks(const Case& c, const Setting& setting, std::function<VectorField(int)> pair);

  /// Of frame `pair[0]`, one byte a pixel; empty: all of it may be.
  std::vector<std::uint8_t> of(std::array<int, 2> pair, const ImageView& first, const ImageView& second);

 private:
  void follow_to(int frame);

  const Setting& setting_;
  int window_px_;
  std::function<VectorField(int)> pair_;
  std::vector<MovingOutline> start_, now_;
  int frame_ = 0;
};

}  // namespace pivnp::app
