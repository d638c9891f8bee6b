#include "compare/measures/history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

bool HistoryMeasures::noise_known() const { return std::isfinite(errors.own[0]) || std::isfinite(errors.own[1]); }

std::optional<HistoryMeasures> measure_histories(const std::string& subject, const std::string& what,
                                                 const History& first, const History& second,
                                                 const HistoryErrors& errors, const std::string& unit,
                                                 const std::string& time_unit) {
  HistoryMeasures out;
  for (std::size_t k = 0; k < first.time.size(); ++k) {
    const double d = value_at(second, first.time[k]) - first.value[k];
    if (std::isfinite(d)) out.difference.add(d);
  }
  if (out.difference.count() == 0) return std::nullopt;
  out.subject = subject;
  out.what = what;
  out.unit = unit;
  out.time_unit = time_unit;
  out.errors = errors;
  const PerDataSet<const History*> histories{&first, &second};
  for (std::size_t s = 0; s < 2; ++s) {
    const double own = out.noise_known() && std::isnan(errors.own[s]) ? 0 : errors.own[s];
    out.onset[s] = onset(*histories[s], own);
    out.peak_rate[s] = peak_rate(*histories[s], own);
    out.rest[s] = rest(*histories[s], own);
  }
  return out;
}

}  // namespace pivnp::compare
