// What a study is told beside its case, and what it gives back.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "compare/compare.hpp"

namespace pivnp::app {

struct RunSettings {
  std::filesystem::path out;          // receives record.h5, record.xdmf, report.html, report.pdf, figures/
  bool resume = false;                // go on from what a killed run left in `out`
  int threads = 0;                    // 0: all cores; never changes a result
  std::string command;                // as typed, for the record
  std::optional<std::string> frames;  // wins over the case's [frames] path, relative to the working folder
};

struct RunOutcome {
  bool over_limit = false;  // a limit of [compare.limits] was exceeded: exit code 3
  std::filesystem::path record, report_html, report_pdf;
  std::vector<std::string> remarks;          // what was flagged and why, one sentence each
  std::vector<compare::LimitResult> limits;  // one a limit of [compare.limits] that was given and judged
};

}  // namespace pivnp::app
