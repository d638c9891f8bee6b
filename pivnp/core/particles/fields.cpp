#include "pivnp/core/particles/fields.hpp"

#include <algorithm>

namespace pivnp {

namespace {

const std::vector<std::string>& names_of(FieldForm form) {
  static const std::vector<std::string> none = {""}, vector = {"x", "y"}, tensor = {"xx", "xy", "yx", "yy"},
                                        symmetric = {"xx", "yy", "xy"}, stress = {"xx", "yy", "zz", "xy"};
  switch (form) {
    case FieldForm::vector: return vector;
    case FieldForm::tensor: return tensor;
    case FieldForm::symmetric: return symmetric;
    case FieldForm::stress: return stress;
    case FieldForm::scalar:
    case FieldForm::code: break;
  }
  return none;
}

// Calls `visit` with the array that holds `field`; false where the frame has none of that name.
template <class Frame, class Visit>
bool with_array(Frame& frame, const MotionField& field, const Visit& visit) {
  if (!field.member) {
    const auto at = std::find_if(frame.fields.begin(), frame.fields.end(),
                                 [&](const FieldValues& f) { return f.field->name == field.name; });
    if (at == frame.fields.end()) return false;
    visit(at->values);
  } else if (field.name == "u") visit(frame.u);
  else if (field.name == "F") visit(frame.F);
  else if (field.name == "status") visit(frame.status);
  else if (field.name == "cov_u") visit(frame.cov_u);
  else if (field.name == "v") visit(frame.v);
  else return false;
  return true;
}

}  // namespace

std::size_t MotionField::components() const { return names_of(form).size(); }
std::vector<std::string> MotionField::component_names() const { return names_of(form); }

Registry<MotionField>& motion_fields() {
  static Registry<MotionField> fields = {
      {.name = "u", .unit = "L", .form = FieldForm::vector, .label = "displacement",
       .definition = "displacement since x0 (since birth); the position is x0 + u", .shown_as = "displacement",
       .always = true, .member = true},
      {.name = "F", .form = FieldForm::tensor, .label = "deformation gradient",
       .definition = "deformation gradient, row by row", .shown_as = "", .always = true, .member = true},
      {.name = "status", .unit = "", .form = FieldForm::code, .label = "status",
       .definition = "0 unborn, 1 active, 2 flagged, 3 ended", .always = true, .member = true},
      {.name = "cov_u", .unit = "L^2", .form = FieldForm::symmetric, .label = "covariance of the displacement",
       .definition = "covariance of u from the measurement", .shown_as = "", .member = true},
      {.name = "v", .unit = "L/T", .form = FieldForm::vector, .label = "velocity",
       .definition = "velocity, where the source states it", .shown_as = "velocity",
       .member = true},
      {.name = "cov_F", .form = FieldForm::symmetric, .label = "variance of the deformation gradient",
       .definition = "covariance of a row of F from the measurement; both rows err alike and independently", .shown_as = ""},
      {.name = "stress", .unit = "Pa", .form = FieldForm::stress, .label = "stress",
       .definition = "stress, tension positive"},
      {.name = "plastic_dev", .label = "plastic deviatoric strain",
       .definition = "accumulated plastic deviatoric strain, where the source has it"},
      {.name = "pressure", .unit = "Pa", .label = "pore pressure",
       .definition = "pressure of the water in the pores, compression positive"},
      {.name = "excess_pressure", .unit = "Pa", .label = "excess pore pressure",
       .definition = "pore pressure above the hydrostatic pressure of the water outside"},
      {.name = "porosity", .label = "porosity", .definition = "volume of the pores over total volume"},
      {.name = "water_flow", .unit = "L/T", .form = FieldForm::vector, .label = "flow of the water",
       .definition = "Darcy's flow of the water relative to the skeleton, a volume per area and time"},
      {.name = "temperature", .unit = "degC", .label = "temperature", .definition = "temperature of water and grains, degrees Celsius"},
      {.name = "band_width", .unit = "L", .label = "width of the shear zone",
       .definition = "width into which the cells localise, around points with an embedded band; 0 elsewhere"},
      {.name = "band_temperature", .unit = "degC", .label = "temperature of the band",
       .definition = "temperature inside the embedded band; where there is no band, as temperature"},
      {.name = "band_pressure", .unit = "Pa", .label = "pore pressure in the band",
       .definition = "pressure of the water inside the embedded band; where there is no band, as pressure"},
      {.name = "heat_limit", .label = "beyond the equations of heat",
       .definition = "whether the equations of heat hold: 0 they do; 1 hotter than 100 C, 2 pressure above the total mean stress, 3 both; of the band, where there is one"},
  };
  return fields;
}

const void* values_of(const MotionFrame& frame, const MotionField& field) {
  const void* values = nullptr;
  with_array(frame, field, [&](const auto& array) {
    if (!array.empty()) values = array.data();
  });
  return values;
}

std::size_t particles_with(const MotionFrame& frame, const MotionField& field) {
  std::size_t count = 0;
  with_array(frame, field, [&](const auto& array) { count = array.size(); });
  return field.member ? count : count / field.components();
}

void* make_room(MotionFrame& frame, const MotionField& field, std::size_t particles) {
  if (!field.member) return frame.add(field.name, particles).data();
  void* room = nullptr;
  with_array(frame, field, [&](auto& array) {
    array.resize(particles);
    room = array.data();
  });
  return room;
}

const FieldValues* MotionFrame::find(std::string_view name) const {
  const auto at = std::find_if(fields.begin(), fields.end(), [&](const FieldValues& f) { return f.field->name == name; });
  return at == fields.end() ? nullptr : &*at;
}

const FieldValues& MotionFrame::field(std::string_view name) const {
  if (const FieldValues* found = find(name)) return *found;
  throw std::logic_error("motion: this frame has no field '" + std::string(name) + "'");
}

std::span<float> MotionFrame::add(std::string_view name, std::size_t particles) {
  const MotionField* row = motion_fields().find(name);
  if (!row || row->member) throw std::logic_error("motion: '" + std::string(name) + "' is not listed as a field");
  if (row->form == FieldForm::code) throw std::logic_error("motion: '" + row->name + "' is a code: only members are bytes");
  FieldValues* to = const_cast<FieldValues*>(find(name));
  if (!to) to = &fields.emplace_back(FieldValues{row, row->components(), {}});
  to->values.assign(particles * to->components, 0.0f);
  return to->values;
}

std::string unit_in(std::string_view pattern, const std::string& length, const std::string& time) {
  std::string out;
  for (const char c : pattern) {
    if (c == 'L') out += length;
    else if (c == 'T') out += time;
    else out += c;
  }
  return out;
}

}  // namespace pivnp
