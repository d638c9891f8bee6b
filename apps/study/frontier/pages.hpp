// The frontier as a page.
#pragma once

#include <string>
#include <vector>

#include "apps/report/document/document.hpp"
#include "apps/study/frontier/front.hpp"

namespace pivnp::app {

/// The processor's name, as the system has it.
std::string processor();

/// What to change, a chart and a table a stage, and how it was measured.
report::Document frontier_document(const std::vector<FrontierStage>& stages, const std::string& subject, int threads);

}  // namespace pivnp::app
