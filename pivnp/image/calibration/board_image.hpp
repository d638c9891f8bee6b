// What both kinds of boards share: grey values and corners to subpixels. For sources that may see OpenCV.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "pivnp/core/image_view.hpp"

namespace pivnp::image {

cv::Mat eight_bits(const ImageView& image);
/// Corners to where all slopes within `half` pixels to each side point past them (Foerstner & Guelch 1987).
void refine_corners(const cv::Mat& grey, std::vector<cv::Point2f>& corners, int half);

}  // namespace pivnp::image
