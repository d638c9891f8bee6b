#include "pivnp/image/calibration/calibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/image/calibration/board_image.hpp"
#include "pivnp/image/files/image_file.hpp"

namespace pivnp::image {

namespace {

const std::string command = "calibrate: ";

std::vector<cv::Point3d> corners_of(const Board& board) {
  std::vector<cv::Point3d> out;
  for (int r = 0; r < board.rows; ++r)
    for (int c = 0; c < board.columns; ++c) out.emplace_back(c * board.square, r * board.square, 0.0);
  return out;
}

void check_board(const Board& board) {
  if (board.columns < 3 || board.rows < 3)
    throw InputError(command + "found a board of " + std::to_string(board.columns) + " x " + std::to_string(board.rows) +
                     " inner corners, expected at least 3 x 3");
  if (!(board.square > 0)) throw InputError(command + "the board's squares have no size, expected a length above 0");
  if (!board.dictionary.empty() && !(board.marker > 0 && board.marker < 0.95 * board.square))
    throw InputError(command + "found markers of side " + number(board.marker) + " in squares of " + number(board.square) +
                     ", expected a length above 0 and below 0.95 of the square's");
}

// Share of 6 x 4 fields of the image in which there is a corner: the lens is known only where it was seen.
double covered_share(const std::vector<BoardView>& views, int width, int height) {
  constexpr int across = 6, down = 4;
  std::array<bool, across * down> seen{};
  for (const BoardView& v : views)
    for (const Vec2& p : v.corner) {
      const int c = std::clamp(int(p.x() * across / width), 0, across - 1), r = std::clamp(int(p.y() * down / height), 0, down - 1);
      seen[std::size_t(r * across + c)] = true;
    }
  return double(std::count(seen.begin(), seen.end(), true)) / double(seen.size());
}

}  // namespace

cv::Mat eight_bits(const ImageView& image) {
  const int type = image.depth == PixelDepth::u8 ? CV_8U : image.depth == PixelDepth::u16 ? CV_16U : CV_32F;
  const cv::Mat grey(image.height, image.width, type, const_cast<std::byte*>(image.data), std::size_t(image.stride));
  cv::Mat out;
  grey.convertTo(out, CV_8U, image.depth == PixelDepth::u8 ? 1.0 : 255.0 / double(image.white));
  return out;
}

void refine_corners(const cv::Mat& grey, std::vector<cv::Point2f>& corners, int half) {
  cv::Mat soft;  // slopes of sharp edges are those of the pixels' raster
  cv::GaussianBlur(grey, soft, cv::Size(0, 0), 1.0);
  cv::cornerSubPix(soft, corners, cv::Size(half, half), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4));
}

int Calibration::used() const {
  return int(std::count_if(views.begin(), views.end(), [](const BoardView& v) { return !v.corner.empty(); }));
}

std::vector<Vec2> board_corners(const ImageView& image, const Board& board) {
  check_board(board);
  std::vector<cv::Point2f> found;
  const cv::Mat grey = eight_bits(image);
  const cv::Size size(board.columns, board.rows);
  bool whole = cv::findChessboardCornersSB(grey, size, found, cv::CALIB_CB_NORMALIZE_IMAGE);
  if (!whole) whole = cv::findChessboardCornersSB(grey, size, found, cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE);
  std::vector<Vec2> out;
  if (!whole) return out;
  // To where all slopes about a corner point past it, over a third of a square to each side.
  float least = INFINITY;
  for (std::size_t k = 0; k + 1 < found.size(); ++k)
    if ((k + 1) % std::size_t(board.columns) != 0) least = std::min(least, float(cv::norm(found[k + 1] - found[k])));
  for (std::size_t k = 0; k + std::size_t(board.columns) < found.size(); ++k)
    least = std::min(least, float(cv::norm(found[k + std::size_t(board.columns)] - found[k])));
  refine_corners(grey, found, std::clamp(int(least / 3), 2, 20));
  for (const cv::Point2f& p : found) out.emplace_back(double(p.x), double(p.y));
  return out;
}

