#include "pivnp/piv/gauss_newton.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pivnp/piv/increments.hpp"
#include "pivnp/piv/judge.hpp"
#include "pivnp/piv/light.hpp"
#include "pivnp/piv/multipass.hpp"
#include "pivnp/piv/presmoothing.hpp"
#include "pivnp/piv/validate.hpp"
#include "pivnp/piv/window_passes.hpp"

namespace pivnp::piv {

namespace {

constexpr int coarse_passes = 4, middle_passes = 3, fine_passes = 3;  // at 1/4, 1/2 and the full resolution

// Frames at one resolution and the lattice of cells on it.
struct GnLevel : Level {
  int passes = 0;
  PixelFlags first_flags, second_flags;
  CellLattice lattice;
  std::vector<std::uint8_t> wanted;  // points near nodes that are on; empty: all

  // Place of a point of the lattice in the full image.
  float column(int i) const { return to_full(static_cast<float>(lattice.x0 + i * lattice.step)); }
  float row(int j) const { return to_full(static_cast<float>(lattice.y0 + j * lattice.step)); }
  EvenLattice even() const {
    const auto step = static_cast<float>(lattice.step * decimation);
    return {lattice.nx, lattice.ny, column(0), row(0), step, step};
  }
};

class GaussNewton final : public Method {
 public:
  GaussNewton(const PivOptions& options, const NodeLattice& nodes, int width, int height, int threads, int finest);
  void correlate(const ImageView& first, const ImageView& second, const MaskView& mask, PixelVectors& vectors) override;

 private:
  void add_level(int decimation, int passes);
  void take_images(GnLevel& level, const ImageView& first, const ImageView& second, const MaskView& mask);
  void start_from(const GnLevel& level, const PredictorField& predictor);
  void start_from(const GnLevel& level, const GnLevel& coarser);
  void pass(const GnLevel& level, bool scores);
  void smooth(const GnLevel& level);
  void mend(const GnLevel& level);
  void search_again(const GnLevel& level, const std::vector<std::uint8_t>& poor,
                    const std::vector<std::uint8_t>& textured);

