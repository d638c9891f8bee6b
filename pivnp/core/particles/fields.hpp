// What a motion can carry of its particles at each time: one list, one row a field. Records, their readers and viewers,
// computed fields and reports walk it, so that a field which is added here arrives in all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/registry.hpp"

namespace pivnp {

/// What the numbers of one particle are, which also says how they turn with the axes.
enum class FieldForm : std::uint8_t {
  scalar,
  code,       // a small whole number (a status): one byte, not single precision like all others
  vector,     // x y
  tensor,     // xx xy yx yy, row-major
  symmetric,  // xx yy xy
  stress,     // xx yy zz xy, with the component across the plane
};

struct MotionField {
  std::string name;                          // of the dataset
  std::string unit = "1";                    // in terms of length L and time T: "1", "Pa", "L/T", "L^2"; "": none
  FieldForm form = FieldForm::scalar;
  std::string label = {};                    // as a report says it
  std::string definition = {};               // one line
  std::optional<std::string> shown_as = {};  // in viewers; left out: `name`; empty: not shown
  bool always = false;                       // every motion has it
  bool member = false;                       // a member of MotionFrame; all others are in its `fields`

  std::size_t components() const;
  /// "xx", "yy" ...; one empty name for a scalar.
  std::vector<std::string> component_names() const;
};

/// The members of MotionFrame first; then what stands in its `fields`. The order is that of a record's datasets.
Registry<MotionField>& motion_fields();

/// The values of `field` in `frame`, particle by particle, components together (floats, bytes for a code); nullptr
/// where the frame lacks it.
const void* values_of(const MotionFrame& frame, const MotionField& field);

/// The number of particles that `frame` has values of `field` for; 0 where it lacks it.
std::size_t particles_with(const MotionFrame& frame, const MotionField& field);

/// Gives `frame` room for `field` of so many particles, and returns it. Valid until the frame or that field changes.
void* make_room(MotionFrame& frame, const MotionField& field, std::size_t particles);

/// A unit in terms of length L and time T ("L/T^2"), in those that are used: "m/s^2".
std::string unit_in(std::string_view pattern, const std::string& length, const std::string& time);

}  // namespace pivnp
