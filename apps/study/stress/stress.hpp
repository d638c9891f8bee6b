// `pivnp stress`: where methods fail.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "apps/study/stress/survival_map.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

/// Stages, by the names that --stages and the maps' files have.
inline constexpr std::array stress_stages{"piv", "np", "mpm", "compare"};

struct StressOptions {
  std::vector<std::string> stages = {};  // of stress_stages; empty: all
  std::vector<std::string> maps = {};    // names of maps; empty: all of the stages
  int seeds = 1;                         // pairs of frames a combination
  bool in_short = false;                 // every second level, and smaller frames
};

struct StressOutcome {
  std::vector<SurvivalMap> maps;
  std::vector<std::filesystem::path> files;  // pages first
  std::vector<std::string> sentences;
  std::size_t combinations = 0, kept = 0;  // all, and those that a run that was stopped had finished
};

/// Draws survival maps: of image correlation with the case's [piv] (`c` null: the default) on drawn texture and on that of its frames, of
/// numerical particles with its [np], of the simulation's schemes, and of the comparison's verdicts. Writes stress.html, stress.pdf,
/// stress.h5 and, of each map, NAME.csv, .svg and .png into settings.out. While it runs, finished combinations are kept in
/// stress.part there: a run that was stopped goes on with them. Throws InputError for a stage or map that there is not, and Interrupted.
StressOutcome stress(const Case* c, const StressOptions& options, const RunSettings& settings, Progress& progress);

/// A map as CSV: a row a combination.
std::string csv(const SurvivalMap& map);

}  // namespace pivnp::app
