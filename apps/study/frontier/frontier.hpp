// `pivnp frontier`: speed against accuracy, on drawn texture or on a scene of one's own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/study/frontier/front.hpp"
#include "apps/study/pipeline/settings.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

struct FrontierOptions {
  bool piv = true, mpm = true;  // stages, where there is something for them
  int repeats = 3;              // of each pair by each setting of [piv]
};

struct FrontierOutcome {
  std::vector<FrontierStage> stages;
  std::vector<std::filesystem::path> files;  // pages first
  std::vector<std::string> sentences;        // what to change
  std::vector<std::string> remarks;          // what else was seen, and what could not be measured
};

/// Measures the settings and writes frontier.html, frontier.pdf, frontier.h5 and, of each stage, STAGE.csv, .svg and .png into
/// settings.out. `c` null: image correlation on drawn texture alone. Throws InputError where a case has nothing to measure.
FrontierOutcome frontier(const Case* c, const FrontierOptions& options, const RunSettings& settings, Progress& progress);

/// A stage as CSV: a row a point.
std::string csv(const FrontierStage& stage);

}  // namespace pivnp::app
