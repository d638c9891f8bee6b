// The small vectors and matrices that appear in public headers.
#pragma once

#include <Eigen/Core>

namespace pivnp {

using Vec2 = Eigen::Vector2d;  // (x, y), world axes unless the name says otherwise
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;

}  // namespace pivnp
