// Fields through time, for a reader with a browser: a slider over time, and values under the pointer.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/plot/raster.hpp"
#include "apps/plot/scale.hpp"
#include "apps/report/content/content.hpp"
#include "apps/report/content/options.hpp"
#include "apps/report/words/data_sets.hpp"

namespace pivnp::report {

/// Particles at fifteen times and five thousand places at most, in the content's units: numbers of the record, in single
/// precision, as it holds them. NaN: not there, or not known.
struct Player {
  struct Field {
    std::string label, unit;
    plot::Scale scale;
  };
  struct Side {
    std::string name;
    double size = 0;                         // edge of a particle's square
    std::size_t count = 0;                   // of its particles
    std::vector<std::vector<float>> values;  // one a time: x of all, y of all, then each field of all
  };
  std::vector<double> times;
  std::vector<Field> fields;
  std::vector<Side> sides;
  plot::Box box;
  std::string length_unit, time_unit;
};

/// Of the first two fields that the report draws; nothing where there are not two times.
std::optional<Player> player_of(const ReportOptions& options, const Content& content, const DataSetNames& names, bool central);

/// Its elements and their script.
std::string html_of(const Player& player);

}  // namespace pivnp::report
