#include "pivnp/core/error.hpp"
#include "pivnp/image/calibration/calibration.hpp"

#ifdef PIVNP_ARUCO

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <utility>

#include "pivnp/image/calibration/board_image.hpp"

namespace pivnp::image {

namespace {

struct DictionaryRow {
  std::string_view name;
  int id;
};
constexpr std::array dictionaries{
    DictionaryRow{"4x4_50", cv::aruco::DICT_4X4_50},   DictionaryRow{"4x4_100", cv::aruco::DICT_4X4_100},
    DictionaryRow{"4x4_250", cv::aruco::DICT_4X4_250}, DictionaryRow{"4x4_1000", cv::aruco::DICT_4X4_1000},
    DictionaryRow{"5x5_50", cv::aruco::DICT_5X5_50},   DictionaryRow{"5x5_100", cv::aruco::DICT_5X5_100},
    DictionaryRow{"5x5_250", cv::aruco::DICT_5X5_250}, DictionaryRow{"5x5_1000", cv::aruco::DICT_5X5_1000},
    DictionaryRow{"6x6_50", cv::aruco::DICT_6X6_50},   DictionaryRow{"6x6_100", cv::aruco::DICT_6X6_100},
    DictionaryRow{"6x6_250", cv::aruco::DICT_6X6_250}, DictionaryRow{"6x6_1000", cv::aruco::DICT_6X6_1000},
    DictionaryRow{"7x7_50", cv::aruco::DICT_7X7_50},   DictionaryRow{"7x7_100", cv::aruco::DICT_7X7_100},
    DictionaryRow{"7x7_250", cv::aruco::DICT_7X7_250}, DictionaryRow{"7x7_1000", cv::aruco::DICT_7X7_1000},
    DictionaryRow{"original", cv::aruco::DICT_ARUCO_ORIGINAL}};

struct Markers {
  std::vector<int> id;
  std::vector<std::vector<cv::Point2f>> corner;  // clockwise from the upper left of the marker
};

Markers find(const cv::Mat& grey, int dictionary) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;  // it would slip to the chessboard's own corners
  Markers out;
  cv::aruco::detectMarkers(grey, cv::aruco::getPredefinedDictionary(dictionary), out.corner, out.id, parameters);
  return out;
}

int dictionary_of(const Board& board) {
  std::string names;
  for (const DictionaryRow& row : dictionaries) {
    if (row.name == board.dictionary) return row.id;
    names += (names.empty() ? "" : ", ") + std::string(row.name);
  }
  throw InputError("calibrate: found the dictionary '" + board.dictionary + "', expected one of " + names);
}

// Where the squares with markers are, (column, row), in the order of the markers' numbers.
std::vector<cv::Point> marked_squares(const Board& board, bool white_first) {
  std::vector<cv::Point> out;
  for (int r = 0; r <= board.rows; ++r)
    for (int c = 0; c <= board.columns; ++c)
      if (((r + c) % 2 == 0) == white_first) out.emplace_back(c, r);
  return out;
}

// Corners of the marker in a square, in squares from the first inner corner.
std::array<cv::Point2f, 4> marker_at(const cv::Point& square, float gap) {
  const float l = float(square.x) - 1 + gap, t = float(square.y) - 1 + gap, side = 1 - 2 * gap;
  return {cv::Point2f(l, t), cv::Point2f(l + side, t), cv::Point2f(l + side, t + side), cv::Point2f(l, t + side)};
}

struct Placed {
  std::vector<cv::Point2f> board, image;  // marker corners, four by four
};

// The markers that lie on the board as one plane's do; a lens bends by less than half a square from marker to marker.
Placed placed(const Markers& markers, const Board& board, bool white_first, float gap) {
  const std::vector<cv::Point> squares = marked_squares(board, white_first);
  Placed all, out;
  for (std::size_t k = 0; k < markers.id.size(); ++k) {
    if (markers.id[k] < 0 || std::size_t(markers.id[k]) >= squares.size()) continue;
    const auto at = marker_at(squares[std::size_t(markers.id[k])], gap);
    all.board.insert(all.board.end(), at.begin(), at.end());
    all.image.insert(all.image.end(), markers.corner[k].begin(), markers.corner[k].end());
  }
  if (all.board.size() < 8) return out;
  const cv::Mat H = cv::findHomography(all.image, all.board, cv::RANSAC, 0.35);
  if (H.empty()) return out;
  std::vector<cv::Point2f> mapped;
  cv::perspectiveTransform(all.image, mapped, H);
  for (std::size_t k = 0; k < mapped.size(); k += 4) {
    bool fits = true;
    for (std::size_t n = k; n < k + 4; ++n) fits = fits && cv::norm(mapped[n] - all.board[n]) < 0.5;
    if (!fits) continue;
    out.board.insert(out.board.end(), all.board.begin() + std::ptrdiff_t(k), all.board.begin() + std::ptrdiff_t(k + 4));
    out.image.insert(out.image.end(), all.image.begin() + std::ptrdiff_t(k), all.image.begin() + std::ptrdiff_t(k + 4));
  }
  return out;
}

// Where the markers next to a place of the board foresee it, and how long a square is there in the image, px.
bool foresee(const Placed& markers, const cv::Point2f& at, cv::Point2f& seen, cv::Matx22f& square) {
  std::vector<cv::Point2f> from, to;
  for (std::size_t k = 0; k < markers.board.size(); ++k)
    if (std::abs(markers.board[k].x - at.x) < 1.01 && std::abs(markers.board[k].y - at.y) < 1.01)
      from.push_back(markers.board[k]), to.push_back(markers.image[k]);
  if (from.size() < 4) return false;
  const cv::Mat H = cv::findHomography(from, to);
  if (H.empty()) return false;
  const std::vector<cv::Point2f> asked{at, at + cv::Point2f(0.5F, 0), at - cv::Point2f(0.5F, 0), at + cv::Point2f(0, 0.5F), at - cv::Point2f(0, 0.5F)};
  std::vector<cv::Point2f> out;
  cv::perspectiveTransform(asked, out, H);
  seen = out[0];
  const cv::Point2f across = out[1] - out[2], down = out[3] - out[4];
  square = {across.x, down.x, across.y, down.y};
  return true;
}

// Whether the four squares about a corner are dark and bright as the board's are; what covers it is not.
bool is_corner(const cv::Mat& grey, const cv::Point2f& p, const cv::Matx22f& square, float gap, bool dark_falls) {
  float dark = 0, bright = 255;  // the brightest of the dark, the darkest of the bright
  for (const auto& [a, b] : {std::pair{-1.F, -1.F}, {1.F, 1.F}, {1.F, -1.F}, {-1.F, 1.F}}) {
    const cv::Vec2f d = square * cv::Vec2f(a * gap * 0.7F, b * gap * 0.7F);
    const cv::Point2f q = p + cv::Point2f(d[0], d[1]);
    if (q.x < 0 || q.y < 0 || q.x > float(grey.cols - 1) || q.y > float(grey.rows - 1)) return false;
    const float v = grey.at<std::uint8_t>(int(std::lround(q.y)), int(std::lround(q.x)));
    if ((a * b > 0) == dark_falls)
      dark = std::max(dark, v);
    else
      bright = std::min(bright, v);
  }
  return bright - dark > 20;
}

}  // namespace

