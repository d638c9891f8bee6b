#include "apps/report/content/metric_layout.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace pivnp::report {

namespace {

// A member's part of its name, and its column.
constexpr std::pair<std::string_view, std::size_t> statistics[] = {
    {"_bias_x", 0}, {"_bias_y", 1}, {"_bias", 0}, {"_rms", 2}, {"_p95", 3}, {"_max", 4}};
constexpr std::pair<std::string_view, std::size_t> data_sets[] = {{"_first", 0}, {"_second", 1}, {"_difference", 2}};

struct Member {
  std::string stem;
  std::size_t column;
};

std::optional<Member> statistic_of(const std::string& name) {
  for (const auto& [part, column] : statistics) {
    const std::size_t at = name.find(part), end = at + part.size();
    if (at == std::string::npos || at == 0 || (end < name.size() && name[end] != '_')) continue;
    return Member{name.substr(0, at) + name.substr(end), column};
  }
  return std::nullopt;
}

std::optional<Member> data_set_of(const std::string& name) {
  for (const auto& [part, column] : data_sets)
    if (name.ends_with(part)) return Member{name.substr(0, name.size() - part.size()), column};
  return std::nullopt;
}

}  // namespace

const Metric& StatisticsRow::any() const {
  return members[2] != nullptr ? *members[2] : **std::find_if(members.begin(), members.end(), [](const Metric* m) { return m != nullptr; });
}

const Metric& BothRow::any() const { return difference != nullptr ? *difference : first != nullptr ? *first : *second; }

MetricLayout layout_of(const std::vector<Metric>& metrics) {
  using Find = std::optional<Member> (*)(const std::string&);
  // A family has two members at least: what stands alone is listed by itself.
  const auto count = [&](Find find) {
    std::map<std::string, int> members;
    for (const Metric& m : metrics)
      if (const auto member = find(m.name)) ++members[member->stem];
    return members;
  };
  const std::map<std::string, int> in_statistics = count(statistic_of), in_both = count(data_set_of);
  MetricLayout layout;
  const auto row_for = [](auto& rows, const std::string& stem) -> auto& {
    const auto at = std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return row.stem == stem; });
    if (at != rows.end()) return *at;
    rows.push_back({.stem = stem});
    return rows.back();
  };
  for (const Metric& m : metrics) {
    if (const auto member = statistic_of(m.name); member && in_statistics.at(member->stem) > 1) {
      row_for(layout.statistics, member->stem).members[member->column] = &m;
    } else if (const auto of = data_set_of(m.name); of && in_both.at(of->stem) > 1) {
      BothRow& row = row_for(layout.both, of->stem);
      (of->column == 0 ? row.first : of->column == 1 ? row.second : row.difference) = &m;
    } else {
      layout.single.push_back(&m);
    }
  }
  return layout;
}

}  // namespace pivnp::report
