// The small vectors and matrices that appear in public headers.
#pragma once

#include <Eigen/Core>
#include <numbers>

namespace pivnp {

using Vec2 = Eigen::Vector2d;  // (x, y), world axes unless the name says otherwise
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace pivnp
