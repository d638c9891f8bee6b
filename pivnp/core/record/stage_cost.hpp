// What a stage of a run took.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace pivnp {

/// NaN: not known.
struct StageCost {
  std::string name;         // "mesh_study"
  double wall_s = 0;
  double processor_s = 0;   // user time of all threads
  double peak_bytes = 0;    // most memory that the whole process held meanwhile
  double expected_s = std::numeric_limits<double>::quiet_NaN();  // by its first steps or pairs, as `pivnp check` expects it
};

/// What a run took: its stages in their order, all by the process that finished it.
struct RunCost {
  std::vector<StageCost> stages;
  double before_bytes = std::numeric_limits<double>::quiet_NaN();    // held when it began
  double expected_bytes = std::numeric_limits<double>::quiet_NaN();  // on top of that, as `pivnp check` says
  std::string machine;                                               // "2 processors, Intel(R) Xeon(R) ..."; empty: not known
};

/// "mesh study" of "mesh_study".
std::string words_of(const StageCost& stage);

/// "Time: 4.2 s frames, 56 s vectors (expected 50 s) ...; 80 s in all ... Memory: ..."; empty without stages.
std::string text_of(const RunCost& cost);

}  // namespace pivnp
