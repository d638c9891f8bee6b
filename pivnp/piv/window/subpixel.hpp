// Where between whole pixels a correlation peak lies.
#pragma once

namespace pivnp::piv {

/// Offset of the peak from the middle of three equidistant values, -1 .. 1: three-point Gaussian fit (Willert & Gharib
/// 1991). Where a neighbour is not clearly positive (below a twentieth of the middle, so that its logarithm says
/// little): three-point parabola. 0 if the middle is not the largest.
float three_point_peak(float before, float middle, float after);

/// d offset / d (after - before) of that fit at its present values; infinite for a flat peak.
float three_point_sensitivity(float before, float middle, float after);

}  // namespace pivnp::piv
