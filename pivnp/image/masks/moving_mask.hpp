// Masks that differ from frame to frame: sequences of mask images, tools that move, glare.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pivnp/core/record/camera_motion.hpp"
#include "pivnp/image/masks/mask.hpp"

namespace pivnp::image {

/// The masks of a case that move (MaskOptions::moves). Frames are counted among those used, from 0.
class MovingMasks {
 public:
  MovingMasks() = default;
  /// `named`: all masks of the case; those that do not move are left to make_mask(). Throws InputError: a missing file, a
  /// table of motion without its columns, several shapes in one mask, a world polygon beyond the horizon.
  /// `camera_moves`: polygons in the world that are otherwise at rest go with what the moving camera sees (set_cameras).
  MovingMasks(const std::vector<std::pair<std::string, MaskOptions>>& named, const Camera& camera, int width, int height,
              const std::filesystem::path& base, bool camera_moves = false);

  bool empty() const { return items_.empty(); }
  /// Throws InputError if a sequence of mask images is not as long as the frames.
  void require_frames(std::size_t frames) const;
  /// Outlines (px, first frame) of the shapes whose motion is to be found, by index.
  struct Followed {
    std::size_t item;
    std::string name;
    std::vector<Vec2> outline;
    FollowBy by;
  };
  std::vector<Followed> to_follow() const;
  void set_motion(std::size_t item, CameraMotion motion) { items_[item].motion = std::move(motion); }
  /// Cameras of all frames; without them those polygons stay where they are in the first frame.
  void set_cameras(std::vector<Camera> cameras) { cameras_ = std::move(cameras); }
  bool any_in_world() const;
  /// Whether a mask is of air = "still", which must be given the background first: frames 0 and 1, and where material is in frame 0.
  bool wants_background() const;
  void set_background(const ImageView& first, const ImageView& second, const std::vector<std::uint8_t>& material);
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
    StillBackground background;
    std::vector<Vec2> world;  // of a polygon that goes with the camera; sides divided if a lens bends them
  };
  CameraMotion at(const Item& item, int frame) const;
  std::vector<Vec2> outline_at(const Item& item, int frame) const;
  std::vector<Item> items_;
  std::vector<Camera> cameras_;
  int width_ = 0, height_ = 0;
};

/// Masks that stay where they are in the image although the camera moves: all but polygons in the world.
std::vector<std::pair<std::string, MaskOptions>> fixed_in_image(const std::vector<std::pair<std::string, MaskOptions>>& named);
/// What both masks leave.
Mask both(const Mask& a, const Mask& b);

}  // namespace pivnp::image
