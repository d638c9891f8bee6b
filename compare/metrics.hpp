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
inline constexpr const char* not_distinguishable = "not distinguishable at this u_val";

/// A difference between the sides, E = S - D, judged against its standard uncertainty u_val (V&V 20): less than `k` of
/// them is not distinguishable. Beyond it no word is said: E is then the model's error to within u_val.
Metric difference_metric(std::string name, double value, std::string unit, double uncertainty, std::string definition,
                         double k = 2);

/// Factor for the greatest of `count` errors: exceeded by none of them in 95 of 100 cases, however the two components
/// of each share its variance and whether or not the errors are independent: sqrt(2 ln(20 count)), at least 2.
double greatest_factor(std::size_t count);

/// The same for the 95th percentile: where neighbours share their errors, it may be the greatest of twenty independent
/// ones.
double percentile_factor(std::size_t count);

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
