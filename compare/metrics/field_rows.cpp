// Metrics of whole fields: pressure, distributions, decompositions, increments.
#include <cmath>

#include "compare/metrics/rows.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

// Of water in the pores, where both know it. No data set states what its pressures are uncertain by.
void add_pressure(Registry<MetricRow>& rows) {
  struct Statistic {
    const char *name, *words, *definition;
    double (*value)(const ScalarStatistics&);
    Leads leads;
  };
  static constexpr Statistic statistics[] = {
      {"bias", "mean", "mean of pore pressure of the second minus that of the first", [](const ScalarStatistics& s) { return s.bias(); }, Leads::no},
      {"rms", "RMS", "root mean square of pore pressure of the second minus that of the first", [](const ScalarStatistics& s) { return s.rms(); }, Leads::yes},
      {"p95", "95th percentile", "95th percentile (nearest rank) of the size of pore pressure of the second minus that of the first",
       [](const ScalarStatistics& s) { return s.p95(); }, Leads::no},
      {"max", "maximum", "greatest size of pore pressure of the second minus that of the first", [](const ScalarStatistics& s) { return s.max(); },
       Leads::no}};
  for (const bool last : {false, true})
    for (const Statistic& s : statistics)
      rows.add({{.name = std::string("pressure_") + s.name + (last ? "_final" : ""), .unit = "Pa", .definition = s.definition,
                 .words = std::string("pore pressure, difference, ") + s.words + (last ? ", at the end" : ""),
                 .leads = last ? Leads::no : s.leads},
                [s, last](const Findings& f) -> std::optional<MetricValue> {
                  const ScalarStatistics& d = last ? f.pressures.last() : f.pressures.total();
                  if (d.count() == 0) return std::nullopt;
                  return difference(s.value(d), not_known, ", " + (last ? f.at_end : std::string("over all common particles and times")) + "; uncertainty not known");
                }});
  static constexpr const char *suffix[] = {"_first", "_second"}, *of[] = {"first", "second"}, *words[] = {"measured", "simulated"};
  for (std::size_t k = 0; k < 2; ++k)
    rows.add({{.name = std::string("pressure_peak") + suffix[k], .unit = "Pa",
               .definition = "greatest size of pore pressure of the " + std::string(of[k]) + ", over all common particles and times",
               .words = "pore pressure, greatest size, " + std::string(words[k])},
              [k](const Findings& f) -> std::optional<MetricValue> {
                if (f.pressures.total().count() == 0) return std::nullopt;
                return MetricValue{f.pressures.greatest(k)};
              }});
}

void add_distributions(Registry<MetricRow>& rows) {
  const std::string how =
      ", over the compared particles at the last common time: area between the cumulative distributions of both data sets";
  // Errors e of the values change the area by at most the mean of |e|.
  const auto by = [](double u, const char* what) {
    return std::isnan(u) ? std::string("; uncertainty not known")
                         : "; uncertainty: " + std::string(what) +
                               ", a bound (errors move the area by at most their mean size)";
  };
  rows.add({{.name = "area_metric_displacement", .unit = "L", .definition = "of |u|" + how,
             .words = "area metric of the displacement", .leads = Leads::yes},
            [by](const Findings& f) {
              const double u = f.last().displacement.rms_uncertainty();
              return difference(f.distributions.displacement_area, u, by(u, "u_val"));
            }});
  rows.add({{.name = "area_metric_strain_dev", .unit = "1", .definition = "of deviatoric log strain" + how,
             .words = "area metric of the deviatoric strain"},
            [by](const Findings& f) -> std::optional<MetricValue> {
              if (!std::isfinite(f.distributions.strain_dev_area)) return std::nullopt;
              const double u = f.last().dev_uncertainty();
              return difference(f.distributions.strain_dev_area, u, by(u, f.strain.empty() ? "the noise floor" : "u_val of the strain"));
            }});
}

const FieldDecomposition* find(const Findings& f, std::string_view field) {
  for (const FieldDecomposition& d : f.decompositions)
    if (d.field.name == field) return &d;
  return nullptr;
}

