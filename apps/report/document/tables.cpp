#include "apps/report/document/tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "apps/report/content/ends.hpp"
#include "apps/report/content/metric_layout.hpp"
#include "apps/report/words/summary.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

// The words of a family: those of a member without what tells it from the others.
std::string family_words(const std::string& member, const DataSetNames& names, const std::vector<std::string>& parts) {
  std::string text = metric_words(member, names);
  for (const std::string& part : parts)
    if (const std::size_t at = text.find(", " + part); at != std::string::npos) {
      text.erase(at, part.size() + 2);
      break;
    }
  for (const auto& [from, to] : {std::pair<std::string_view, std::string_view>{", in units of its uncertainty", " \u00f7 u"},
                                 {", relative to the greatest displacement", ", relative"}, {"decomposition of the ", "decomposed "}, {", difference", ""}, {" difference", ""}})
    if (const std::size_t at = text.find(from); at != std::string::npos) text.replace(at, from.size(), to);
  return capitalised(text);
}

std::string with_unit(const std::string& words, const Metric& m) {
  std::string unit = unit_words(m.unit);
  if (const std::size_t at = unit.find("^2"); at != std::string::npos) unit.replace(at, 2, "\u00b2");
  return unit.empty() ? words : words + " (" + unit + ")";
}

// The value, and what is said of it: a sign for its verdict, the limit's fate in words.
std::string cell(const Metric* m) {
  if (m == nullptr) return "";
  std::string text = value_with_uncertainty(m->value, m->uncertainty);
  if (m->verdict == Verdict::agrees) text += "\u00a0=";
  if (m->verdict == Verdict::not_resolved) text += "\u00a0\u00b0";
  if (m->limit != LimitFate::none) text += "\u00a0(" + std::string(name_of(m->limit)) + ")";
  return text;
}

template <class Members>
std::optional<std::size_t> exceeded(const Members& members) {
  for (std::size_t k = 0; k < members.size(); ++k)
    if (members[k] != nullptr && members[k]->limit == LimitFate::exceeded) return k + 1;
  return std::nullopt;
}

constexpr std::string_view signs = " \u00b1: standard uncertainty of the value; =: agrees; \u00b0: not resolved; (met), (exceeded): its limit.";

std::string without(std::string text, const std::string& part) {
  const std::size_t at = text.find(part);
  return at == std::string::npos ? text : text.erase(at, part.size());
}

}  // namespace

std::optional<Table> summary_table(const Content& content, const DataSetNames& names) {
  const std::vector<SummaryRow> rows = summary_rows(content);
  if (rows.empty()) return std::nullopt;
  Table t;
  t.caption = capitalised(names.difference()) +
              ". Counts from: the difference that would be more than the uncertainties that are known. In the row of the "
              "displacement both data sets show their means over the particles.";
  t.head = {"", capitalised(names.first), capitalised(names.second), "Difference", "Counts from", "Verdict"};
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
    t.rows.push_back({row.quantity, cell(row.first, 3), cell(row.second, 3), cell(row.difference, 3),
                      row.counts_from() > 0 ? cell(row.counts_from(), 2) : "not known", row.words()});
    t.marked.push_back(row.limit == LimitFate::exceeded ? std::optional<std::size_t>(5) : std::nullopt);
  }
  return t;
}

std::optional<Table> runs_table(const Content& content) {
  std::vector<const Run*> runs;
  for (const Run& run : content.runs)
    if (!run.metrics.empty() && runs.size() < 5) runs.push_back(&run);
  if (runs.size() < 2) return std::nullopt;
  Table t;
  t.caption = "Runs beside each other: of each, its second data set minus its first. \u00b1: standard uncertainty.";
  t.head = {"Difference"};
  t.width = {0.25};
  t.align = {'l'};
  std::vector<std::string> quantities, units;
  std::vector<std::vector<SummaryRow>> rows;
  for (const Run* run : runs) {
    t.head.push_back(run->name);
    t.width.push_back(0.75 / double(runs.size()));
    t.align.push_back('r');
    Content alone;
    alone.comparison.emplace().metrics = run->metrics;
    rows.push_back(summary_rows(alone));
    for (const SummaryRow& row : rows.back())
      if (std::find(quantities.begin(), quantities.end(), row.quantity) == quantities.end())
        quantities.push_back(row.quantity), units.push_back(row.unit);
  }
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    t.rows.push_back({unit_words(units[q]).empty() ? quantities[q] : quantities[q] + " (" + units[q] + ")"});
    for (const auto& list : rows) {
      const auto at = std::find_if(list.begin(), list.end(), [&](const SummaryRow& row) { return row.quantity == quantities[q]; });
      t.rows.back().push_back(at == list.end() ? "\u2013" : value_with_uncertainty(at->difference, at->uncertainty));
    }
  }
  return t;
}

