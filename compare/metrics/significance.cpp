#include "compare/metrics/significance.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace pivnp::compare {

namespace {

double square_or_zero(double u) { return std::isfinite(u) ? u * u : 0; }

double value_of(const std::vector<Metric>& metrics, std::string_view name) {
  const Metric* found = find(metrics, name);
  return found == nullptr ? not_known : found->value;
}

// The size of what a difference is a difference of.
double size_of(const Metric& m, const std::vector<Metric>& metrics, const std::string& length_unit) {
  if (m.name.ends_with("_relative")) return 1;
  if (m.name.starts_with("velocity_")) return value_of(metrics, "velocity_peak_first");
  if (m.unit == length_unit) return value_of(metrics, "displacement_peak_first");
  constexpr std::string_view ending = "_difference";
  if (m.unit != "deg" || !m.name.ends_with(ending)) return not_known;
  const std::string base = m.name.substr(0, m.name.size() - ending.size());
  return std::fmax(std::abs(value_of(metrics, base + "_first")), std::abs(value_of(metrics, base + "_second")));
}

}  // namespace

MetricValue difference(double value, double uncertainty, std::string note, double k) {
  return {value, uncertainty, std::move(note), k};
}

bool made_of_u_val(std::string_view name) {
  for (const std::string_view family :
       {"displacement_", "velocity_", "area_metric_displacement", "decomposition_displacement", "point_"})
    if (name.starts_with(family)) return true;
  return false;
}

void judge(Metric& m, const KnownParts& known) {
  m.verdict = Verdict::none;
  m.lost_in = LostIn::nothing;
  if (!std::isfinite(m.factor) || !std::isfinite(m.value) || !(m.uncertainty > 0)) return;
  const double size = std::abs(m.value), u2 = m.uncertainty * m.uncertainty;
  const double mesh2 = square_or_zero(m.numerical), input2 = square_or_zero(m.input);
  const double measured2 = std::max(0.0, u2 - mesh2 - input2);
  const LostIn model = mesh2 >= input2 ? LostIn::mesh : LostIn::inputs;
  if (size >= m.factor * m.uncertainty) {
    m.verdict = known.numerical && known.input ? Verdict::differs : Verdict::larger;
  } else if (size >= m.factor * std::sqrt(measured2)) {
    m.verdict = Verdict::not_resolved;
    m.lost_in = model;
  } else if (m.seen() > m.scale / 2) {
    m.verdict = Verdict::not_resolved;
    m.lost_in = measured2 >= std::max(mesh2, input2) ? LostIn::measurement : model;
  } else {
    m.verdict = Verdict::agrees;
  }
}

void judge(std::vector<Metric>& metrics, const KnownParts& everywhere, const std::string& length_unit) {
  const double u = value_of(metrics, "u_val");
  const double mesh = value_of(metrics, "u_numerical") / u, inputs = value_of(metrics, "u_input") / u;
  for (Metric& m : metrics) {
    if (!std::isfinite(m.factor) || m.verdict == Verdict::withheld) continue;
    if (std::isnan(m.scale)) m.scale = size_of(m, metrics, length_unit);
    if (made_of_u_val(m.name)) {
      if (mesh > 0) m.numerical = mesh * m.uncertainty;
      if (inputs > 0) m.input = inputs * m.uncertainty;
    }
    KnownParts known = everywhere;
    known.numerical = known.numerical || std::isfinite(m.numerical);
    known.input = known.input || std::isfinite(m.input);
    judge(m, known);
  }
}

double greatest_of_paths_factor(std::size_t count) { return 2 * greatest_factor(count); }

double percentile_factor(std::size_t count) { return greatest_factor(std::min<std::size_t>(count, 20)); }

double greatest_factor(std::size_t count) {
  return std::max(2.0, std::sqrt(2 * std::log(20.0 * double(std::max<std::size_t>(1, count)))));
}

}  // namespace pivnp::compare
