#include "apps/report/document/tables.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "apps/report/content/ends.hpp"
#include "apps/report/words/summary.hpp"
#include "apps/report/words/words.hpp"
#include "compare/metrics/words.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

// Those with a limit are always among those that a reader asks for first.
bool leading(const Metric& m) {
  return compare::leads(m.name) || m.verdict == Verdict::met || m.verdict == Verdict::exceeded;
}

Table empty_metrics_table() {
  Table t;
  t.head = {"Metric", "Value", "Unit", "Verdict"};
  t.width = {0.44, 0.22, 0.06, 0.28};
  t.align = {'l', 'r', 'l', 'l'};
  return t;
}

void add_row(Table& t, const Metric& m, const DataSetNames& names) {
  t.rows.push_back({capitalised(metric_words(m.name, names)), value_with_uncertainty(m.value, m.uncertainty),
                    unit_words(m.unit), std::string(name_of(m.verdict))});
  t.marked.push_back(m.verdict == Verdict::exceeded ? std::optional<std::size_t>(3) : std::nullopt);
}

}  // namespace

std::optional<Table> summary_table(const Content& content, const DataSetNames& names) {
  const std::vector<SummaryRow> rows = summary_rows(content);
  if (rows.empty()) return std::nullopt;
  Table t;
  t.caption = capitalised(names.difference()) +
              ". By chance: twice the standard uncertainty of the difference. In the row of the displacement both data sets "
              "show their means over the particles.";
  t.head = {"", capitalised(names.first), capitalised(names.second), "Difference", "By chance", "Verdict"};
  t.width = {0.32, 0.13, 0.13, 0.13, 0.11, 0.18};
  t.align = {'l', 'r', 'r', 'r', 'r', 'l'};
  for (const SummaryRow& row : rows) {
    double largest = std::abs(row.difference);
    for (const double v : {row.first, row.second})
      if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
    const DisplayUnit unit = display_unit(row.unit, largest);
    const auto cell = [&](double v, int digits) {
      return std::isfinite(v) ? significant(v * unit.factor, digits) + unit_suffix(unit.name) : std::string("\u2013");
    };
    const bool known = row.judgement() != Told::not_known;
    t.rows.push_back({row.quantity, cell(row.first, 3), cell(row.second, 3), cell(row.difference, 3),
                      known ? cell(2 * row.uncertainty, 2) : "not known", row.verdict()});
    t.marked.push_back(row.limit == Verdict::exceeded ? std::optional<std::size_t>(5) : std::nullopt);
  }
  return t;
}

Table leading_metrics_table(const Content& content, const DataSetNames& names) {
  Table t = empty_metrics_table();
  t.caption = "Metrics, " + names.difference() +
              "; \u00b1: standard uncertainty of the value. All metrics and their definitions stand at the end of the "
              "report.";
  for (const Metric& m : content.comparison->metrics)
    if (leading(m)) add_row(t, m, names);
  return t;
}

Table metrics_table(const Content& content, const DataSetNames& names) {
  Table t = empty_metrics_table();
  t.caption = "Metrics of the comparison with their definitions, under the names of the record" +
              std::string(names.alike ? "" : "; first: measured, second: simulated") +
              ". \u00b1: standard uncertainty of the value.";
  for (const Metric& m : content.comparison->metrics) {
    add_row(t, m, names);
    t.notes.push_back(m.name + ": " + m.definition);
  }
  return t;
}

std::optional<Table> ends_table(const Content& content, const DataSetNames& names) {
  Table t;
  t.caption = "Particles that ended before the last frame, by reason.";
  t.head = {"Data set", "Reason", "Particles", "Share", "First", "Median", "Last (" + content.time_unit + ")"};
  t.width = {0.12, 0.38, 0.12, 0.1, 0.09, 0.09, 0.1};
  t.align = {'l', 'l', 'r', 'r', 'r', 'r', 'r'};
  for (const auto& [motion, name] :
       {std::pair{content.measured.get(), names.first}, {content.simulated.get(), names.second}}) {
    if (motion == nullptr) continue;
    for (const Ends& e : ends_by_reason(motion->particles()))
      t.rows.push_back({name, words(e.reason), std::to_string(e.particles),
                        percent(double(e.particles) / double(motion->particles().size())), plain(e.first),
                        plain(e.median), plain(e.last)});
  }
  if (t.rows.empty()) return std::nullopt;
  return t;
}

}  // namespace pivnp::report
