// How the data sets were brought together and what was left out, one sentence each.
#pragma once

#include <string>
#include <vector>

#include "compare/alignment/partners.hpp"
#include "compare/data/data_set.hpp"
#include "compare/data/options.hpp"
#include "compare/metrics/findings.hpp"
#include "compare/metrics/limits.hpp"

namespace pivnp::compare {

std::string quoted(const MotionSource& motion);

void remark_alignment(const Alignment& alignment, const DataSet& first, const DataSet& second,
                      const CommonTimes& common, std::vector<std::string>& remarks);
void remark_findings(const Findings& findings, std::vector<std::string>& remarks);
void remark_units(const CompareOptions& options, const LimitOptions& limits, const std::string& unit,
                  std::vector<std::string>& remarks);
/// Of metrics whose three grids show no order.
std::string remark_outside(const std::vector<std::string>& metrics);
/// What was given to the second's clock and coordinates.
void remark_offsets(const Findings& findings, std::vector<std::string>& remarks);

}  // namespace pivnp::compare
