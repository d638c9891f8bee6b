// What was flagged.
#pragma once

#include <string>
#include <vector>

#include "apps/report/content/content.hpp"
#include "apps/report/content/quality.hpp"
#include "apps/report/words/data_sets.hpp"

namespace pivnp::report {

/// Remarks of the run, then what the data show: flagged steps, pairs short of valid vectors, particles that ended. One
/// sentence each; empty if nothing was flagged.
std::vector<std::string> flags(const Content& content, const DataSetNames& names, const std::vector<PairQuality>& pairs);

}  // namespace pivnp::report
