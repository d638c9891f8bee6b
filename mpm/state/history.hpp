// What laws remember of a point beside its stress. Each law declares its variables with its row (material/model.hpp); only
// those that a law of the case declares have values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "mpm/state/array.hpp"
#include "pivnp/core/particles/fields.hpp"

namespace pivnp::mpm {

enum class Recorded {
  no,
  declared,  // where a law of the case declares the variable
  always,    // zeros elsewhere, so that records of all laws have it
};

/// A history variable of a law. Laws that declare the same name share its values. Components are double precision.
struct HistoryVariable {
  std::string_view name;  // the name of the motion field too, if it is recorded
  std::string_view unit = "1";
  std::string_view definition = {};  // one line
  FieldForm form = FieldForm::scalar;  // code: a flag of one byte, 0 or 1
  Recorded recorded = Recorded::no;
  std::string_view label = {};  // as a report says it
  bool reset = true;            // zero again after the initial equilibrium

  bool flag() const { return form == FieldForm::code; }
  /// The row that a recorded variable has among motion_fields(). A flag is recorded as 0 or 1.
  MotionField field() const;
};

/// Variables that more than their laws know of.
/// Volumetric strain by which material stands open: transfers do not average over points where it is above zero.
inline constexpr HistoryVariable opening_strain{.name = "opening",
                                                .definition = "volumetric strain by which the material stands open, >= 0"};
/// The energy balance counts it.
inline constexpr HistoryVariable plastic_work{
    .name = "dissipated", .unit = "J/m^3", .definition = "plastic work per initial volume"};
/// Of which softening may take the mean around a point (Material::nonlocal_length).
inline constexpr HistoryVariable plastic_strain{
    .name = "plastic_dev",
    .definition = "sum of sqrt(2/3 dep:dep), dep the deviator of plastic strain",
    .recorded = Recorded::always,
    .label = "plastic deviatoric strain"};

/// The values of a case's history variables.
class HistoryVariables {
 public:
  struct Variable {
    HistoryVariable is;
    std::size_t first, count;  // its components among `numbers`, or its place among `flags`
  };
  /// Where a law's variables are: places among `numbers` and `flags`, in the order in which it declares them.
  struct Places {
    std::vector<std::uint32_t> numbers, flags;
  };

  /// Makes room for these variables of `n` points, at zero, and tells where they are; those that are there already are
  /// shared. What find() returned before is no longer valid.
  Places declare(const std::vector<HistoryVariable>& variables, std::size_t n);
  /// The first component of a variable's values; nullptr where no law declares it.
  Array* find(std::string_view name);
  const Array* find(std::string_view name) const { return const_cast<HistoryVariables*>(this)->find(name); }
  /// Zeros, where a variable asks for it.
  void reset();

  std::vector<Variable> variables;
  std::vector<Array> numbers;
  std::vector<Flags> flags;
};

}  // namespace pivnp::mpm
