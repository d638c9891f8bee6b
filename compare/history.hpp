// One quantity against time, on two sides: a point's displacement, a front's place, a curve read off a figure.
#pragma once

#include <string>
#include <vector>

#include "pivnp/core/record/metric.hpp"

namespace pivnp::compare {

struct History {
  std::vector<double> time, value;  // ascending times; NaN where the value is not known
};

/// Linear between its times; NaN outside them and beside unknown values.
double value_at(const History& history, double time);

/// First time at which the value has gone 5 % of its whole range from where it starts (linear between times); NaN if it
/// never moves.
double onset_time(const History& history);
/// Greatest size of the central difference over the times (uneven steps: the parabola's slope); NaN with fewer than
/// three values.
double peak_rate(const History& history);
/// Last time at which the value is 5 % of its whole range from where it ends; NaN if it never moves.
double rest_time(const History& history);

/// Adds PREFIX_bias, _rms, _p95, _max of the difference (second minus first) at the first's times that the second
/// covers, and for _onset, _peak_rate and _rest both sides' values and their difference. `sigma`: standard uncertainty
/// of a difference of values, NaN if not known. `what` is the quantity in words. False if no time is common.
bool add_history_metrics(const std::string& prefix, const std::string& what, const History& first,
                         const History& second, double sigma, const std::string& unit, const std::string& time_unit,
                         std::vector<Metric>& metrics);

}  // namespace pivnp::compare
