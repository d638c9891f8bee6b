// What a comparison of two data sets came to: the values that the comparison fills, a record holds and a report shows.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/record/metric.hpp"

namespace pivnp {

/// The two data sets of a comparison error E = S - D (ASME V&V 20): the first is D, as a rule the experiment, the second
/// S, as a rule the simulation. The names stand in those of metrics, tables and columns (coverage_first, bands_second).
enum class DataSetRole { first, second };
inline constexpr std::array data_set_role_names{NamedValue{"first", DataSetRole::first},
                                                NamedValue{"second", DataSetRole::second}};
constexpr const auto& names_of(DataSetRole) { return data_set_role_names; }
inline constexpr std::array data_set_roles{DataSetRole::first, DataSetRole::second};

/// One value for each data set, in the order of their roles.
template <class T>
using PerDataSet = std::array<T, 2>;

/// A field on the particles of the first motion that found a partner at the common start.
struct ComparisonField {
  std::string name, unit, definition;
  std::vector<double> time;
  std::vector<std::int64_t> id;  // of the first motion's particles
  std::vector<float> values;     // [time][id], NaN where there is no partner (any more)
};

/// Columns of one length: statistics and histories against time, coefficients, distributions, shear bands.
struct ComparisonTable {
  struct Column {
    std::string name, unit;
    std::vector<double> values;  // NaN where not known
    std::string definition = "";  // where the table's own does not say it
  };
  std::string name, definition;
  std::vector<Column> columns;
};

/// The table of statistics over the particles at each time compared; its first column is `time`.
inline constexpr std::string_view over_space_table = "over_space";
/// The two curves of a comparison of histories, with the columns `time` and `value`.
std::string history_table(DataSetRole role);

struct Comparison {
  PerDataSet<std::string> names;  // of the motions, or what the curves were read from
  std::vector<Metric> metrics;
  std::vector<ComparisonField> fields;
  std::vector<ComparisonTable> tables;

  // What a record does not hold.
  std::vector<LimitResult> limits;  // one a limit given
  // Outlines at the last time, for drawing: each ring ends on its first point; material to the left of its sense.
  PerDataSet<std::vector<std::vector<Vec2>>> outlines;
  std::vector<std::string> remarks;  // how the data sets were aligned, what was left out and why; one sentence each
  std::vector<std::string> doubts;   // likely mistakes of units, origin and axes, likewise

  /// nullptr: there is none of that name.
  const ComparisonTable* table(std::string_view name) const;
  const ComparisonField* field(std::string_view name) const;
  /// The times compared: those of over_space, of the first of two histories, or else of the fields.
  const std::vector<double>& times() const;
};

/// nullptr: the table has no such column.
const ComparisonTable::Column* find(const ComparisonTable& table, std::string_view column);

}  // namespace pivnp
