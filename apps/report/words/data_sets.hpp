// What a report calls the two data sets that it shows beside each other.
#pragma once

#include <string>

#include "apps/report/content/content.hpp"

namespace pivnp::report {

/// An experiment D and a simulation S, as in ASME V&V 20; or a first and a second one, where nothing says that one was
/// measured and the other simulated.
struct DataSetNames {
  bool alike = false;         // a first and a second
  std::string first, second;  // before a noun: "measured", "simulated"
  std::string the_first, the_second;  // as a noun: "the measurement", "the simulation"
  /// "simulated minus measured".
  std::string difference() const { return second + " minus " + first; }
};

/// Like with like: two histories; two motions, the first not called np or the second likewise, of which both know their
/// error, or neither does, or the second only.
DataSetNames data_set_names(const Content& content);

/// With a capital first letter.
std::string capitalised(std::string text);

}  // namespace pivnp::report
