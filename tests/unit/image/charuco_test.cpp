// ChArUco boards.
//   criterion: corners of a board that leaves the image are those of the drawing within .07 px RMS; a lens found from such
//     pictures maps the image as the true one does within .02 px; a wrong dictionary or board is named by what was found.
#include <gmock/gmock.h>

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "pivnp/image/calibration/calibration.hpp"
#include "pivnp/image/camera/homography.hpp"
#include "pivnp/image/files/write.hpp"
#include "scratch.hpp"

namespace pivnp::image {
namespace charuco_tests {

using test::error_of;
using ::testing::HasSubstr;

constexpr int width = 640, height = 480, raster = 40;
const Board board{9, 6, 1.0, "4x4_100", 0.7};

Lens truth() { return {LensModel::brown, {620, 618}, {323, 236}, {-0.08, 0.02, 5e-4, -3e-4}, {}}; }

struct View {
  double tilt_x, tilt_y, shift_x, shift_y, distance;
};

Mat3 pose_of(const View& v) {  // board plane (u, v, 1) from its middle -> camera
  const double cx = std::cos(v.tilt_x), sx = std::sin(v.tilt_x), cy = std::cos(v.tilt_y), sy = std::sin(v.tilt_y);
  Mat3 pose;
  pose.col(0) << cy, sx * sy, -cx * sy;
  pose.col(1) << 0, cx, sx;
  pose.col(2) << v.shift_x, v.shift_y, v.distance;
  return pose;
}

// What the lens sees of the printed board; each pixel is the mean of 4 x 4 points. A hand covers `covered` columns from the left.
Image seen(const Lens& lens, const Image& print, const View& view, const Board& shown = board, int covered = 0) {
  // The rays of pixel centres, linear between them.
  static std::vector<Vec2> rays;
  constexpr int across = width + 2;
  if (rays.empty())
    for (int r = -1; r <= height; ++r)
      for (int c = -1; c <= width; ++c) rays.push_back((lens.to_ideal({double(c), double(r)}) - lens.centre()).cwiseQuotient(lens.focal()));
  const Mat3 back = pose_of(view).inverse();
  Image out(width, height, PixelDepth::u8, 255);
  constexpr int fine = 4;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      double sum = 0;
      for (int k = 0; k < fine * fine; ++k) {
        const int i = k % fine, j = k / fine;  // no two of the points in one row or column
        const double x = c + 0.5 + (i + (j + 0.5) / fine) / fine, y = r + 0.5 + (j + (i + 0.5) / fine) / fine, a = x - int(x), b = y - int(y);
        const Vec2* at0 = &rays[std::size_t(int(y) * across + int(x))];
        const Vec2 ray = (1 - b) * ((1 - a) * at0[0] + a * at0[1]) + b * ((1 - a) * at0[across] + a * at0[across + 1]);
        const Eigen::Vector3d at = back * Eigen::Vector3d(ray.x(), ray.y(), 1);
        const int column = int(std::floor((at.x() / at.z() + (shown.columns + 3) / 2.0) * raster)),
                  row = int(std::floor((at.y() / at.z() + (shown.rows + 3) / 2.0) * raster));
        const bool on = column >= 0 && row >= 0 && column < print.width() && row < print.height();
        sum += c < covered ? 120 : on ? 25 + 200.0 / 255 * print.view().row<std::uint8_t>(row)[column] : 150;
      }
      out.row<std::uint8_t>(r)[c] = std::uint8_t(std::lround(sum / (fine * fine)));
    }
  return out;
}

double corner_error(const BoardView& found, const Lens& lens, const View& view) {
  double sum = 0;
  for (std::size_t k = 0; k < found.corner.size(); ++k) {
    const int c = found.id[k] % board.columns, r = found.id[k] / board.columns;
    const Eigen::Vector3d at = pose_of(view) * Eigen::Vector3d(c - (board.columns - 1) / 2.0, r - (board.rows - 1) / 2.0, 1);
    sum += (lens.to_pixel(lens.centre() + Vec2(at.x() / at.z() * lens.focal().x(), at.y() / at.z() * lens.focal().y())) - found.corner[k]).squaredNorm();
  }
  return std::sqrt(sum / double(found.corner.size()));
}

TEST(Charuco, FindsCornersOfABoardThatIsSeenInPart) {
  const Image print = charuco_board(board, raster);
  const View whole{0.3, 0.2, 0, 0, 13}, part{0.2, -0.3, -3.2, 1.5, 10};
  const BoardView all = charuco_corners(seen(truth(), print, whole).view(), board);
  EXPECT_EQ(all.corner.size(), 54u);
  EXPECT_LT(corner_error(all, truth(), whole), 0.07);
  const BoardView some = charuco_corners(seen(truth(), print, part, board, 130).view(), board);  // beyond the image, and a hand
  EXPECT_GT(some.corner.size(), 12u);
  EXPECT_LT(some.corner.size(), 45u);
  EXPECT_LT(corner_error(some, truth(), part), 0.07);
  for (const Vec2& p : some.corner) EXPECT_GT(p.x(), 130);
}

TEST(Charuco, FindsALens) {
  const Image print = charuco_board(board, raster);
  std::vector<BoardView> views;
  std::size_t corners = 0;
  for (const View& v : {View{0, 0, 0, 0, 9}, View{0.45, 0.1, -2, -1.2, 9.5}, View{-0.45, 0.1, 2, 1.2, 9.5}, View{0.1, 0.5, 2.4, -1.2, 9.5},
                        View{0.1, -0.5, -2.4, 1.2, 9.5}, View{0.3, 0.3, 0.8, -1.6, 9}, View{-0.3, -0.3, -0.8, 1.6, 9}, View{0.35, -0.25, 1.5, 1, 9.5}}) {
    views.push_back(charuco_corners(seen(truth(), print, v).view(), board));
    corners += views.back().corner.size();
  }
  EXPECT_LT(corners, 8 * 50u);  // none is seen whole in all of them
  const Calibration found = calibrate_views(std::move(views), width, height, board, LensModel::brown, false);
  EXPECT_EQ(found.used(), 8);
  EXPECT_LT(found.rms_px, 0.06);
  const Lens lens(LensModel::brown, found.focal, found.centre, found.coefficients, {});
  std::vector<Vec2> from, to;
  for (double r = 40; r <= height - 40; r += 40)
    for (double c = 40; c <= width - 40; c += 40) from.push_back(truth().to_ideal({c, r})), to.push_back(lens.to_ideal({c, r}));
  const Mat3 H = fit_homography(from, to).world_from_pixel;
  double most = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const Eigen::Vector3d w = H * Eigen::Vector3d(from[k].x(), from[k].y(), 1);
    most = std::max(most, (lens.to_pixel(w.head<2>() / w.z()) - lens.to_pixel(to[k])).norm());
  }
  EXPECT_LT(most, 0.02);
  RecordProperty("round_trip_px", std::to_string(most));
}

