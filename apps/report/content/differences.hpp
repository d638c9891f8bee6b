// What a comparison found, against time and field by field.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/report/content/content.hpp"
#include "apps/report/content/fields.hpp"

namespace pivnp::report {

/// RMS over the compared particles against time.
struct DifferenceCurve {
  std::vector<double> time, rms, median;
  std::vector<double> sigma;  // RMS standard uncertainty of the measured |u| over the same particles; NaN if not known
  std::vector<std::size_t> compared;
};
DifferenceCurve difference_curve(const Content& content);

/// Difference of a field (second minus first) at the first's particles and at `time`, in their order; empty if the
/// comparison lacks it. |u| from difference_x and _y: |u + d| - |u|; others from the field "difference_NAME".
std::vector<double> field_difference(const Content& content, const std::string& field, double time,
                                     const FieldAtTime& first);

}  // namespace pivnp::report
