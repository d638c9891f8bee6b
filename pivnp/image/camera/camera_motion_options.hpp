// How a moving camera is followed.
#pragma once

#include "pivnp/core/options.hpp"
#include "pivnp/image/camera/similarity.hpp"

namespace pivnp::image {

/// By what the motion of the camera is measured.
enum class RestSource { none, still_zone, targets, dominant };
inline constexpr std::array rest_source_names{
    NamedValue{"none", RestSource::none}, NamedValue{"still_zone", RestSource::still_zone},
    NamedValue{"targets", RestSource::targets}, NamedValue{"dominant", RestSource::dominant}};
constexpr const auto& names_of(RestSource) { return rest_source_names; }

struct CameraMotionOptions {
  RestSource from = RestSource::none;
  MotionModel model = MotionModel::similarity;
  Points zone_px = {};
  Points zone_m = {};
  Points targets_px = {};
  int subset_px = 41;
  int search_px = 16;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("from", self.from,
          OptionInfo{.text = "what shows the camera's motion; dominant: most of the image outside regions and masks"});
    visit("model", self.model, OptionInfo{.text = "what is removed; rigid: with rotation; similarity: with scale too"});
    visit("zone_px", self.zone_px,
          OptionInfo{.unit = "px", .text = "still_zone: polygon (column, row) at rest, with texture; default: np.still_zone_px or _m"});
    visit("zone_m", self.zone_m, OptionInfo{.unit = "m", .text = "the same in the world"});
    visit("targets_px", self.targets_px, OptionInfo{.unit = "px", .text = "targets: centres (column, row) of marks at rest, in the first frame"});
    visit("subset_px", self.subset_px, OptionInfo{.unit = "px", .text = "side of the subsets that are found again", .min = 15, .max = 401});
    visit("search_px", self.search_px,
          OptionInfo{.unit = "px", .text = "greatest shift from frame to frame", .min = 2, .max = 200});
  }
};

}  // namespace pivnp::image