std::vector<Table> metrics_tables(const Content& content, const DataSetNames& names) {
  const MetricLayout layout = layout_of(content.comparison->metrics);
  std::vector<Table> tables;
  if (!layout.statistics.empty()) {
    Table t;
    t.fine = true;
    t.caption = "Differences over the particles, " + names.difference() +
                ". \u00f7 u: each divided by its own standard uncertainty; relative: by the greatest displacement. Without \u201cat the end\u201d: over all times." +
                std::string(signs);
    t.head = {"Difference of", "Mean (in x)", "Mean in y", "RMS", "95th percentile", "Maximum"};
    t.width = {0.26, 0.148, 0.148, 0.148, 0.148, 0.148};
    t.align = {'l', 'r', 'r', 'r', 'r', 'r'};
    for (const StatisticsRow& row : layout.statistics) {
      const Metric& any = row.any();
      t.rows.push_back({with_unit(family_words(any.name, names, {"RMS", "mean in x", "mean in y", "mean", "95th percentile", "maximum"}), any)});
      for (const Metric* m : row.members) t.rows.back().push_back(cell(m));
      t.marked.push_back(exceeded(row.members));
    }
    tables.push_back(std::move(t));
  }
  if (!layout.both.empty()) {
    Table t;
    t.fine = true;
    t.caption = "Quantities of both data sets." + std::string(signs);
    t.head = {"Quantity", capitalised(names.first), capitalised(names.second), capitalised(names.difference())};
    t.width = {0.46, 0.18, 0.18, 0.18};
    t.align = {'l', 'r', 'r', 'r'};
    for (const BothRow& row : layout.both) {
      const Metric& any = row.any();
      t.rows.push_back({with_unit(family_words(any.name, names, {names.second + " \u2212 " + names.first, names.first, names.second}), any),
                        cell(row.first), cell(row.second), cell(row.difference)});
      t.marked.push_back(exceeded(std::array{row.first, row.second, row.difference}));
    }
    tables.push_back(std::move(t));
  }
  if (!layout.single.empty()) {  // in two columns, read downwards
    Table t;
    t.fine = true;
    t.caption = "What remains, one by one." + std::string(signs);
    t.head = {"Metric", "Value", "Metric", "Value"};
    t.width = {0.36, 0.14, 0.36, 0.14};
    t.align = {'l', 'r', 'l', 'r'};
    const std::size_t n = layout.single.size(), rows = (n + 1) / 2;
    for (std::size_t r = 0; r < rows; ++r) {
      t.rows.emplace_back();
      t.marked.push_back(std::nullopt);
      for (const std::size_t k : {r, r + rows}) {
        const Metric* m = k < n ? layout.single[k] : nullptr;
        t.rows.back().push_back(m != nullptr ? with_unit(capitalised(metric_words(m->name, names)), *m) : "");
        t.rows.back().push_back(cell(m));
        if (m != nullptr && m->limit == LimitFate::exceeded) t.marked.back() = k == r ? 1u : 3u;
      }
    }
    tables.push_back(std::move(t));
  }
  return tables;
}

Definitions metric_definitions(const Content& content) {
  const MetricLayout layout = layout_of(content.comparison->metrics);
  Definitions d;
  std::set<std::string> told;
  const auto tell = [&](const std::string& name, const std::string& definition) {
    if (told.insert(name).second) d.items.emplace_back(name, definition);
  };
  for (const StatisticsRow& row : layout.statistics) {
    const std::string base = without(without(without(row.stem, "_over_u"), "_relative"), "_final");
    tell(base, row.any().definition);
  }
  for (const BothRow& row : layout.both) tell(row.stem, row.any().definition);
  for (const Metric* m : layout.single) tell(without(m->name, "_final"), m->definition);
  // Of the three decomposed fields the first stands for all.
  std::set<std::string> kinds;
  std::erase_if(d.items, [&](const auto& item) {
    return item.first.starts_with("decomposition_") && !kinds.insert(item.first.substr(item.first.rfind('_'))).second;
  });
  return d;
}

std::optional<Table> ends_table(const Content& content, const DataSetNames& names) {
  Table t;
  t.fine = true;
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
