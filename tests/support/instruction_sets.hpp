// The instruction sets that vector kernels are compiled for and this processor has, one by one.
#pragma once

#include <cstdint>
#include <vector>

#include <hwy/targets.h>

namespace pivnp::test {

/// As Highway's target bits, the best one first.
inline std::vector<std::int64_t> instruction_sets() {
  std::vector<std::int64_t> sets;
  for (std::int64_t left = (hwy::SupportedTargets() & HWY_TARGETS) | HWY_STATIC_TARGET; left != 0; left &= left - 1)
    sets.push_back(left & -left);
  return sets;
}

/// Kernels run on this set from here on.
inline void choose_instruction_set(std::int64_t set) { hwy::GetChosenTarget().Update(set); }
/// Kernels run on the best set, as they do by themselves.
inline void choose_best_instruction_set() { hwy::GetChosenTarget().DeInit(); }

}  // namespace pivnp::test