BoardView charuco_corners(const ImageView& image, const Board& board) {
  const cv::Mat grey = eight_bits(image);
  const float gap = float((1 - board.marker / board.square) / 2);
  const Markers markers = find(grey, dictionary_of(board));
  const bool even = (board.rows + 1) % 2 == 0;  // rows of squares: only then two layouts are in use
  Placed on = placed(markers, board, false, gap);
  bool white_first = false;
  if (even)
    if (Placed other = placed(markers, board, true, gap); other.board.size() > on.board.size()) on = std::move(other), white_first = true;
  BoardView out;
  std::vector<cv::Point2f> corner;
  std::vector<cv::Matx22f> square;
  std::vector<int> id;
  double least = 1e9;
  for (int r = 0; r < board.rows; ++r)
    for (int c = 0; c < board.columns; ++c) {
      cv::Point2f seen;
      cv::Matx22f side;
      if (!foresee(on, {float(c), float(r)}, seen, side)) continue;
      const double length = std::min(std::hypot(side(0, 0), side(1, 0)), std::hypot(side(0, 1), side(1, 1)));
      const double margin = std::max(3.0, gap * length);
      if (!(seen.x > margin && seen.y > margin && seen.x < grey.cols - 1 - margin && seen.y < grey.rows - 1 - margin)) continue;
      least = std::min(least, length);
      corner.push_back(seen), square.push_back(side), id.push_back(r * board.columns + c);
    }
  if (corner.empty()) return out;
  // No marker within the window, or its edges would draw the corner.
  const int half = std::clamp(int(gap * least) - 2, 2, 20);
  std::vector<cv::Point2f> refined = corner;
  refine_corners(grey, refined, half);
  for (std::size_t k = 0; k < corner.size(); ++k) {
    const int r = id[k] / board.columns, c = id[k] % board.columns;  // the square up and left of it is (c, r)
    const bool dark_falls = ((r + c) % 2 == 0) != white_first;
    if (cv::norm(refined[k] - corner[k]) > half + 1 || !is_corner(grey, refined[k], square[k], gap, dark_falls)) continue;
    out.corner.emplace_back(double(refined[k].x), double(refined[k].y));
    out.id.push_back(id[k]);
  }
  const auto spans = [&](int divide, int remainder) {  // rows or columns that hold a corner
    std::map<int, int> lines;
    for (const int n : out.id) ++lines[remainder ? n % remainder : n / divide];
    return lines.size() > 1;
  };
  if (out.corner.size() < 8 || !spans(board.columns, 0) || !spans(1, board.columns)) return {};
  return out;
}

