// What is drawn over the frames: outlines of the case, in pixels.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/case/edit.hpp"
#include "pivnp/core/choice.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/image/camera/camera.hpp"

namespace pivnp::view {

enum class ShapeKind { region, mask, wall, still_zone };
inline constexpr std::array shape_kind_names{NamedValue{"Region", ShapeKind::region}, NamedValue{"Mask", ShapeKind::mask},
                                             NamedValue{"Wall", ShapeKind::wall},
                                             NamedValue{"Still zone", ShapeKind::still_zone}};
constexpr const auto& names_of(ShapeKind) { return shape_kind_names; }

struct Shape {
  ShapeKind kind = ShapeKind::region;
  app::KeyPath key;          // {"region", "sand", "polygon_px"}
  bool world = false;        // the key holds world coordinates
  bool closed = true;
  std::vector<Vec2> points;  // px (column, row)
  bool circle = false;       // points around a circle of the text, where its numbers are edited

  /// "sand"; of a still zone "still zone".
  std::string name() const { return key.size() == 3 ? key[1] : "still zone"; }
};

/// Every outline of the case: regions, masks, boundaries, the still zone. `camera` is that of the case as
/// its text has it.
std::vector<Shape> shapes_of(const app::Case& c, const image::Camera& camera);

/// The key's value for these points; pixels to 0.01 px, the world to six digits of a hundredth of a pixel.
std::string toml_of(const Shape& shape, const image::Camera& camera);

/// Throws InputError with the reason where the points are no outline.
void require_outline(const Shape& shape);

}  // namespace pivnp::view
