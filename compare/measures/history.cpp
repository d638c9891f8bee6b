#include "compare/measures/history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/data/statistics.hpp"
#include "compare/measures/judged.hpp"

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

namespace {

// First time at which the value is `level` away from its first one; the interval it lies in.
struct Reach {
  double time = not_known, interval = not_known;
};

Reach first_reach(const History& h, double level) {
  for (std::size_t k = 1; k < h.time.size(); ++k) {
    const double before = std::abs(h.value[k - 1] - h.value[0]), now = std::abs(h.value[k] - h.value[0]);
    if (now < level) continue;
    const double w = now > before ? (level - before) / (now - before) : 0, step = h.time[k] - h.time[k - 1];
    return {h.time[k - 1] + std::clamp(w, 0.0, 1.0) * step, step};
  }
  return {};
}

constexpr double begun = 0.05;  // share of the range that counts as motion

}  // namespace

Estimate onset(const History& history, double sigma) {
  const History h = known(history);
  const double threshold = begun * range(h);
  if (!(threshold > 0)) return {};
  const Reach here = first_reach(h, threshold);
  const double both = std::sqrt(2.0) * sigma;  // the value here, and the one that it is counted from
  Estimate out{here.time, not_known};
  if (both >= threshold) return out;
  const double rise = first_reach(h, 2 * threshold).time - first_reach(h, threshold / 2).time;
  const double by_noise = std::isnan(sigma) ? 0 : both * rise / (1.5 * threshold);
  out.uncertainty = std::hypot(here.interval / std::sqrt(12.0), by_noise);
  return out;
}

Estimate rest(const History& history, double sigma) {
  History backwards = known(history);
  std::reverse(backwards.time.begin(), backwards.time.end());
  std::reverse(backwards.value.begin(), backwards.value.end());
  for (double& t : backwards.time) t = -t;
  Estimate out = onset(backwards, sigma);
  out.value = -out.value;
  return out;
}

Estimate peak_rate(const History& history, double sigma) {
  const History h = known(history);
  Estimate peak;
  for (std::size_t k = 1; k + 1 < h.time.size(); ++k) {
    const double a = h.time[k] - h.time[k - 1], b = h.time[k + 1] - h.time[k];
    const double w0 = -b / (a * (a + b)), w1 = (b - a) / (a * b), w2 = a / (b * (a + b));
    const double rate = std::abs(w0 * h.value[k - 1] + w1 * h.value[k] + w2 * h.value[k + 1]);
    if (rate <= peak.value) continue;
    peak = {rate, sigma * std::sqrt(w0 * w0 + w1 * w1 + w2 * w2)};
  }
  return peak;
}

bool add_history_metrics(const std::string& prefix, const std::string& what, const History& first,
                         const History& second, const HistoryErrors& errors, const std::string& unit,
                         const std::string& time_unit, std::vector<Metric>& metrics) {
  ScalarStatistics difference;
  for (std::size_t k = 0; k < first.time.size(); ++k) {
    const double d = value_at(second, first.time[k]) - first.value[k];
    if (std::isfinite(d)) difference.add(d);
  }
  if (difference.count() == 0) return false;
  const std::string at = " of the second minus that of the first, at the first's times that the second covers";
  const double sigma = errors.difference;
  const std::string how = std::isfinite(sigma) ? "; uncertainty: of one value, errors taken as one and the same"
                                               : "; uncertainty not known";
  const auto differ = [&](const char* name, double value, const std::string& words, double k) {
    metrics.push_back(difference_metric(prefix + name, value, unit, sigma, words + what + at + how, k));
  };
  differ("_bias", difference.bias(), "mean of ", 2);
  differ("_rms", difference.rms(), "root mean square of ", 2);
  differ("_p95", difference.p95(), "95th percentile of the size of ", percentile_factor(difference.count()));
  differ("_max", difference.max(), "greatest size of ", greatest_factor(difference.count()));
  const bool noise = std::isfinite(errors.side[0]) || std::isfinite(errors.side[1]);
  const std::string crossing = "; uncertainty: the interval between two times (rectangular)" +
                               std::string(noise ? ", and the values' errors over the slope there" : " alone");
  // A side without an error of its own adds none where the other knows one.
  std::array<double, 2> side = errors.side;
  for (double& s : side)
    if (noise && std::isnan(s)) s = 0;
  const auto both = [&](const char* name, auto&& read, const std::string& in, const std::string& definition,
                        const std::string& by) {
    const Estimate a = read(first, side[0]), b = read(second, side[1]);
    metrics.push_back({prefix + name + "_first", a.value, in, a.uncertainty, definition + ", first" + by, ""});
    metrics.push_back({prefix + name + "_second", b.value, in, b.uncertainty, definition + ", second" + by, ""});
    metrics.push_back(difference_metric(prefix + name + "_difference", b.value - a.value, in,
                                        std::hypot(a.uncertainty, b.uncertainty),
                                        definition + ", second minus first" + by));
  };
  both("_onset", onset, time_unit, "time at which " + what + " has gone 5 % of its whole range", crossing);
  both("_peak_rate", peak_rate, unit + "/" + time_unit, "greatest rate of " + what,
       noise ? "; uncertainty: independent errors of three values" : "; uncertainty not known");
  both("_rest", rest, time_unit, "last time at which " + what + " is 5 % of its whole range from its last value",
       crossing);
  return true;
}

}  // namespace pivnp::compare
