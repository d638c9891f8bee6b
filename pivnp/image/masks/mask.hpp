// Pixels that must not be measured: polygons, circles, a mask image.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/core/options.hpp"
#include "pivnp/image/camera/camera.hpp"
#include "pivnp/image/masks/air_mask.hpp"

namespace pivnp::image {

/// What of a tool is found again in every frame.
enum class FollowBy { texture, outline };
inline constexpr std::array follow_by_names{NamedValue{"texture", FollowBy::texture}, NamedValue{"outline", FollowBy::outline}};
constexpr const auto& names_of(FollowBy) { return follow_by_names; }

struct MaskOptions {
  Points polygon_px = {};
  Points polygon_m = {};
  std::vector<double> circle_px = {};
  std::string image = {};
  bool invert = false;
  std::string images = {};
  std::optional<double> glare = {};
  std::string motion = {};
  bool follow = false;
  FollowBy follow_by = FollowBy::texture;
  AirKind air = AirKind::none;
  int grow_px = 0;

  /// Whether the mask differs from frame to frame (moving_mask.hpp).
  bool moves() const { return !images.empty() || glare || air != AirKind::none || !motion.empty() || follow; }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("polygon_px", self.polygon_px, OptionInfo{.unit = "px", .text = "masked polygon (column, row)"});
    visit("polygon_m", self.polygon_m, OptionInfo{.unit = "m", .text = "the same in the world"});
    visit("circle_px", self.circle_px,
          OptionInfo{.unit = "px", .text = "masked circle: centre column, row, radius"});
    visit("image", self.image, OptionInfo{.text = "image of the frames' size: 0 is masked"});
    visit("images", self.images,
          OptionInfo{.text = "one such image for every frame used, in order (glob, printf pattern or folder)"});
    visit("glare", self.glare,
          OptionInfo{.text = "masks pixels at least so bright in each frame, fraction of white (0.98)", .min = 0, .max = 1, .above_min = true});
    visit("motion", self.motion,
          OptionInfo{.text = "CSV of the shape's motion: frame,right_px,down_px,turn_deg (clockwise about its middle)"});
    visit("follow", self.follow,
          OptionInfo{.text = "the shape is a rigid tool, followed from frame to frame"});
    visit("follow_by", self.follow_by,
          OptionInfo{.text = "texture inside it, or its outline, given within 3 px in the first frame"});
    visit("air", self.air,
          OptionInfo{.text = "masked in each frame: windows of 15 px without texture; still: what looks as outside the regions at first"});
    visit("grow_px", self.grow_px, OptionInfo{.unit = "px", .text = "widens images, glare, air and moving shapes", .min = 0, .max = 200});
    visit("invert", self.invert, OptionInfo{.text = "mask everything else instead"});
  }
};

/// Owns a mask: 1 = usable. Empty if nothing is masked.
class Mask {
 public:
  Mask() = default;
  Mask(int width, int height) : width_(width), height_(height), bytes_(std::size_t(width) * std::size_t(height), 1) {}
  bool empty() const { return bytes_.empty(); }
  std::uint8_t* row(int r) { return bytes_.data() + std::size_t(r) * std::size_t(width_); }
  MaskView view() const { return {empty() ? nullptr : bytes_.data(), width_, height_, width_}; }

 private:
  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> bytes_;
};

/// All masks together (a pixel left out by any is left out). `named` pairs a mask's name (for messages) with its
/// options. Throws InputError: crossing polygon, mask image of another size, nothing left, no shape or several in one.
Mask make_mask(const std::vector<std::pair<std::string, MaskOptions>>& named, const Camera& camera, int width,
               int height, const std::filesystem::path& base);

}  // namespace pivnp::image