  PivOptions options_;
  NodeLattice nodes_;
  int width_, height_, threads_;
  Anchor anchor_;
  WindowPasses windows_;
  std::vector<WindowTools> tools_;  // one a thread, for places searched again
  std::vector<GnLevel> levels_;
  float rounding_ = 0;  // variance of a grey value's rounding, grey^2
  float presmoothing_ = 0;
  LightField light_;
  // The field at the level in work, and what its last pass left.
  std::vector<float> u_, v_, noise_, tolerance_, gain_, offset_;
  SplineField field_;
  CellSums sums_;
  Increments increments_;
  SmoothedField smooth_u_, smooth_v_;
};

GaussNewton::GaussNewton(const PivOptions& options, const NodeLattice& nodes, int width, int height, int threads,
                         int finest)
    : options_(options),
      nodes_(nodes),
      width_(width),
      height_(height),
      threads_(std::max(1, threads)),
      anchor_(options.anchor == "central" ? Anchor::central : Anchor::forward),
      windows_(options, nodes, width, height, threads) {
  const std::vector<int> sides = window_sides(options, width, height);
  const int side = sides.front();
  if (bounding_box(nodes_, static_cast<float>(side) / 2, width, height).empty()) return;  // no node lies in the image
  // A first guess by correlation of large windows of decimated images, then of windows half as large.
  const int decimation = decimation_of(side, sides.back());
  windows_.add(side, decimation, static_cast<float>(side) / 2, 2, true);
  if (side / 2 > options.window_px) windows_.add(side / 2, decimation, static_cast<float>(side) / 4, 1, true);
  constexpr int again_px = 32;  // side of the windows, pixels of the level
  for (int t = 0; t < threads_; ++t) tools_.emplace_back(again_px, true);
  add_level(4, coarse_passes);
  add_level(2, middle_passes);
  if (finest == 1) add_level(1, options.passes > 0 ? options.passes : fine_passes);
}

void GaussNewton::add_level(int decimation, int passes) {
  constexpr int margin = 2;  // cells beyond the outermost nodes
  GnLevel level;
  level.decimation = decimation;
  level.passes = passes;
  CellLattice& lattice = level.lattice;
  lattice.step = std::max(2, options_.window_px / 4);
  const Box box = bounding_box(nodes_, static_cast<float>(margin * lattice.step * decimation), width_, height_);
  const auto place = [&](int first, int end, int& origin, int& points) {
    const float from = level.from_full(static_cast<float>(first)), to = level.from_full(static_cast<float>(end - 1));
    const int cells = static_cast<int>(std::ceil((to - from) / static_cast<float>(lattice.step)));
    points = std::max(least_lattice_points, cells + 1);
    // Centred, so that what the lattice has too much is the same on both sides.
    origin =
        static_cast<int>(std::floor(from - 0.5f * (static_cast<float>((points - 1) * lattice.step) - (to - from))));
  };
  place(box.x0, box.x1, lattice.x0, lattice.nx);
  place(box.y0, box.y1, lattice.y0, lattice.ny);
  if (!nodes_.on.empty()) {
    const float reach = std::max(node_spacing(nodes_), static_cast<float>(margin * lattice.step * decimation));
    level.wanted = nodes_near(level.even(), nodes_, reach).on;
  }
  levels_.push_back(std::move(level));
}

void GaussNewton::take_images(GnLevel& level, const ImageView& first, const ImageView& second, const MaskView& mask) {
  // Averages over blocks of pixels hold what their own sampling folds: where they are the last word, smooth them fully.
  const bool finest = &level == &levels_.back();
  const float smoothing = !finest ? 0.0f : level.decimation == 1 ? presmoothing_ : 0.25f;
  level.first.assign(first, mask, level.decimation, threads_, smoothing);
  level.second.assign(second, mask, level.decimation, threads_, smoothing);
  if (level.decimation == 1) {
    level.first_flags.take(first, mask);
    level.second_flags.take(second, mask);
  } else {
    level.first_flags.take_mask(mask, level.decimation);
    level.second_flags.take_mask(mask, level.decimation);
  }
}

void GaussNewton::correlate(const ImageView& first, const ImageView& second, const MaskView& mask,
                            PixelVectors& vectors) {
  prepare_vectors(nodes_, anchor_, vectors);
  if (windows_.empty()) return;
  rounding_ = first.depth == PixelDepth::f32 ? 1e-14f * first.white * first.white : 1.0f / 12.0f;
  presmoothing_ = presmoothing(first, second);
  light_.clear();
  const PredictorField& predictor = windows_.find(first, second, mask);
  const GnLevel* coarser = nullptr;
  for (GnLevel& level : levels_) {
    take_images(level, first, second, mask);
    coarser == nullptr ? start_from(level, predictor) : start_from(level, *coarser);
    noise_.clear();
    for (int k = 0; k < level.passes; ++k) {
      pass(level, k + 1 == level.passes);
      smooth(level);
    }
    if (&level != &levels_.back()) mend(level);
    field_.interpolate(level.lattice, u_, v_);
    if (coarser == nullptr && levels_.size() > 1) light_.take(sums_, level.decimation, rounding_);
    coarser = &level;
  }
  const GnLevel& finest = levels_.back();
  judge_nodes({options_, nodes_, width_, height_, finest.decimation, threads_, rounding_}, field_, sums_, u_, v_,
              smooth_u_, smooth_v_, vectors);
}

void GaussNewton::start_from(const GnLevel& level, const PredictorField& predictor) {
  const CellLattice& lattice = level.lattice;
  const auto scale = 1 / static_cast<float>(level.decimation);
  u_.resize(lattice.size());
  v_.resize(lattice.size());
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const auto d = predictor.at(level.column(i), level.row(j));
      u_[lattice.index(i, j)] = scale * d[0], v_[lattice.index(i, j)] = scale * d[1];
    }
}

void GaussNewton::start_from(const GnLevel& level, const GnLevel& coarser) {
  const CellLattice& lattice = level.lattice;
  const float scale = static_cast<float>(coarser.decimation) / static_cast<float>(level.decimation);
  u_.resize(lattice.size());
  v_.resize(lattice.size());
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const auto d = field_.at(coarser.from_full(level.column(i)), coarser.from_full(level.row(j)));
      u_[lattice.index(i, j)] = scale * d[0], v_[lattice.index(i, j)] = scale * d[1];
    }
}

// One warp and its sums by the field of now.
void GaussNewton::pass(const GnLevel& level, bool scores) {
  field_.interpolate(level.lattice, u_, v_);
  SumsInput input;
  input.first = &level.first;
  input.second = &level.second;
  if (!level.first_flags.empty()) input.first_flags = &level.first_flags;
  if (!level.second_flags.empty()) input.second_flags = &level.second_flags;
  input.field = &field_;
  input.share_first = anchor_ == Anchor::central ? -0.5f : 0.0f;
  input.share_second = anchor_ == Anchor::central ? 0.5f : 1.0f;
  if (!noise_.empty()) input.noise = &noise_, input.tolerance = &tolerance_;
  if (light_.known()) {
    light_.at(level.lattice, level.decimation, gain_, offset_);
    input.gain = &gain_, input.offset = &offset_;
  }
  if (!level.wanted.empty()) input.active = &level.wanted;
  input.scores = scores;
  accumulate_sums(input, threads_, sums_);
}

// The field of the next pass, and how far residuals may reach in it.
void GaussNewton::smooth(const GnLevel& level) {
  if (options_.smoothing == "adaptive") {
    cell_increments(sums_, rounding_, increments_);
    for (std::size_t k = 0; k < u_.size(); ++k) u_[k] += increments_.u[k], v_[k] += increments_.v[k];
    const Shrinker shrinker(level.lattice);
    shrinker.run(u_, level.wanted, threads_, smooth_u_);
    shrinker.run(v_, level.wanted, threads_, smooth_v_);
    u_ = smooth_u_.value, v_ = smooth_v_.value;
  } else {
    window_increments(sums_, options_.order, static_cast<float>(options_.window_px), level.wanted, threads_,
                      increments_);
    for (std::size_t k = 0; k < u_.size(); ++k) u_[k] += increments_.u[k], v_[k] += increments_.v[k];
    smooth_u_.variance = increments_.variance_u, smooth_v_.variance = increments_.variance_v;
    for (auto* s : {&smooth_u_, &smooth_v_}) s->area.assign(u_.size(), 16.0f);  // a window is four cells wide
  }
  // Lost grains are told from misplaced ones only once the images are nearly in register.
  if (level.decimation <= 2) residual_scale(sums_, u_, v_, rounding_, noise_, tolerance_);
}

