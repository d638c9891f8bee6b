#include "apps/study/element/element.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "apps/plot/canvas.hpp"
#include "apps/plot/marks.hpp"
#include "apps/study/frontier/written_pages.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/imports/time_table.hpp"

namespace pivnp::app {

namespace {

using mpm::ElementPath;
using mpm::ElementTest;

constexpr std::size_t most_pressures = 6;
constexpr double kilo = 1e3, percent = 1e-2;

struct ElementLook {
  plot::Rgb rgb;
  plot::Dash dash;
  plot::Key key;
};
constexpr std::array<ElementLook, most_pressures> element_looks = {{{plot::blue, plot::Dash::solid, plot::Key::line},
                                                                    {plot::vermilion, plot::Dash::dashed, plot::Key::dashed},
                                                                    {plot::green, plot::Dash::dotted, plot::Key::dotted},
                                                                    {plot::purple, plot::Dash::dash_dot, plot::Key::dash_dot},
                                                                    {plot::sky, plot::Dash::solid, plot::Key::line},
                                                                    {plot::orange, plot::Dash::dashed, plot::Key::dashed}}};

// What one panel shows: two quantities of a path, as a laboratory's file calls them.
struct Drawn {
  std::string words, unit, quantity;
  double scale;
  const std::vector<double>& (*of)(const ElementPath&);
};

namespace quantity {

#define PIVNP_OF(member) [](const ElementPath& p) -> const std::vector<double>& { return p.member; }
const Drawn axial = {"axial strain", "%", "axial_strain", percent, PIVNP_OF(strain)};
const Drawn gamma_strain = {"shear strain", "%", "shear_strain", percent, PIVNP_OF(strain)};
const Drawn volumetric = {"volumetric strain", "%", "volumetric_strain", percent, PIVNP_OF(volume)};
const Drawn pore = {"pore pressure", "kPa", "pore_pressure", kilo, PIVNP_OF(pore_pressure)};
const Drawn deviator = {"deviator stress q", "kPa", "deviator_stress", kilo, PIVNP_OF(deviator)};
const Drawn mean_stress = {"mean effective stress p'", "kPa", "mean_stress", kilo, PIVNP_OF(mean)};
const Drawn vertical = {"vertical effective stress", "kPa", "vertical_stress", kilo, PIVNP_OF(vertical)};
const Drawn horizontal = {"horizontal effective stress", "kPa", "horizontal_stress", kilo, PIVNP_OF(horizontal)};
const Drawn shear = {"shear stress", "kPa", "shear_stress", kilo, PIVNP_OF(shear)};
#undef PIVNP_OF

}  // namespace quantity

std::vector<std::pair<Drawn, Drawn>> panels_of(const ElementStudy& study) {
  if (ends_by_stress(study.test.test)) {
    const Drawn& stress = study.test.test == ElementTest::isotropic ? quantity::mean_stress : quantity::vertical;
    if (study.test.test == ElementTest::isotropic) return {{stress, quantity::axial}, {stress, quantity::volumetric}};
    return {{stress, quantity::axial}, {stress, quantity::horizontal}};
  }
  if (is_shear(study.test.test)) {
    Drawn along = quantity::gamma_strain;
    if (study.band_m > 0) along.words = "displacement", along.unit = "mm", along.quantity = "", along.scale = 1e-3 / study.band_m;
    return {{along, quantity::shear}, {along, study.test.undrained ? quantity::pore : quantity::volumetric}, {quantity::vertical, quantity::shear}};
  }
  return {{quantity::axial, quantity::deviator}, {quantity::axial, study.test.undrained ? quantity::pore : quantity::volumetric}, {quantity::mean_stress, quantity::deviator}};
}

using Laboratory = std::map<std::string, std::vector<double>>;

std::vector<double> scaled(const std::vector<double>& values, double by) {
  std::vector<double> out = values;
  for (double& v : out) v /= by;
  return out;
}

struct Bounds {
  double lower = 0, upper = 0;  // zero belongs to every axis
  void take(const std::vector<double>& values) {
    for (const double v : values)
      if (std::isfinite(v)) lower = std::min(lower, v), upper = std::max(upper, v);
  }
  Bounds with_room() const {
    const double room = upper > lower ? 0.05 * (upper - lower) : 1;
    return {lower < 0 ? lower - room : 0, upper > 0 ? upper + room : 0};
  }
};

report::Figure chart_of(const ElementStudy& study, const std::vector<ElementPath>& paths, const std::vector<std::string>& names, const Laboratory& laboratory) {
  const std::vector<std::pair<Drawn, Drawn>> panels = panels_of(study);
  const double wide = report::figure_width_mm / double(panels.size()), left = 15, top = 9, high = 50;
  auto canvas = std::make_shared<plot::Canvas>(report::figure_width_mm, top + high + 14);
  double next = left;
  for (std::size_t k = 0; k < names.size(); ++k) next = plot::legend(*canvas, next, 3, element_looks[k].key, element_looks[k].rgb, names[k]);
  if (!laboratory.empty()) plot::legend(*canvas, next, 3, plot::Key::circle, plot::ink, "laboratory");
  for (std::size_t n = 0; n < panels.size(); ++n) {
    const auto& [across, up] = panels[n];
    std::vector<std::pair<std::vector<double>, std::vector<double>>> drawn;
    Bounds x, y;
    for (const ElementPath& path : paths) drawn.emplace_back(scaled(across.of(path), across.scale), scaled(up.of(path), up.scale));
    const auto lab_x = laboratory.find(across.quantity), lab_y = laboratory.find(up.quantity);
    if (lab_x != laboratory.end() && lab_y != laboratory.end()) drawn.emplace_back(scaled(lab_x->second, across.scale), scaled(lab_y->second, up.scale));
    for (const auto& [a, b] : drawn) x.take(a), y.take(b);
    plot::Panel panel = canvas->panel(wide * double(n) + left, top, wide - left - 3, high);
    panel.pale_grid();
    panel.axis(plot::Axis::x, x.with_room().lower, x.with_room().upper, plot::axis_label(across.words, across.unit), 4);
    panel.axis(plot::Axis::y, y.with_room().lower, y.with_room().upper, plot::axis_label(up.words, up.unit), 5);
    canvas->paint(panel, [panel, drawn, count = paths.size()](plot::Painter& p) {
      for (std::size_t k = 0; k < drawn.size(); ++k) {
        std::vector<Vec2> line;
        for (std::size_t m = 0; m < drawn[k].first.size(); ++m) line.push_back(panel.at({drawn[k].first[m], drawn[k].second[m]}));
        if (k < count) {
          p.pen({element_looks[k].rgb, 1.2, element_looks[k].dash});
          p.polyline(line);
        } else {
          for (const Vec2& at : line) p.symbol({plot::Marker::circle, {plot::ink, 0.6}, {}, 1.2}, at);
        }
      }
    });
  }
  report::Figure figure;
  figure.name = "element";
  figure.canvas = canvas;
  figure.caption = "One point of the material, strained as in the test. Compression is positive; stresses are effective.";
  figure.shows = "Stress, volume or pore pressure against strain, and the stress path, one curve a pressure.";
  for (std::size_t k = 0; k < paths.size(); ++k)
    for (const auto& [across, up] : {panels.front()}) {
      figure.data.push_back({names[k] + ": " + across.words, across.unit, scaled(across.of(paths[k]), across.scale)});
      figure.data.push_back({names[k] + ": " + up.words, up.unit, scaled(up.of(paths[k]), up.scale)});
    }
  return figure;
}

const std::pair<std::string, mpm::MaterialOptions>& material_of(const Case& c, const std::string& name) {
  std::vector<std::string> names;
  std::string listed;
  for (const auto& [known, material] : c.materials) names.push_back(known), listed += (listed.empty() ? "" : ", ") + known;
  if (names.empty()) throw InputError(of_file(c) + ": there is no material; expected [material.NAME]");
  if (name.empty() && names.size() > 1) throw InputError("--material: missing, expected one of " + listed);
  for (const auto& row : c.materials)
    if (name.empty() || row.first == name) return row;
  throw InputError("--material: found '" + name + "', expected one of " + listed + did_you_mean(name, names));
}

std::string in_percent(double strain) { return number(100 * strain, 3) + " %"; }
std::string in_kpa(double pa) { return number(pa / kilo, 4) + " kPa"; }

std::string sentence_of(const ElementStudy& study, const std::string& name, const ElementPath& path) {
  if (path.size() < 2) return name + ": " + path.ended + ".";
  const ElementTest test = study.test.test;
  const std::size_t k = mpm::peak_of(path, test), last = path.size() - 1;
  std::string text = name + ": ";
  if (ends_by_stress(test)) {
    const std::size_t top = std::size_t(std::max_element(path.strain.begin(), path.strain.end()) - path.strain.begin());
    text += "axial strain " + in_percent(path.strain[top]) + " at " + in_kpa(path.vertical[top]) + ", " + in_percent(path.strain[last]) + " after unloading to " + in_kpa(path.vertical[last]);
    if (test == ElementTest::oedometer && path.vertical[top] > 0) text += "; horizontal over vertical stress " + number(path.horizontal[top] / path.vertical[top], 3);
  } else {
    const bool sheared = is_shear(test);
    const std::vector<double>& of = sheared ? path.shear : path.deviator;
    text += std::string("greatest ") + (sheared ? "shear stress " : "deviator stress ") + in_kpa(of[k]) + " at a strain of " + in_percent(path.strain[k]);
    if (k == last) text += ", where it still rises";
    if (of[last] < 0.995 * of[k]) text += ", at the end " + in_kpa(of[last]);
    text += study.test.undrained ? "; pore pressure " + in_kpa(path.pore_pressure[last]) + " at the end" : "; volumetric strain " + in_percent(path.volume[last]) + " at the end";
  }
  if (!path.ended.empty()) text += "; " + path.ended;
  return text + ".";
}

std::vector<io::TableColumn> columns_of(const ElementPath& path, ElementTest test) {
  std::vector<io::TableColumn> columns = {{.name = is_shear(test) ? "shear_strain" : "axial_strain", .unit = "1", .numbers = path.strain},
                                          {.name = "volumetric_strain", .unit = "1", .numbers = path.volume},
                                          {.name = "vertical_stress", .unit = "pa", .numbers = path.vertical},
                                          {.name = "horizontal_stress", .unit = "pa", .numbers = path.horizontal},
                                          {.name = "out_of_plane_stress", .unit = "pa", .numbers = path.out_of_plane},
                                          {.name = "shear_stress", .unit = "pa", .numbers = path.shear},
                                          {.name = "mean_stress", .unit = "pa", .numbers = path.mean},
                                          {.name = "deviator_stress", .unit = "pa", .numbers = path.deviator},
                                          {.name = "pore_pressure", .unit = "pa", .numbers = path.pore_pressure}};
  for (const auto& [name, values] : path.history) columns.push_back({.name = name, .unit = "1", .numbers = values});
  return columns;
}

std::string csv_of_tests(const std::vector<double>& pressures, const std::vector<ElementPath>& paths, ElementTest test) {
  std::string out;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const std::vector<io::TableColumn> columns = columns_of(paths[k], test);
    if (out.empty()) {
      out = "pressure_pa";
      for (const io::TableColumn& column : columns) out += "," + column.name + (column.unit == "1" && column.name.find("strain") == std::string::npos ? "" : "_" + column.unit);
      out += "\n";
    }
    for (std::size_t n = 0; n < paths[k].size(); ++n) {
      out += number(pressures[k], 9);
      for (const io::TableColumn& column : columns) out += ',', out += number(column.numbers[n], 9);
      out += "\n";
    }
  }
  return out;
}

}  // namespace

