#include "pivnp/io/records/schema.hpp"

#include <algorithm>
#include <cctype>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/io/files/quoting.hpp"

namespace pivnp::io {

std::string Units::of(std::string_view pattern) const { return unit_in(pattern, length, time); }

std::vector<ItemArray> pair_arrays(const Grid& grid, const Units& units, const VectorField* f) {
  using h5::Type;
  const auto nx = static_cast<hsize_t>(grid.nx), ny = static_cast<hsize_t>(grid.ny);
  static_assert(sizeof(int) == 4 && sizeof(Anchor) == 1 && sizeof(VectorStatus) == 1);
  return {
      {"pair", Type::i32, {2}, "", f ? f->pair.data() : nullptr},
      {"anchor", Type::u8, {}, "", f ? &f->anchor : nullptr},
      {"displacement", Type::f32, {ny, nx, 2}, units.length, f ? f->displacement.data() : nullptr},
      {"status", Type::u8, {ny, nx}, "", f ? f->status.data() : nullptr},
      {"cov", Type::f32, {ny, nx, 3}, units.length2(), f ? f->cov.data() : nullptr},
      {"score", Type::f32, {ny, nx}, "1", f ? f->score.data() : nullptr},
      {"correlation_length", Type::f32, {}, units.length, f ? &f->correlation_length : nullptr},
      {"path_factor", Type::f32, {ny, nx}, "1", f && !f->path_factor.empty() ? f->path_factor.data() : nullptr, true},
  };
}

std::vector<ItemArray> frame_arrays(std::size_t particles, const Units& units, const MotionFrame* f) {
  static_assert(sizeof(ParticleStatus) == 1 && sizeof(EndReason) == 1);
  std::vector<ItemArray> arrays = {{"time", h5::Type::f64, {}, units.time, f ? &f->time : nullptr}};
  for (const MotionField& field : motion_fields()) {
    h5::Shape item{particles};
    if (field.form == FieldForm::tensor) item.insert(item.end(), {2, 2});
    else if (field.components() > 1) item.push_back(field.components());
    arrays.push_back({field.name, field.form == FieldForm::code ? h5::Type::u8 : h5::Type::f32, item,
                      units.of(field.unit), f ? values_of(*f, field) : nullptr});
  }
  return arrays;
}

const std::vector<EnergyColumn>& energy_table() {
  static const std::vector<EnergyColumn> table = {
      {"time", &EnergyRow::time},       {"kinetic", &EnergyRow::kinetic}, {"elastic", &EnergyRow::elastic},
      {"plastic", &EnergyRow::plastic}, {"damping", &EnergyRow::damping}, {"contact", &EnergyRow::contact},
      {"external", &EnergyRow::external}, {"residual", &EnergyRow::residual},
      {"hourglass", &EnergyRow::hourglass, 1},
      {"water", &EnergyRow::water, 4, true},
      {"darcy", &EnergyRow::darcy, 4, true},
      {"water_mass", &EnergyRow::water_mass, 4, true, "kg/m"},
      {"water_inflow", &EnergyRow::water_inflow, 4, true, "kg/m"},
      {"heat", &EnergyRow::heat, 6, true},
      {"heat_made", &EnergyRow::heat_made, 6, true},
      {"heat_inflow", &EnergyRow::heat_inflow, 6, true}};
  return table;
}

void check_name(const std::string& name, const std::string& what) {
  const bool good = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-';
  });
  if (!good) throw InputError(what + ": name '" + shown(name) + "', expected letters, digits, '_' and '-'");
}

}  // namespace pivnp::io
