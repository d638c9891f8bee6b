// One quantity against time, on two sides: a point's displacement, a front's place, a curve read off a figure.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "pivnp/core/record/metric.hpp"

namespace pivnp::compare {

struct History {
  std::vector<double> time, value;  // ascending times; NaN where the value is not known
};

/// Linear between its times; NaN outside them and beside unknown values.
double value_at(const History& history, double time);

/// A number read off a history. Standard uncertainties are of random, independent errors of the values, standard
/// deviation `sigma`; NaN where they cannot be stated.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN(), uncertainty = value;
};

/// First time at which the value has gone 5 % of its whole range from where it starts (linear between times); NaN if it
/// never moves. u^2 = dt^2/12 + 2 sigma^2/slope^2: the interval in which it lies (rectangular), and the errors of the
/// value there and at the start over the slope between 2.5 and 10 % of the range. Without sigma (NaN) the first part
/// alone; not known where the noise reaches the threshold.
Estimate onset(const History& history, double sigma);
/// Greatest size of the central difference over the times (uneven steps: the parabola's slope), with what the errors of
/// the three values make of it; NaN with fewer than three.
Estimate peak_rate(const History& history, double sigma);
/// Last time at which the value is 5 % of its whole range from where it ends: the onset of the history read backwards.
Estimate rest(const History& history, double sigma);

/// Standard uncertainties, NaN if not known: of a difference of values, and of each side's values alone.
struct HistoryErrors {
  double difference = std::numeric_limits<double>::quiet_NaN();
  std::array<double, 2> side{difference, difference};
};

/// Adds PREFIX_bias, _rms, _p95, _max of the difference (second minus first) at the first's times that the second
/// covers, and for _onset, _peak_rate and _rest both sides' values and their difference. `what` is the quantity in
/// words. False if no time is common.
bool add_history_metrics(const std::string& prefix, const std::string& what, const History& first,
                         const History& second, const HistoryErrors& errors, const std::string& unit,
                         const std::string& time_unit, std::vector<Metric>& metrics);

}  // namespace pivnp::compare
