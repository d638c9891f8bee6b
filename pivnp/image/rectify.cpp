#include "pivnp/image/rectify.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pivnp::image {

namespace {

struct Cover {
  int x0 = 0, y0 = 0, width = 0, height = 0;  // ideal pixels
};

Cover cover(const Camera& camera, int width, int height) {
  constexpr int pieces = 32;
  Vec2 lower = Vec2::Constant(INFINITY), upper = -lower;
  for (int k = 0; k <= pieces; ++k) {
    const double c = (width - 1.0) * k / pieces, r = (height - 1.0) * k / pieces;
    for (const Vec2& p : {Vec2(c, 0), Vec2(c, height - 1), Vec2(0, r), Vec2(width - 1, r)}) {
      const Vec2 q = camera.lens().to_ideal(p);
      if (q.allFinite()) lower = lower.cwiseMin(q), upper = upper.cwiseMax(q);
    }
  }
  const auto side = [](double from, double to, int size, int& first, int& count) {
    first = std::max(int(std::floor(from)), -size / 2);
    count = std::min(int(std::ceil(to)), size + size / 2) - first + 1;
  };
  Cover out;
  side(lower.x(), upper.x(), width, out.x0, out.width);
  side(lower.y(), upper.y(), height, out.y0, out.height);
  return out;
}

Mat3 moved(const Camera& camera, const Cover& c) {
  Mat3 shift = Mat3::Identity();
  shift(0, 2) = c.x0, shift(1, 2) = c.y0;
  return camera.world_from_pixel() * shift;
}

double grey(const ImageView& image, int column, int row) {
  const int c = std::clamp(column, 0, image.width - 1), r = std::clamp(row, 0, image.height - 1);
  switch (image.depth) {
    case PixelDepth::u8: return double(image.row<std::uint8_t>(r)[c]);
    case PixelDepth::u16: return double(image.row<std::uint16_t>(r)[c]);
    case PixelDepth::f32: return double(image.row<float>(r)[c]);
  }
  return 0;
}

}  // namespace

DrawnFrame drawn_frame(Image image, const Camera& camera) {
  if (camera.lens().straight() || image.empty()) return {std::move(image), camera.world_from_pixel()};
  const Cover area = cover(camera, image.width(), image.height());
  Image out(area.width, area.height, PixelDepth::u8, 255.0f);
  const ImageView from = image.view();
  for (int r = 0; r < area.height; ++r)
    for (int c = 0; c < area.width; ++c) {
      const Vec2 p = camera.lens().to_pixel({double(c + area.x0), double(r + area.y0)});
      double value = 0;
      if (p.x() >= -0.5 && p.y() >= -0.5 && p.x() <= from.width - 0.5 && p.y() <= from.height - 0.5) {
        const int i = int(std::floor(p.x())), j = int(std::floor(p.y()));
        const double fx = p.x() - i, fy = p.y() - j;
        value = (1 - fy) * ((1 - fx) * grey(from, i, j) + fx * grey(from, i + 1, j)) +
                fy * ((1 - fx) * grey(from, i, j + 1) + fx * grey(from, i + 1, j + 1));
      }
      out.row<std::uint8_t>(r)[c] = std::uint8_t(std::lround(std::clamp(255 * value / double(from.white), 0.0, 255.0)));
    }
  return {std::move(out), moved(camera, area)};
}

Mask drawn_mask(const Mask& mask, const Camera& camera) {
  if (camera.lens().straight() || mask.empty()) return mask;
  const MaskView from = mask.view();
  const Cover area = cover(camera, from.width, from.height);
  Mask out(area.width, area.height);
  for (int r = 0; r < area.height; ++r)
    for (int c = 0; c < area.width; ++c) {
      const Vec2 p = camera.lens().to_pixel({double(c + area.x0), double(r + area.y0)});
      if (!(p.x() >= -0.5 && p.y() >= -0.5 && p.x() < from.width - 0.5 && p.y() < from.height - 0.5)) continue;
      out.row(r)[c] = from.usable(int(std::lround(p.x())), int(std::lround(p.y())));
    }
  return out;
}

}  // namespace pivnp::image
