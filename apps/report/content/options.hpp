// What a report can be told. Kept apart from the drawing, so that a case knows no Qt.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::report {

/// What nothing but its owner knows of the camera and the specimen, as he says it: rows of the table by which a reader
/// judges the measurement (iDICs, A Good Practices Guide for Digital Image Correlation, 2018, tables of reporting).
struct HardwareOptions {
  std::string camera, lens, aperture, exposure, stand_off, lighting, pattern, feature_size, other;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("camera", self.camera, OptionInfo{.text = "maker, model and sensor"});
    visit("lens", self.lens, OptionInfo{.text = "lens and focal length"});
    visit("aperture", self.aperture, OptionInfo{.text = "aperture"});
    visit("exposure", self.exposure, OptionInfo{.text = "exposure time, with its unit"});
    visit("stand_off", self.stand_off, OptionInfo{.text = "distance from the specimen, with its unit"});
    visit("lighting", self.lighting, OptionInfo{.text = "kind and place of the lights"});
    visit("pattern", self.pattern, OptionInfo{.text = "what gives the texture: sand grains, flock, spray ..."});
    visit("feature_size", self.feature_size, OptionInfo{.text = "size of the texture's features, with its unit"});
    visit("other", self.other, OptionInfo{.text = "anything else: window, filters, synchronisation"});
  }
};

enum class LineType { section, extensometer };
inline constexpr std::array line_type_names{NamedValue{"section", LineType::section}, NamedValue{"extensometer", LineType::extensometer}};
constexpr const auto& names_of(LineType) { return line_type_names; }

/// A line that the report draws a figure along.
struct LineOptions {
  LineType type = LineType::section;
  std::optional<Pair> from_m, to_m;
  std::string field = "displacement_magnitude";

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("type", self.type, OptionInfo{.text = "section: a field along a line; extensometer: strain between two material points in time"});
    visit("from_m", self.from_m, OptionInfo{.unit = "m", .text = "first end; of an extensometer at the first frame"});
    visit("to_m", self.to_m, OptionInfo{.unit = "m", .text = "the other end"});
    visit("field", self.field, OptionInfo{.text = "section: the field, by its name in docs/format.md"});
  }
};

struct ReportOptions {
  std::string title;
  std::vector<double> times_s;
  Points points_m;
  std::vector<std::string> fields_drawn = {"displacement_magnitude", "strain_dev"};
  std::optional<double> gauge_m;
  std::vector<std::string> data_sets;
  bool animation = false;
  std::vector<std::string> compare_runs;

  // Sections of their own in a case.
  HardwareOptions hardware;                                 // [report.hardware]
  std::vector<std::pair<std::string, LineOptions>> lines;   // [report.line.NAME]

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("title", self.title, OptionInfo{.text = "default: the case's name"});
    visit("times_s", self.times_s, OptionInfo{.unit = "s", .text = "times at which fields are drawn; default: three"});
    visit("points_m", self.points_m, OptionInfo{.unit = "m", .text = "material points whose histories are drawn; default: three"});
    visit("fields", self.fields_drawn, OptionInfo{.text = "fields drawn, by their names in docs/format.md; with water or heat, pressure and temperature too"});
    visit("gauge_m", self.gauge_m, OptionInfo{.unit = "m", .text = "diameter of circles over which strains are drawn; default: the record's gauge", .min = 0, .above_min = true});
    visit("data_sets", self.data_sets, OptionInfo{.text = "one or two motions of the record; default: those compared, else np and mpm"});
    visit("compare_runs", self.compare_runs, OptionInfo{.text = "records of other runs to show as well"});
    visit("animation", self.animation, OptionInfo{.text = "writes animation.mp4: frame with vectors, strains, simulation"});
  }
};

}  // namespace pivnp::report
