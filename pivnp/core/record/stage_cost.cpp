#include "pivnp/core/record/stage_cost.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/core/text.hpp"

namespace pivnp {

std::string words_of(const StageCost& stage) {
  std::string words = stage.name;
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string text_of(const RunCost& cost) {
  std::string text;
  double wall = 0, processor = 0, peak = 0;
  for (const StageCost& stage : cost.stages) {
    text += (text.empty() ? "Time: " : ", ") + number(stage.wall_s, 2) + " s " + words_of(stage);
    if (std::isfinite(stage.expected_s)) text += " (expected " + number(stage.expected_s, 2) + " s)";
    wall += stage.wall_s, processor += stage.processor_s, peak = std::max(peak, stage.peak_bytes);
  }
  if (text.empty()) return text;
  text += "; " + number(wall, 3) + " s in all, " + number(processor, 3) + " s of processor time. Memory: " + number(peak / 1e6, 3) + " MB at most";
  if (std::isfinite(cost.expected_bytes) && std::isfinite(cost.before_bytes))
    text += " (expected " + number(cost.expected_bytes / 1e6, 2) + " MB beside the frames and the " + number(cost.before_bytes / 1e6, 2) + " MB of the program)";
  return text + ".";
}

}  // namespace pivnp
