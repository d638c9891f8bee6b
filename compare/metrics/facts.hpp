// What is known of a metric without a comparison.
#pragma once

#include <string>

namespace pivnp::compare {

/// Whether a metric stands among those that a reader asks for first, and whether it does so when it is levelled.
enum class Leads { no, yes, levelled_too };

struct MetricFacts {
  std::string name;        // as in the record
  std::string unit;        // L, T: the motions' units of length and time; V: that of a history's values
  std::string definition;  // one line, which the value's note ends; {}: the quantity of a history
  std::string words;       // for reports, in lower case
  std::string limit = "";  // key of [compare.limits] that holds it; empty: none
  Leads leads = Leads::no;
  bool levelled = false;   // also taken from the simulation as it would have been measured ("levelled_NAME")
};

}  // namespace pivnp::compare
