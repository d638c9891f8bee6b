#include "compare/metrics/words.hpp"

#include <algorithm>

#include "compare/metrics/rows.hpp"

namespace pivnp::compare {

namespace {

const std::string history = "history", point = "point_";

// "point_3" of "point_3_onset_first", with the rest's place; 0: no name of a material point.
std::size_t point_length(std::string_view name) {
  if (!name.starts_with(point)) return 0;
  const std::size_t end = name.find_first_not_of("0123456789", point.size());
  return end == std::string_view::npos || end == point.size() || name[end] != '_' ? 0 : end;
}

}  // namespace

std::optional<KnownMetric> known_metric(std::string_view name) {
  KnownMetric known;
  known.levelled = name.starts_with(levelled_prefix);
  if (known.levelled) name.remove_prefix(levelled_prefix.size());
  known.facts = metric_rows().find(name);
  if (known.facts != nullptr) return known;
  const std::size_t length = name.starts_with(history + "_") ? history.size() : point_length(name);
  if (length == 0) return std::nullopt;
  known.facts = history_metric_rows().find(name.substr(length + 1));
  if (known.facts == nullptr) return std::nullopt;
  known.subject = name.substr(0, length);
  std::replace(known.subject.begin(), known.subject.end(), '_', ' ');
  return known;
}

std::string words_of(std::string_view metric) {
  const auto known = known_metric(metric);
  if (!known) {
    std::string words(metric);
    std::replace(words.begin(), words.end(), '_', ' ');
    return words;
  }
  return (known->subject.empty() ? "" : known->subject + ", ") + known->facts->words +
         (known->levelled ? ", levelled" : "");
}

std::string limit_of(std::string_view metric) {
  const auto known = known_metric(metric);
  const bool held = known && !known->levelled && (known->subject.empty() || known->subject == history);
  return held ? known->facts->limit : "";
}

bool leads(std::string_view metric) {
  const auto known = known_metric(metric);
  if (!known || (!known->subject.empty() && known->subject != history)) return false;
  return known->levelled ? known->facts->leads == Leads::levelled_too : known->facts->leads != Leads::no;
}

}  // namespace pivnp::compare
