// The verdict: how far the two data sets are apart.
#pragma once

#include <string>

#include "apps/report/content/content.hpp"
#include "apps/report/content/differences.hpp"
#include "apps/report/content/quality.hpp"
#include "apps/report/words/data_sets.hpp"

namespace pivnp::report {

/// A short paragraph on how far simulation and measurement are apart against what the measurement knows; without a
/// comparison, on what was measured or simulated. Never says that a simulation is right.
/// What was compared, and how much of it: one sentence; empty where no motions were compared.
std::string basis(const Content& content, const DataSetNames& names);

std::string verdict(const Content& content, const DataSetNames& names, const std::vector<PairQuality>& pairs,
                    const DifferenceCurve& differences);

}  // namespace pivnp::report
