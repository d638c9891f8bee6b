#include "pivnp/piv/window_passes.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pivnp/piv/method.hpp"

namespace pivnp::piv {

namespace {

constexpr int least_search_side = 32;        // pixels of a decimated image that a search window keeps at least
constexpr float converged_px = 0.01f;  // root mean square change of the predictor's vectors
constexpr float smoothing = 0.3f;      // standard deviation of the predictor's weights over the window's side

}  // namespace

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

int decimation_of(int side, int last_side) {
  int decimation = 1;
  while (side > last_side && side / (2 * decimation) >= least_search_side) decimation *= 2;
  return decimation;
}

WindowPasses::WindowPasses(const PivOptions& options, const Extent& extent, int threads)
    : options_(options), extent_(extent), threads_(std::max(1, threads)), anchor_(options.anchor) {}

void WindowPasses::add(int side, int decimation, float step, int passes, bool searches) {
  WindowStage stage;
  stage.decimation = decimation;
  stage.side = side / decimation * decimation;
  stage.lattice =
      even_lattice(bounding_box(extent_.nodes, static_cast<float>(side) / 2, extent_.width, extent_.height), step);
  stage.points = nodes_near(stage.lattice, extent_.nodes, 1.5f * std::max(node_spacing(extent_.nodes), step));
  stage.passes = passes;
  stage.searches = searches;
  for (int t = 0; t < threads_; ++t) stage.tools.emplace_back(stage.level_side(), searches);
  if (images(decimation) == nullptr) {
    Level& added = levels_.emplace_back();
    added.decimation = decimation;
    added.mask = mask_at(extent_.mask, decimation);
  }
  stages_.push_back(std::move(stage));
}

// 1 where most of a block of pixels may be used.
std::vector<std::uint8_t> WindowPasses::mask_at(const MaskView& mask, int decimation) const {
  if (mask.data == nullptr) return {};
  std::vector<std::uint8_t> out;
  for (int r = 0; r < extent_.height / decimation; ++r)
    for (int c = 0; c < extent_.width / decimation; ++c) {
      int usable = 0;
      for (int dr = 0; dr < decimation; ++dr)
        for (int dc = 0; dc < decimation; ++dc) usable += mask.usable(c * decimation + dc, r * decimation + dr);
      out.push_back(2 * usable > decimation * decimation);
    }
  return out;
}

void WindowPasses::set_first_mask(const MaskView& mask) {
  for (Level& l : levels_) l.first_mask = mask_at(mask, l.decimation);
}

const Level* WindowPasses::images(int decimation) const {
  const auto at =
      std::find_if(levels_.begin(), levels_.end(), [&](const Level& l) { return l.decimation == decimation; });
  return at == levels_.end() ? nullptr : &*at;
}

void WindowPasses::take_images(const ImageView& first, const ImageView& second) {
  rounding_variance_ = piv::rounding_variance(first);
  for (Level& l : levels_) {
    l.first.assign(first, extent_.mask, l.decimation, threads_);
    l.second.assign(second, extent_.mask, l.decimation, threads_);
  }
}

void WindowPasses::take_images(const FramePair& pair) {
  take_images(pair.first, pair.second);
  set_first_mask(pair.material);
}

const WarpedPair& WindowPasses::warp(const WindowStage& stage) {
  const Level& l = level(stage);
  const Box full =
      bounding_box(extent_.nodes, static_cast<float>(stage.side) + 2.0f * std::max(stage.lattice.dx, stage.lattice.dy),
                   extent_.width, extent_.height);
  const int d = stage.decimation;
  const Box box{full.x0 / d, full.y0 / d, std::min((full.x1 + d - 1) / d, l.first.width()),
                std::min((full.y1 + d - 1) / d, l.first.height())};
  warp_pair(l, predictor_, anchor_, box, threads_, warped_);
  return warped_;
}

const PredictorField& WindowPasses::find(const ImageView& first, const ImageView& second) {
  take_images(first, second);
  predictor_ = std::exchange(start_, {});
  for (WindowStage& stage : stages_)
    if (!started_ || stage.side <= options_.window_px) improve_predictor(stage);
  started_ = false;
  return predictor_;
}

void WindowPasses::start_from(std::span<const std::array<float, 2>> displacement, std::span<const std::uint8_t> known) {
  const NodeLattice& nodes = extent_.nodes;
  const float window = static_cast<float>(options_.window_px), step = std::max(node_spacing(nodes), window / 2);
  const Box box = bounding_box(nodes, window / 2, extent_.width, extent_.height);
  if (box.empty()) return;
  const EvenLattice lattice = even_lattice(box, step);
  const std::size_t points = std::size_t(lattice.nx) * std::size_t(lattice.ny);
  std::vector<std::array<float, 2>> mean(points, {0, 0});
  std::vector<std::uint8_t> good(points, 0);
  std::vector<float> count(points, 0);
  for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
    if (!known[k]) continue;
    const auto i = std::lround((nodes.pixel[k][0] - lattice.x0) / lattice.dx), j = std::lround((nodes.pixel[k][1] - lattice.y0) / lattice.dy);
    if (i < 0 || j < 0 || i >= lattice.nx || j >= lattice.ny) continue;
    const std::size_t n = std::size_t(j) * std::size_t(lattice.nx) + std::size_t(i);
    mean[n][0] += displacement[k][0], mean[n][1] += displacement[k][1], ++count[n];
  }
  for (std::size_t n = 0; n < points; ++n)
    if (count[n] > 0) mean[n][0] /= count[n], mean[n][1] /= count[n], good[n] = 1;
  if (std::find(good.begin(), good.end(), 1) == good.end()) return;
  start_.fit(lattice, mean, good, 1, threads_);
  started_ = true;
}

