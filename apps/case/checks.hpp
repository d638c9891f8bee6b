// What only the whole case shows.
#pragma once

#include <optional>
#include <string>

#include "apps/case/case.hpp"
#include "apps/case/document.hpp"

namespace pivnp::app {

/// Throws InputError of one line, with file, line and key, for options that contradict each other, outlines that are
/// none, materials that are missing, stages without what they need. `source` says where keys stand and which were
/// given; piv and np are still as the file has them.
void check_given(const Case& c, const Source& source);

/// What is wrong with [report.line.NAME]; `key` empty: the section itself.
struct LineFault {
  std::string key, text;
};
std::optional<LineFault> fault_of_line(const std::string& name, const report::LineOptions& line);

}  // namespace pivnp::app
