// What a finished record says of a comparison's camera.
#pragma once

#include "compare/data/options.hpp"

namespace pivnp::app {

/// The residual of the camera's targets becomes the measurement's systematic uncertainty where none is given.
void add_camera(double residual, compare::CompareOptions& options);

}  // namespace pivnp::app
