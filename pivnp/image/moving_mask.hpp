// Masks that differ from frame to frame: sequences of mask images, tools that move, glare.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pivnp/core/record/camera_motion.hpp"
#include "pivnp/image/mask.hpp"

namespace pivnp::image {

/// The masks of a case that move (MaskOptions::moves). Frames are counted among those used, from 0.
class MovingMasks {
 public:
  MovingMasks() = default;
  /// `named`: all masks of the case; those that do not move are left to make_mask(). Throws InputError: a missing file, a
  /// table of motion without its columns, several shapes in one mask, a world polygon beyond the horizon.
  MovingMasks(const std::vector<std::pair<std::string, MaskOptions>>& named, const Camera& camera, int width, int height,
              const std::filesystem::path& base);

  bool empty() const { return items_.empty(); }
  /// Throws InputError if a sequence of mask images is not as long as the frames.
  void require_frames(std::size_t frames) const;
  /// Outlines (px, first frame) of the shapes whose motion is to be found from their texture, by index.
  struct Followed {
    std::size_t item;
    std::string name;
    std::vector<Vec2> outline;
  };
  std::vector<Followed> to_follow() const;
  void set_motion(std::size_t item, CameraMotion motion) { items_[item].motion = std::move(motion); }
  /// Where the outline of a shape that moves is in a frame, px; empty for what has none.
  std::vector<std::vector<Vec2>> outlines(int frame) const;
  /// Takes from `mask` (all usable if it is empty) what these masks cover in a frame.
  void apply(int frame, const ImageView& image, Mask& mask) const;
  std::vector<std::filesystem::path> files() const;

 private:
  struct Item {
    std::string name;
    MaskOptions options;
    std::vector<Vec2> outline;                 // px, first frame
    CameraMotion motion;                       // of the outline; empty: at rest so far
    std::vector<std::filesystem::path> images;
    std::vector<std::pair<double, CameraPlace>> told;  // prescribed, by frame
  };
  CameraMotion at(const Item& item, int frame) const;
  std::vector<Vec2> outline_at(const Item& item, int frame) const;
  std::vector<Item> items_;
  int width_ = 0, height_ = 0;
};

/// What both masks leave.
Mask both(const Mask& a, const Mask& b);

}  // namespace pivnp::image