// Where the frames still do not match although they have texture, the field sits on a wrong match: such places are
// searched again with small windows, from what the matched surroundings say, and the better of both fields stays.
void GaussNewton::mend(const GnLevel& level) {
  constexpr int rounds = 6;                             // each grows from what the one before has matched
  constexpr float poor_score = 0.6f, most_poor = 0.4f;  // beyond that share the frames are poor, not the match
  const CellLattice& lattice = level.lattice;
  MatchQuality before, after;
  match_quality(sums_, before);
  std::size_t last_count = lattice.size();
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::uint8_t> poor(lattice.size(), 0), textured(lattice.size(), 0);
    std::size_t count = 0, judged = 0;
    for (std::size_t k = 0; k < lattice.size(); ++k) {
      textured[k] = before.usable[k] >= 0.3f && before.variance[k] > 4 * rounding_ && before.contrast[k] > 0.1f;
      poor[k] = textured[k] && before.score[k] < poor_score;
      judged += textured[k], count += poor[k];
    }
    if (count == 0 || static_cast<float>(count) > most_poor * static_cast<float>(judged) ||
        20 * count > 19 * last_count)
      return;
    last_count = count;
    const std::vector<float> u = u_, v = v_;
    search_again(level, poor, textured);
    noise_.clear();
    for (int k = 0; k < level.passes; ++k) {
      pass(level, k + 1 == level.passes);
      smooth(level);
    }
    match_quality(sums_, after);
    for (std::size_t k = 0; k < lattice.size(); ++k)
      if (after.score[k] > before.score[k])
        before.score[k] = after.score[k];
      else
        u_[k] = u[k], v_[k] = v[k];
  }
}

void GaussNewton::search_again(const GnLevel& level, const std::vector<std::uint8_t>& poor,
                               const std::vector<std::uint8_t>& textured) {
  const CellLattice& lattice = level.lattice;
  const auto scale = static_cast<float>(level.decimation);
  VectorGrid known{lattice.nx, lattice.ny, {}, std::vector<std::uint8_t>(lattice.size(), 0)};
  known.displacement.resize(lattice.size());
  std::vector<std::size_t> open;  // points next to a poor one
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t k = lattice.index(i, j);
      bool near_poor = false;
      for (int b = std::max(0, j - 1); b <= std::min(lattice.ny - 1, j + 1); ++b)
        for (int a = std::max(0, i - 1); a <= std::min(lattice.nx - 1, i + 1); ++a)
          near_poor = near_poor || poor[lattice.index(a, b)];
      known.displacement[k] = {scale * u_[k], scale * v_[k]};
      known.good[k] = textured[k] && !near_poor;
      if (near_poor) open.push_back(k);
    }
  PredictorField around;
  around.fit(level.even(), known.displacement, known.good, 0.5f, threads_);
  WarpedPair warped;
  warp_pair(level, around, anchor_, {0, 0, level.first.width(), level.first.height()}, threads_, warped);
  const auto found = [&](std::size_t k, WindowTools& tools) {
    const int i = static_cast<int>(k % std::size_t(lattice.nx)), j = static_cast<int>(k / std::size_t(lattice.nx));
    const auto predicted = around.at(level.column(i), level.row(j));
    known.displacement[k] = predicted;
    tools.window.cut(warped, static_cast<float>(lattice.x0 + i * lattice.step),
                     static_cast<float>(lattice.y0 + j * lattice.step));
    if (!textured[k] || !windows_.enough(tools.window)) return;
    const Peak peak = tools.find(Search::far);
    if (!peak.interior || peak.score < 0.5f) return;
    known.displacement[k] = {predicted[0] + scale * peak.dx, predicted[1] + scale * peak.dy};
    known.good[k] = 1;
  };
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 4)
  for (std::size_t n = 0; n < open.size(); ++n) found(open[n], tools_[std::size_t(omp_get_thread_num())]);
  median_test(known, options_.median_threshold, options_.median_floor_px * scale, threads_);
  around.fit(level.even(), known.displacement, known.good, 0.5f, threads_);
  for (const std::size_t k : open) {
    const auto d = around.at(level.column(static_cast<int>(k % std::size_t(lattice.nx))),
                             level.row(static_cast<int>(k / std::size_t(lattice.nx))));
    u_[k] = d[0] / scale, v_[k] = d[1] / scale;
  }
}

}  // namespace

std::unique_ptr<Method> make_gauss_newton(const PivOptions& options, const NodeLattice& nodes, int width, int height,
                                          int threads, int finest) {
  return std::make_unique<GaussNewton>(options, nodes, width, height, threads, finest);
}

}  // namespace pivnp::piv
