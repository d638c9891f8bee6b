#include "pivnp/piv/window/uncertainty.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/piv/window/subpixel.hpp"

namespace pivnp::piv {

UncertaintyEstimator::UncertaintyEstimator(int side)
    : scratch_(FlankScratch(side).floats(), 0.0f) {}

float iteration_variance(int passes) { return passes <= 1 ? 1.0f : passes == 2 ? 1.6f : 2.0f; }

std::array<float, 3> UncertaintyEstimator::covariance(const Window& window, const Peak& peak, float rounding_variance) {
  const float energy = std::sqrt(window.energy_a) * std::sqrt(window.energy_b);
  const std::size_t at = window.index(0, 0);
  const FlankSums s = flank_sums(window.a.data() + at, window.b.data() + at, window.weight.data() + at, window.side,
                                 window.stride, scratch_.data());
  const float bartlett = energy > 0 ? 1 / (static_cast<float>(flank_span * flank_span) * energy * energy) : 0.0f;
  const float rounding = window.energy_a > 0 ? 2 * rounding_variance / (window.energy_a * window.energy_a) : 0.0f;
  const float kx = three_point_sensitivity(peak.around[1][0], peak.around[1][1], peak.around[1][2]);
  const float ky = three_point_sensitivity(peak.around[0][1], peak.around[1][1], peak.around[2][1]);
  return {kx * kx * std::max(bartlett * s.xx, rounding * s.slope_x),
          ky * ky * std::max(bartlett * s.yy, rounding * s.slope_y), kx * ky * bartlett * s.xy};
}

}  // namespace pivnp::piv
