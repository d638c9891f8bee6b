// `pivnp stress`: where methods fail.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/settings.hpp"
#include "apps/study/stress/survival_map.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

struct StressOptions {
  bool piv = true, mpm = true;  // stages
  int seeds = 1;                // pairs of frames a combination
};

struct StressOutcome {
  std::vector<SurvivalMap> maps;
  std::vector<std::filesystem::path> files;  // pages first
  std::vector<std::string> sentences;
};

/// Draws survival maps: of image correlation with the case's [piv] (`c` null: the default), and of the simulation's schemes. Writes
/// stress.html, stress.pdf, stress.h5 and, of each map, NAME.csv, .svg and .png into settings.out.
StressOutcome stress(const Case* c, const StressOptions& options, const RunSettings& settings, Progress& progress);

/// A map as CSV: a row a combination.
std::string csv(const SurvivalMap& map);

}  // namespace pivnp::app
