#include "apps/study/pipeline/record/simulation_setup.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <string_view>

#include "apps/case/values.hpp"
#include "apps/plot/numbers.hpp"
#include "mpm/material/model.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

// The end of a key that names its unit: kg/m^3 is _kg_m3.
std::string key_end(std::string_view unit) {
  if (unit == "degC") return "_c";
  if (unit == "1/s") return "_per_s";
  if (unit == "1/min") return "_rpm";
  std::string end = "_";
  for (const char ch : unit)
    if (ch == '/' || ch == ' ') end += '_';
    else if (std::isalnum(static_cast<unsigned char>(ch))) end += char(std::tolower(static_cast<unsigned char>(ch)));
  return end;
}

// A key as a paper says it.
std::string name_in_words(std::string_view name, std::string_view unit) {
  std::string words(name);
  if (const std::string end = key_end(unit); !unit.empty() && words.ends_with(end)) words.resize(words.size() - end.size());
  std::replace(words.begin(), words.end(), '_', ' ');
  if (words == "young") return "Young\u2019s modulus";
  if (words == "poisson") return "Poisson\u2019s ratio";
  return words;
}

std::string in_words(double value, std::string_view unit) {
  const plot::DisplayUnit shown = unit == "Pa" ? plot::display_unit("Pa", std::abs(value)) : plot::DisplayUnit{1, std::string(unit)};
  return number(value * shown.factor, 6) + (shown.name.empty() || shown.name == "1" ? std::string() : " " + shown.name);
}
std::string in_words(int value, std::string_view unit) { return in_words(double(value), unit); }
std::string in_words(const std::string& value, std::string_view) { return value; }
std::string in_words(bool value, std::string_view) { return value ? "yes" : "no"; }
std::string bracketed(const Pair& x) { return "(" + number(x[0], 6) + ", " + number(x[1], 6) + ")"; }
std::string with_unit(std::string_view unit) { return unit.empty() ? std::string() : " " + std::string(unit); }
std::string in_words(const Pair& value, std::string_view unit) { return bracketed(value) + with_unit(unit); }
std::string in_words(const Points& value, std::string_view unit) {
  if (value.size() > 4) return std::to_string(value.size()) + " corners from " + bracketed(value.front()) + with_unit(unit);
  std::string text;
  for (const Pair& x : value) text += (text.empty() ? "" : value.size() == 2 ? " to " : ", ") + bracketed(x);
  return text + with_unit(unit);
}
std::string in_words(const std::vector<double>& value, std::string_view unit) {
  std::string text;
  for (const double x : value) text += (text.empty() ? "" : ", ") + number(x, 6);
  return text + with_unit(unit);
}
std::string in_words(const std::vector<std::string>& value, std::string_view) {
  std::string text;
  for (const std::string& x : value) text += (text.empty() ? "" : ", ") + x;
  return text;
}
template <Choice E>
std::string in_words(const E& value, std::string_view) {
  return std::string(name_of(value));
}
template <class T>
std::string in_words(const std::optional<T>& value, std::string_view unit) {
  return value ? in_words(*value, unit) : std::string();
}

// The keys that `wanted` and are not as they are by default.
template <class T, class Wanted>
std::string chosen(const T& options, const Wanted& wanted) {
  std::vector<std::string> usual;
  const T untouched{};
  T::fields(untouched, [&](std::string_view, const auto& value, const OptionInfo&) { usual.push_back(toml_text(value)); });
  std::string text;
  std::size_t k = 0;
  T::fields(options, [&](std::string_view name, const auto& value, const OptionInfo& info) {
    const std::string held = toml_text(value);
    if (held != usual[k++] && wanted(name))
      text += (text.empty() ? "" : "; ") + name_in_words(name, info.unit) + " " + in_words(value, info.unit);
  });
  return text;
}
template <class T>
std::string chosen(const T& options) {
  return chosen(options, [](std::string_view) { return true; });
}

std::string words_of(const mpm::MaterialOptions& material) {
  std::string text = material.model;
  std::replace(text.begin(), text.end(), '_', ' ');
  const std::string values = chosen(material, [&](std::string_view key) {
    if (key == "model") return false;
    const std::vector<std::string> laws = mpm::models_with_key(key);
    return laws.empty() || std::find(laws.begin(), laws.end(), material.model) != laws.end();
  });
  return text + (values.empty() ? "" : "; " + values);
}

std::string words_of(mpm::SchemeName name, const mpm::Scheme& s) {
  return std::string(name_of(name)) + ": shape functions " + std::string(name_of(s.shape)) + ", transfer " + std::string(name_of(s.transfer)) +
         ", stress update " + std::string(name_of(s.stress)) + ", locking " + std::string(name_of(s.locking));
}

}  // namespace

Rows simulation_setup(const Case& c, double spacing, std::size_t points) {
  if (!c.mpm) return {};
  const mpm::MpmOptions& o = *c.mpm;
  Rows rows;
  for (const auto& [name, material] : c.materials) rows.emplace_back("Material " + name, words_of(material));
  rows.emplace_back("Cells and material points", number(spacing / o.refine, 6) + " m, " + std::to_string(o.per_element) + " points a cell at the start, " +
                                                     plot::count(points, "point") + " in all");
  rows.emplace_back("Method", words_of(o.scheme, mpm::scheme_of(o)));
  if (o.geometry != mpm::Geometry::plane) rows.emplace_back("Geometry", std::string(name_of(o.geometry)));
  rows.emplace_back("Time step", o.courant ? "Courant number " + number(*o.courant, 3) : std::string("Courant number 0.4, greater where the arrangement of the points allows"));
  rows.emplace_back("Gravity", in_words(o.gravity_m_s2, "m/s^2"));
  if (c.centrifuge) rows.emplace_back("Centrifuge", chosen(*c.centrifuge));
  rows.emplace_back("Initial stress", o.initial_equilibrium ? "found in equilibrium" + (o.k0 ? " from K0 = " + number(*o.k0, 4) : std::string())
                                                            : o.k0 ? "K0 = " + number(*o.k0, 4) : std::string("elastic K0"));
  static const std::set<std::string_view> told = {"scheme", "geometry", "per_element", "gravity_m_s2", "initial_equilibrium", "k0", "shape", "transfer",
                                                  "stress_update", "locking", "courant", "refine", "output_rate_hz"};
  if (const std::string more = chosen(o, [](std::string_view key) { return !told.contains(key); }); !more.empty()) rows.emplace_back("Further", more);
  for (const auto& [name, initial] : c.initial) rows.emplace_back("Initial state of " + name, chosen(initial));
  for (const auto& [name, boundary] : c.boundaries)
    rows.emplace_back("Boundary " + name, std::string(name_of(boundary.type)) +
                                              (chosen(boundary, [](std::string_view key) { return key != "type"; }).empty()
                                                   ? std::string()
                                                   : "; " + chosen(boundary, [](std::string_view key) { return key != "type"; })));
  for (const auto& [name, body] : c.bodies) rows.emplace_back("Rigid body " + name, chosen(body));
  for (const auto& [name, contact] : c.contacts) rows.emplace_back("Contact " + name, chosen(contact));
  if (c.water) rows.emplace_back("Water", chosen(*c.water));
  if (c.heat) rows.emplace_back("Heat", chosen(*c.heat));
  std::erase_if(rows, [](const auto& row) { return row.second.empty(); });
  return rows;
}

}  // namespace pivnp::app