const PredictorField& WindowPasses::find(std::span<const FramePair> pairs) {
  predictor_ = {};
  pairs_ = pairs;
  for (WindowStage& stage : stages_) improve_predictor(stage);
  pairs_ = {};
  return predictor_;
}

float WindowPasses::least_score(std::size_t count) const {
  return static_cast<float>(options_.min_score / std::sqrt(double(std::max<std::size_t>(1, count))));
}

bool WindowPasses::textured(const Window& window) const {
  return std::min(window.variance_f, window.variance_g) > 4 * rounding_variance_;
}

void WindowPasses::improve_predictor(WindowStage& stage) {
  VectorGrid found{stage.lattice.nx, stage.lattice.ny, {}, {}};
  for (int pass = 0; pass < stage.passes; ++pass) {
    const Search search = stage.searches && pass == 0 ? Search::far : Search::near;
    const float change = pairs_.empty() ? measure(stage, search, found) : measure_mean(stage, search, found);
    median_test(found, options_.median_threshold, options_.median_floor_px * stage.decimation, threads_);
    const float step = std::min(stage.lattice.dx, stage.lattice.dy);
    predictor_.fit(stage.lattice, found.displacement, found.good,
                   std::max(0.5f, smoothing * static_cast<float>(std::max(stage.side, stages_.back().side)) / step),
                   threads_);
    if (options_.passes == 0 && !stage.searches && change < converged_px) break;
  }
}