Calibration calibrate(const std::vector<std::filesystem::path>& images, const Board& board, LensModel model, bool third) {
  check_board(board);
  std::vector<BoardView> views;
  int width = 0, height = 0;
  for (const std::filesystem::path& file : images) {
    const Image image = read_image_file(file, "calibrate");
    if (width == 0) width = image.width(), height = image.height();
    if (image.width() != width || image.height() != height)
      throw InputError(command + "'" + file.string() + "' is " + describe(image.width(), image.height(), image.depth()) +
                       ", expected the size of the first, " + std::to_string(width) + "x" + std::to_string(height));
    BoardView view;
    if (board.dictionary.empty())
      view.corner = board_corners(image.view(), board);
    else
      view = charuco_corners(image.view(), board);
    view.name = file.filename().string();
    views.push_back(std::move(view));
  }
  if (!board.dictionary.empty() && std::none_of(views.begin(), views.end(), [](const BoardView& v) { return !v.corner.empty(); }))
    throw InputError(command + "found in none of " + std::to_string(images.size()) + " images the markers of a board of " +
                     std::to_string(board.columns) + " x " + std::to_string(board.rows) + " inner corners with the dictionary " +
                     board.dictionary + "; '" + views.front().name + "' holds " +
                     markers_seen(read_image_file(images.front(), "calibrate").view(), board));
  return calibrate_views(std::move(views), width, height, board, model, third);
}

Calibration calibrate_views(std::vector<BoardView> views, int width, int height, const Board& board, LensModel model, bool third) {
  check_board(board);
  if (model == LensModel::none) throw InputError(command + "found the lens \"none\", expected brown or fisheye");
  Calibration out;
  out.model = model;
  out.width = width, out.height = height;
  out.views = std::move(views);
  if (out.used() < 3)
    throw InputError(command + "the board of " + std::to_string(board.columns) + " x " + std::to_string(board.rows) +
                     " inner corners was found " + (board.dictionary.empty() ? "as a whole " : "") + "in " + std::to_string(out.used()) + " of " +
                     std::to_string(out.views.size()) + " images, expected at least 3");
  const std::vector<cv::Point3d> whole = corners_of(board);
  std::vector<std::vector<cv::Point2d>> seen;
  std::vector<std::vector<cv::Point3d>> places;
  for (const BoardView& v : out.views) {
    if (v.corner.empty()) continue;
    seen.emplace_back();
    places.emplace_back();
    for (std::size_t k = 0; k < v.corner.size(); ++k) {
      seen.back().emplace_back(v.corner[k].x(), v.corner[k].y());
      places.back().push_back(whole[v.id.empty() ? k : std::size_t(v.id[k])]);
    }
  }
  const cv::TermCriteria until(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 200, 1e-12);
  cv::Matx33d K = cv::Matx33d::eye();
  cv::Mat D, sigma, ignored;
  std::vector<cv::Mat> turns, shifts;
  try {
    if (model == LensModel::fisheye) {
      D = cv::Mat::zeros(4, 1, CV_64F);
      cv::fisheye::calibrate(places, seen, cv::Size(width, height), K, D, turns, shifts,
                             cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW, until);
    } else {
      // Single precision is all that this function takes.
      std::vector<std::vector<cv::Point3f>> places_f(places.size());
      std::vector<std::vector<cv::Point2f>> seen_f(seen.size());
      for (std::size_t v = 0; v < seen.size(); ++v) {
        for (const cv::Point3d& p : places[v]) places_f[v].emplace_back(cv::Point3f(p));
        for (const cv::Point2d& p : seen[v]) seen_f[v].emplace_back(cv::Point2f(p));
      }
      D = cv::Mat::zeros(5, 1, CV_64F);
      cv::calibrateCamera(places_f, seen_f, cv::Size(width, height), K, D, turns, shifts, sigma, ignored, ignored,
                          third ? 0 : cv::CALIB_FIX_K3, until);
    }
  } catch (const cv::Exception& error) {
    throw InputError(command + "no camera fits the corners: " + error.err);
  }
  out.focal = {K(0, 0), K(1, 1)};
  out.centre = {K(0, 2), K(1, 2)};
  for (int k = 0; k < int(D.total()); ++k) out.coefficients.push_back(D.at<double>(k));
  if (!sigma.empty())
    for (int k = 0; k < 9; ++k) out.sigma.push_back(sigma.at<double>(k));
  double squares = 0;
  std::size_t count = 0, v = 0;
  for (BoardView& view : out.views) {
    if (view.corner.empty()) continue;
    std::vector<cv::Point2d> fitted;
    if (model == LensModel::fisheye)
      cv::fisheye::projectPoints(places[v], fitted, turns[v], shifts[v], K, D);
    else
      cv::projectPoints(places[v], turns[v], shifts[v], K, D, fitted);
    double sum = 0;
    for (std::size_t k = 0; k < fitted.size(); ++k) {
      view.residual.push_back(view.corner[k] - Vec2(fitted[k].x, fitted[k].y));
      sum += view.residual.back().squaredNorm();
    }
    view.rms_px = std::sqrt(sum / double(fitted.size()));
    squares += sum, count += fitted.size(), ++v;
  }
  out.rms_px = std::sqrt(squares / double(count));
  out.covered = covered_share(out.views, width, height);
  return out;
}

}  // namespace pivnp::image
