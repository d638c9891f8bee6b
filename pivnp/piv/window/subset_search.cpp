#include "pivnp/piv/window/subset_search.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pivnp::piv {

namespace {

// The box [x0, x0 + w) x [y0, y0 + h) as floats.
std::vector<float> cut(const ImageView& image, int x0, int y0, int w, int h) {
  std::vector<float> out;
  out.reserve(std::size_t(w) * std::size_t(h));
  const auto rows = [&](auto type) {
    using T = decltype(type);
    for (int r = y0; r < y0 + h; ++r)
      for (int c = x0; c < x0 + w; ++c) out.push_back(static_cast<float>(image.row<T>(r)[c]));
  };
  switch (image.depth) {
    case PixelDepth::u8: rows(std::uint8_t{}); break;
    case PixelDepth::u16: rows(std::uint16_t{}); break;
    case PixelDepth::f32: rows(float{}); break;
  }
  return out;
}

}  // namespace

std::optional<SearchHit> search_subset(const ImageView& first, const ImageView& second, const Vec2& from, const Vec2& expected,
                                       int side_px, int reach_px) {
  if (!from.allFinite() || !expected.allFinite()) return std::nullopt;
  const int half = side_px / 2, side = 2 * half + 1;
  const int cx = int(std::lround(from.x())), cy = int(std::lround(from.y()));
  const auto inside = [&](const ImageView& image, int x, int y) {
    return x - half >= 0 && y - half >= 0 && x + half < image.width && y + half < image.height;
  };
  if (!inside(first, cx, cy) || expected.cwiseAbs().maxCoeff() > 1e6) return std::nullopt;
  std::vector<float> f = cut(first, cx - half, cy - half, side, side);
  double mean = 0, energy = 0;
  for (const float v : f) mean += double(v);
  mean /= double(f.size());
  for (float& v : f) v = static_cast<float>(double(v) - mean), energy += double(v) * double(v);
  if (!(energy > double(f.size()) / 3)) return std::nullopt;
  const Vec2 off = from - Vec2(cx, cy);  // of the rounding
  const int ex = int(std::lround(expected.x() - off.x())), ey = int(std::lround(expected.y() - off.y()));
  // The second image's part that shifts reach.
  const int x0 = std::max(0, ex - reach_px - half), y0 = std::max(0, ey - reach_px - half);
  const int x1 = std::min(second.width, ex + reach_px + half + 1), y1 = std::min(second.height, ey + reach_px + half + 1);
  if (x1 - x0 < side || y1 - y0 < side) return std::nullopt;
  const int width = x1 - x0;
  const std::vector<float> g = cut(second, x0, y0, width, y1 - y0);
  std::optional<SearchHit> best;
  for (int top = 0; top + side <= y1 - y0; ++top)
    for (int left = 0; left + side <= width; ++left) {
      double sum = 0, squares = 0, product = 0;
      for (int r = 0; r < side; ++r) {
        const float* here = g.data() + std::size_t(top + r) * std::size_t(width) + std::size_t(left);
        const float* there = f.data() + std::size_t(r) * std::size_t(side);
        float s = 0, q = 0, p = 0;  // of one row: exact enough in single precision
        for (int c = 0; c < side; ++c) s += here[c], q += here[c] * here[c], p += there[c] * here[c];
        sum += double(s), squares += double(q), product += double(p);
      }
      const double variance = squares - sum * sum / double(f.size());
      if (!(variance > 0)) continue;
      const double score = product / std::sqrt(energy * variance);
      if (!best || score > best->score) best = SearchHit{Vec2(x0 + left + half, y0 + top + half) + off, score};
    }
  return best;
}

}  // namespace pivnp::piv
