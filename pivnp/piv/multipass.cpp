#include "pivnp/piv/multipass.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pivnp/piv/correlate.hpp"
#include "pivnp/piv/uncertainty.hpp"
#include "pivnp/piv/validate.hpp"
#include "pivnp/piv/warp.hpp"

namespace pivnp::piv {

namespace {

constexpr int search_side = 32;        // pixels of a decimated image that a search window keeps at least
constexpr int automatic_passes = 4;    // with the last window: one search, two to converge, one at the nodes
constexpr float converged_px = 0.01f;  // root mean square change of the predictor's vectors
constexpr float smoothing = 0.3f;      // standard deviation of the predictor's weights over the window's side
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

enum class Search { far, near };

// What one thread needs for windows of one side.
struct Tools {
  Tools(int side, bool far) : window(side), near(side), uncertainty(side) {
    if (far) fft.emplace_back(side);
  }
  Window window;
  NearCorrelator near;
  std::vector<FftCorrelator> fft;  // one, if this side is searched far
  UncertaintyEstimator uncertainty;

  Peak find(Search search) { return search == Search::far ? fft.front().find(window) : near.find(window); }
};

// One window size: the resolution its images are taken at, and the even lattice its predictor is measured on.
struct Stage {
  int side = 0;  // pixels of the full image
  int decimation = 1;
  EvenLattice lattice;
  NodeLattice points;
  int passes = 0;            // on the even lattice
  bool searches = false;     // the first of them searches far; the others refine
  std::vector<Tools> tools;  // one a thread

  int level_side() const { return side / decimation; }
};

// Decimated so far that about `search_side` pixels of it are left; the last window always sees the full image.
int decimation_of(int side, int last_side) {
  int decimation = 1;
  while (side > last_side && side / (2 * decimation) >= search_side) decimation *= 2;
  return decimation;
}

class MultipassFft final : public Method {
 public:
  MultipassFft(const PivOptions& options, const NodeLattice& nodes, int width, int height, int threads);
  void correlate(const ImageView& first, const ImageView& second, const MaskView& mask, PixelVectors& vectors) override;

 private:
  void take_images(const ImageView& first, const ImageView& second, const MaskView& mask);
  Level& level(int decimation);
  void improve_predictor(Stage& stage);
  float measure(Stage& stage, Search search, VectorGrid& found);
  void measure_nodes(Stage& stage, PixelVectors& vectors);
  void measure_node(Tools& tools, const Level& images, std::size_t k, PixelVectors& vectors);
  void validate_nodes(PixelVectors& vectors);
  bool enough(const Window& window) const { return window.usable >= static_cast<float>(options_.min_usable); }
  bool textured(const Window& window) const {
    return std::min(window.variance_f, window.variance_g) > 4 * rounding_variance_;
  }
  void warp(const Stage& stage);

