// Metrics of histories: of curves that are compared, and of material points.
#include <cmath>

#include "compare/metrics/rows.hpp"

namespace pivnp::compare {

namespace {

void add_differences(Registry<HistoryMetricRow>& rows) {
  const auto add = [&](const char* name, const char* words, const char* of, double (*value)(const ScalarStatistics&),
                       double (*factor)(std::size_t), const char* limit, Leads leads) {
    rows.add({{.name = name, .unit = "V",
               .definition = std::string(of) +
                             "{} of the second minus that of the first, at the first's times that the second covers",
               .words = words, .limit = limit, .leads = leads},
              [=](const HistoryMeasures& h) {
                const double sigma = h.errors.difference;
                return difference(value(h.difference), sigma,
                                  std::isfinite(sigma) ? "; uncertainty: of one value, all errors assumed to be equal"
                                                       : "; uncertainty not known",
                                  factor(h.difference.count()));
              }});
  };
  const auto two = [](std::size_t) { return 2.0; };
  add("bias", "mean difference", "mean of ", [](const ScalarStatistics& s) { return s.bias(); }, two, "", Leads::yes);
  add("rms", "RMS", "root mean square of ", [](const ScalarStatistics& s) { return s.rms(); }, two, "history_rms",
      Leads::yes);
  add("p95", "95th percentile", "95th percentile of the size of ", [](const ScalarStatistics& s) { return s.p95(); },
      percentile_factor, "", Leads::no);
  add("max", "maximum", "greatest size of ", [](const ScalarStatistics& s) { return s.max(); }, greatest_factor, "",
      Leads::no);
}

// A number read off each history.
void add_estimate(Registry<HistoryMetricRow>& rows, const MetricFacts& facts,
                  PerDataSet<Estimate> HistoryMeasures::*estimates, std::string (*how)(const HistoryMeasures&)) {
  add_for_both(rows, Variants::both_and_difference, facts, Leads::no,
               [=](const HistoryMeasures& h) -> std::vector<MetricValue> {
                 const auto& [a, b] = h.*estimates;
                 const std::string by = how(h);
                 return {{a.value, a.uncertainty, by},
                         {b.value, b.uncertainty, by},
                         difference(b.value - a.value, std::hypot(a.uncertainty, b.uncertainty), by)};
               });
}

std::string by_crossing(const HistoryMeasures& h) {
  return "; uncertainty: the interval between two times (rectangular)" +
         std::string(h.noise_known() ? ", and the values' errors over the slope there" : " alone");
}

std::string by_three_values(const HistoryMeasures& h) {
  return h.noise_known() ? "; uncertainty: independent errors of three values" : "; uncertainty not known";
}

}  // namespace

Registry<HistoryMetricRow>& history_metric_rows() {
  static Registry<HistoryMetricRow> rows = [] {
    Registry<HistoryMetricRow> list;
    add_differences(list);
    add_estimate(list,
                 {.name = "onset", .unit = "T", .definition = "time at which {} has gone 5 % of its whole range",
                  .words = "onset"},
                 &HistoryMeasures::onset, by_crossing);
    add_estimate(list, {.name = "peak_rate", .unit = "V/T", .definition = "greatest rate of {}", .words = "greatest rate"},
                 &HistoryMeasures::peak_rate, by_three_values);
    add_estimate(list,
                 {.name = "rest", .unit = "T",
                  .definition = "last time at which {} is 5 % of its whole range from its last value",
                  .words = "time to rest"},
                 &HistoryMeasures::rest, by_crossing);
    list.add({{.name = "distance_rms", .unit = "V",
               .definition = "root mean square over the times of the size of the difference of the vectors whose size is "
                             "{}; uncertainty: root mean trace of the covariance of u, and what is known of camera, gauge, "
                             "frame of reference, numerics and inputs",
               .words = "RMS distance"},
              [](const HistoryMeasures& h) -> std::optional<MetricValue> {
                if (!std::isfinite(h.distance_rms)) return std::nullopt;
                return difference(h.distance_rms, h.errors.difference, "");
              }});
    return list;
  }();
  return rows;
}

}  // namespace pivnp::compare
