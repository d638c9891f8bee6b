#include "compare/measures/clocks.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::compare {

Beginnings beginnings(const Differences& differences) {
  Beginnings out;
  const ComparisonTable table = differences.over_space();
  const auto column = [&](const char* name) -> const std::vector<double>& { return find(table, name)->values; };
  const std::vector<double>&t = column("time"), &first = column("displacement_mean_first"),
        &second = column("displacement_mean_second"), &rms = column("displacement_rms"), &u = column("displacement_uncertainty");
  if (t.size() < 4 || !(second.back() > 0) || !(first.back() > 0)) return out;
  for (std::size_t k = 1; k < t.size(); ++k)
    if (second[k] < 0.02 * second.back() && u[k] > 0) out.rest_over_u = std::max(out.rest_over_u.value_or(0), rms[k] / u[k]);

  const auto both = [&](int power) -> PerDataSet<Onset> { return {find_onset(t, first, power), find_onset(t, second, power)}; };
  const PerDataSet<Onset> one = both(1), two = both(2);
  const auto scatter = [](const PerDataSet<Onset>& o) { return std::hypot(o[0].sigma, o[1].sigma); };
  const PerDataSet<Onset>& best = scatter(two) < scatter(one) ? two : one;
  if (!std::isfinite(scatter(best))) return out;
  // The speed of the rise: from the onset to a quarter of the way.
  const auto quarter = std::find_if(first.begin(), first.end(), [&](double v) { return v > 0.25 * first.back(); }) - first.begin();
  const double since = t[std::size_t(quarter)] - best[0].time, speed = since > 0 ? first[std::size_t(quarter)] / since : not_known;
  const double by_error = u[std::size_t(quarter)] / speed;
  const double law = (one[1].time - one[0].time) - (two[1].time - two[0].time);
  double sigma = scatter(best);
  for (const double part : {by_error, law / std::sqrt(12.0)})
    if (std::isfinite(part)) sigma = std::hypot(sigma, part);
  out.difference = Onset{best[1].time - best[0].time, sigma};
  return out;
}

}  // namespace pivnp::compare
