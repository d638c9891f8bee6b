// What the metrics of a family share: the times they are of, and what single members have of their own.
#pragma once

#include <map>
#include <string>

#include "compare/metrics/facts.hpp"
#include "compare/metrics/findings.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

/// All times together, or the last alone.
struct Span {
  const char *suffix, *words;
  bool last;

  const Tally& tally(const Findings& f) const { return last ? f.last() : f.total(); }
  std::string when(const Findings& f) const {
    return ", " + (last ? f.at_end : std::string("over all common particles and times"));
  }
};
inline constexpr Span all_times{"", "", false}, last_time{"_final", ", at the end", true};

/// By the metric's name.
struct Own {
  const char* limit;
  Leads leads;
};
using OwnFacts = std::map<std::string, Own>;

/// The family's facts, with what the member has of its own.
inline MetricFacts with_own(MetricFacts facts, const OwnFacts& members) {
  if (const auto at = members.find(facts.name); at != members.end()) {
    facts.limit = at->second.limit;
    facts.leads = at->second.leads;
  }
  return facts;
}

/// How far random errors of a mean are shared, for notes.
inline std::string shared_over(const Findings& f) {
  return number(f.differences.correlation_length()) + " " + f.length_unit +
         " (or further, by a jackknife over 4 x 4 blocks of the differences)";
}

/// Standard uncertainties that tell a mean or a root mean square apart.
inline double two(std::size_t) { return 2; }

}  // namespace pivnp::compare