  PivOptions options_;
  NodeLattice nodes_;
  int width_, height_, threads_;
  int passes_;  // with the last window
  Anchor anchor_;
  std::vector<Stage> stages_;
  std::vector<Level> levels_;
  PredictorField predictor_;
  WarpedPair warped_;
  float rounding_variance_ = 0;  // grey^2
};

MultipassFft::MultipassFft(const PivOptions& options, const NodeLattice& nodes, int width, int height, int threads)
    : options_(options),
      nodes_(nodes),
      width_(width),
      height_(height),
      threads_(std::max(1, threads)),
      passes_(options.passes > 0 ? options.passes : automatic_passes),
      anchor_(options.anchor == "central" ? Anchor::central : Anchor::forward) {
  const std::vector<int> sides = window_sides(options, width, height);
  const Box whole = bounding_box(nodes_, static_cast<float>(sides.front()) / 2, width, height);
  if (whole.empty()) return;  // no node lies in the image
  const float node_step = node_spacing(nodes_);
  const auto add = [&](int side, int decimation, float step, int passes, bool searches) {
    Stage stage;
    stage.decimation = decimation;
    stage.side = side / decimation * decimation;
    stage.lattice = even_lattice(bounding_box(nodes_, static_cast<float>(side) / 2, width, height), step);
    stage.points = nodes_near(stage.lattice, nodes_, 1.5f * std::max(node_step, step));
    stage.passes = passes;
    stage.searches = searches;
    for (int t = 0; t < threads_; ++t) stage.tools.emplace_back(stage.side / decimation, searches);
    if (std::none_of(levels_.begin(), levels_.end(), [&](const Level& l) { return l.decimation == decimation; }))
      levels_.emplace_back().decimation = decimation;
    stages_.push_back(std::move(stage));
  };
  for (const int side : sides)
    if (side != sides.back()) add(side, decimation_of(side, sides.back()), static_cast<float>(side) / 2, 2, true);
  // With the last window: a search on a coarse lattice, refinement on one about as fine as the window can resolve, and
  // one pass at the nodes themselves.
  const int support = support_of_window(sides.back());
  const auto window = static_cast<float>(sides.back());
  add(support, 1, window / 2, passes_ > 1 ? 1 : 0, true);
  if (passes_ > 2) add(support, 1, std::clamp(node_step, window / 4, window / 3), passes_ - 2, false);
}

Level& MultipassFft::level(int decimation) {
  return *std::find_if(levels_.begin(), levels_.end(), [&](const Level& l) { return l.decimation == decimation; });
}

void MultipassFft::take_images(const ImageView& first, const ImageView& second, const MaskView& mask) {
  rounding_variance_ = first.depth == PixelDepth::f32 ? 1e-14f * first.white * first.white : 1.0f / 12.0f;
  for (Level& l : levels_) {
    l.first.assign(first, mask, l.decimation, threads_);
    l.second.assign(second, mask, l.decimation, threads_);
    l.mask.clear();
    if (mask.data == nullptr) continue;
    const int d = l.decimation;
    l.mask.resize(std::size_t(l.first.width()) * std::size_t(l.first.height()));
    for (int r = 0; r < l.first.height(); ++r)
      for (int c = 0; c < l.first.width(); ++c) {
        int usable = 0;
        for (int dr = 0; dr < d; ++dr)
          for (int dc = 0; dc < d; ++dc) usable += mask.usable(c * d + dc, r * d + dr);
        l.mask[std::size_t(r) * std::size_t(l.first.width()) + std::size_t(c)] = 2 * usable > d * d;
      }
  }
}

void MultipassFft::warp(const Stage& stage) {
  const Level& l = level(stage.decimation);
  const Box full = bounding_box(
      nodes_, static_cast<float>(stage.side) + 2.0f * std::max(stage.lattice.dx, stage.lattice.dy), width_, height_);
  const int d = stage.decimation;
  const Box box{full.x0 / d, full.y0 / d, std::min((full.x1 + d - 1) / d, l.first.width()),
                std::min((full.y1 + d - 1) / d, l.first.height())};
  warp_pair(l, predictor_, anchor_, box, threads_, warped_);
}

void MultipassFft::correlate(const ImageView& first, const ImageView& second, const MaskView& mask,
                             PixelVectors& vectors) {
  vectors.anchor = anchor_;
  for (std::size_t k = 0; k < nodes_.pixel.size(); ++k) {
    vectors.displacement[k] = {nan, nan};
    vectors.cov[k] = {nan, nan, nan};
    vectors.score[k] = nan;
    vectors.status[k] = switched_on(nodes_, k) ? VectorStatus::failed : VectorStatus::masked;
  }
  if (stages_.empty()) return;
  take_images(first, second, mask);
  predictor_ = {};
  for (Stage& stage : stages_) improve_predictor(stage);
  measure_nodes(stages_.back(), vectors);
  validate_nodes(vectors);
}

void MultipassFft::improve_predictor(Stage& stage) {
  VectorGrid found{stage.lattice.nx, stage.lattice.ny, {}, {}};
  for (int pass = 0; pass < stage.passes; ++pass) {
    const float change = measure(stage, stage.searches && pass == 0 ? Search::far : Search::near, found);
    median_test(found, options_.median_threshold, options_.median_floor_px * stage.decimation, threads_);
    const float step = std::min(stage.lattice.dx, stage.lattice.dy);
    predictor_.fit(stage.lattice, found.displacement, found.good,
                   std::max(0.5f, smoothing * static_cast<float>(stage.side) / step), threads_);
    if (options_.passes == 0 && !stage.searches && change < converged_px) break;
  }
}

// Measures the stage's even lattice; returns the root mean square residual of the good vectors in pixels.
float MultipassFft::measure(Stage& stage, Search search, VectorGrid& found) {
  warp(stage);
  const Level& l = level(stage.decimation);
  const std::size_t count = stage.points.pixel.size();
  found.displacement.assign(count, {0, 0});
  found.good.assign(count, 0);
  std::vector<float> change(count, 0.0f);
  const auto least_score = static_cast<float>(0.5 * options_.min_score);
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 16)
  for (std::size_t k = 0; k < count; ++k) {
    if (!switched_on(stage.points, k)) continue;
    Tools& tools = stage.tools[std::size_t(omp_get_thread_num())];
    const auto [x, y] = stage.points.pixel[k];
    tools.window.cut(warped_, l.from_full(x), l.from_full(y));
    if (!enough(tools.window) || !textured(tools.window)) continue;
    const Peak peak = tools.find(search);
    if (!(peak.score >= least_score) || (search == Search::far && !peak.interior)) continue;
    const auto predicted = predictor_.at(x, y);
    const auto d = static_cast<float>(stage.decimation);
    found.displacement[k] = {predicted[0] + d * peak.dx, predicted[1] + d * peak.dy};
    found.good[k] = 1;
    change[k] = d * d * (peak.dx * peak.dx + peak.dy * peak.dy);
  }
  double sum = 0, good = 0;
  for (std::size_t k = 0; k < count; ++k) sum += change[k], good += found.good[k];
  return good > 0 ? static_cast<float>(std::sqrt(sum / good)) : 0.0f;
}

void MultipassFft::measure_nodes(Stage& stage, PixelVectors& vectors) {
  warp(stage);
  const Level& l = level(stage.decimation);
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 16)
  for (std::size_t k = 0; k < nodes_.pixel.size(); ++k)
    if (vectors.status[k] != VectorStatus::masked)
      measure_node(stage.tools[std::size_t(omp_get_thread_num())], l, k, vectors);
}

