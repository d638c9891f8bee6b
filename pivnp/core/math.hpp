// The small vectors and matrices that appear in public headers.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <numbers>

namespace pivnp {

using Vec2 = Eigen::Vector2d;  // (x, y), world axes unless the name says otherwise
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;

inline constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

/// Of two vectors, the component out of the plane.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace pivnp