void add_decomposition(Registry<MetricRow>& rows, const DecomposedField& field) {
  const std::string prefix = "decomposition_" + std::string(field.name) + "_", of = definition_of(field),
                    subject = "decomposition of the " + std::string(field.words) + ", ", unit(field.unit);
  using Value = std::function<MetricValue(const FieldDecomposition&)>;
  const auto add = [&](const char* name, const std::string& in, const std::string& definition, const char* what,
                       const Value& value) {
    rows.add({{.name = prefix + name, .unit = in, .definition = definition, .words = subject + what},
              [name = field.name, value](const Findings& f) -> std::optional<MetricValue> {
                const FieldDecomposition* d = find(f, name);
                if (d == nullptr) return std::nullopt;
                return value(*d);
              }});
  };
  add("terms", "1", "number of coefficients" + of, "coefficients",
      [](const FieldDecomposition& d) { return MetricValue{double(d.of.first.size())}; });
  add("outside", "1",
      "share of the coefficients that leave the band s_second = s_first +- 2 u(s); u(s)^2 = u^2 + residual_first^2, u the "
      "field's own standard uncertainty where known" +
          of + "; uncertainty: half the change when the band's edge moves by u(s) both ways",
      "share of coefficients outside the band", [](const FieldDecomposition& d) {
        return MetricValue{d.of.outside(), (d.of.outside(1) - d.of.outside(3)) / 2};
      });
  add("distance", unit, "distance of both data sets' coefficients (root of the sum of squares)" + of,
      "distance of the coefficients", [](const FieldDecomposition& d) {
        double square = 0;
        for (std::size_t k = 0; k < d.of.first.size(); ++k)
          square += (d.of.second[k] - d.of.first[k]) * (d.of.second[k] - d.of.first[k]);
        const bool known = std::isfinite(d.u);
        return difference(std::sqrt(square), known ? d.of.uncertainty : not_known,
                          known ? "; uncertainty: u(s)" : "; uncertainty not known", greatest_factor(d.of.first.size()));
      });
  add("residual_first", unit, "RMS of field minus reconstruction of the first," + of, "residual, measured",
      [](const FieldDecomposition& d) { return MetricValue{d.of.residual_first}; });
  add("residual_second", unit, "RMS of field minus reconstruction of the second," + of, "residual, simulated",
      [](const FieldDecomposition& d) { return MetricValue{d.of.residual_second}; });
  add("cluster_first", "1",
      "largest share of neighbouring points that the first's reconstruction misses by more than three residuals (above "
      "0.003 the reconstruction is not adequate)" +
          of,
      "share of the greatest cluster of residuals, measured",
      [](const FieldDecomposition& d) { return MetricValue{d.of.cluster_first}; });
  add("cluster_second", "1",
      "largest share of neighbouring points that the second's reconstruction misses by more than three residuals (above "
      "0.003 the reconstruction is not adequate)" +
          of,
      "share of the greatest cluster of residuals, simulated",
      [](const FieldDecomposition& d) { return MetricValue{d.of.cluster_second}; });
}

void add_increments(Registry<MetricRow>& rows) {
  const std::string over = " of |d(u_second - u_first)| over particles and steps between consecutive common times";
  const auto where = [](const Findings& f) {
    const std::vector<double>& circle = f.rates().outside();
    return circle.empty() ? std::string()
                          : ", material positions further than " + number(circle[2]) + " " + f.length_unit + " from (" +
                                number(circle[0]) + ", " + number(circle[1]) + ")";
  };
  const auto quantile = [&](const std::string& name, const std::string& words, double q, Leads leads) {
    rows.add({{.name = "increment_" + name, .unit = "L", .definition = words + over, .words = "increment, " + words,
               .leads = leads},
              [=](const Findings& f) -> std::optional<MetricValue> {
                const double value = f.rates().increment(q);
                if (!std::isfinite(value)) return std::nullopt;
                return MetricValue{value, not_known, where(f)};
              }});
  };
  quantile("median", "median", 0.5, Leads::yes);
  quantile("p95", "95th percentile", 0.95, Leads::no);
  rows.add({{.name = "increment_median_relative", .unit = "1",
             .definition = "increment_median over the mean increment of the reference material in the first data set",
             .words = "increment, median, relative to the reference material\u2019s", .leads = Leads::yes},
            [](const Findings& f) -> std::optional<MetricValue> {
              const std::size_t steps = f.differences.times().size() - 1;
              const double median = f.rates().increment(0.5);
              const double reference = f.last().frame[0].motion.shift.norm() / double(steps);
              if (!std::isfinite(median) || !(reference > 0)) return std::nullopt;
              return MetricValue{median / reference};
            }});
}

}  // namespace

void add_field_rows(Registry<MetricRow>& rows) {
  add_pressure(rows);
  add_distributions(rows);
  for (const DecomposedField& field : decomposed_fields) add_decomposition(rows, field);
  add_increments(rows);
}

}  // namespace pivnp::compare
