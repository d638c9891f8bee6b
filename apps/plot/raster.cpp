#include "apps/plot/raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

namespace pivnp::plot {

namespace {

// Twice the resolution, averaged down: coverage gives alpha.
Raster halved(const Raster& fine) {
  Raster out{fine.width / 2, fine.height / 2, {}};
  out.pixels.resize(std::size_t(out.width) * std::size_t(out.height));
  for (int r = 0; r < out.height; ++r)
    for (int c = 0; c < out.width; ++c) {
      unsigned alpha = 0, channel[3] = {0, 0, 0};
      for (int k = 0; k < 4; ++k) {
        const std::uint32_t p =
            fine.pixels[std::size_t(2 * r + k / 2) * std::size_t(fine.width) + std::size_t(2 * c + k % 2)];
        if (p >> 24 == 0) continue;
        ++alpha;
        channel[0] += (p >> 16) & 0xff;
        channel[1] += (p >> 8) & 0xff;
        channel[2] += p & 0xff;
      }
      if (alpha == 0) continue;
      out.pixels[std::size_t(r) * std::size_t(out.width) + std::size_t(c)] =
          (alpha * 255 / 4) << 24 | (channel[0] / alpha) << 16 | (channel[1] / alpha) << 8 | (channel[2] / alpha);
    }
  return out;
}

int height_for(const Box& box, int width) {
  return std::clamp(int(std::lround(width * box.height() / box.width())), 1, 8 * width);
}

double grey(const ImageView& image, int column, int row) {
  switch (image.depth) {
    case PixelDepth::u8: return image.row<std::uint8_t>(row)[column];
    case PixelDepth::u16: return image.row<std::uint16_t>(row)[column];
    case PixelDepth::f32: return double(image.row<float>(row)[column]);
  }
  return 0;
}

// The image averaged over factor x factor blocks: pixel (c, r) is centred on (c + 1/2) factor - 1/2 of the original.
struct Reduced {
  int width, height, factor;
  std::vector<float> value;
  float at(int c, int r) const {
    return value[std::size_t(std::clamp(r, 0, height - 1)) * std::size_t(width) +
                 std::size_t(std::clamp(c, 0, width - 1))];
  }
};

Reduced reduce(const ImageView& image, int factor) {
  Reduced out{(image.width + factor - 1) / factor, (image.height + factor - 1) / factor, factor, {}};
  out.value.resize(std::size_t(out.width) * std::size_t(out.height));
#pragma omp parallel for schedule(static)
  for (int r = 0; r < out.height; ++r)
    for (int c = 0; c < out.width; ++c) {
      double sum = 0;
      int n = 0;
      for (int row = r * factor; row < std::min((r + 1) * factor, image.height); ++row)
        for (int column = c * factor; column < std::min((c + 1) * factor, image.width); ++column, ++n)
          sum += grey(image, column, row);
      out.value[std::size_t(r) * std::size_t(out.width) + std::size_t(c)] = float(sum / n);
    }
  return out;
}

std::array<float, 2> contrast_limits(const std::vector<float>& value) {
  std::vector<float> sorted;
  for (float v : value)
    if (std::isfinite(v)) sorted.push_back(v);
  if (sorted.empty()) return {0, 1};
  auto quantile = [&](double q) {
    const auto at = sorted.begin() + std::ptrdiff_t(q * double(sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    return *at;
  };
  const float low = quantile(0.01), high = quantile(0.99);
  return {low, high > low ? high : low + 1};
}

Vec2 project(const Mat3& h, const Vec2& p) {
  const Eigen::Vector3d q = h * Eigen::Vector3d(p.x(), p.y(), 1);
  return q.head<2>() / q.z();
}

}  // namespace

Raster draw_tiles(std::span<const Tile> tiles, const Box& box, int width) {
  Raster fine{2 * width, 2 * height_for(box, width), {}};
  fine.pixels.assign(std::size_t(fine.width) * std::size_t(fine.height), 0);
  const double sx = fine.width / box.width(), sy = fine.height / box.height();
  for (const Tile& tile : tiles) {
    // Sample coordinates, y downward, sample centres on whole numbers.
    const double cx = (tile.centre.x() - box.lower.x()) * sx - 0.5, cy = (box.upper.y() - tile.centre.y()) * sy - 0.5;
    const Vec2 a(tile.half_x.x() * sx, -tile.half_x.y() * sy), b(tile.half_y.x() * sx, -tile.half_y.y() * sy);
    const double det = a.x() * b.y() - a.y() * b.x();
    const double ex = std::abs(a.x()) + std::abs(b.x()), ey = std::abs(a.y()) + std::abs(b.y());
    if (!std::isfinite(cx + cy + ex + ey) || std::abs(cx) > 1e6 || std::abs(cy) > 1e6) continue;
    const int c0 = std::max(0, int(std::ceil(cx - ex))), c1 = std::min(fine.width - 1, int(std::floor(cx + ex)));
    const int r0 = std::max(0, int(std::ceil(cy - ey))), r1 = std::min(fine.height - 1, int(std::floor(cy + ey)));
    const std::uint32_t colour = 0xff000000u | tile.colour;
    auto put = [&](int c, int r) { fine.pixels[std::size_t(r) * std::size_t(fine.width) + std::size_t(c)] = colour; };
    if (const int c = int(std::lround(cx)), r = int(std::lround(cy));
        c >= 0 && c < fine.width && r >= 0 && r < fine.height)
      put(c, r);
    if (std::abs(det) < 1e-9) continue;
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c) {
        const double dx = c - cx, dy = r - cy;
        const double s = (dx * b.y() - dy * b.x()) / det, t = (a.x() * dy - a.y() * dx) / det;
        if (std::abs(s) <= 1 && std::abs(t) <= 1) put(c, r);
      }
  }
  return halved(fine);
}

Box image_box(int width, int height, const Mat3& world_from_pixel) {
  Box box{Vec2::Constant(INFINITY), Vec2::Constant(-INFINITY)};
  for (const double c : {-0.5, width - 0.5})
    for (const double r : {-0.5, height - 0.5}) {
      const Vec2 x = project(world_from_pixel, {c, r});
      box.lower = box.lower.cwiseMin(x);
      box.upper = box.upper.cwiseMax(x);
    }
  return box;
}

Raster draw_image(const ImageView& image, const Mat3& world_from_pixel, const Box& box, int width, int dark,
                  int light) {
  Raster out{width, height_for(box, width), {}};
  out.pixels.assign(std::size_t(out.width) * std::size_t(out.height), 0);
  const Mat3 pixel_from_world = world_from_pixel.inverse();
  const Vec2 left = project(pixel_from_world, box.lower),
             right = project(pixel_from_world, {box.upper.x(), box.lower.y()});
  const double pixels_each = (right - left).norm() / width;
  const Reduced reduced = reduce(image, std::clamp(int(std::floor(pixels_each + 0.25)), 1, 64));
  const auto [low, high] = contrast_limits(reduced.value);
#pragma omp parallel for schedule(static)
  for (int r = 0; r < out.height; ++r)
    for (int c = 0; c < out.width; ++c) {
      const Vec2 world(box.lower.x() + (c + 0.5) / out.width * box.width(),
                       box.upper.y() - (r + 0.5) / out.height * box.height());
      const Vec2 p = project(pixel_from_world, world);
      if (!(p.x() >= -0.5 && p.y() >= -0.5 && p.x() <= image.width - 0.5 && p.y() <= image.height - 0.5)) continue;
      const double x = (p.x() + 0.5) / reduced.factor - 0.5, y = (p.y() + 0.5) / reduced.factor - 0.5;
      const int i = int(std::floor(x)), j = int(std::floor(y));
      const double fx = x - i, fy = y - j;
      const double v = (1 - fy) * ((1 - fx) * double(reduced.at(i, j)) + fx * double(reduced.at(i + 1, j))) +
                       fy * ((1 - fx) * double(reduced.at(i, j + 1)) + fx * double(reduced.at(i + 1, j + 1)));
      if (!std::isfinite(v)) continue;
      const double t = std::clamp((v - double(low)) / double(high - low), 0.0, 1.0);
      const auto g = std::uint32_t(std::lround(dark + t * (light - dark)));
      out.pixels[std::size_t(r) * std::size_t(out.width) + std::size_t(c)] = 0xff000000u | g << 16 | g << 8 | g;
    }
  return out;
}

}  // namespace pivnp::plot
