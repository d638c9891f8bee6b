// A camera's lens from pictures of a board: the keys of [camera], and a picture of the residuals.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pivnp/image/calibration/calibration.hpp"

namespace pivnp::app {

struct CalibrateOutcome {
  image::Calibration calibration;
  std::filesystem::path keys, picture;  // DIR/camera.toml, DIR/residuals.png
  std::vector<std::string> remarks;     // what was found, and what is to be doubted; one sentence each
};

/// `pattern`: glob, printf pattern or folder of images. Writes DIR/camera.toml, a [camera] to be put into a case, and
/// DIR/residuals.png. Throws InputError as image::calibrate.
CalibrateOutcome calibrate_camera(const std::string& pattern, const image::Board& board, image::LensModel model, bool third,
                                  const std::filesystem::path& out);

}  // namespace pivnp::app
