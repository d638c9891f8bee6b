#include "apps/case/lengths.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <type_traits>

#include "apps/case/sections.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

struct LengthUnit {
  const char* name;
  double times, by;  // whole numbers, one of them 1
};
constexpr std::array length_units{LengthUnit{"m", 1, 1}, LengthUnit{"mm", 1, 1e3}, LengthUnit{"cm", 1, 1e2},
                                  LengthUnit{"km", 1e3, 1}, LengthUnit{"um", 1, 1e6}};

const LengthUnit* unit_named(const std::string& name) {
  const auto at = std::find_if(length_units.begin(), length_units.end(), [&](const LengthUnit& u) { return name == u.name; });
  return at == length_units.end() ? nullptr : &*at;
}

// Of the options of a section those that are lengths.
struct Converted {
  const LengthUnit& unit;
  const Source& source;

  void scale(double& value) const { value = value * unit.times / unit.by; }
  void scale(Pair& value) const {
    for (double& v : value) scale(v);
  }
  void scale(std::vector<double>& values) const {
    for (double& v : values) scale(v);
  }
  void scale(Points& values) const {
    for (Pair& v : values) scale(v);
  }
  template <class T>
    requires(std::is_same_v<T, double> || std::is_same_v<T, Pair>)
  void scale(std::optional<T>& value) const {
    if (value) scale(*value);
  }
  template <class T>
  void section(const std::string& path, T& options) const {
    T::fields(options, [&](std::string_view name, auto& value, const OptionInfo& info) {
      if (!source.given(joined_key(path, name)) && (info.alias.empty() || !source.given(joined_key(path, info.alias)))) return;
      if constexpr (requires { scale(value); })
        if (info.unit == "m" || info.unit == "m/px") scale(value);
      if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Points>)
        if (info.unit == "s, m")
          for (Pair& v : value) scale(v[1]);
    });
  }

  template <class T>
  void always(const std::string& path, T& options, const char*) const { section(path, options); }
  template <class T>
  void optional(const std::string& path, std::optional<T>& options, const char*) const {
    if (options) section(path, *options);
  }
  template <class T>
  void named(const std::string& path, Named<T>& list, const char*) const {
    for (auto& [name, options] : list) section(joined_key(path, name), options);
  }
};

}  // namespace

std::vector<std::string> length_unit_names() {
  std::vector<std::string> names;
  for (const LengthUnit& u : length_units) names.emplace_back(u.name);
  return names;
}

bool is_length_unit(const std::string& unit) { return unit_named(unit) != nullptr; }

double in_metres(double value, const std::string& unit) {
  const LengthUnit* found = unit_named(unit);
  return found ? value * found->times / found->by : value;
}

void take_lengths_in_metres(Case& c, const Source& source) {
  const std::string name = c.camera.length_unit;
  const bool scaled = c.camera.metres_per_pixel || !c.camera.points_px.empty(), pictured = c.frames || c.synth;
  if (pictured && !scaled) return;  // px
  const LengthUnit* unit = unit_named(name);
  // Another name is a length of the scene ("D"), in which its author states all else as well; a foot is not.
  static constexpr std::string_view foreign[] = {"ft", "foot", "feet", "in", "inch", "yd", "nm", "mil"};
  if ((c.mpm || c.synth_mpm) && std::ranges::find(foreign, name) != std::ranges::end(foreign))
    throw InputError(source.at("camera.length_unit") + ": found \"" + name +
                     "\", expected m, mm, cm, km or um, or a length of the scene: a simulation runs in metres");
  if (!unit || name == "m") return;
  for_each_section(c, Converted{*unit, source});
  if (c.vectors && c.vectors->length_unit.empty()) c.vectors->length_unit = name;
  c.camera.length_unit = "m";
}

}  // namespace pivnp::app
