// The metrics of a comparison: one row each, with all that anyone asks of it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compare/measures/history.hpp"
#include "compare/metrics/facts.hpp"
#include "compare/metrics/findings.hpp"
#include "compare/metrics/significance.hpp"
#include "pivnp/core/record/metric.hpp"
#include "pivnp/core/registry.hpp"

namespace pivnp::compare {

/// A metric and where it is read from; nothing where a comparison has no such value.
template <class Source>
struct MetricRowOf : MetricFacts {
  std::function<std::optional<MetricValue>(const Source&)> value;
};
using MetricRow = MetricRowOf<Findings>;
/// Of a history: its name and an underscore come before that of the row ("history_rms", "point_1_rms"). Limits hold
/// those of compared histories, not those of points.
using HistoryMetricRow = MetricRowOf<HistoryMeasures>;

/// In the order of the record.
Registry<MetricRow>& metric_rows();
Registry<HistoryMetricRow>& history_metric_rows();

/// Metrics of motions, those of material points last.
std::vector<Metric> metrics_of(const Findings& findings);
std::vector<Metric> metrics_of(const HistoryMeasures& measures);

// Parts of the registry, by what they are about.
void add_motion_rows(Registry<MetricRow>& rows);     // displacement, velocity, their uncertainty
void add_strain_rows(Registry<MetricRow>& rows);     // strain
void add_alignment_rows(Registry<MetricRow>& rows);  // coverage, frame of reference, grid convergence
void add_shape_rows(Registry<MetricRow>& rows);      // outline, slope, mobilised material, shear bands
void add_field_rows(Registry<MetricRow>& rows);      // pressure, distributions, decompositions, increments
void add_offset_rows(Registry<MetricRow>& rows);     // what was given to the second's clock and coordinates

/// Rows NAME_first and NAME_second, and NAME_difference where `facts` are asked to go on to it. `values(source)`: in this
/// order, fewer where the comparison lacks them. `facts` are the difference's; the other two have no limit.
enum class Variants { both, both_and_difference };
template <class Source, class Values>
void add_for_both(Registry<MetricRowOf<Source>>& rows, Variants variants, const MetricFacts& facts, Leads each_leads,
                  Values values) {
  struct Variant {
    const char *suffix, *definition, *words;
  };
  static constexpr Variant all[] = {{"_first", ", first", ", measured"},
                                    {"_second", ", second", ", simulated"},
                                    {"_difference", ", second minus first", ", simulated \u2212 measured"}};
  const std::size_t count = variants == Variants::both ? 2 : 3;
  for (std::size_t k = 0; k < count; ++k) {
    MetricFacts own = facts;
    own.name += all[k].suffix;
    own.definition += all[k].definition;
    own.words += all[k].words;
    if (k < 2) {
      own.limit = "";
      own.leads = each_leads;
    }
    rows.add({std::move(own), [values, k](const Source& source) -> std::optional<MetricValue> {
                std::vector<MetricValue> found = values(source);
                if (k >= found.size()) return std::nullopt;
                return std::move(found[k]);
              }});
  }
}

}  // namespace pivnp::compare
