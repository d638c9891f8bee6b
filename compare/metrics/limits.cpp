#include "compare/metrics/limits.hpp"

#include <algorithm>
#include <cmath>

#include "compare/data/stated.hpp"
#include "compare/data/statistics.hpp"
#include "compare/metrics/words.hpp"

namespace pivnp::compare {

Registry<LimitRow>& limit_rows() {
  static Registry<LimitRow> rows{
      {"displacement_rms_m", "m", "RMS displacement difference"},
      {"displacement_p95_m", "m", "95th percentile of the displacement difference"},
      {"displacement_max_m", "m", "displacement difference"},
      {"displacement_bias_m", "m", "either component of the mean difference"},
      {"velocity_rms_m_s", "m/s", "RMS velocity difference"},
      {"strain_rms", "", "RMS difference of deviatoric strain"},
      {"strain_p95", "", "95th percentile of the difference of deviatoric strain"},
      {"displacement_over_u", "", "RMS displacement difference in units of its standard uncertainty"},
      {.name = "outline_iou_min", .unit = "", .text = "fraction of area that the final outlines share",
       .least = true, .max = 1},
      {"hausdorff_m", "m", "Hausdorff distance (95 %) of the final outlines"},
      {.name = "run_out_m", .unit = "m", .text = "difference of run-out",
       .needs = "slope_base_m"},
      {.name = "slope_angle_deg", .unit = "deg",
       .text = "difference of the final slope angle", .needs = "slope_base_m"},
      {.name = "coverage_min", .unit = "", .text = "fraction of the first's particles with a partner",
       .least = true, .max = 1},
      {"history_rms", "", "RMS difference of two histories, in their unit"}};
  return rows;
}

std::optional<double>& LimitOptions::operator[](std::string_view key) {
  const LimitRow& row = limit_rows().at(key, "compare.limits");
  return given_[row.name];
}

const std::optional<double>& LimitOptions::operator[](std::string_view key) const {
  static const std::optional<double> none;
  limit_rows().at(key, "compare.limits");
  const auto at = given_.find(key);
  return at == given_.end() ? none : at->second;
}

LimitOptions& LimitOptions::operator=(const LimitOptions& other) {
  if (this == &other) return *this;
  for (auto& [key, limit] : given_) limit.reset();
  for (const auto& [key, limit] : other.given_) given_[key] = limit;
  return *this;
}

bool LimitOptions::any() const {
  return std::any_of(given_.begin(), given_.end(), [](const auto& limit) { return limit.second.has_value(); });
}

const LimitRow* limit_without_its_option(const LimitOptions& limits, const CompareOptions& options) {
  for (const LimitRow& row : limit_rows())
    if (!row.needs.empty() && limits[row.name] && !is_stated(options, row.needs)) return &row;
  return nullptr;
}

std::vector<LimitResult> apply_limits(const LimitOptions& limits, std::vector<Metric>& metrics) {
  std::vector<LimitResult> results;
  for (const LimitRow& row : limit_rows()) {
    const std::optional<double>& limit = limits[row.name];
    if (!limit) continue;
    LimitResult result{row.name, *limit, row.least ? std::numeric_limits<double>::infinity() : 0.0, true};
    std::size_t found = 0;
    bool known = true;  // the uncertainty of each
    for (Metric& m : metrics) {
      if (limit_of(m.name) != row.name) continue;
      ++found;
      const bool withheld = m.verdict == Verdict::withheld;
      const double size = withheld && !row.least ? not_known : row.least ? m.value : std::abs(m.value);
      const bool met = row.least ? size >= *limit : size <= *limit;  // a value that is not a number exceeds it
      m.limit = met ? LimitFate::met : LimitFate::exceeded;
      result.met = result.met && met;
      if (std::isnan(size) || (row.least ? size < result.reached : size > result.reached)) result.reached = size;
      if (row.least) continue;
      known = known && std::isfinite(m.within());
      result.within = std::fmax(result.within, m.within());
    }
    if (!known) result.within = not_known;
    if (found == 0) {
      result.met = false;
      result.reached = not_known;
    }
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace pivnp::compare
