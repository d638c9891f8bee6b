#include "pivnp/piv/validation/vector_validation.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/piv/dense/lattice_filter.hpp"
#include "pivnp/piv/sampling/lattice.hpp"
#include "pivnp/piv/validation/median_test.hpp"
#include "pivnp/piv/validation/moving_edges.hpp"
#include "pivnp/piv/validation/replacement.hpp"

namespace pivnp::piv {

namespace {

// Shares, over 5 x 5 points, of those whose own texture tells the displacement to `most_sigma` (level pixels); `seen`: 1
// for points that see pixels. What chance grants a point in a hole, or takes from one under loss, its neighbours correct.
std::vector<float> telling_share(const CellSums& sums, const std::vector<float>& variance, float most_sigma,
                                 const std::vector<float>& seen) {
  constexpr int reach = 2;
  std::vector<float> telling = seen, voices, votes;
  for (std::size_t k = 0; k < seen.size(); ++k)
    if (!(variance[k] <= most_sigma * most_sigma)) telling[k] = 0;
  box_mean(sums.lattice, seen, reach, voices);
  box_mean(sums.lattice, telling, reach, votes);
  for (std::size_t k = 0; k < seen.size(); ++k) votes[k] /= std::max(voices[k], 1e-6f);
  return votes;
}

// Where there is something to measure: windows tell the displacement about the point, and so do cells, in about the
// share that they do elsewhere in the image (all of them on good texture, few where grains are few or lost). Windows
// alone would see a hole's rim from within.
// `own`: the windows' own variance.
std::vector<std::uint8_t> measured_points(const CellSums& sums, const MatchQuality& quality, const std::vector<float>& own,
                                          float rounding) {
  // Windows: noise of 10 % yields .05 px, 30 % of loss .13; holes, sky, glass and defocus .25 and above. Cells have a
  // quarter of a window's pixels.
  constexpr float most_sigma = 0.25f, most_cell_sigma = 0.45f, least_usable = 0.3f;
  constexpr float majority = 0.5f, usual_share = 0.5f;
  std::vector<float> seen(quality.usable.size());
  for (std::size_t k = 0; k < seen.size(); ++k) seen[k] = quality.usable[k] >= least_usable ? 1.0f : 0.0f;
  std::vector<float> cell_variance;
  own_variance(sums, false, rounding, cell_variance);
  const std::vector<float> windows = telling_share(sums, own, most_sigma, seen);
  const std::vector<float> cells = telling_share(sums, cell_variance, most_cell_sigma, seen);
  double usual = 0, count = 0;
  for (std::size_t k = 0; k < seen.size(); ++k)
    if (seen[k] > 0 && windows[k] > majority) usual += static_cast<double>(cells[k]), ++count;
  const float quorum = std::min(majority, usual_share * static_cast<float>(usual / std::max(count, 1.0)));
  std::vector<std::uint8_t> measured(seen.size());
  for (std::size_t k = 0; k < seen.size(); ++k) measured[k] = windows[k] > majority && cells[k] > quorum;
  return measured;
}

// Share of the window about a node that the image holds, along one axis: hats seen through weights 1/4, 1/2, 1/4 reach
// two cells.
float inside_share(float place, int pixels, float cell) {
  const auto cumulated = [&](float x) {  // of a smooth bell of that width
    const float t = std::clamp(x / (4 * cell) + 0.5f, 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
  };
  return cumulated(static_cast<float>(pixels - 1) - place) - cumulated(-place);
}

// Share of the pixels about a node that the mask leaves, over an even window of `width` px: what is missing beside it,
// the motion has carried out of the frame.
float mask_share(const MaskView& mask, float column, float row, float width) {
  if (mask.data == nullptr) return 1;
  constexpr int samples = 9;
  int usable = 0, inside = 0;
  for (int b = 0; b < samples; ++b)
    for (int a = 0; a < samples; ++a) {
      const auto place = [&](float centre, int k) {
        return static_cast<int>(std::lround(centre + width * ((float(k) + 0.5f) / float(samples) - 0.5f)));
      };
      const int c = place(column, a), r = place(row, b);
      if (c < 0 || r < 0 || c >= mask.width || r >= mask.height) continue;
      ++inside, usable += mask.usable(c, r);
    }
  return inside > 0 ? static_cast<float>(usable) / static_cast<float>(inside) : 0.0f;
}

// Whether what is measured beside the frame's edge holds for a place: `beyond` px from where either frame ends, with the
// field's change over that way no more than a quarter of a pixel. Even motion may be continued.
bool continued_to(const CellLattice& lattice, const std::vector<float>& u, const std::vector<float>& v, int i, int j, float beyond) {
  constexpr float most_px = 0.25f;
  if (beyond <= 0) return true;
  const int left = std::max(i - 1, 0), right = std::min(i + 1, lattice.nx - 1);
  const int above = std::max(j - 1, 0), below = std::min(j + 1, lattice.ny - 1);
  const auto change = [&](std::size_t a, std::size_t b, int steps) {
    return std::hypot(u[b] - u[a], v[b] - v[a]) / static_cast<float>(steps * lattice.step);
  };
  return beyond * std::max(change(lattice.index(left, j), lattice.index(right, j), right - left),
                           change(lattice.index(i, above), lattice.index(i, below), below - above)) <= most_px;
}

// What is trusted at the lattice's points: measured by texture of its own, matched well enough, of a small enough error,
// and in line with its neighbours. Tested there and not at the nodes, which may lie far apart for the field's curvature.
std::vector<std::uint8_t> trusted_points(const ValidationInput& input, const CellLattice& lattice,
                                         const MatchQuality& quality, const std::vector<std::uint8_t>& measured,
                                         const std::vector<float>& u,
                                         const std::vector<float>& v, const std::vector<float>& variance_u,
                                         const std::vector<float>& variance_v) {
  const auto d = static_cast<float>(input.decimation), least_score = static_cast<float>(input.limits.min_score);
  VectorGrid grid{lattice.nx, lattice.ny, std::vector<std::array<float, 2>>(lattice.size()),
                  std::vector<std::uint8_t>(lattice.size())};
  for (std::size_t k = 0; k < lattice.size(); ++k) {
    grid.displacement[k] = {d * u[k], d * v[k]};
    const float limit = trusted_sigma(static_cast<float>(input.limits.max_sigma_px), quality.wide_score[k]);
    grid.good[k] = quality.variance[k] > 4 * input.rounding && quality.score[k] >= least_score &&
                   std::max(variance_u[k], variance_v[k]) <= limit * limit && measured[k] != 0;
  }
  median_test(grid, input.limits.median_threshold, input.limits.median_floor_px, input.threads);
  return grid.good;
}

}  // namespace

void validate_vectors(const ValidationInput& input, const SplineField& field, const CellSums& sums,
                      const std::vector<float>& u, const std::vector<float>& v, const SmoothedField& smooth_u,
                      const SmoothedField& smooth_v, PixelVectors& vectors, std::vector<std::uint8_t>& trusted) {
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
  std::vector<float> own, open;
  own_variance(sums, true, input.rounding, own);
  const auto measured = measured_points(sums, quality, own, input.rounding);
  trusted = trusted_points(input, lattice, quality, measured, u, v, variance_u, variance_v);
  const AnchorShares shares = shares_of(vectors.anchor);
  constexpr float most_departure_px = 0.4f;
  reject_moving_edges(sums, u, v, most_departure_px / d, trusted);
  // Where frames match, thin layers and bands that cells do not resolve would leave windows unsettled too.
  constexpr float matched = 0.65f;
  open_correction(sums, open);
  for (std::size_t k = 0; k < trusted.size(); ++k)
    if (quality.wide_score[k] < matched && !settled(open[k], own[k], input.decimation)) trusted[k] = 0;
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
      if (inside >= least_usable && inside * mask_share(input.mask, column, row, 3 * cell * d) < least_usable)
        vectors.status[k] = VectorStatus::masked;  // it is the mask that takes the window away
      continue;
    }
    if (!(quality.variance[q] > 4 * input.rounding)) continue;
    const auto value = field.at(x, y);
    vectors.displacement[k] = {d * value[0], d * value[1]};
    const auto lost = [&](const SmoothedField& smooth) { return smooth.lost.empty() ? 0.0f : d * d * smooth.lost[q]; };
    vectors.cov[k] = {variance_u[q] + lost(smooth_u), variance_v[q] + lost(smooth_v),
                      quality.slant[q] * d * d * std::sqrt(smooth_u.variance[q] * smooth_v.variance[q])};
    vectors.score[k] = quality.score[q];
    float beyond = 0;
    for (const float share : {shares.first, shares.second}) {
      const float c = column + share * vectors.displacement[k][0], r = row + share * vectors.displacement[k][1];
      beyond = std::max({beyond, -c, -r, c - float(input.width - 1), r - float(input.height - 1)});
    }
    vectors.status[k] = trusted[q] && continued_to(lattice, u, v, i, j, beyond) ? VectorStatus::valid : VectorStatus::rejected;
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
