// Filters of frames before correlation.
#pragma once

#include <functional>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/image/frames/filter_options.hpp"

namespace pivnp::image {

/// Mean, minimum or median (of an even number the lower one) of frames of one size and depth, pixel by pixel; `read` is
/// asked for frame 0 ... count - 1 in turn. Holds all frames for a median, in bands of rows where they would take more
/// than `memory` bytes (each band then reads all frames again).
Image background_of(int count, const std::function<Image(int)>& read, Background kind,
                    std::size_t memory = std::size_t(256) << 20);

/// Which of `frames` frames the background is taken from.
std::vector<int> background_frames(int frames, int most);

/// The frame blurred by a Gaussian, floating grey values: its illumination.
Image blurred_image(const ImageView& frame, double sigma);

/// The part of a frame from (left, top) on.
Image part_of(const ImageView& frame, int left, int top, int width, int height);

/// Applies what `options` say, in their order: the background is subtracted, and its mean is added; high pass, the
/// frame's own mean is kept; CLAHE (Zuiderveld 1994); cap at median + n standard deviations of the frame (Shavit, Lowe
/// & Steinbuck 2007, Exp. Fluids 42:225); local mean to mid grey and local deviation to a sixth of full scale, but no
/// deviation below 1/100 of full scale is raised as though it were less. Size, depth and full scale stay as they are.
/// The background's size is the frame's.
class FrameFilter {
 public:
  explicit FrameFilter(const FilterOptions& options, Image background = {});
  Image operator()(Image frame) const;
  const FilterOptions& options() const { return options_; }
  const Image& background() const { return background_; }

 private:
  FilterOptions options_;
  Image background_;
};

}  // namespace pivnp::image
