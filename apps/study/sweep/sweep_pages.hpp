// A sweep as a page with charts, and as tables.
#pragma once

#include <string>
#include <vector>

#include "apps/report/document/document.hpp"
#include "apps/study/sweep/plan.hpp"
#include "pivnp/io/records/table_file.hpp"

namespace pivnp::app {

struct SweepPages {
  report::Document document;
  std::vector<std::string> sentences;
};

SweepPages sweep_pages(const Case& c, const SweepOptions& options, const std::vector<Variation>& variations, const std::vector<SweepRun>& runs);
std::string csv_of(const SweepOptions& options, const std::vector<Variation>& variations, const std::vector<SweepRun>& runs);
io::NamedTable table_of(const SweepOptions& options, const std::vector<Variation>& variations, const std::vector<SweepRun>& runs);

}  // namespace pivnp::app
