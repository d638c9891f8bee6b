// How far two motions are apart. Sees motions only, and cannot tell measured from simulated.
#pragma once

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

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("reference_m", self.reference_m,
          OptionInfo{.unit = "m", .text = "polygon of material whose mean motion is subtracted from both sides (the frame of the far soil)"});
    visit("slope_base_m", self.slope_base_m,
          OptionInfo{.unit = "m", .text = "height of the base on which a slope rests: outline and slope angle are reported above it"});
  }
};

/// Thresholds; what is left out is not judged.
struct LimitOptions {
  std::optional<double> displacement_rms_m;
  std::optional<double> strain_rms;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("displacement_rms_m", self.displacement_rms_m, OptionInfo{.unit = "m", .text = "greatest RMS displacement difference", .min = 0});
    visit("strain_rms", self.strain_rms, OptionInfo{.text = "greatest RMS difference of deviatoric strain", .min = 0});
  }
};

/// A field on the particles of the first motion that found a partner.
struct DifferenceField {
  std::string name, unit, definition;
  std::vector<float> values;  // [time][particle], NaN where there is no partner
};

struct Comparison {
  std::vector<double> time;
  std::vector<std::int64_t> id;
  double coverage_first = 0, coverage_second = 0;  // share of each side that found a partner
  std::vector<Metric> metrics;
  std::vector<DifferenceField> fields;  // difference_x, difference_y, difference_magnitude, difference_strain_dev
  bool over_limit = false;
  // Outlines at the last time, closed, for drawing.
  std::vector<std::vector<Vec2>> outline_first, outline_second;
};

/// second minus first, at the first's particles and times. Material positions are aligned through the first frame; the
/// second motion is interpolated between its particles (linear on the Delaunay triangulation of x0) unless ids and x0
/// agree, and linearly in time. Throws InputError if the units differ or no particle finds a partner.
Comparison compare(const MotionSource& first, const MotionSource& second, const CompareOptions& options,
                   const LimitOptions& limits, Progress& progress);

}  // namespace pivnp::compare
