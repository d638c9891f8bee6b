// Survival maps combination by combination, on all threads, and able to go on after a break.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "apps/study/stress/survival_map.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

struct FilledMaps {
  std::vector<SurvivalMap> maps;
  std::size_t combinations = 0, kept = 0;  // all, and those of an earlier run
};

/// Makes all combinations, `threads` at a time; the numbers do not depend on it. Each is appended to the file `kept` when it is
/// finished, and taken from there where the file has it from an earlier run of the same program with the same settings and levels (a
/// line that was cut off is made again). No path: nothing is kept. Throws Interrupted, and what a combination throws.
FilledMaps filled(const std::vector<MapPlan>& plans, const std::filesystem::path& kept, int threads, Progress& progress);

/// The plan with every second level of each axis of numbers, the first and the last among them: its short form.
MapPlan thinned(const MapPlan& plan);

}  // namespace pivnp::app
