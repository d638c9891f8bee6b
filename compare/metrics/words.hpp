// What is known of a metric by its name.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "compare/metrics/facts.hpp"

namespace pivnp::compare {

/// A metric of the simulation as it would have been measured bears the name of the other after this.
inline constexpr std::string_view levelled_prefix = "levelled_";

struct KnownMetric {
  const MetricFacts* facts = nullptr;
  std::string subject;  // of a history: "history", "point 1"; else empty
  bool levelled = false;
};
/// Nothing for a name that no row gives.
std::optional<KnownMetric> known_metric(std::string_view name);

/// displacement_rms -> "displacement, RMS"; of an unknown name its own words.
std::string words_of(std::string_view metric);
/// Key of [compare.limits] that holds the metric; empty: none.
std::string limit_of(std::string_view metric);
/// Whether the metric stands among those that a reader asks for first.
bool leads(std::string_view metric);

}  // namespace pivnp::compare
