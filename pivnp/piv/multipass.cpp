#include "pivnp/piv/multipass.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "pivnp/piv/validation/replacement.hpp"
#include "pivnp/piv/window_passes.hpp"

namespace pivnp::piv {

namespace {

constexpr int automatic_passes = 4;  // with the last window: one search, two to converge, one at the nodes

// Mean of those values that are numbers over (2 reach + 1)^2 nodes about each; 0 where there is none.
std::vector<float> mean_about(const NodeLattice& nodes, const std::vector<float>& value, int reach) {
  // Sums from the lattice's corner: of values, and of how many there are.
  const auto nx = static_cast<std::size_t>(nodes.nx), ny = static_cast<std::size_t>(nodes.ny), row = nx + 1;
  std::vector<double> sum(row * (ny + 1)), count(row * (ny + 1));
  for (std::size_t j = 0; j < ny; ++j)
    for (std::size_t i = 0; i < nx; ++i) {
      const bool known = std::isfinite(value[j * nx + i]);
      const auto add = [&](std::vector<double>& of, double more) {
        of[(j + 1) * row + i + 1] = more + of[j * row + i + 1] + of[(j + 1) * row + i] - of[j * row + i];
      };
      add(sum, known ? static_cast<double>(value[j * nx + i]) : 0.0), add(count, known ? 1.0 : 0.0);
    }
  const auto first = [&](std::size_t at) { return at - std::min(at, static_cast<std::size_t>(reach)); };
  const auto end = [&](std::size_t at, std::size_t most) {
    return std::min(at + static_cast<std::size_t>(reach) + 1, most);
  };
  std::vector<float> mean(value.size());
  for (std::size_t j = 0; j < ny; ++j)
    for (std::size_t i = 0; i < nx; ++i) {
      const std::size_t above = first(j) * row, below = end(j, ny) * row, left = first(i), right = end(i, nx);
      const auto over = [&](const std::vector<double>& of) {
        return of[below + right] - of[above + right] - of[below + left] + of[above + left];
      };
      mean[j * nx + i] = static_cast<float>(over(sum) / std::max(over(count), 1.0));
    }
  return mean;
}

// Of the sides between the window's and its support's the one that FFTs are quickest with: most factors of two.
int search_side(int window_px, int support) {
  int best = window_px;
  for (int side = window_px; side <= support; ++side)
    if ((side & -side) > (best & -best)) best = side;
  return best;
}

class Multipass final : public Method {
 public:
  Multipass(const PivOptions& options, const Extent& extent, int threads, Search last_window);
  void correlate(const ImageView& first, const ImageView& second, PixelVectors& vectors) override;
  bool correlate_mean(std::span<const FramePair> pairs, PixelVectors& vectors) override;
  void set_first_mask(const MaskView& mask) override { windows_.set_first_mask(mask); }
  void start_from(std::span<const std::array<float, 2>> displacement, std::span<const std::uint8_t> known) override {
    if (!windows_.empty()) windows_.start_from(displacement, known);
  }

 private:
  void measure_nodes(PixelVectors& vectors);
  void measure_node(WindowTools& tools, const WarpedPair& warped, std::size_t k, PixelVectors& vectors);
  void reject_mismatched(PixelVectors& vectors) const;
  void validate_nodes(PixelVectors& vectors);
  void measure_mean(std::span<const FramePair> pairs, PixelVectors& vectors);
  bool seen(std::size_t k) const;

