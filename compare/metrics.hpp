// Numbers into metrics: name, unit, uncertainty, definition, verdict.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "compare/compare.hpp"
#include "compare/differences.hpp"
#include "compare/slope.hpp"

namespace pivnp::compare {

/// The only words a verdict may hold, beside none.
inline constexpr const char* within_limit = "within limit";
inline constexpr const char* over_limit = "over limit";
inline constexpr const char* not_distinguishable = "not distinguishable at this uncertainty";

/// A difference between the sides, judged against its uncertainty: less than twice that is not distinguishable.
Metric difference_metric(std::string name, double value, std::string unit, double uncertainty, std::string definition);

/// Displacement and strain over space and time (`suffix` empty) or at one time. `when` ends the definitions;
/// `covariance` says whose covariance the uncertainties rest on, and is empty if nobody's is known.
struct Wording {
  std::string suffix, when, covariance, length_unit;
};
void add_displacement_metrics(const Tally& tally, const Wording& wording, double peak_first,
                              std::vector<Metric>& metrics);
void add_strain_metrics(const Tally& tally, const Wording& wording, std::vector<Metric>& metrics);
void add_peak_metrics(const Tally& total, const Wording& wording, std::vector<Metric>& metrics);

/// Run-out, crest height and slope angle of both sides and their differences. `sigma`: of the displacement at the end,
/// first and second (0 if not known); `spacing` likewise.
void add_slope_metrics(const SlopeShape& first, const SlopeShape& second, const std::array<double, 2>& spacing,
                       const std::array<double, 2>& sigma, const std::string& length_unit,
                       std::vector<Metric>& metrics);

/// Judges the metrics that have a limit; true if one is exceeded.
bool apply_limits(const LimitOptions& limits, std::vector<Metric>& metrics);

}  // namespace pivnp::compare
