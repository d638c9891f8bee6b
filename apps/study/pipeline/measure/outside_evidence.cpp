#include "apps/study/pipeline/measure/outside_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::app {

namespace {

constexpr int side = 8;             // of the blocks that belong to one point of an outline, px
constexpr int most_blocks = 3;      // from the outline, that tell of it
constexpr int far_blocks = 12;      // from the outline, that are looked at for grains on their own
constexpr double grain_px2 = 9;     // pixels that tell about one thing
constexpr double least_pixels = 60, errors = 3, better = 0.8;

struct Evidence {
  double still = 0, moved = 0, square = 0, pixels = 0;  // sums of squared differences, and of the square of their difference
  void add(const Evidence& e) {
    still += e.still, moved += e.moved, square += e.square, pixels += e.pixels;
  }
};

// Sums that stand out by three standard errors, and by a fifth.
bool first_is_less(double first, double second, double square) {
  return second - first > errors * std::sqrt(square * grain_px2) && first < better * second;
}

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

struct Shift {
  int column = 0, row = 0;
};

// One block's pixels that are not inside.
template <class Grey>
Evidence look(const std::vector<std::uint8_t>& inside, const ImageView& first, const ImageView& second, int i, int j, Shift still, Shift moved) {
  Evidence e;
  if (still.column == moved.column && still.row == moved.row) return e;
  const auto within = [&](int c, int r) { return c >= 0 && r >= 0 && c < second.width && r < second.height; };
  for (int r = j * side; r < std::min((j + 1) * side, first.height); ++r)
    for (int c = i * side; c < std::min((i + 1) * side, first.width); ++c) {
      if (inside[std::size_t(r) * std::size_t(first.width) + std::size_t(c)]) continue;
      const double grey = double(first.row<Grey>(r)[c]);
      if (!within(c + still.column, r + still.row) || !within(c + moved.column, r + moved.row)) continue;
      const double a = double(second.row<Grey>(r + still.row)[c + still.column]) - grey,
                   b = double(second.row<Grey>(r + moved.row)[c + moved.column]) - grey, d = a * a - b * b;
      e.still += a * a, e.moved += b * b, e.square += d * d, ++e.pixels;
    }
  return e;
}

Outside judged(const Evidence& e, Outside before) {
  if (e.pixels >= least_pixels) {
    if (first_is_less(e.moved, e.still, e.square)) return Outside::moving;
    if (first_is_less(e.still, e.moved, e.square)) return Outside::still;
  }
  return before;
}

template <class Grey>
std::vector<std::uint8_t> judge(const std::vector<std::uint8_t>& inside, const Setting& setting, std::array<int, 2> pair, const ImageView& first,
                                const ImageView& second, int window_px, std::vector<MovingOutline>& outlines) {
  const image::Camera &a = setting.camera_at(pair[0]), &b = setting.camera_at(pair[1]);
  std::vector<Vec2> px;
  std::vector<Shift> still, moved;
  const auto whole = [](const Vec2& d) { return d.allFinite() && d.norm() < 1e4 ? Shift{int(std::lround(d.x())), int(std::lround(d.y()))} : Shift{}; };
  for (const MovingOutline& outline : outlines)
    for (const OutlinePoint& p : outline.points) {
      px.push_back(a.to_pixel(p.place));
      still.push_back(whole(b.to_pixel(p.place) - px.back()));
      moved.push_back(whole(b.to_pixel(p.place + p.moved) - px.back()));
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
      out[n] = left_out(outside_of[std::size_t(point)]) && !first_is_less(own[n].moved, own[n].still, own[n].square);
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
