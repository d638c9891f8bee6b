// `pivnp frontier`: speed against accuracy, on drawn texture or on a scene of one's own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/study/frontier/front.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

struct FrontierOptions {
  bool piv = true, np = true, mpm = true, chain = true;  // stages, where there is something for them
  int repeats = 3;                                       // of what takes less than long_work_s
  int drawn_px = 512;                                    // side of the drawn frames without a case; twice that beside other programs
  double column_cell_px = 10;                            // cells of the column without a case
};

struct FrontierOutcome {
  std::vector<FrontierStage> stages;
  std::vector<std::filesystem::path> files;  // pages first
  std::vector<std::string> sentences;        // what to change
  std::vector<std::string> remarks;          // what else was seen, and what could not be measured
};

/// Measures the settings and writes frontier.html, frontier.pdf, frontier.h5 and, of each stage, STAGE.csv, .svg and .png into
/// settings.out. `c` null: on drawn scenes. Throws InputError where a case has nothing to measure.
FrontierOutcome frontier(const Case* c, const FrontierOptions& options, const RunSettings& settings, Progress& progress);

}  // namespace pivnp::app
