// What a frame's grey values show of the exposure and of the sensor.
#pragma once

#include <string>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"

namespace pivnp::app {

/// Clipped: more than a tenth of the material's pixels has the greatest grey value of the frame, or more than half the
/// least. Mosaic: green pixels of a sensor with a colour filter (Bayer 1976) differ from red and blue ones in a pattern
/// of two by two pixels: the mean of the checkerboard's part, (a - b - c + d)/4, is more than a hundredth of the mean
/// grey value and than eight standard errors.
std::vector<std::string> exposure_remarks(const Setting& setting, const Image& frame);

}  // namespace pivnp::app
