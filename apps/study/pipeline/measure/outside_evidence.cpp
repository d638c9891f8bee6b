#include "apps/study/pipeline/measure/outside_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::app {

namespace {

constexpr int side = 8;             // of the blocks that belong to one point of an outline, px
constexpr int most_blocks = 3;      // from the outline, that tell of it
constexpr int far_blocks = 12;      // from the outline, that are looked at for grains on their own
constexpr double grain_px2 = 9;     // pixels that tell about one thing
constexpr double least_pixels = 60, errors = 3;      // of one block
constexpr double least_blocks = 6, errors_of_blocks = 4.5;
constexpr double least_share = 0.35;  // beyond this ground moves by less than a third of the move, or by more than two thirds

// Differences a of the frames at rest, and b along the move: sums over pixels. Of ground that moves by the share s of it,
// a - b is the contrast along the move and (a^2 - b^2) / (a - b)^2 = 2 s - 1, by however little it moves.
struct Evidence {
  double moving = 0, square = 0, contrast = 0, pixels = 0;  // of a^2 - b^2, of its square, of (a - b)^2
  double blocks = 0, of_blocks = 0;                         // how many, and the squares of their sums of a^2 - b^2
  void add(const Evidence& e) {
    moving += e.moving, square += e.square, contrast += e.contrast, pixels += e.pixels, blocks += e.blocks, of_blocks += e.of_blocks;
  }
};

Outside shown(const Evidence& e, double error, Outside otherwise) {
  const double least = std::max(error, least_share * e.contrast);
  return e.moving > least ? Outside::moving : e.moving < -least ? Outside::still : otherwise;
}
double error_by_pixels(const Evidence& e) { return errors * std::sqrt(e.square * grain_px2); }

// Blocks of the frame: the outline's point nearest to each, and how many blocks away it is.
struct Blocks {
  int nx, ny;
  std::vector<int> point, away;  // -1: none
  std::size_t at(int i, int j) const { return std::size_t(j) * std::size_t(nx) + std::size_t(i); }
};

Blocks nearest_points(const std::vector<Vec2>& px, int width, int height) {
  Blocks b{(width + side - 1) / side, (height + side - 1) / side, {}, {}};
  b.point.assign(std::size_t(b.nx) * std::size_t(b.ny), -1), b.away = b.point;
  std::vector<std::size_t> front, next;
  for (std::size_t k = 0; k < px.size(); ++k) {
    const int i = int(std::floor(px[k].x() / side)), j = int(std::floor(px[k].y() / side));
    if (i < 0 || j < 0 || i >= b.nx || j >= b.ny || b.point[b.at(i, j)] >= 0) continue;
    b.point[b.at(i, j)] = int(k), b.away[b.at(i, j)] = 0;
    front.push_back(b.at(i, j));
  }
  for (int away = 1; !front.empty(); ++away, front.swap(next)) {
    next.clear();
    for (const std::size_t n : front)
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) {
          const int i = int(n % std::size_t(b.nx)) + di, j = int(n / std::size_t(b.nx)) + dj;
          if (i < 0 || j < 0 || i >= b.nx || j >= b.ny || b.point[b.at(i, j)] >= 0) continue;
          b.point[b.at(i, j)] = b.point[n], b.away[b.at(i, j)] = away;
          next.push_back(b.at(i, j));
        }
  }
  return b;
}

// Grey values at a fixed distance from pixels, linear between them.
class Beside {
 public:
  Beside(const ImageView& frame, const Vec2& by)
      : frame_(frame), column_(int(std::floor(by.x()))), row_(int(std::floor(by.y()))), x_(by.x() - column_), y_(by.y() - row_) {}
  bool within(int c, int r) const {
    return c + column_ >= 0 && r + row_ >= 0 && c + column_ + (x_ > 0) < frame_.width && r + row_ + (y_ > 0) < frame_.height;
  }
  template <class Grey>
  double at(int c, int r) const {
    const double above = along(frame_.row<Grey>(r + row_) + c + column_);
    return y_ > 0 ? (1 - y_) * above + y_ * along(frame_.row<Grey>(r + row_ + 1) + c + column_) : above;
  }

 private:
  template <class Grey>
  double along(const Grey* p) const {
    return x_ > 0 ? (1 - x_) * double(p[0]) + x_ * double(p[1]) : double(p[0]);
  }
  const ImageView& frame_;
  int column_, row_;
  double x_, y_;
};