  PivOptions options_;
  NodeLattice nodes_;
  int width_, height_, threads_;
  int passes_;  // with the last window
  WindowPasses windows_;
};

Multipass::Multipass(const PivOptions& options, const Extent& extent, int threads, Search last_window)
    : options_(options),
      nodes_(extent.nodes),
      width_(extent.width),
      height_(extent.height),
      threads_(std::max(1, threads)),
      passes_(options.passes > 0 ? options.passes : automatic_passes),
      windows_(options, extent, threads) {
  const std::vector<int> sides = window_sides(options, extent.width, extent.height);
  if (bounding_box(nodes_, static_cast<float>(sides.front()) / 2, width_, height_).empty()) return;  // no node inside
  for (const int side : sides)
    if (side != sides.back())
      windows_.add(side, decimation_of(side, sides.back()), static_cast<float>(side) / 2, 2, true);
  // With the last window: a search on a coarse lattice, refinement on one about as fine as the window can resolve, and
  // one pass at the nodes themselves.
  const int support = support_of_window(sides.back());
  const auto window = static_cast<float>(sides.back());
  const bool searches = last_window == Search::far || sides.size() == 1;
  windows_.add(searches && passes_ > 2 ? search_side(sides.back(), support) : support, 1, window / 2,
               passes_ > 1 ? 1 : 0, searches);
  if (passes_ > 2)
    windows_.add(support, 1, std::clamp(node_spacing(nodes_), window / 4, window / 3), passes_ - 2, false);
}

void Multipass::correlate(const ImageView& first, const ImageView& second, PixelVectors& vectors) {
  vectors.correlation_px = 0.5f * static_cast<float>(options_.window_px);
  if (windows_.empty()) return;
  windows_.find(first, second);
  measure_nodes(vectors);
  reject_mismatched(vectors);
  validate_nodes(vectors);
}

void Multipass::measure_nodes(PixelVectors& vectors) {
  WindowStage& stage = windows_.last();  // its images are not decimated
  const WarpedPair& warped = windows_.warp(stage);
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 16)
  for (std::size_t k = 0; k < nodes_.pixel.size(); ++k)
    if (vectors.status[k] != VectorStatus::masked)
      measure_node(stage.tools[std::size_t(omp_get_thread_num())], warped, k, vectors);
}

bool Multipass::seen(std::size_t k) const {
  const auto [x, y] = nodes_.pixel[k];
  return x >= 0 && y >= 0 && x <= static_cast<float>(width_ - 1) && y <= static_cast<float>(height_ - 1);
}

void Multipass::measure_node(WindowTools& tools, const WarpedPair& warped, std::size_t k, PixelVectors& vectors) {
  const auto [x, y] = nodes_.pixel[k];
  if (!seen(k)) return;
  tools.window.cut(warped, x, y);
  const Window& window = tools.window;
  if (!windows_.enough(window)) {
    if (window.usable + window.masked >= static_cast<float>(options_.min_usable))
      vectors.status[k] = VectorStatus::masked;
    return;
  }
  if (!windows_.textured(window)) return;
  const bool single_pass = passes_ == 1 && !tools.fft.empty();  // then nothing has searched with this window yet
  const Peak peak = tools.find(single_pass ? Search::far : Search::near);
  const auto predicted = windows_.predictor().at(x, y);
  vectors.displacement[k] = {predicted[0] + peak.dx, predicted[1] + peak.dy};
  vectors.score[k] = peak.score;
  const Peak matched = single_pass ? tools.near.find(window) : peak;
  vectors.cov[k] = tools.uncertainty.covariance(window, matched, windows_.rounding_variance());
  for (float& entry : vectors.cov[k]) entry *= iteration_variance(passes_);
  const auto most_variance = static_cast<float>(options_.max_sigma_px * options_.max_sigma_px);
  const bool accepted = peak.interior && peak.score >= static_cast<float>(options_.min_score) &&
                        vectors.cov[k][0] <= most_variance && vectors.cov[k][1] <= most_variance;  // false for NaN
  vectors.status[k] = accepted ? VectorStatus::valid : VectorStatus::rejected;
}

// Windows that show different material have a peak near zero as well, and so have their neighbours on the same wrong
// predictor. Two signs tell them: the last correction is large all around, as nothing has converged, and windows match
// poorly. What corrections and stated errors may be falls with the score about a node. Measured on stretches of .80 to
// 1 with noise of 1 to 10 % and no to half the grains lost (docs/theory/piv.md).
void Multipass::reject_mismatched(PixelVectors& vectors) const {
  constexpr float most_correction = 1.5f;  // px: beyond it one counts for no more
  constexpr float correction_share = 0.5f, fall = 0.9f;
  if (passes_ < automatic_passes) return;  // with fewer, the last correction may still be large
  const std::size_t count = nodes_.pixel.size();
  std::vector<float> correction(count);  // its square
  for (std::size_t k = 0; k < count; ++k) {
    const auto predicted = windows_.predictor().at(nodes_.pixel[k][0], nodes_.pixel[k][1]);
    const float du = vectors.displacement[k][0] - predicted[0], dv = vectors.displacement[k][1] - predicted[1];
    correction[k] = du * du + dv * dv;
  }
  std::vector<float> clipped = correction;
  for (float& c : clipped)
    if (std::isfinite(c)) c = std::min(c, most_correction * most_correction);
  const float spacing = std::max(node_spacing(nodes_), 1.0f);
  const int reach =
      std::clamp(static_cast<int>(std::lround(0.5f * static_cast<float>(options_.window_px) / spacing)), 1, 8);
  const std::vector<float> score = mean_about(nodes_, vectors.score, reach), about = mean_about(nodes_, clipped, reach);
  for (std::size_t k = 0; k < count; ++k) {
    if (vectors.status[k] != VectorStatus::valid) continue;
    const float sigma = static_cast<float>(options_.max_sigma_px) * std::exp(fall * (std::min(score[k], 1.0f) - 1));
    const float moved = correction_share * sigma;
    if (std::max(vectors.cov[k][0], vectors.cov[k][1]) > sigma * sigma ||
        std::max(correction[k], about[k]) > moved * moved)
      vectors.status[k] = VectorStatus::rejected;
  }
}

bool Multipass::correlate_mean(std::span<const FramePair> pairs, PixelVectors& vectors) {
  vectors.correlation_px = 0.5f * static_cast<float>(options_.window_px);
  if (windows_.empty() || pairs.empty()) return true;
  windows_.find(pairs);
  measure_mean(pairs, vectors);
  validate_nodes(vectors);
  return true;
}

// Twice through the pairs: for the peak of the mean correlation, and for what each pair's mismatch says of its error.
void Multipass::measure_mean(std::span<const FramePair> pairs, PixelVectors& vectors) {
  WindowStage& stage = windows_.last();
  const std::size_t count = nodes_.pixel.size();
  std::vector<float> planes(count * NearCorrelator::plane_size, 0.0f);
  std::vector<int> used(count, 0);
  std::vector<Peak> peaks(count);
  const auto each_window = [&](const auto& look) {
    for (const FramePair& pair : pairs) {
      windows_.take_images(pair);
      const WarpedPair& warped = windows_.warp(stage);
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 16)
      for (std::size_t k = 0; k < count; ++k) {
        if (vectors.status[k] == VectorStatus::masked || !seen(k)) continue;
        WindowTools& tools = stage.tools[std::size_t(omp_get_thread_num())];
        tools.window.cut(warped, nodes_.pixel[k][0], nodes_.pixel[k][1]);
        look(tools, k);
      }
    }
  };
  each_window([&](WindowTools& tools, std::size_t k) {
    const Window& window = tools.window;
    if (!windows_.enough(window)) {
      if (window.usable + window.masked >= static_cast<float>(options_.min_usable))
        vectors.status[k] = VectorStatus::masked;
    } else if (windows_.textured(window)) {
      tools.near.add(window, planes.data() + k * NearCorrelator::plane_size);
      ++used[k];
    }
  });
  std::vector<std::array<float, 3>> sum(count, {0, 0, 0});
  for (std::size_t k = 0; k < count; ++k)
    if (used[k] > 0) peaks[k] = NearCorrelator::peak_of(planes.data() + k * NearCorrelator::plane_size, used[k]);
  each_window([&](WindowTools& tools, std::size_t k) {
    if (used[k] == 0 || !windows_.enough(tools.window) || !windows_.textured(tools.window)) return;
    const auto cov = tools.uncertainty.covariance(tools.window, peaks[k], windows_.rounding_variance());
    for (std::size_t c = 0; c < 3; ++c) sum[k][c] += cov[c];
  });
  const auto most_variance = static_cast<float>(options_.max_sigma_px * options_.max_sigma_px);
  for (std::size_t k = 0; k < count; ++k) {
    if (used[k] == 0 || vectors.status[k] == VectorStatus::masked) continue;
    const auto predicted = windows_.predictor().at(nodes_.pixel[k][0], nodes_.pixel[k][1]);
    const auto n = static_cast<float>(used[k]);
    vectors.displacement[k] = {predicted[0] + peaks[k].dx, predicted[1] + peaks[k].dy};
    vectors.score[k] = peaks[k].score;
    for (std::size_t c = 0; c < 3; ++c) vectors.cov[k][c] = iteration_variance(passes_) * sum[k][c] / (n * n);
    const bool accepted = peaks[k].interior && peaks[k].score >= windows_.least_score(std::size_t(used[k])) &&
                          vectors.cov[k][0] <= most_variance && vectors.cov[k][1] <= most_variance;  // false for NaN
    vectors.status[k] = accepted ? VectorStatus::valid : VectorStatus::rejected;
  }
}