// Boards printed by OpenCV before 4.6 begin with a white square where the rows of squares are even in number.
TEST(Charuco, KnowsBothLayouts) {
  const Board even{8, 5, 1.0, "5x5_100", 0.7};  // 9 x 6 squares
  const Image now = charuco_board(even, raster);
  Image before(now.width(), now.height(), PixelDepth::u8, 255);
  for (int r = 0; r < before.height(); ++r) std::fill(before.row<std::uint8_t>(r), before.row<std::uint8_t>(r) + before.width(), std::uint8_t{255});
  std::vector<std::array<int, 2>> marked;  // of the layout of today, by number
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 9; ++c)
      if ((r + c) % 2 == 1) marked.push_back({c, r});
  std::size_t next = 0;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 9; ++c)
      for (int y = 0; y < raster; ++y) {
        std::uint8_t* out = before.row<std::uint8_t>((r + 1) * raster + y) + (c + 1) * raster;
        if ((r + c) % 2 == 1) {
          std::fill(out, out + raster, std::uint8_t{0});
          continue;
        }
        const std::array<int, 2> from = marked[next];
        const std::uint8_t* in = now.view().row<std::uint8_t>((from[1] + 1) * raster + y) + (from[0] + 1) * raster;
        std::copy(in, in + raster, out);
        if (y == raster - 1) ++next;
      }
  ASSERT_EQ(next, marked.size());
  const View view{0.2, 0.1, 0, 0, 12};
  const BoardView a = charuco_corners(seen(truth(), now, view, even).view(), even), b = charuco_corners(seen(truth(), before, view, even).view(), even);
  ASSERT_EQ(a.corner.size(), 40u);
  ASSERT_EQ(b.corner.size(), 40u);
  for (std::size_t k = 0; k < 40; ++k) EXPECT_LT((a.corner[k] - b.corner[k]).norm(), 0.1);
}

class CharucoFiles : public test::Scratch {};

TEST_F(CharucoFiles, NamesWhatWasFoundInstead) {
  const Image print = charuco_board(board, raster);
  for (int k = 0; k < 3; ++k) write_image(seen(truth(), print, {0.1 * k, 0.1, 0, 0, 13}).view(), folder_ / ("v" + std::to_string(k) + ".png"));
  const std::vector<std::filesystem::path> files{folder_ / "v0.png", folder_ / "v1.png", folder_ / "v2.png"};
  Board other = board;
  other.dictionary = "5x5_100";
  EXPECT_THAT(error_of([&] { calibrate(files, other, LensModel::brown, false); }),
              HasSubstr("with the dictionary 5x5_100; 'v0.png' holds 35 markers of the dictionary 4x4_"));
  other = board;
  other.columns = 4, other.rows = 3;
  EXPECT_THAT(error_of([&] { calibrate(files, other, LensModel::brown, false); }), HasSubstr("which do not lie as on such a board"));
  other.dictionary = "3x3";
  EXPECT_THAT(error_of([&] { calibrate(files, other, LensModel::brown, false); }), HasSubstr("found the dictionary '3x3', expected one of 4x4_50, "));
  other = board;
  other.marker = 1;
  EXPECT_THAT(error_of([&] { calibrate(files, other, LensModel::brown, false); }), HasSubstr("markers of side 1 in squares of 1"));
  EXPECT_EQ(calibrate(files, board, LensModel::brown, false).used(), 3);
}

}  // namespace charuco_tests
}  // namespace pivnp::image
