#include "pivnp/piv/validation/vector_validation.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/piv/sampling/lattice.hpp"
#include "pivnp/piv/validation/median_test.hpp"
#include "pivnp/piv/validation/replacement.hpp"

namespace pivnp::piv {

namespace {

// Errors that no smoothing removes, px^2: interpolation of undersampled grains, clipped ones, rounding; measured on
// evenly moved frames. Averages over blocks of pixels alias what they do not resolve: up to .006 px.
constexpr float systematic_variance(int decimation) { return decimation == 1 ? 0.32e-6f : 12e-6f; }

// Share of the window about a node that the image holds, along one axis: hats seen through weights 1/4, 1/2, 1/4 reach
// two cells.
float inside_share(float place, int pixels, float cell) {
  const auto cumulated = [&](float x) {  // of a smooth bell of that width
    const float t = std::clamp(x / (4 * cell) + 0.5f, 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
  };
  return cumulated(static_cast<float>(pixels - 1) - place) - cumulated(-place);
}

// What is trusted at the lattice's points: matched well enough, of a small enough error, and in line with its
// neighbours. Tested there and not at the nodes, which may lie far apart for the field's curvature.
std::vector<std::uint8_t> trusted_points(const ValidationInput& input, const CellLattice& lattice,
                                         const MatchQuality& quality, const std::vector<float>& u,
                                         const std::vector<float>& v, const std::vector<float>& variance_u,
                                         const std::vector<float>& variance_v) {
  const auto d = static_cast<float>(input.decimation), least_score = static_cast<float>(input.limits.min_score);
  VectorGrid grid{lattice.nx, lattice.ny, std::vector<std::array<float, 2>>(lattice.size()),
                  std::vector<std::uint8_t>(lattice.size())};
  for (std::size_t k = 0; k < lattice.size(); ++k) {
    grid.displacement[k] = {d * u[k], d * v[k]};
    const float limit = trusted_sigma(static_cast<float>(input.limits.max_sigma_px), quality.wide_score[k]);
    grid.good[k] = quality.variance[k] > 4 * input.rounding && quality.score[k] >= least_score &&
                   std::max(variance_u[k], variance_v[k]) <= limit * limit;
  }
  median_test(grid, input.limits.median_threshold, input.limits.median_floor_px, input.threads);
  return grid.good;
}

}  // namespace

void validate_vectors(const ValidationInput& input, const SplineField& field, const CellSums& sums,
                      const std::vector<float>& u, const std::vector<float>& v, const SmoothedField& smooth_u,
                      const SmoothedField& smooth_v, PixelVectors& vectors) {
  const CellLattice& lattice = sums.lattice;
  const auto d = static_cast<float>(input.decimation), cell = static_cast<float>(lattice.step);
  MatchQuality quality;
  match_quality(sums, quality);
  std::vector<float> variance_u, variance_v, areas;
  truncation_variance(lattice, u, input.threads, variance_u);
  truncation_variance(lattice, v, input.threads, variance_v);
  for (std::size_t k = 0; k < lattice.size(); ++k) {
    variance_u[k] = d * d * (smooth_u.variance[k] + variance_u[k]) + systematic_variance(input.decimation);
    variance_v[k] = d * d * (smooth_v.variance[k] + variance_v[k]) + systematic_variance(input.decimation);
  }
  const auto trusted = trusted_points(input, lattice, quality, u, v, variance_u, variance_v);
  const auto least_usable = static_cast<float>(input.limits.min_usable);
  for (std::size_t k = 0; k < input.nodes.pixel.size(); ++k) {
    if (vectors.status[k] == VectorStatus::masked) continue;
    const auto [column, row] = input.nodes.pixel[k];
    if (!(column >= 0 && row >= 0 && column <= float(input.width - 1) && row <= float(input.height - 1))) continue;
    const float x = (column - 0.5f * (d - 1)) / d, y = (row - 0.5f * (d - 1)) / d;
    const int i = std::clamp(static_cast<int>(std::lround((x - float(lattice.x0)) / cell)), 0, lattice.nx - 1);
    const int j = std::clamp(static_cast<int>(std::lround((y - float(lattice.y0)) / cell)), 0, lattice.ny - 1);
    const std::size_t q = lattice.index(i, j);
    if (quality.usable[q] < least_usable) {
      const float inside = inside_share(column, input.width, cell * d) * inside_share(row, input.height, cell * d);
      if (inside >= least_usable)
        vectors.status[k] = VectorStatus::masked;  // it is the mask that takes the window away
      continue;
    }
    if (!(quality.variance[q] > 4 * input.rounding)) continue;
    const auto value = field.at(x, y);
    vectors.displacement[k] = {d * value[0], d * value[1]};
    vectors.cov[k] = {variance_u[q], variance_v[q],
                      quality.slant[q] * d * d * std::sqrt(smooth_u.variance[q] * smooth_v.variance[q])};
    vectors.score[k] = quality.score[q];
    vectors.status[k] = trusted[q] ? VectorStatus::valid : VectorStatus::rejected;
    areas.push_back(0.5f * (smooth_u.area[q] + smooth_v.area[q]));
  }
  if (!areas.empty()) {
    const auto middle = areas.begin() + std::ptrdiff_t(areas.size() / 2);
    std::nth_element(areas.begin(), middle, areas.end());
    vectors.correlation_px = 0.5f * d * cell * std::sqrt(*middle);
  }
  constexpr int rings = 2;
  if (input.limits.replace)
    replace_rejected(input.nodes.nx, input.nodes.ny, rings, vectors.displacement, vectors.status, vectors.cov);
}

}  // namespace pivnp::piv
