// Fields computed from a motion on reading: strains, invariants, velocity, acceleration.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/particles/motion.hpp"

namespace pivnp {

/// One field the reader can compute.
struct DerivedField {
  std::string name;
  std::string unit;  // in terms of length L and time T: "1", "1/T", "L", "L/T", "L/T^2", "Pa", "rad"
  std::string definition;
  std::string label = {};   // as a report says it
  std::string source = {};  // the recorded field that a motion must carry for it; empty: u and F are enough
  bool strain = false;      // of F or its increments: stated with a gauge length and a noise floor
};

/// displacement_x _y _magnitude; velocity_x _y _magnitude; acceleration_x _y _magnitude;
/// strain_xx _yy _xy (log strain, world axes); strain_vol; strain_dev; strain_1 _2 _angle; J;
/// strain_rate_xx _yy _xy _vol _dev _1 _2 _angle (rate of deformation);
/// strain_dev_path (sum over frames of sqrt(2/3 de:de)); strain_sum_xx _yy _xy _dev (the thesis' summed increments);
/// sigma_displacement_x _y _magnitude (from cov_u), sigma_strain_xx _yy _xy _vol _dev (from cov_F): standard uncertainties;
/// mean_stress; and every recorded field beyond u, F and v (core/particles/fields.hpp), NAME or NAME_COMPONENT:
/// stress_xx _yy _zz _xy, plastic_dev.
std::vector<DerivedField> derived_fields();

/// Throws InputError listing the nearest known name if `name` is not one.
DerivedField derived_field(std::string_view name);

/// The field that is the standard uncertainty of `name`; empty: none is.
std::string sigma_field(std::string_view name);

/// The named fields of one motion, frame after frame. Path fields (strain_dev_path, strain_sum_*) need the frames in
/// order: reading frame k after frame j < k reads those between; going back starts again at the first.
/// Velocity: MotionFrame::v where the source has it, else the central difference of u over the neighbouring frames
/// (exact for uneven times to second order), one-sided second order at the ends of a particle's life. Acceleration:
/// difference of the same. A particle unborn or ended at the frame gives NaN.
class DerivedReader {
 public:
  /// `central`: the increments' anchor is central (see strain.hpp); it decides the summed strain only.
  DerivedReader(const MotionSource& motion, bool central);
  ~DerivedReader();
  /// One value a particle, NaN where it is not alive or the source lacks the quantity.
  std::vector<double> values(std::string_view name, std::size_t frame);

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace pivnp
