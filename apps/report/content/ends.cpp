#include "apps/report/content/ends.hpp"

#include <limits>
#include <map>

#include "apps/plot/numbers.hpp"

namespace pivnp::report {

std::vector<Ends> ends_by_reason(const ParticleSet& particles) {
  std::map<EndReason, std::vector<double>> times;
  for (std::size_t p = 0; p < particles.end_reason.size(); ++p)
    if (particles.end_reason[p] != EndReason::none)
      times[particles.end_reason[p]].push_back(p < particles.end.size() ? particles.end[p] : std::numeric_limits<double>::quiet_NaN());
  std::vector<Ends> out;
  for (const auto& [reason, t] : times)
    out.push_back({reason, t.size(), plot::quantile(t, 0), plot::quantile(t, 0.5), plot::quantile(t, 1)});
  return out;
}

}  // namespace pivnp::report
