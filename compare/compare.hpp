// How far two motions are apart. Sees motions only, and cannot tell measured from simulated.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "compare/options.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/core/record/metric.hpp"
#include "pivnp/core/record/strain_note.hpp"

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

/// The simulation on coarser grids than the second side, for the numerical part of its uncertainty.
struct Refinement {
  std::vector<const MotionSource*> coarser;  // one or two: ratio, ratio^2 times the second's cell size
  double ratio = 2;
};

/// What the records state with their strains, first and second side; nothing where they state nothing. A noise floor
/// stated there is the side's; otherwise it is sought where the side stands still.
using StrainNotes = std::array<std::optional<StrainNote>, 2>;

/// second minus first, at the first's particles and times. Displacement and strain count from the common start, the
/// later of the two first times. Material positions are aligned there; the second motion is interpolated between its
/// particles (natural neighbours among material positions, no triangle that bridges a gap; within half a spacing of the
/// material's edge from the nearest point of the edge) unless ids and positions agree, and linearly in time. A
/// particle that ends on either side has no partner from then on. Options and limits named _m and _s are in the
/// motions' own units. Frames are read one by one, in order (twice where an onset is looked for); memory grows with the
/// particles, not with the frames: of each field at most 2^23 values are kept. Throws InputError if a motion is empty,
/// the units differ, no time is common, no particle finds a partner, or a limit cannot be judged for want of an option;
/// Interrupted if asked to stop. Every metric carries its definition; docs/theory/compare.md has the equations.
Comparison compare(const MotionSource& first, const MotionSource& second, const CompareOptions& options,
                   const LimitOptions& limits, Progress& progress, const Refinement& refinement = {},
                   const StrainNotes& notes = {});

}  // namespace pivnp::compare
