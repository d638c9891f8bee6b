// Which runs a sweep consists of.
#pragma once

#include <string>
#include <vector>

#include "apps/study/sweep/sweep.hpp"

namespace pivnp::app {

struct Variation {
  std::vector<std::string> keys;    // all take the same value
  std::vector<std::string> values;  // as TOML
  std::string own;                  // the case's value of the first key, as TOML; empty: left out there
  const std::string& name() const { return keys.front(); }
};

/// "KEY+KEY=VALUE,VALUE"; commas within brackets or quotation marks belong to a value. Throws InputError naming the text.
Variation parse_variation(const std::string& text);

/// The case's value of a key as the file has it; empty where it is left out.
std::string value_in(const Case& c, const std::string& key);

/// The runs, their values and labels filled in: the case's own and each value of each key alone, without those that equal the case's; or
/// all combinations.
std::vector<SweepRun> plan_sweep(const std::vector<Variation>& variations, bool grid);

/// "KEY=VALUE" of what a run changes.
std::vector<std::string> keys_of(const SweepRun& run, const std::vector<Variation>& variations);

}  // namespace pivnp::app