// The nodes may be far apart for the field's curvature; the predictor, validated on a finer lattice, knows it. So the
// median test sees what they deviate from it.
void Multipass::validate_nodes(PixelVectors& vectors) {
  VectorGrid grid{nodes_.nx, nodes_.ny, vectors.displacement, {}};
  for (std::size_t k = 0; k < grid.displacement.size(); ++k) {
    const auto predicted = windows_.predictor().at(nodes_.pixel[k][0], nodes_.pixel[k][1]);
    grid.displacement[k][0] -= predicted[0], grid.displacement[k][1] -= predicted[1];
  }
  grid.good.resize(nodes_.pixel.size());
  for (std::size_t k = 0; k < grid.good.size(); ++k) grid.good[k] = vectors.status[k] == VectorStatus::valid;
  median_test(grid, options_.median_threshold, options_.median_floor_px, threads_);
  for (std::size_t k = 0; k < grid.good.size(); ++k)
    if (vectors.status[k] == VectorStatus::valid && !grid.good[k]) vectors.status[k] = VectorStatus::rejected;
  constexpr int rings = 2;
  if (options_.replace)
    replace_rejected(nodes_.nx, nodes_.ny, rings, vectors.displacement, vectors.status, vectors.cov);
}

}  // namespace

std::unique_ptr<Method> make_multipass(const PivOptions& options, const Extent& extent, int threads,
                                       Search last_window) {
  return std::make_unique<Multipass>(options, extent, threads, last_window);
}

}  // namespace pivnp::piv
