#include "apps/study/stress/mpm/mpm_maps.hpp"

#include <utility>

#include "apps/study/stress/mpm/scenes.hpp"

namespace pivnp::app {

std::vector<MapPlan> mpm_maps() {
  std::vector<MapPlan> all;
  for (const auto& trials : {&column_trials, &body_trials, &soil_trials, &water_trials})
    for (TrialMap& map : trials()) all.push_back(plan_of(std::move(map)));
  return all;
}

}  // namespace pivnp::app
