// What the report says in words: the verdict, and what was flagged.
#pragma once

#include <string>
#include <vector>

#include "apps/report/content/analysis.hpp"
#include "apps/report/content/content.hpp"

namespace pivnp::report {

/// A short paragraph on how far simulation and measurement are apart against what the measurement knows; without a
/// comparison, on what was measured or simulated. Never says that a simulation is right.
std::string verdict(const Content& content, const std::vector<PairQuality>& pairs,
                    const DifferenceHistory& differences);

/// Remarks of the run, then what the data show: flagged steps, pairs short of valid vectors, particles that ended. One
/// sentence each; empty if nothing was flagged.
std::vector<std::string> flags(const Content& content, const std::vector<PairQuality>& pairs);

}  // namespace pivnp::report
