#include "compare/history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/metrics.hpp"
#include "compare/statistics.hpp"

namespace pivnp::compare {

namespace {

History known(const History& h) {
  History out;
  for (std::size_t k = 0; k < h.time.size(); ++k)
    if (std::isfinite(h.value[k])) {
      out.time.push_back(h.time[k]);
      out.value.push_back(h.value[k]);
    }
  return out;
}

double range(const History& h) {
  const auto [least, most] = std::minmax_element(h.value.begin(), h.value.end());
  return h.value.empty() ? 0 : *most - *least;
}

}  // namespace

double value_at(const History& h, double time) {
  const auto after = std::lower_bound(h.time.begin(), h.time.end(), time);
  if (after == h.time.end()) return not_known;
  const std::size_t k = std::size_t(after - h.time.begin());
  if (h.time[k] == time) return h.value[k];
  if (k == 0) return not_known;
  const double w = (time - h.time[k - 1]) / (h.time[k] - h.time[k - 1]);
  return (1 - w) * h.value[k - 1] + w * h.value[k];
}

double onset_time(const History& history) {
  const History h = known(history);
  const double threshold = 0.05 * range(h);
  if (!(threshold > 0)) return not_known;
  for (std::size_t k = 1; k < h.time.size(); ++k) {
    const double before = std::abs(h.value[k - 1] - h.value[0]), now = std::abs(h.value[k] - h.value[0]);
    if (now < threshold) continue;
    const double w = now > before ? (threshold - before) / (now - before) : 0;
    return h.time[k - 1] + std::clamp(w, 0.0, 1.0) * (h.time[k] - h.time[k - 1]);
  }
  return not_known;
}

double rest_time(const History& history) {
  const History h = known(history);
  const double threshold = 0.05 * range(h);
  if (!(threshold > 0)) return not_known;
  const double end = h.value.back();
  for (std::size_t k = h.time.size() - 1; k-- > 0;) {
    const double off = std::abs(h.value[k] - end), next = std::abs(h.value[k + 1] - end);
    if (off < threshold) continue;
    const double w = off > next ? (off - threshold) / (off - next) : 1;
    return h.time[k] + std::clamp(w, 0.0, 1.0) * (h.time[k + 1] - h.time[k]);
  }
  return not_known;
}

double peak_rate(const History& history) {
  const History h = known(history);
  double peak = not_known;
  for (std::size_t k = 1; k + 1 < h.time.size(); ++k) {
    const double a = h.time[k] - h.time[k - 1], b = h.time[k + 1] - h.time[k];
    const double rate = -b / (a * (a + b)) * h.value[k - 1] + (b - a) / (a * b) * h.value[k] +
                        a / (b * (a + b)) * h.value[k + 1];
    if (!(std::abs(rate) <= peak)) peak = std::abs(rate);
  }
  return peak;
}

bool add_history_metrics(const std::string& prefix, const std::string& what, const History& first,
                         const History& second, double sigma, const std::string& unit, const std::string& time_unit,
                         std::vector<Metric>& metrics) {
  ScalarStatistics difference;
  for (std::size_t k = 0; k < first.time.size(); ++k) {
    const double d = value_at(second, first.time[k]) - first.value[k];
    if (std::isfinite(d)) difference.add(d);
  }
  if (difference.count() == 0) return false;
  const std::string at = " of the second minus that of the first, at the first's times that the second covers";
  const std::string how = std::isfinite(sigma) ? "; uncertainty: of one value, errors taken as one and the same"
                                               : "; uncertainty not known";
  const auto differ = [&](const char* name, double value, const std::string& words, double k) {
    metrics.push_back(difference_metric(prefix + name, value, unit, sigma, words + what + at + how, k));
  };
  differ("_bias", difference.bias(), "mean of ", 2);
  differ("_rms", difference.rms(), "root mean square of ", 2);
  differ("_p95", difference.p95(), "95th percentile of the size of ", percentile_factor(difference.count()));
  differ("_max", difference.max(), "greatest size of ", greatest_factor(difference.count()));
  const auto both = [&](const char* name, double a, double b, const std::string& in, const std::string& definition) {
    const std::string none = "; uncertainty not estimated";
    metrics.push_back({prefix + name + "_first", a, in, not_known, definition + ", first" + none, ""});
    metrics.push_back({prefix + name + "_second", b, in, not_known, definition + ", second" + none, ""});
    metrics.push_back(
        {prefix + name + "_difference", b - a, in, not_known, definition + ", second minus first" + none, ""});
  };
  both("_onset", onset_time(first), onset_time(second), time_unit,
       "time at which " + what + " has gone 5 % of its whole range");
  both("_peak_rate", peak_rate(first), peak_rate(second), unit + "/" + time_unit, "greatest rate of " + what);
  both("_rest", rest_time(first), rest_time(second), time_unit,
       "last time at which " + what + " is 5 % of its whole range from its last value");
  return true;
}

}  // namespace pivnp::compare
