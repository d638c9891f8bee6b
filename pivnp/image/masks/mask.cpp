#include "pivnp/image/masks/mask.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/image/files/image_file.hpp"
#include "pivnp/image/masks/raster.hpp"

namespace pivnp::image {

namespace {

// Marks with 1 the pixels of one row that a shape covers; the row comes as zeros.
using RowCover = std::function<void(int row, std::uint8_t* covered)>;

std::string which_shapes(const MaskOptions& o) {
  std::string out;
  auto add = [&](bool given, const char* name) {
    if (given) out += (out.empty() ? "" : ", ") + std::string(name);
  };
  add(!o.polygon_px.empty(), "polygon_px");
  add(!o.polygon_m.empty(), "polygon_m");
  add(!o.circle_px.empty(), "circle_px");
  add(!o.image.empty(), "image");
  return out;
}

void mark(const std::vector<Run>& runs, std::uint8_t* covered) {
  for (const Run& run : runs) std::fill(covered + run.first, covered + run.last + 1, std::uint8_t{1});
}

RowCover polygon_cover(std::vector<Vec2> vertices_px, int width) {
  return [vertices = std::move(vertices_px), width, runs = std::vector<Run>()](int row, std::uint8_t* covered) mutable {
    polygon_runs(vertices, row, width, runs);
    mark(runs, covered);
  };
}

RowCover world_polygon_cover(const Points& points, const Camera& camera, int width, const std::string& what) {
  // A homography takes straight sides to straight sides, so the vertices are enough; a lens bends them.
  std::vector<Vec2> vertices = Polygon(positions_of(points), what).vertices();
  if (!camera.lens().straight()) {
    constexpr int pieces = 32;
    std::vector<Vec2> finer;
    for (std::size_t k = 0; k < vertices.size(); ++k)
      for (int n = 0; n < pieces; ++n)
        finer.push_back(vertices[k] + n / double(pieces) * (vertices[(k + 1) % vertices.size()] - vertices[k]));
    vertices = std::move(finer);
  }
  for (Vec2& v : vertices) {
    v = camera.to_pixel(v);
    if (!v.allFinite()) throw InputError(what + ": a vertex lies beyond the camera's horizon");
  }
  return polygon_cover(std::move(vertices), width);
}

RowCover circle_cover(const std::vector<double>& circle, int width, const std::string& what) {
  if (circle.size() != 3)
    throw InputError(what + ": found " + std::to_string(circle.size()) +
                     " numbers, expected three: centre column, centre row, radius");
  const bool finite = std::all_of(circle.begin(), circle.end(), [](double v) { return std::isfinite(v); });
  if (!finite || !(circle[2] > 0))
    throw InputError(what + ": found radius " + std::to_string(circle[2]) + ", expected finite numbers and a radius "
                     "above 0");
  return [centre = Vec2(circle[0], circle[1]), radius = circle[2], width, runs = std::vector<Run>()](
             int row, std::uint8_t* covered) mutable {
    circle_runs(centre, radius, row, width, runs);
    mark(runs, covered);
  };
}

template <class T>
void mark_zeros(const T* grey, int width, std::uint8_t* covered) {
  for (int c = 0; c < width; ++c) covered[c] = grey[c] == T(0);
}

RowCover image_cover(const std::filesystem::path& file, int width, int height, const std::string& what) {
  auto image = std::make_shared<Image>(read_image_file(file, what));
  if (image->width() != width || image->height() != height)
    throw InputError(what + ": '" + file.string() + "' is " + std::to_string(image->width()) + "x" +
                     std::to_string(image->height()) + ", but the frames are " + std::to_string(width) + "x" +
                     std::to_string(height));
  return [image, width](int row, std::uint8_t* covered) {
    switch (image->depth()) {
      case PixelDepth::u8: return mark_zeros(image->row<std::uint8_t>(row), width, covered);
      case PixelDepth::u16: return mark_zeros(image->row<std::uint16_t>(row), width, covered);
      case PixelDepth::f32: return mark_zeros(image->row<float>(row), width, covered);
    }
  };
}

RowCover cover_of(const MaskOptions& options, const Camera& camera, int width, int height,
                  const std::filesystem::path& base, const std::string& what) {
  const std::string shapes = which_shapes(options);
  if (shapes.empty())
    throw InputError(what + ": no shape; expected one of polygon_px, polygon_m, circle_px, image");
  if (shapes.find(',') != std::string::npos)
    throw InputError(what + ": several shapes in one mask (" + shapes + "); expected one, give each a mask of its own");
  const std::string place = what + "." + shapes;
  if (!options.polygon_px.empty())
    return polygon_cover(Polygon(positions_of(options.polygon_px), place).vertices(), width);
  if (!options.polygon_m.empty()) return world_polygon_cover(options.polygon_m, camera, width, place);
  if (!options.circle_px.empty()) return circle_cover(options.circle_px, width, place);
  return image_cover(base / options.image, width, height, place);
}

}  // namespace

Mask make_mask(const std::vector<std::pair<std::string, MaskOptions>>& named, const Camera& camera, int width,
               int height, const std::filesystem::path& base) {
  if (std::all_of(named.begin(), named.end(), [](const auto& entry) { return entry.second.moves(); })) return {};
  Mask mask(width, height);
  std::vector<std::uint8_t> covered(std::size_t(width), std::uint8_t{0});
  for (const auto& [name, options] : named) {
    if (options.moves()) continue;
    const RowCover cover = cover_of(options, camera, width, height, base, "mask." + name);
    for (int r = 0; r < height; ++r) {
      std::fill(covered.begin(), covered.end(), std::uint8_t{0});
      cover(r, covered.data());
      std::uint8_t* usable = mask.row(r);
      const std::uint8_t keep = options.invert ? 1 : 0;
      for (int c = 0; c < width; ++c) usable[c] = std::uint8_t(usable[c] & (covered[std::size_t(c)] == keep));
    }
  }
  for (int r = 0; r < height; ++r)
    if (std::find(mask.row(r), mask.row(r) + width, std::uint8_t{1}) != mask.row(r) + width) return mask;
  std::string names;
  for (const auto& entry : named) names += (names.empty() ? "" : ", ") + entry.first;
  throw InputError("mask: nothing of the image is left (masks: " + names + ")");
}

}  // namespace pivnp::image
