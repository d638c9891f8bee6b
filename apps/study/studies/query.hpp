// Values of a finished record at places that are asked for.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/options.hpp"

namespace pivnp::app {

/// One of the four kinds of place. Lengths in the motion's unit.
struct QueryOptions {
  Points points_m, line_m, rectangle_m, extensometer_m;
  std::vector<std::string> fields_shown = {"displacement_x", "displacement_y", "displacement_magnitude", "strain_vol", "strain_dev"};
  std::vector<double> times_s;
  std::optional<double> gauge_m;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("points_m", self.points_m, OptionInfo{.unit = "m", .text = "material points at the first frame, as in [[0.1, 0.02], [0.2, 0.02]]"});
    visit("line_m", self.line_m, OptionInfo{.unit = "m", .text = "two ends of a line in space: values of the nearest particles along it"});
    visit("rectangle_m", self.rectangle_m, OptionInfo{.unit = "m", .text = "two opposite corners: means over the particles that start inside"});
    visit("extensometer_m", self.extensometer_m, OptionInfo{.unit = "m", .text = "two material points at the first frame: strain of the line between them"});
    visit("fields", self.fields_shown, OptionInfo{.text = "fields, by their names in docs/format.md; default: displacement and strain"});
    visit("times_s", self.times_s, OptionInfo{.unit = "s", .text = "the nearest recorded times are taken; default: all, of a line the last"});
    visit("gauge_m", self.gauge_m, OptionInfo{.unit = "m", .text = "diameter of circles over which strains are taken; default: the record's gauge", .min = 0, .above_min = true});
  }
};

/// CSV, a row a place and time, each field followed by its standard uncertainty where there is one; what is not known is an
/// empty cell. `source`: as open_motion() has it. Throws InputError, also where no particle is at a place.
std::string query_motion(const std::string& source, const QueryOptions& options);

}  // namespace pivnp::app
