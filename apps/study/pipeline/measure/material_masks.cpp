#include "apps/study/pipeline/measure/material_masks.hpp"

#include <utility>

#include "apps/study/pipeline/measure/moving_regions.hpp"
#include "apps/study/pipeline/measure/outside_evidence.hpp"

namespace pivnp::app {

MaterialMasks::MaterialMasks(const Case& c, const Setting& setting, std::function<VectorField(int)> pair)
    : setting_(setting), window_px_(c.piv.value_or(piv::PivOptions{}).window_px), pair_(std::move(pair)) {
  const bool on = c.piv.value_or(piv::PivOptions{}).follow_regions && !c.regions.empty() && !setting.imported;
  if (on) start_ = now_ = outlines_of_regions(setting);
}

// Where a region is lost nothing is left out from there on, as in the pairs.
void MaterialMasks::follow_to(int frame) {
  if (frame < frame_) now_ = start_, frame_ = 0;
  for (; frame_ < frame && !now_.empty(); ++frame_) carry_outlines(pair_(frame_), setting_, window_px_, now_);
  frame_ = frame;
}

std::vector<std::uint8_t> MaterialMasks::of(std::array<int, 2> pair, const ImageView& first, const ImageView& second) {
  follow_to(pair[0]);
  if (now_.empty()) return {};
  // The same points to the other frame, none of them left out or added meanwhile.
  std::vector<MovingOutline> there = now_;
  for (int k = pair[0]; k < pair[1]; ++k)
    if (!move_outlines(pair_(k), setting_, window_px_, there)) return {};
  std::vector<MovingOutline> here = now_;
  for (std::size_t n = 0; n < here.size(); ++n)
    for (std::size_t p = 0; p < here[n].points.size(); ++p) {
      here[n].points[p].moved = there[n].points[p].place - here[n].points[p].place;
      here[n].points[p].outside = Outside::unknown;
    }
  const auto inside = inside_outlines(here, setting_.camera_at(pair[0]), setting_.width, setting_.height);
  return judge_outside(inside, setting_, pair, first, second, window_px_, here);
}

}  // namespace pivnp::app
