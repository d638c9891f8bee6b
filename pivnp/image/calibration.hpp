// A lens from pictures of a board.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/image/lens.hpp"

namespace pivnp::image {

/// A checkerboard by its inner corners.
struct Board {
  int columns = 9, rows = 6;
  double square = 1;  // length of a square's side
};

struct BoardView {
  std::string name;
  std::vector<Vec2> corner;    // px, row by row of the board; empty: the board was not found
  std::vector<Vec2> residual;  // corner less where the fitted camera sees it, px
  double rms_px = 0;
};

struct Calibration {
  LensModel model = LensModel::brown;
  int width = 0, height = 0;
  Vec2 focal = Vec2::Zero(), centre = Vec2::Zero();  // px
  std::vector<double> coefficients;                  // in the order of camera.distortion
  std::vector<double> sigma;                         // standard errors of fx, fy, cx, cy and the coefficients; brown only
  double rms_px = 0;                                 // of all corners' residuals
  double covered = 0;                                // share of the image's 6 x 4 fields that hold a corner
  std::vector<BoardView> views;

  int used() const;
};

/// The inner corners of a board in one image: found as OpenCV's findChessboardCornersSB does (Duda & Frese 2018), refined to
/// where the grey values' slopes about a corner are square to the way to it (Foerstner & Guelch 1987, cornerSubPix). Empty if the board is not seen as a whole.
std::vector<Vec2> board_corners(const ImageView& image, const Board& board);

/// The least sum of squared residuals over all views (Zhang 2000; of a fish-eye, Kannala & Brandt 2006), by OpenCV's
/// calib3d. `brown`: k1 k2 p1 p2, and k3 where `third`. Throws InputError: images of different size, fewer than three in
/// which the board is found, a board of fewer than 3 x 3 inner corners, a fit that does not hold to the image's corners.
Calibration calibrate(const std::vector<std::filesystem::path>& images, const Board& board, LensModel model, bool third);
Calibration calibrate_views(std::vector<BoardView> views, int width, int height, const Board& board, LensModel model, bool third);

}  // namespace pivnp::image
