// What a report can be told. Kept apart from the drawing, so that a case knows no Qt.
#pragma once

#include <string>
#include <vector>

#include "pivnp/core/options.hpp"

namespace pivnp::report {

struct ReportOptions {
  std::string title;
  std::vector<double> times_s;
  Points points_m;
  std::vector<std::string> fields_drawn = {"displacement_magnitude", "strain_dev"};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("title", self.title, OptionInfo{.text = "title of the report (left out: the case's name)"});
    visit("times_s", self.times_s, OptionInfo{.unit = "s", .text = "times at which fields are drawn (left out: three, evenly)"});
    visit("points_m", self.points_m, OptionInfo{.unit = "m", .text = "material points whose histories are drawn (left out: three)"});
    visit("fields", self.fields_drawn, OptionInfo{.text = "fields drawn side by side, by their names in docs/format.md (where none but these are asked for and there is water or heat: pressure, temperature and those of embedded bands, too)"});
  }
};

}  // namespace pivnp::report
