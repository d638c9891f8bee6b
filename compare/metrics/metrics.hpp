// Numbers into metrics: name, unit, uncertainty, definition, verdict.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "compare/measures/comparison.hpp"
#include "compare/measures/differences.hpp"
#include "compare/measures/judged.hpp"
#include "compare/shapes/slope.hpp"

namespace pivnp::compare {

/// Displacement and strain over space and time (`suffix` empty) or at one time. `when` ends the definitions;
/// `covariance` says whose covariance the uncertainties rest on, and is empty if nobody's is known.
struct Wording {
  std::string suffix, when, covariance, length_unit;
  std::string floor = "";  // whose strain floor the record states, and from what; empty: nobody's
};
void add_displacement_metrics(const Tally& tally, const Wording& wording, double peak_first,
                              std::vector<Metric>& metrics);
void add_strain_metrics(const Tally& tally, const Wording& wording, std::vector<Metric>& metrics);
void add_velocity_metrics(const Rates& rates, const Wording& wording, const std::string& unit,
                          std::vector<Metric>& metrics);
/// u_val and its parts u_measurement (random error, camera, gauge), u_numerical, u_input: RMS over what `tally` holds.
void add_uncertainty_metrics(const Tally& tally, const Wording& wording, std::vector<Metric>& metrics);
void add_peak_metrics(const Tally& total, const Wording& wording, std::vector<Metric>& metrics);

/// Run-out, crest height and slope angle of both sides and their differences. `sigma`: of the displacement at the end,
/// first and second (0 if not known); `spacing` likewise.
void add_slope_metrics(const SlopeShape& first, const SlopeShape& second, const std::array<double, 2>& spacing,
                       const std::array<double, 2>& sigma, const std::string& length_unit,
                       std::vector<Metric>& metrics);

/// Judges the metrics that have a limit. A metric that could not be computed misses its limit.
std::vector<LimitResult> apply_limits(const LimitOptions& limits, std::vector<Metric>& metrics);

}  // namespace pivnp::compare
