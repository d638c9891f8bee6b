#include "compare/metrics/rows.hpp"
#include "pivnp/core/particles/fields.hpp"

namespace pivnp::compare {

Registry<MetricRow>& metric_rows() {
  static Registry<MetricRow> rows = [] {
    Registry<MetricRow> list;
    add_motion_rows(list);
    add_strain_rows(list);
    add_alignment_rows(list);
    add_shape_rows(list);
    add_field_rows(list);
    add_offset_rows(list);
    return list;
  }();
  return rows;
}

std::vector<Metric> metrics_of(const HistoryMeasures& measures) {
  std::vector<Metric> metrics;
  for (const HistoryMetricRow& row : history_metric_rows()) {
    const std::optional<MetricValue> found = row.value(measures);
    if (!found) continue;
    std::string definition = row.definition;
    if (const std::size_t at = definition.find("{}"); at != std::string::npos) definition.replace(at, 2, measures.what);
    std::string unit = row.unit;
    if (unit.starts_with('V')) unit = measures.unit + unit_in(unit.substr(1), "", measures.time_unit);
    else unit = unit_in(unit, "", measures.time_unit);
    metrics.push_back({measures.subject + "_" + row.name, found->value, std::move(unit), found->uncertainty,
                       definition + found->note, Verdict::none, found->factor});
    metrics.back().scale = found->scale;
  }
  return metrics;
}

std::vector<Metric> metrics_of(const Findings& findings) {
  std::vector<Metric> metrics;
  for (const MetricRow& row : metric_rows())
    if (const std::optional<MetricValue> found = row.value(findings)) {
      metrics.push_back({row.name, found->value, unit_in(row.unit, findings.length_unit, findings.time_unit),
                         found->uncertainty, row.definition + found->note, Verdict::none, found->factor});
      metrics.back().scale = found->scale;
    }
  for (const HistoryMeasures& point : findings.points.histories)
    for (Metric& metric : metrics_of(point)) metrics.push_back(std::move(metric));
  return metrics;
}

}  // namespace pivnp::compare
