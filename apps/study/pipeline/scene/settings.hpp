// What a study is told beside its case, and what it gives back.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/record/metric.hpp"
#include "pivnp/core/record/remark.hpp"
#include "pivnp/core/record/stage_cost.hpp"

namespace pivnp::app {

struct RunSettings {
  std::filesystem::path out;          // receives record.h5, record.xdmf, report.html, report.pdf, figures/
  bool resume = false;                // go on from what a killed run left in `out`
  int threads = 0;                    // 0: all cores; never changes a result
  bool report = true;                 // false: the record alone
  std::string command;                // as typed, for the record
  std::optional<std::string> frames;  // wins over the case's [frames] path, relative to the working folder
};

struct RunOutcome {
  std::filesystem::path record, report_html, report_pdf;
  std::vector<Remark> remarks;
  std::vector<Metric> metrics;       // of the comparison, where there is one
  std::vector<LimitResult> limits;   // one a limit of [compare.limits] that was given; one exceeded gives exit code 3
  RunCost cost;                      // of a run's stages, the report included
};

}  // namespace pivnp::app
