// From the sums of a pass to the correction of the field, and how far residuals may reach in the next pass.
#pragma once

#include <vector>

#include "pivnp/piv/dense/normal_sums.hpp"

namespace pivnp::piv {

/// What the displacement still lacks at the lattice's points, level pixels.
struct Corrections {
  std::vector<float> u, v;
  std::vector<float> variance_u, variance_v;  // window_corrections only
};

/// Each cell by itself: (H + mu) d = b, H = sum w grad grad^T, b = sum w grad e; mu, 0.3 of the texture around, keeps
/// cells without texture of their own where the field already is and gives cells with more texture more weight in
/// whatever averages them; the correction is enlarged by 1.3, so that on the average nothing of it is lost, and limited
/// to 1.5 px. `rounding`: variance of a grey value's rounding, grey^2.
void cell_corrections(const CellSums& sums, float rounding, Corrections& out);

/// Gauss-Newton for subsets of order 0, 1 or 2 (displacement, its gradient, its curvature) under a Gaussian window
/// whose noise equals that of an even window of `window_px` pixels; the cells' sums take the place of pixels (a hat
/// function repeats linear weights exactly). Source: Pan et al. 2013; Lu & Cary 2000.
void window_corrections(const CellSums& sums, int order, float window_px, const std::vector<std::uint8_t>& wanted,
                        int threads, Corrections& out);

/// What the robust weights of the next pass take for noise (grey^2) and for the tolerance of misplaced texture (px^2):
/// nine times the weighted residuals' own variance about a point, and (0.1 px + a tenth of what the displacement
/// changes by over a cell)^2. `u`, `v`: the field, level pixels.
void residual_scale(const CellSums& sums, const std::vector<float>& u, const std::vector<float>& v, float rounding,
                    std::vector<float>& noise, std::vector<float>& tolerance);

}  // namespace pivnp::piv
