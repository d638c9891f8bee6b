#include "compare/measures/distribution.hpp"

#include <algorithm>
#include <cmath>

#include "compare/data/statistics.hpp"
#include "compare/measures/judged.hpp"

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

void add_distributions(const Snapshot& last, double u_displacement, double u_strain, const std::string& unit,
                       Comparison& out) {
  std::vector<double> u1, u2;
  for (std::size_t k = 0; k < last.X.size(); ++k) {
    u1.push_back(last.u_first[k].norm());
    u2.push_back(last.u_second[k].norm());
  }
  const std::string how =
      ", over the compared particles at the last common time: area between the cumulative distributions of both sides";
  const auto by = [](double u, const char* what) {
    return std::isnan(u) ? std::string("; uncertainty not known")
                         : "; uncertainty: " + std::string(what) + ", a bound (errors move the area by at most their "
                           "mean size)";
  };
  out.metrics.push_back(difference_metric("area_metric_displacement", area_metric(u1, u2), unit, u_displacement,
                                          "of |u|" + how + by(u_displacement, "u_val")));
  if (const double strain = area_metric(last.dev_first, last.dev_second); std::isfinite(strain))
    out.metrics.push_back(difference_metric("area_metric_strain_dev", strain, "1", u_strain,
                                            "of deviatoric log strain" + how + by(u_strain, "the noise floor")));
  ColumnTable table{"distribution", "values that a share of the compared particles does not exceed at the last common "
                    "time (nearest rank)", {{"share", "1", {}}, {"displacement_first", unit, {}},
                    {"displacement_second", unit, {}}, {"strain_dev_first", "1", {}}, {"strain_dev_second", "1", {}}}};
  const std::vector<std::vector<double>> columns{sorted(u1), sorted(u2), sorted(last.dev_first),
                                                 sorted(last.dev_second)};
  for (int k = 0; k <= 100; ++k) {
    table.columns[0].values.push_back(k / 100.0);
    for (std::size_t c = 0; c < columns.size(); ++c)
      table.columns[c + 1].values.push_back(level(columns[c], k / 100.0));
  }
  out.tables.push_back(std::move(table));
}

}  // namespace pivnp::compare
