// Names, shapes and units of what a record holds (docs/format.md). Private to this folder's sources.
#pragma once

#include <string>
#include <vector>

#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/record/energy.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/io/hdf5/hdf5.hpp"

namespace pivnp::io {

inline constexpr const char* schema_name = "pivnp";
inline constexpr int schema_major = 1;
inline constexpr const char* schema_version = "1.9";

struct Units {
  std::string length = "m", time = "s";
  bool per_radian = false;
  std::string length2() const { return length + "^2"; }
  std::string velocity() const { return length + "/" + time; }
  /// Energy per unit of thickness, or of a radian.
  std::string energy() const { return per_radian ? of_radian("J", "L^3") : length == "m" ? "J/m" : "Pa " + length2(); }
  /// Force and moment likewise.
  std::string force() const { return per_radian ? of_radian("N", "L^2") : length == "m" ? "N/m" : "Pa " + length; }
  std::string moment() const { return per_radian ? of_radian("N m", "L^3") : length == "m" ? "N" : "Pa " + length2(); }
  /// "kg/m" and the like, per metre of thickness, or of a radian.
  std::string of_thickness(const std::string& per_metre) const {
    return per_radian ? per_metre.substr(0, per_metre.rfind('/')) + "/rad" : per_metre;
  }
  /// "L/T^2" and the like with the record's own units.
  std::string of(std::string_view pattern) const;

 private:
  std::string of_radian(const char* metric, const char* pattern) const { return (length == "m" ? metric : "Pa " + of(pattern)) + "/rad"; }
};

/// One array of a series of pairs or frames; `data` holds one item. nullptr: this item lacks it.
struct ItemArray {
  std::string name;
  h5::Type type;
  h5::Shape item;  // shape of one item
  std::string unit;
  const void* data = nullptr;
  bool optional = false;  // of pairs: absent in older records, and where no pair has it

  std::size_t bytes() const { return h5::size_of(type) * h5::product(item); }
};

/// The arrays of /piv in their order, with the data of `field` (which must outlive them), or without if nullptr.
std::vector<ItemArray> pair_arrays(const Grid& grid, const Units& units, const VectorField* field);

/// The arrays of /motion/NAME that have a time axis: time, and motion_fields() in their order.
std::vector<ItemArray> frame_arrays(std::size_t particles, const Units& units, const MotionFrame* frame);

/// Columns of the table of energies, time first.
struct EnergyColumn {
  const char* name;
  double EnergyRow::*member;
  int since_minor = 0;  // version 1.x that brought it; older records lack it
  bool optional = false;     // left out where it is zero throughout
  const char* unit = "";     // empty: an energy per thickness (the first: time)
};
const std::vector<EnergyColumn>& energy_table();

/// Throws InputError unless `name` is made of letters, digits, '_' and '-'; it becomes part of paths.
void check_name(const std::string& name, const std::string& what);

}  // namespace pivnp::io
