// How far two motions are apart. Sees motions only, and cannot tell measured from simulated.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/options.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/core/record/metric.hpp"

namespace pivnp::compare {

struct CompareOptions {
  Points reference_m;
  std::optional<double> slope_base_m;
  std::vector<double> increments_outside_m;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("reference_m", self.reference_m,
          OptionInfo{.unit = "m",
                     .text = "polygon of material whose mean motion is subtracted from both sides (the far soil)"});
    visit("slope_base_m", self.slope_base_m,
          OptionInfo{.unit = "m",
                     .text = "height of the base a slope rests on: run-out, crest and slope angle are taken above it"});
    visit("increments_outside_m", self.increments_outside_m,
          OptionInfo{.unit = "m",
                     .text = "circle (centre x, y, radius) inside which increments are not compared (a tool)"});
  }
};

/// Thresholds; what is left out is not judged.
struct LimitOptions {
  std::optional<double> displacement_rms_m;
  std::optional<double> strain_rms;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("displacement_rms_m", self.displacement_rms_m,
          OptionInfo{.unit = "m", .text = "greatest RMS displacement difference, over space and time", .min = 0});
    visit("strain_rms", self.strain_rms,
          OptionInfo{.text = "greatest RMS difference of deviatoric strain, over space and time", .min = 0});
  }
};

/// A field on the particles of the first motion that found a partner at the common start.
struct DifferenceField {
  std::string name, unit, definition;
  std::vector<float> values;  // [time][particle], NaN where there is no partner (any more)
};

/// One number a time, over the particles compared then.
struct Series {
  std::string name, unit, definition;
  std::vector<double> values;  // [time], NaN where not known
};

struct Comparison {
  std::vector<double> time;      // the first's times at which both sides are known
  std::vector<std::int64_t> id;  // the first's ids, in the order of the fields
  double coverage_first = 0, coverage_second = 0;  // share of each side that found a partner, at the common start
  std::vector<Metric> metrics;
  std::vector<DifferenceField> fields;  // difference_x, difference_y, difference_magnitude, difference_strain_dev
  // displacement_rms, displacement_uncertainty, displacement_mean_first, displacement_mean_second, strain_dev_rms,
  // strain_dev_uncertainty, particles_compared
  std::vector<Series> series;
  bool over_limit = false;
  // Outlines at the last time, for drawing: each ring ends on its first point; material to the left of its sense.
  std::vector<std::vector<Vec2>> outline_first, outline_second;
  std::vector<std::string> remarks;  // how the sides were aligned, what was left out and why; one sentence each
};

/// second minus first, at the first's particles and times. Displacement and strain count from the common start, the
/// later of the two first times. Material positions are aligned there; the second motion is interpolated between its
/// particles (linear on the Delaunay triangulation of material positions, no triangle that bridges a gap; within half a
/// spacing of its edge from the nearest point of the edge) unless ids and positions agree, and linearly in time. A
/// particle that ends on either side has no partner from then on. `reference_m`, `slope_base_m` and the limits are in
/// the motions' own length unit. Frames are read one by one, in order; the fields are what memory grows with.
/// Throws InputError if a motion is empty, the units differ, no time is common or no particle finds a partner;
/// Interrupted if asked to stop.
/// Every metric carries its definition; docs/theory.md has the equations.
Comparison compare(const MotionSource& first, const MotionSource& second, const CompareOptions& options,
                   const LimitOptions& limits, Progress& progress);

}  // namespace pivnp::compare
