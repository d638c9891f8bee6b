// A comparison as JSON, for scripts.
#pragma once

#include <string>

#include "apps/study/pipeline/scene/settings.hpp"

namespace pivnp::app {

/// One object: "record", "report" (null without), "exit_code"; "metrics", one object a metric by name: "value", "unit",
/// "uncertainty", of a difference also "within_95" (the least tolerance that two one-sided tests show), "seen_95" (the
/// difference that would have been found in 95 of 100 cases) and "verdict" (Verdict's names, null where the uncertainty is
/// not known), "lost_in" of one that is not resolved, "limit" ("met", "exceeded"); "limits" by key: "limit", "reached",
/// "verdict", "shown_95" (met by two one-sided tests); "remarks". What is not known is null.
std::string comparison_json(const RunOutcome& outcome, int exit_code);

}  // namespace pivnp::app
