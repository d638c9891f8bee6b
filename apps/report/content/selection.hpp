// Which times and material points a report shows.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "apps/report/content/content.hpp"
#include "apps/report/content/options.hpp"
#include "pivnp/core/particles/places.hpp"

namespace pivnp::report {

/// Index of the frame nearest to `time`; none if it lies outside the motion's times by more than half a step.
std::optional<std::size_t> frame_at(const MotionSource& motion, double time);

/// The times asked for, or up to three that part the compared (else the recorded) time evenly, the last one included.
std::vector<double> chosen_times(const ReportOptions& options, const Content& content);

/// The material points asked for, or up to three spread over the moving part: particles followed to the end whose final
/// displacement is nearest to the quartiles of those that moved more than a tenth of the 99th percentile.
std::vector<Vec2> chosen_points(const ReportOptions& options, const Content& content);

}  // namespace pivnp::report
