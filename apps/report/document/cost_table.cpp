// What the run took, stage by stage, beside what was expected.
#include <algorithm>
#include <cmath>
#include <string>

#include "apps/plot/numbers.hpp"
#include "apps/report/document/tables.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

std::string seconds(double s) { return std::isfinite(s) ? significant(s, s < 10 ? 2 : 3) + " s" : std::string("\u2013"); }
std::string megabytes(double bytes) { return std::isfinite(bytes) ? significant(bytes / 1e6, 3) + " MB" : std::string("not known"); }

}  // namespace

std::optional<Table> cost_table(const Content& content) {
  const RunCost& cost = content.cost;
  if (cost.stages.empty()) return std::nullopt;
  Table t;
  t.fine = true;
  t.caption = "What the run took, without this report" + (cost.machine.empty() ? std::string() : ", on " + cost.machine) +
              ". Expected: the time of the stage\u2019s first pairs or steps, times their number, as pivnp check states it. Peak: the most memory that the "
              "whole program held during the stage; before the run " + megabytes(cost.before_bytes) + ", expected on top of that " +
              megabytes(cost.expected_bytes) + ".";
  t.head = {"Stage", "Time", "Expected", "Processor time", "Peak of memory"};
  t.width = {0.28, 0.18, 0.18, 0.18, 0.18};
  t.align = {'l', 'r', 'r', 'r', 'r'};
  double wall = 0, processor = 0, peak = 0;
  for (const StageCost& stage : cost.stages) {
    t.rows.push_back({capitalised(words_of(stage)), seconds(stage.wall_s), seconds(stage.expected_s), seconds(stage.processor_s), megabytes(stage.peak_bytes)});
    wall += stage.wall_s, processor += stage.processor_s, peak = std::max(peak, stage.peak_bytes);
  }
  t.rows.push_back({"In all", seconds(wall), "", seconds(processor), megabytes(peak)});
  return t;
}

}  // namespace pivnp::report
