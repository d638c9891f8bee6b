#include "pivnp/piv/gauss_newton.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "pivnp/piv/dense/corrections.hpp"
#include "pivnp/piv/dense/illumination.hpp"
#include "pivnp/piv/dense/lost.hpp"
#include "pivnp/piv/recorrelation.hpp"
#include "pivnp/piv/sampling/even_light.hpp"
#include "pivnp/piv/sampling/presmoothing.hpp"
#include "pivnp/piv/validation/vector_validation.hpp"

namespace pivnp::piv {

namespace {

constexpr int coarse_passes = 4, middle_passes = 3, fine_passes = 3;  // at 1/4, 1/2 and the full resolution

float greatest_change(const std::vector<float>& a, const std::vector<float>& b) {
  float most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

class GaussNewton final : public Method {
 public:
  GaussNewton(const PivOptions& options, const Extent& extent, int threads, int finest);
  void correlate(const ImageView& first, const ImageView& second, PixelVectors& vectors) override;
  void start_from(std::span<const std::array<float, 2>> displacement, std::span<const std::uint8_t> known) override {
    if (!windows_.empty()) windows_.start_from(displacement, known);
  }
  void set_first_mask(const MaskView& mask) override {
    first_mask_ = mask;
    windows_.set_first_mask(mask);
    for (GnLevel& level : levels_) level.set_first_mask(mask);
  }
  // The cells of the field stay where they are; the vectors are its values at the nodes.
  bool place(const NodeLattice& nodes) override {
    extent_.nodes = nodes;
    return true;
  }
  const DenseField* field() const override {
    return options_.smoothing == Smoothing::adaptive && !windows_.empty() ? &dense_ : nullptr;
  }

 private:
  void start_from(const GnLevel& level, const PredictorField& predictor);
  void start_from(const GnLevel& level, const GnLevel& coarser);
  void correlate_as_they_are(const ImageView& first, const ImageView& second, PixelVectors& vectors);
  float mismatch_at(const std::vector<std::size_t>& points);
  void pass(const GnLevel& level, bool scores);
  void smooth(const GnLevel& level);
  void run_passes(const GnLevel& level);
  void recorrelate(const GnLevel& level);
  void estimate_illumination(const GnLevel& level);
  void find_lost(const GnLevel& finest);

  PivOptions options_;
  Extent extent_;
  MaskView first_mask_;
  int threads_;
  Anchor anchor_;
  WindowPasses windows_;
  Recorrelation recorrelation_;
  std::vector<GnLevel> levels_;
  float rounding_ = 0;  // variance of a grey value's rounding, grey^2
  IlluminationCorrection illumination_;
  // The field at the level in work, and what its last pass left.
  std::vector<float> u_, v_, before_u_, before_v_, noise_, tolerance_, gain_, offset_;
  SplineField field_;
  DenseField dense_;
  CellSums sums_;
  Corrections corrections_;
  SmoothedField smooth_u_, smooth_v_;
};

GaussNewton::GaussNewton(const PivOptions& options, const Extent& extent, int threads, int finest)
    : options_(options),
      extent_(extent),
      threads_(std::max(1, threads)),
      anchor_(options.anchor),
      windows_(options, extent, threads),
      recorrelation_(options, threads_) {
  const std::vector<int> sides = window_sides(options, extent.width, extent.height);
  const int side = sides.front();
  if (bounding_box(extent.nodes, static_cast<float>(side) / 2, extent.width, extent.height).empty())
    return;  // no node lies in the image
  // A first guess by correlation of large windows of decimated images, then of windows half as large.
  const int decimation = decimation_of(side, sides.back());
  windows_.add(side, decimation, static_cast<float>(side) / 2, 2, true);
  if (side / 2 > options.window_px) windows_.add(side / 2, decimation, static_cast<float>(side) / 4, 1, true);
  const auto add_level = [&](int level_decimation, int passes) {
    levels_.emplace_back(extent, level_decimation, options.window_px, passes);
  };
  add_level(4, coarse_passes);
  add_level(2, middle_passes);
  if (finest == 1) add_level(1, options.passes > 0 ? options.passes : fine_passes);
}

void GaussNewton::correlate(const ImageView& first, const ImageView& second, PixelVectors& vectors) {
  if (windows_.empty()) return;
  const PixelVectors before = vectors;
  rounding_ = rounding_variance(first);
  correlate_as_they_are(first, second, vectors);
  const std::vector<std::size_t> suspected = moving_light(sums_, rounding_);
  if (suspected.empty()) return;
  // Again on frames freed of light; that field stays if the texture matches better by it, and no fewer vectors hold.
  const DenseField field_as_is = dense_;
  const PixelVectors vectors_as_is = vectors;
  const float rounding = rounding_;
  const std::vector<float> u = u_, v = v_;
  vectors = before;
  rounding_ = evened_rounding(rounding);
  correlate_as_they_are(even_light(first, threads_).view(), even_light(second, threads_).view(), vectors);
  noise_.clear();
  const float freed = mismatch_at(suspected);
  u_ = u;
  v_ = v;
  const float as_is = mismatch_at(suspected);
  rounding_ = rounding;
  const auto valid = [](const PixelVectors& of) { return std::ranges::count(of.status, VectorStatus::valid); };
  if (freed < as_is && valid(vectors) >= valid(vectors_as_is)) return;
  dense_ = field_as_is;
  vectors = vectors_as_is;
}

// Mean of 1 - score, by the field of now, at the finest level's points.
float GaussNewton::mismatch_at(const std::vector<std::size_t>& points) {
  pass(levels_.back(), true);
  MatchQuality quality;
  match_quality(sums_, quality);
  double sum = 0;
  for (const std::size_t k : points) sum += 1 - double(quality.score[k]);
  return static_cast<float>(sum / double(points.size()));
}

void GaussNewton::correlate_as_they_are(const ImageView& first, const ImageView& second, PixelVectors& vectors) {
  illumination_.clear();
  const PredictorField& predictor = windows_.find(first, second);
  const GnLevel* coarser = nullptr;
  for (GnLevel& level : levels_) {
    // Averages over blocks of pixels hold the aliases of their own sampling: where the result rests on them, they are
    // smoothed fully.
    const bool finest = &level == &levels_.back();
    const float smoothing = !finest ? 0.0f : level.decimation() == 1 ? presmoothing(first, second, threads_) : 0.25f;
    level.take(first, second, smoothing, threads_, finest ? nullptr : windows_.images(level.decimation()));
    coarser == nullptr ? start_from(level, predictor) : start_from(level, *coarser);
    // Before anything is matched by it, and again once it is matched.
    if (coarser == nullptr) estimate_illumination(level);
    run_passes(level);
    if (!finest) recorrelate(level);
    field_.interpolate(level.lattice(), u_, v_, threads_);
    if (coarser == nullptr && levels_.size() > 1) illumination_.take(sums_, level.decimation(), threads_, rounding_);
    coarser = &level;
  }
  const GnLevel& finest = levels_.back();
  find_lost(finest);
  validate_vectors({limits_of(options_), extent_.nodes, extent_.width, extent_.height, finest.decimation(), threads_,
                    rounding_, first_mask_.data != nullptr ? first_mask_ : extent_.mask},
                   field_, sums_, u_, v_, smooth_u_, smooth_v_, vectors, dense_.trusted);
  dense_.lattice = finest.lattice(), dense_.decimation = finest.decimation(), dense_.wanted = &finest.wanted();
  dense_.smooth_u = u_, dense_.smooth_v = v_;
  dense_.variance_u = smooth_u_.variance, dense_.variance_v = smooth_v_.variance;
  for (std::size_t k = 0; k < smooth_u_.lost.size(); ++k)
    dense_.variance_u[k] += smooth_u_.lost[k], dense_.variance_v[k] += smooth_v_.lost[k];
}

// Stated with the vectors, and used for nothing else.
void GaussNewton::find_lost(const GnLevel& finest) {
  if (options_.smoothing != Smoothing::adaptive) return;
  std::vector<float> off(u_.size());
  for (const auto& [measured, smooth, field] : {std::tuple{&dense_.u, &u_, &smooth_u_}, {&dense_.v, &v_, &smooth_v_}}) {
    for (std::size_t k = 0; k < off.size(); ++k) off[k] = (*measured)[k] - (*smooth)[k];
    lost_variance(finest.lattice(), off, finest.wanted(), threads_, field->lost);
  }
}

void GaussNewton::start_from(const GnLevel& level, const PredictorField& predictor) {
  const CellLattice& lattice = level.lattice();
  const auto scale = 1 / static_cast<float>(level.decimation());
  u_.resize(lattice.size());
  v_.resize(lattice.size());
  for (int j = 0; j < lattice.ny; ++j)
    for (int i = 0; i < lattice.nx; ++i) {
      const auto d = predictor.at(level.column(i), level.row(j));
      u_[lattice.index(i, j)] = scale * d[0], v_[lattice.index(i, j)] = scale * d[1];
    }
}

void GaussNewton::start_from(const GnLevel& level, const GnLevel& coarser) {
  const CellLattice& lattice = level.lattice();
  const float scale = static_cast<float>(coarser.decimation()) / static_cast<float>(level.decimation());
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
  field_.interpolate(level.lattice(), u_, v_, threads_);
  SumsInput input;
  input.first = &level.images().first;
  input.second = &level.images().second;
  input.first_flags = level.first_flags();
  input.second_flags = level.second_flags();
  input.field = &field_;
  input.shares = shares_of(anchor_);
  if (!noise_.empty()) input.noise = &noise_, input.tolerance = &tolerance_;
  if (illumination_.known()) {
    illumination_.at(level.lattice(), level.decimation(), threads_, gain_, offset_);
    input.gain = &gain_, input.offset = &offset_;
  }
  if (!level.wanted().empty()) input.active = &level.wanted();
  input.scores = scores;
  accumulate_sums(input, threads_, sums_);
}

// From the frames as the predictor brings them together: without it a change of light is taken for motion, which no
// later pass undoes.
void GaussNewton::estimate_illumination(const GnLevel& level) {
  noise_.clear();
  pass(level, true);
  illumination_.take(sums_, level.decimation(), threads_, rounding_);
}

// All passes of a level from the field of now, at first without robust weights. A field that a pass has hardly moved
// has converged: the last pass alone, which also scores, is left.
void GaussNewton::run_passes(const GnLevel& level) {
  constexpr float still = 1e-3f;  // pixels of the level
  noise_.clear();
  const int last = level.passes() - 1;
  for (int k = 0; k <= last; ++k) {
    pass(level, k == last);
    before_u_ = u_, before_v_ = v_;
    smooth(level);
    if (k < last && greatest_change(before_u_, u_) < still && greatest_change(before_v_, v_) < still) k = last - 1;
  }
}

// The field of the next pass, and how far residuals may reach in it.
void GaussNewton::smooth(const GnLevel& level) {
  if (options_.smoothing == Smoothing::adaptive) {
    cell_corrections(sums_, rounding_, corrections_);
    for (std::size_t k = 0; k < u_.size(); ++k) u_[k] += corrections_.u[k], v_[k] += corrections_.v[k];
    level.shrinker().run(u_, level.wanted(), threads_, smooth_u_);
    level.shrinker().run(v_, level.wanted(), threads_, smooth_v_);
    dense_.u.swap(u_), dense_.v.swap(v_);
    u_ = smooth_u_.value, v_ = smooth_v_.value;
  } else {
    window_corrections(sums_, options_.order, static_cast<float>(options_.window_px), level.wanted(), threads_,
                      corrections_);
    for (std::size_t k = 0; k < u_.size(); ++k) u_[k] += corrections_.u[k], v_[k] += corrections_.v[k];
    smooth_u_.variance = corrections_.variance_u, smooth_v_.variance = corrections_.variance_v;
    for (auto* s : {&smooth_u_, &smooth_v_}) s->area.assign(u_.size(), 16.0f);  // a window is four cells wide
  }
  // Lost grains can be distinguished from misplaced ones only once the images are nearly in register.
  if (level.decimation() <= 2) residual_scale(sums_, u_, v_, rounding_, noise_, tolerance_);
}

// Where the frames still do not match although they have texture, the field sits on a wrong match: such places are
// searched again, and the better of both fields stays.
void GaussNewton::recorrelate(const GnLevel& level) {
  constexpr int rounds = 6;  // each grows from what the one before has matched
  MatchQuality before, after;
  match_quality(sums_, before);
  std::size_t last_count = level.lattice().size();
  for (int round = 0; round < rounds; ++round) {
    const Mismatch mismatch(before, rounding_);
    if (mismatch.count == 0 || mismatch.frames_poor || 20 * mismatch.count > 19 * last_count) return;
    last_count = mismatch.count;
    const std::vector<float> u = u_, v = v_;
    recorrelation_.search(level, mismatch, u_, v_);
    run_passes(level);
    match_quality(sums_, after);
    for (std::size_t k = 0; k < u.size(); ++k)
      if (after.score[k] > before.score[k])
        before.score[k] = after.score[k];
      else
        u_[k] = u[k], v_[k] = v[k];
  }
}

}  // namespace

std::unique_ptr<Method> make_gauss_newton(const PivOptions& options, const Extent& extent, int threads, int finest) {
  return std::make_unique<GaussNewton>(options, extent, threads, finest);
}

}  // namespace pivnp::piv
