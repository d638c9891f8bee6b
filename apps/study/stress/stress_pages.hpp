// Survival maps as a page.
#pragma once

#include <string>
#include <vector>

#include "apps/report/document/document.hpp"
#include "apps/study/stress/survival_map.hpp"

namespace pivnp::app {

/// What fails silently in one sentence a map and in all, and the maps.
report::Document stress_document(const std::vector<SurvivalMap>& maps, const std::string& subject);

/// Of all maps of a stage: piv, np, mpm, compare.
Survival total_of(const std::vector<SurvivalMap>& maps, const std::string& stage);

/// "Wrong and flagged: 99.1 % (asked: 97) ...": of maps whose results have errors of their own to be flagged.
std::string flags_sentence(const Survival& total);

}  // namespace pivnp::app
