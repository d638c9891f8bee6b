// How the sides were brought together, in sentences and as metrics.
#pragma once

#include <string>
#include <vector>

#include "compare/alignment/onset.hpp"
#include "compare/alignment/partners.hpp"
#include "compare/alignment/reference.hpp"
#include "compare/measures/comparison.hpp"
#include "compare/measures/differences.hpp"
#include "compare/measures/numerics.hpp"

namespace pivnp::compare {

std::string quoted(const MotionSource& motion);

void remark_alignment(const Alignment& alignment, const Side& first, const Side& second, const CommonTimes& common,
                      std::vector<std::string>& remarks);
void remark_units(const CompareOptions& options, const LimitOptions& limits, const std::string& unit,
                  std::vector<std::string>& remarks);

/// Shares of the particles that found a partner; what the reference took off; the offset in time.
void add_coverage(const Alignment& alignment, const Differences& differences, const Side& first,
                  const std::string& at_end, Comparison& out);
void add_frame(const Reference& reference, const Tally& last, const std::string& unit, const std::string& at_end,
               std::vector<Metric>& metrics);
void add_place(const RigidFit& place, const std::string& unit, Comparison& out);
void add_time_offset(const Onset& offset, const std::string& time_unit, Comparison& out);
void add_convergence(const Numerics& numerics, Comparison& out);

}  // namespace pivnp::compare
