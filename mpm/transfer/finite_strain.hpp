// Strain and rotation of one step, point by point, for steps of any size.
#pragma once

namespace pivnp::mpm {

/// d v_a / d x_b times the step.
struct Gradient {
  double xx = 0, xy = 0, yx = 0, yy = 0;
};

/// f = I + G = V R: rotation by the angle t with 2 tan(t/2) = spin, log strain ln V. Exact: a step that turns the point
/// rigidly, however far, strains it by nothing.
struct Polar {
  double xx, yy, xy, spin;
};

double log_det(const Gradient& G);
Polar polar(const Gradient& G);

}  // namespace pivnp::mpm
