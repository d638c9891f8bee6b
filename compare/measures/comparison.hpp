// What a comparison comes to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/core/record/metric.hpp"

namespace pivnp::compare {

/// A field on the particles of the first motion that found a partner at the common start.
struct DifferenceField {
  std::string name, unit, definition;
  std::vector<float> values;  // [field_time][particle], NaN where there is no partner (any more)
};

/// One number a time, over the particles compared then.
struct Series {
  std::string name, unit, definition;
  std::vector<double> values;  // [time], NaN where not known
};

/// Columns of one length: histories of points, coefficients, distributions, shear bands.
struct ColumnTable {
  std::string name, definition;
  struct Column {
    std::string name, unit;
    std::vector<double> values;
  };
  std::vector<Column> columns;
};

/// What a limit demanded and what was reached.
struct LimitResult {
  std::string key;  // of [compare.limits]
  double limit = 0, reached = 0;
  bool within = false;
};

struct Comparison {
  std::vector<double> time;        // the first's times at which both sides are known
  std::vector<double> field_time;  // those for which fields are kept: all, or evenly fewer where they would be too many
  std::vector<std::int64_t> id;    // the first's ids, in the order of the fields
  double coverage_first = 0, coverage_second = 0;  // share of each side that found a partner, at the common start
  std::vector<Metric> metrics;
  // difference_x, difference_y, difference_magnitude, difference_strain_dev
  std::vector<DifferenceField> fields;
  // Over the times of each particle: one row of values. over_time_displacement_bias_x, _bias_y, _rms, _p95, _max,
  // over_time_velocity_rms, _p95, _max, over_time_strain_dev_bias, _rms, _p95, _max
  std::vector<DifferenceField> over_time;
  // For displacement, velocity, strain_dev, strain_dev_path, strain_vol: _bias (_x, _y), _rms, _p95, _max; beside them
  // displacement_uncertainty, displacement_mean_first, displacement_mean_second, strain_dev_uncertainty,
  // particles_compared
  std::vector<Series> series;
  std::vector<ColumnTable> tables;
  std::vector<LimitResult> limits;  // one a limit given
  bool over_limit = false;
  // Outlines at the last time, for drawing: each ring ends on its first point; material to the left of its sense.
  std::vector<std::vector<Vec2>> outline_first, outline_second;
  std::vector<std::string> remarks;  // how the sides were aligned, what was left out and why; one sentence each

  /// Times of the fields' rows.
  const std::vector<double>& field_times() const { return field_time.empty() ? time : field_time; }
};

}  // namespace pivnp::compare
