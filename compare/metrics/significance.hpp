// A difference held against its standard uncertainty.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "compare/data/statistics.hpp"
#include "pivnp/core/record/metric.hpp"

namespace pivnp::compare {

/// What one comparison says of a metric.
struct MetricValue {
  double value = not_known;
  double uncertainty = not_known;
  std::string note = "";  // ends the definition: when, how uncertain
  double factor = not_known;  // of a difference: it counts from so many uncertainties on
  double scale = not_known;   // of a difference: the size of what is compared, where no other metric states it
};

/// A difference between the data sets, E = S - D, with its standard uncertainty u_val (V&V 20). It counts from `k`
/// uncertainties on; judge() says what that comes to.
MetricValue difference(double value, double uncertainty, std::string note, double k = 2);

/// Whether the errors that are not the measurement's are known of every metric, as between two measurements, which have
/// neither mesh nor inputs.
struct KnownParts {
  bool numerical = false, input = false;
};

/// The verdict on one difference. With u_D^2 = u^2 - u_num^2 - u_input^2, u_num and u_input as far as they are known,
///   |E| >= k u                  differs, if u_num and u_input are known; else larger (than the measurement's error)
///   |E| < k u, |E| >= k u_D     not resolved, by mesh or inputs, whichever adds more: a mesh is not chance
///   |E| < k u_D                 agrees (within Metric::within()); but not resolved, by the greatest part, if not even a
///                               difference of half the size of what is compared would have been seen
/// and none where E is no difference, or u is not known or zero.
void judge(Metric& metric, const KnownParts& known);

/// Every difference. Of what is compared the size is that of other metrics (displacement_peak_first, velocity_peak_first,
/// NAME_first and NAME_second of angles), shares of mesh and inputs in u_val are those of u_numerical and u_input.
void judge(std::vector<Metric>& metrics, const KnownParts& known, const std::string& length_unit);

/// Whether a metric's uncertainty is made of the particles' u_val, and so holds what mesh and inputs add to it.
bool made_of_u_val(std::string_view name);

/// Factor for the greatest of `count` errors: exceeded by none of them in 95 of 100 cases, however the two components
/// of each share its variance and whether or not the errors are independent: sqrt(2 ln(20 count)), at least 2.
double greatest_factor(std::size_t count);

/// The same for paths of particles, whose errors have longer tails than normal ones (an edge, a lost texture). Twice the factor
/// above: 92 % of 16 twin experiments on looks that the table of docs/verdicts.md does not use stay below 1.7 times it.
double greatest_of_paths_factor(std::size_t count);

/// The same for the 95th percentile: where neighbours share their errors, it may be the greatest of twenty independent
/// ones.
double percentile_factor(std::size_t count);

}  // namespace pivnp::compare