void MultipassFft::measure_node(Tools& tools, const Level& images, std::size_t k, PixelVectors& vectors) {
  const auto [x, y] = nodes_.pixel[k];
  if (!(x >= 0 && y >= 0 && x <= static_cast<float>(width_ - 1) && y <= static_cast<float>(height_ - 1))) return;
  tools.window.cut(warped_, images.from_full(x), images.from_full(y));
  const Window& window = tools.window;
  if (!enough(window)) {
    if (window.usable + window.masked >= static_cast<float>(options_.min_usable))
      vectors.status[k] = VectorStatus::masked;
    return;
  }
  if (!textured(window)) return;
  const bool single_pass = passes_ == 1;  // then nothing has searched with this window yet
  const Peak peak = tools.find(single_pass ? Search::far : Search::near);
  const auto predicted = predictor_.at(x, y);
  vectors.displacement[k] = {predicted[0] + peak.dx, predicted[1] + peak.dy};
  vectors.score[k] = peak.score;
  const Peak matched = single_pass ? tools.near.find(window) : peak;
  vectors.cov[k] = tools.uncertainty.covariance(window, matched, rounding_variance_);
  for (float& entry : vectors.cov[k]) entry *= iteration_variance(passes_);
  const auto most_variance = static_cast<float>(options_.max_sigma_px * options_.max_sigma_px);
  const bool accepted = peak.interior && peak.score >= static_cast<float>(options_.min_score) &&
                        vectors.cov[k][0] <= most_variance && vectors.cov[k][1] <= most_variance;  // false for NaN
  vectors.status[k] = accepted ? VectorStatus::valid : VectorStatus::rejected;
}

// The nodes may be far apart for the field's curvature; the predictor, validated on a finer lattice, knows it. So they
// are judged by what they deviate from it.
void MultipassFft::validate_nodes(PixelVectors& vectors) {
  VectorGrid grid{nodes_.nx, nodes_.ny, vectors.displacement, {}};
  for (std::size_t k = 0; k < grid.displacement.size(); ++k) {
    const auto predicted = predictor_.at(nodes_.pixel[k][0], nodes_.pixel[k][1]);
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

int support_of_window(int window_px) { return 2 * static_cast<int>(std::lround(0.6 * window_px)); }

std::vector<int> window_sides(const PivOptions& options, int width, int height) {
  const int last = options.window_px;
  int first = options.first_window_px;
  if (first == 0) first = std::min(std::max(128, 4 * last), std::min(width, height) / 2);
  first = std::min(first, std::min(width, height));
  std::vector<int> sides;
  for (int side = first; side > last; side = side / 2 > last ? side / 2 : last) sides.push_back(side);
  sides.push_back(last);
  return sides;
}

std::unique_ptr<Method> make_multipass_fft(const PivOptions& options, const NodeLattice& nodes, int width, int height,
                                           int threads) {
  return std::make_unique<MultipassFft>(options, nodes, width, height, threads);
}

}  // namespace pivnp::piv
