// A lens from pictures of a board.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/image/camera/lens.hpp"

namespace pivnp::image {

/// A checkerboard by its inner corners, with markers in its white squares if `dictionary` says so (ChArUco).
struct Board {
  int columns = 9, rows = 6;
  double square = 1;       // length of a square's side
  std::string dictionary = {};  // of the markers, by OpenCV's names: "4x4_50", "5x5_100"; empty: none
  double marker = 0;       // length of a marker's side, in the unit of `square`
};

struct BoardView {
  std::string name;
  std::vector<Vec2> corner;    // px, row by row of the board; empty: the board was not found
  std::vector<Vec2> residual;  // corner less where the fitted camera sees it, px
  double rms_px = 0;
  std::vector<int> id = {};    // which corners of the board they are, counted row by row; empty: all of them
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

/// The inner corners that are seen of a ChArUco board, which may leave the image or be covered in part: markers are found and
/// read by OpenCV's aruco module (Garrido-Jurado et al. 2014); each corner is foreseen by the homography of the markers about
/// it, refined as above in a window that holds no marker, and kept if the four squares about it are dark and bright as the
/// board's. Either of the two layouts in use (a dark or a white square first, where the rows of squares are even) is recognised.
/// Empty: fewer than 8 corners. Throws InputError: a dictionary that is not known, a marker that is no smaller than the square.
BoardView charuco_corners(const ImageView& image, const Board& board);
/// The board as it is printed, with a margin of one square; Debian 12's layout. Throws InputError likewise.
Image charuco_board(const Board& board, int square_px);
/// What markers an image holds instead of those of `board`: "17 markers of the dictionary 5x5_100", or "no marker".
std::string markers_seen(const ImageView& image, const Board& board);

/// The least sum of squared residuals over all views (Zhang 2000; of a fish-eye, Kannala & Brandt 2006), by OpenCV's
/// calib3d. `brown`: k1 k2 p1 p2, and k3 where `third`. Throws InputError: images of different size, fewer than three in
/// which the board is found, a board of fewer than 3 x 3 inner corners, a fit that does not hold to the image's corners.
Calibration calibrate(const std::vector<std::filesystem::path>& images, const Board& board, LensModel model, bool third);
Calibration calibrate_views(std::vector<BoardView> views, int width, int height, const Board& board, LensModel model, bool third);

}  // namespace pivnp::image