ElementOutcome element(const Case& c, const ElementStudy& given, const RunSettings& settings) {
  ElementStudy study = given;
  if (study.pressures_pa.empty()) study.pressures_pa = {50e3, 100e3, 200e3};
  if (study.pressures_pa.size() > most_pressures)
    throw InputError("--pressure: found " + std::to_string(study.pressures_pa.size()) + " pressures, expected at most " + std::to_string(most_pressures));
  if (study.band_m < 0 || (study.band_m > 0 && study.test.test != ElementTest::direct_shear)) throw InputError("--band: expected a thickness above 0 with --test direct_shear");
  const auto& [name, material] = material_of(c, study.material);
  const Laboratory laboratory = study.laboratory.empty() ? Laboratory{} : io::read_test_table(study.laboratory);
  const double cell = c.grid.spacing_m.value_or(0.0);
  ElementOutcome outcome;
  std::vector<std::string> names;
  for (const double pressure : study.pressures_pa) {
    study.test.pressure_pa = pressure;
    outcome.paths.push_back(mpm::element_test(material, "material." + name, study.test, cell));
    names.push_back(in_kpa(pressure));
    outcome.sentences.push_back(sentence_of(study, names.back(), outcome.paths.back()));
  }
  if (const auto line = mpm::strength_line(outcome.paths, study.test.test))
    outcome.sentences.push_back((is_shear(study.test.test) ? "Strength on the horizontal plane" : "Strength") +
                                (outcome.paths.size() > 1
                                     ? " by the peaks: friction angle " + number(line->friction_deg, 3) + " degrees, cohesion " + in_kpa(line->cohesion_pa) + "."
                                     : " by the peak: friction angle " + number(line->friction_deg, 3) + " degrees if there is no cohesion."));
  const auto rises = [&](const ElementPath& path) { return path.size() > 0 && mpm::peak_of(path, study.test.test) + 1 == path.size(); };
  if (!ends_by_stress(study.test.test) && std::any_of(outcome.paths.begin(), outcome.paths.end(), rises))
    outcome.sentences.push_back("Not every test reached its peak: more strain (--strain) may give more strength.");
  plot::start_qt();
  report::Document document;
  const std::string test(name_of(study.test.test));
  document.title = "Element tests: " + name;
  document.subtitle = std::string(study.test.undrained ? "Undrained " : "Drained ") + test + " tests of [material." + name + "], model " + material.model + ".";
  std::replace(document.subtitle.begin(), document.subtitle.end(), '_', ' ');
  report::List said;
  said.items = outcome.sentences;
  document.blocks.push_back(said);
  document.blocks.push_back(chart_of(study, outcome.paths, names, laboratory));
  if (material.softening_length_m && cell > 0)
    document.blocks.push_back(report::Paragraph{"Softening is that of cells of " + number(cell, 3) + " m, as in the case's simulation."});
  std::vector<io::NamedTable> tables;
  for (std::size_t k = 0; k < outcome.paths.size(); ++k)
    tables.push_back({"test_" + std::to_string(k + 1), {{"test", test}, {"pressure_pa", number(study.pressures_pa[k], 9)}, {"ended", outcome.paths[k].ended}}, columns_of(outcome.paths[k], study.test.test)});
  outcome.files = write_pages(document, "element", {{"element.csv", csv_of_tests(study.pressures_pa, outcome.paths, study.test.test)}}, tables, settings.out);
  return outcome;
}

}  // namespace pivnp::app
