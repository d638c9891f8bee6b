#include "pivnp/core/record/stage_cost.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/core/text.hpp"

namespace pivnp {

namespace {

std::string seconds(double s) { return number(s < 10 ? s : std::round(s), s < 10 ? 2 : 9) + " s"; }
std::string megabytes(double bytes) { return number(std::round(bytes / 1e6), 9) + " MB"; }

}  // namespace

std::string words_of(const StageCost& stage) {
  std::string words = stage.name;
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string text_of(const RunCost& cost) {
  std::string text;
  double wall = 0, processor = 0, peak = 0;
  for (const StageCost& stage : cost.stages) {
    text += (text.empty() ? "Time: " : ", ") + seconds(stage.wall_s) + " " + words_of(stage);
    if (std::isfinite(stage.expected_s)) text += " (expected " + seconds(stage.expected_s) + ")";
    wall += stage.wall_s, processor += stage.processor_s, peak = std::max(peak, stage.peak_bytes);
  }
  if (text.empty()) return text;
  text += "; " + seconds(wall) + " in all, " + seconds(processor) + " of processor time. Memory: " + megabytes(peak) + " at most";
  if (std::isfinite(cost.expected_bytes) && std::isfinite(cost.before_bytes))
    text += " (expected " + megabytes(cost.expected_bytes) + " beside the " + megabytes(cost.before_bytes) + " of the program)";
  return text + ".";
}

}  // namespace pivnp
