// One quantity against time, on two data sets: a point's displacement, a front's place, a curve read off a figure.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "compare/data/statistics.hpp"
#include "pivnp/core/record/comparison.hpp"

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

/// Standard uncertainties, NaN if not known: of a difference of values, and of each data set's values alone.
struct HistoryErrors {
  double difference = std::numeric_limits<double>::quiet_NaN();
  PerDataSet<double> own{difference, difference};
};

/// What two histories of one quantity come to.
struct HistoryMeasures {
  std::string subject;            // begins the names of its metrics: "history", "point_1"
  std::string what;               // the quantity in words
  std::string unit, time_unit;
  ScalarStatistics difference;    // second minus first, at the first's times that the second covers
  HistoryErrors errors;
  PerDataSet<Estimate> onset, peak_rate, rest;
  // Of a vector: RMS over the times of the size of its difference; NaN for scalars.
  double distance_rms = std::numeric_limits<double>::quiet_NaN();

  /// Whether the error of one of both is known.
  bool noise_known() const;
};

/// Nothing if no time is common. Where one data set has no error of its own and the other knows one, it counts as exact.
std::optional<HistoryMeasures> measure_histories(const std::string& subject, const std::string& what,
                                                 const History& first, const History& second,
                                                 const HistoryErrors& errors, const std::string& unit,
                                                 const std::string& time_unit);

}  // namespace pivnp::compare