Image charuco_board(const Board& board, int square_px) {
  const int columns = board.columns + 1, rows = board.rows + 1;
  const auto drawn = cv::aruco::CharucoBoard::create(columns, rows, float(board.square), float(board.marker),
                                                     cv::aruco::getPredefinedDictionary(dictionary_of(board)));
  Image out((columns + 2) * square_px, (rows + 2) * square_px, PixelDepth::u8, 255);
  cv::Mat grey;
  drawn->draw(cv::Size(out.width(), out.height()), grey, square_px);
  for (int r = 0; r < out.height(); ++r) std::copy(grey.ptr(r), grey.ptr(r) + out.width(), out.row<std::uint8_t>(r));
  return out;
}

std::string markers_seen(const ImageView& image, const Board& board) {
  const cv::Mat grey = eight_bits(image);
  const int own = dictionary_of(board);
  const Markers asked = find(grey, own);
  if (!asked.id.empty()) {
    const int most = *std::max_element(asked.id.begin(), asked.id.end()), least = *std::min_element(asked.id.begin(), asked.id.end());
    return std::to_string(asked.id.size()) + " markers of it, numbered " + std::to_string(least) + " to " + std::to_string(most) +
           ", which do not lie as on such a board (its numbers are 0 to " +
           std::to_string(marked_squares(board, false).size() - 1) + ")";
  }
  std::string name;
  std::size_t most = 0;
  for (const DictionaryRow& row : dictionaries) {
    const std::size_t count = find(grey, row.id).id.size();
    if (count > most) most = count, name = row.name;
  }
  return most < 2 ? "no marker of any known dictionary" : std::to_string(most) + " markers of the dictionary " + name;
}

}  // namespace pivnp::image

#else

namespace pivnp::image {

BoardView charuco_corners(const ImageView&, const Board& board) {
  throw InputError("calibrate: found the dictionary '" + board.dictionary + "', but this program was built without OpenCV's "
                   "aruco module (libopencv-contrib-dev); expected a plain checkerboard");
}

Image charuco_board(const Board& board, int) {
  charuco_corners({}, board);
  return {};
}

std::string markers_seen(const ImageView&, const Board&) { return "what is not known"; }

}  // namespace pivnp::image

#endif