// One block's pixels that are not inside. What is left of the move beside whole pixels is halved between the frames: both
// differences are then smoothed alike.
template <class Grey>
Evidence look(const std::vector<std::uint8_t>& inside, const ImageView& first, const ImageView& second, int i, int j, const Vec2& still, const Vec2& moved) {
  Evidence e;
  const Vec2 by = moved - still;
  if (by == Vec2(0, 0)) return e;
  const Vec2 whole(std::round(by.x()), std::round(by.y())), half = (by - whole) / 2;
  const Beside rest(first, half), at_rest(second, half + still), start(first, -half), end(second, moved - half);
  for (int r = j * side; r < std::min((j + 1) * side, first.height); ++r)
    for (int c = i * side; c < std::min((i + 1) * side, first.width); ++c) {
      if (inside[std::size_t(r) * std::size_t(first.width) + std::size_t(c)]) continue;
      if (!rest.within(c, r) || !at_rest.within(c, r) || !start.within(c, r) || !end.within(c, r)) continue;
      const double a = at_rest.at<Grey>(c, r) - rest.at<Grey>(c, r), b = end.at<Grey>(c, r) - start.at<Grey>(c, r), d = a * a - b * b;
      e.moving += d, e.square += d * d, e.contrast += (a - b) * (a - b), ++e.pixels;
    }
  if (e.pixels > 0) e.blocks = 1, e.of_blocks = e.moving * e.moving;
  return e;
}

// Blocks about a point. Their scatter too tells how well their sum is known: better, where noise exceeds what the move changes.
Outside judged(const Evidence& e, Outside before) {
  if (e.pixels < least_pixels) return before;
  double error = error_by_pixels(e);
  if (e.blocks >= least_blocks) {
    const double scatter = std::max(0.0, e.of_blocks - e.moving * e.moving / e.blocks) * e.blocks / (e.blocks - 1);
    error = std::min(error, errors_of_blocks * std::sqrt(scatter));
  }
  return shown(e, error, before);
}

template <class Grey>
std::vector<std::uint8_t> judge(const std::vector<std::uint8_t>& inside, const Setting& setting, std::array<int, 2> pair, const ImageView& first,
                                const ImageView& second, int window_px, std::vector<MovingOutline>& outlines) {
  const image::Camera &a = setting.camera_at(pair[0]), &b = setting.camera_at(pair[1]);
  std::vector<Vec2> px, still, moved;
  const auto sane = [](const Vec2& d) { return d.allFinite() && d.norm() < 1e4 ? d : Vec2(0, 0); };
  for (const MovingOutline& outline : outlines)
    for (const OutlinePoint& p : outline.points) {
      px.push_back(a.to_pixel(p.place));
      still.push_back(sane(b.to_pixel(p.place) - px.back()));
      moved.push_back(sane(b.to_pixel(p.place + p.moved) - px.back()));
    }
  const Blocks blocks = nearest_points(px, first.width, first.height);
  std::vector<Evidence> evidence(px.size()), own(blocks.point.size());
  for (int j = 0; j < blocks.ny; ++j)
    for (int i = 0; i < blocks.nx; ++i) {
      const std::size_t n = blocks.at(i, j);
      if (blocks.point[n] < 0 || blocks.away[n] > far_blocks) continue;
      const auto k = std::size_t(blocks.point[n]);
      own[n] = look<Grey>(inside, first, second, i, j, still[k], moved[k]);
      if (blocks.away[n] <= most_blocks) evidence[k].add(own[n]);
    }
  // A point is judged by what its neighbours see too, over about a window.
  const int reach = std::max(2, window_px / 5);
  std::vector<Outside> outside_of(px.size(), Outside::unknown);
  std::size_t from = 0;
  bool any = false;
  for (MovingOutline& outline : outlines) {
    const auto count = std::ptrdiff_t(outline.points.size());
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      Evidence about;
      for (std::ptrdiff_t m = -reach; m <= reach; ++m) about.add(evidence[from + std::size_t(((k + m) % count + count) % count)]);
      Outside& outside = outline.points[std::size_t(k)].outside;
      outside = judged(about, outside);
      outside_of[from + std::size_t(k)] = outside;
      any = any || left_out(outside);
    }
    from += std::size_t(count);
  }
  if (!any) return {};
  std::vector<std::uint8_t> usable(inside.size()), out(blocks.point.size(), 0);
  for (std::size_t n = 0; n < out.size(); ++n)
    if (const int point = blocks.point[n]; point >= 0)
      out[n] = left_out(outside_of[std::size_t(point)]) && shown(own[n], error_by_pixels(own[n]), Outside::unknown) != Outside::moving;
  for (int r = 0; r < first.height; ++r)
    for (int c = 0; c < first.width; ++c) {
      const std::size_t n = std::size_t(r) * std::size_t(first.width) + std::size_t(c);
      usable[n] = inside[n] || !out[blocks.at(c / side, r / side)];
    }
  return usable;
}

}  // namespace

std::vector<std::uint8_t> judge_outside(const std::vector<std::uint8_t>& inside, const Setting& setting, std::array<int, 2> pair,
                                        const ImageView& first, const ImageView& second, int window_px, std::vector<MovingOutline>& outlines) {
  switch (first.depth) {
    case PixelDepth::u8: return judge<std::uint8_t>(inside, setting, pair, first, second, window_px, outlines);
    case PixelDepth::u16: return judge<std::uint16_t>(inside, setting, pair, first, second, window_px, outlines);
    case PixelDepth::f32: break;
  }
  return judge<float>(inside, setting, pair, first, second, window_px, outlines);
}

}  // namespace pivnp::app