// Measures the stage's even lattice; returns the root mean square residual of the good vectors in pixels.
float WindowPasses::measure(WindowStage& stage, Search search, VectorGrid& found) {
  warp(stage);
  const Level& l = level(stage);
  const std::size_t count = stage.points.pixel.size();
  found.displacement.assign(count, {0, 0});
  found.good.assign(count, 0);
  std::vector<float> change(count, 0.0f);
  const auto least_score = static_cast<float>(0.5 * options_.min_score);
  const auto take = [&](std::size_t k, const Peak& peak) {
    if (!(peak.score >= least_score) || (search == Search::far && !peak.interior)) return;
    const auto predicted = predictor_.at(stage.points.pixel[k][0], stage.points.pixel[k][1]);
    const auto d = static_cast<float>(stage.decimation);
    found.displacement[k] = {predicted[0] + d * peak.dx, predicted[1] + d * peak.dy};
    found.good[k] = 1;
    change[k] = d * d * (peak.dx * peak.dx + peak.dy * peak.dy);
  };
  constexpr std::size_t batch = FftCorrelator::batch;
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 1)
  for (std::size_t first = 0; first < count; first += batch) {
    WindowTools& tools = stage.tools[std::size_t(omp_get_thread_num())];
    std::size_t point[batch];
    int cut = 0;
    for (std::size_t k = first; k < std::min(first + batch, count); ++k) {
      if (!switched_on(stage.points, k)) continue;
      tools.window.cut(warped_, l.from_full(stage.points.pixel[k][0]), l.from_full(stage.points.pixel[k][1]),
                       false);
      if (!enough(tools.window) || !textured(tools.window)) continue;
      if (search == Search::near) {
        take(k, tools.near.find(tools.window));
      } else {
        tools.fft.front().put(cut, tools.window);
        point[cut++] = k;
      }
    }
    if (cut == 0) continue;
    Peak peaks[batch];
    tools.fft.front().find(cut, peaks);
    for (int n = 0; n < cut; ++n) take(point[n], peaks[n]);
  }
  double sum = 0, good = 0;
  for (std::size_t k = 0; k < count; ++k) sum += change[k], good += found.good[k];
  return good > 0 ? static_cast<float>(std::sqrt(sum / good)) : 0.0f;
}

// As measure(), of the mean correlation of all pairs. Their images are taken in turn, so that one pair is in memory at
// a time; the correlations of all windows are.
float WindowPasses::measure_mean(WindowStage& stage, Search search, VectorGrid& found) {
  const Level& l = level(stage);
  const std::size_t points = stage.points.pixel.size();
  const bool far = search == Search::far;
  const auto size = std::size_t(far ? stage.tools.front().fft.front().plane_size() : NearCorrelator::plane_size);
  std::vector<float> planes(points * size, 0.0f);
  std::vector<int> used(points, 0);
  constexpr std::size_t batch = FftCorrelator::batch;
  for (const FramePair& pair : pairs_) {
    take_images(pair);
    warp(stage);
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 1)
    for (std::size_t first = 0; first < points; first += batch) {
      WindowTools& tools = stage.tools[std::size_t(omp_get_thread_num())];
      float* to[batch];
      int cut = 0;
      for (std::size_t k = first; k < std::min(first + batch, points); ++k) {
        if (!switched_on(stage.points, k)) continue;
        tools.window.cut(warped_, l.from_full(stage.points.pixel[k][0]), l.from_full(stage.points.pixel[k][1]), false);
        if (!enough(tools.window) || !textured(tools.window)) continue;
        ++used[k];
        if (!far) {
          tools.near.add(tools.window, planes.data() + k * size);
          continue;
        }
        tools.fft.front().put(cut, tools.window);
        to[cut++] = planes.data() + k * size;
      }
      if (cut > 0) tools.fft.front().add(cut, to);
    }
  }
  found.displacement.assign(points, {0, 0});
  found.good.assign(points, 0);
  const float least = 0.5f * least_score(pairs_.size()), d = static_cast<float>(stage.decimation);
  double sum = 0, good = 0;
  for (std::size_t k = 0; k < points; ++k) {
    if (used[k] == 0) continue;
    const float* plane = planes.data() + k * size;
    const Peak peak =
        far ? stage.tools.front().fft.front().peak_of(plane, used[k]) : NearCorrelator::peak_of(plane, used[k]);
    if (!(peak.score >= least) || (far && !peak.interior)) continue;
    const auto predicted = predictor_.at(stage.points.pixel[k][0], stage.points.pixel[k][1]);
    found.displacement[k] = {predicted[0] + d * peak.dx, predicted[1] + d * peak.dy};
    found.good[k] = 1;
    sum += double(d * d * (peak.dx * peak.dx + peak.dy * peak.dy));
    ++good;
  }
  return good > 0 ? static_cast<float>(std::sqrt(sum / good)) : 0.0f;
}

}  // namespace pivnp::piv
