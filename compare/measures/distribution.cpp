#include "compare/measures/distribution.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "compare/data/statistics.hpp"

namespace pivnp::compare {

namespace {

std::vector<double> sorted(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  std::sort(values.begin(), values.end());
  return values;
}

// Nearest rank of a sorted list.
double level(const std::vector<double>& values, double q) {
  if (values.empty()) return not_known;
  const double rank = std::ceil(q * double(values.size()) - 1e-9);
  return values[std::size_t(std::max(0.0, rank - 1))];
}

}  // namespace

double area_metric(std::vector<double> first, std::vector<double> second) {
  first = sorted(std::move(first));
  second = sorted(std::move(second));
  if (first.empty() || second.empty()) return not_known;
  double area = 0, at = std::min(first.front(), second.front());
  std::size_t a = 0, b = 0;
  while (a < first.size() || b < second.size()) {
    const double next = a == first.size()    ? second[b]
                        : b == second.size() ? first[a]
                                             : std::min(first[a], second[b]);
    area += (next - at) * std::abs(double(a) / double(first.size()) - double(b) / double(second.size()));
    at = next;
    while (a < first.size() && first[a] == next) ++a;
    while (b < second.size() && second[b] == next) ++b;
  }
  return area;
}

namespace {

PerDataSet<std::vector<double>> displacements(const ComparedParticles& last) {
  PerDataSet<std::vector<double>> u;
  for (std::size_t k = 0; k < last.X.size(); ++k) {
    u[0].push_back(last.u_first[k].norm());
    u[1].push_back(last.u_second[k].norm());
  }
  return u;
}

}  // namespace

DistributionMeasures measure_distributions(const ComparedParticles& last) {
  PerDataSet<std::vector<double>> u = displacements(last);
  return {area_metric(std::move(u[0]), std::move(u[1])), area_metric(last.dev_first, last.dev_second)};
}

ComparisonTable distribution_table(const ComparedParticles& last, const std::string& unit) {
  PerDataSet<std::vector<double>> u = displacements(last);
  struct Source {
    std::string name, unit;
    std::vector<double> values;
  };
  const std::vector<Source> sources{{"displacement_first", unit, sorted(std::move(u[0]))},
                                    {"displacement_second", unit, sorted(std::move(u[1]))},
                                    {"strain_dev_first", "1", sorted(last.dev_first)},
                                    {"strain_dev_second", "1", sorted(last.dev_second)}};
  ComparisonTable table{"distribution",
                        "values that a share of the compared particles does not exceed at the last common time (nearest "
                        "rank)",
                        {{"share", "1", {}}}};
  for (int k = 0; k <= 100; ++k) table.columns[0].values.push_back(k / 100.0);
  for (const Source& source : sources) {
    ComparisonTable::Column& column = table.columns.emplace_back();
    column.name = source.name;
    column.unit = source.unit;
    for (int k = 0; k <= 100; ++k) column.values.push_back(level(source.values, k / 100.0));
  }
  return table;
}

}  // namespace pivnp::compare
