#include "apps/study/methods/paths/drift.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "apps/study/methods/paths/subset_bend.hpp"
#include "apps/study/methods/paths/unseen_error.hpp"
#include "apps/study/pipeline/measure/statistics.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/np/errors/fusion.hpp"
#include "pivnp/piv/window/subset.hpp"

namespace pivnp::app {

namespace {

using Cov = std::array<double, 3>;

constexpr double min_score = 0.6, good_score = 0.75;
constexpr double share_that_fails = 0.1;
constexpr double floor_px = 0.01;  // bias of the direct correlation itself: interpolation

Mat2 matrix_of(const Cov& c) {
  Mat2 m;
  m << c[0], c[2], c[2], c[1];
  return m;
}

Cov cov_of(const Mat2& m) { return {m(0, 0), m(1, 1), m(0, 1)}; }

Cov carried(const Mat2& f, const Cov& c) { return cov_of(f * matrix_of(c) * f.transpose()); }

// What a key frame remembers.
struct KeyFrame {
  int frame = 0;
  piv::SubsetImage image;
  std::vector<Vec2> x;
  std::vector<Mat2> F;
  std::vector<Cov> random, cov_F;
  std::vector<Vec2> bias, lost;
  std::vector<UnseenError> unseen;
  std::vector<std::uint8_t> alive;
};

}  // namespace

struct DriftCorrector::Impl {
  Impl(const Case& c, const Setting& s, int thread_count)
      : setting(s), options(c.np.value_or(np::NpOptions{})), threads(thread_count) {
    const int window = c.piv.value_or(piv::PivOptions{}).window_px;
    subset.side_px = std::max(window, 20) / 2 * 2 + 1;
  }

  const Setting& setting;
  np::NpOptions options;
  int threads;
  piv::SubsetOptions subset;
  std::shared_ptr<KeyFrame> first, kept, newest;
  std::vector<DriftRound> rounds;
  UnseenErrors unseen;

  std::shared_ptr<KeyFrame> key_frame(const np::Tracker& tracker, const np::BendLoss& lost, int frame,
                                      const ImageView& image) const {
    auto key = std::make_shared<KeyFrame>();
    key->frame = frame;
    key->image.assign(image, mask_of(setting, frame, image).view(), threads);
    const auto state = tracker.state();
    for (std::size_t p = 0; p < state.size(); ++p) {
      const auto now = state[p];
      key->x.push_back(now.x);
      key->F.push_back(now.F);
      key->random.push_back(now.random);
      key->bias.push_back(now.bias);
      key->lost.push_back(lost.lost(p));
      key->cov_F.push_back(now.cov_F);
      key->alive.push_back(alive(now.status));
    }
    key->unseen = unseen.all();
    return key;
  }

  struct Direct {
    Vec2 x;
    Cov cov;          // of x, world
    Mat2 f;           // deformation since the key frame
    double var_f = 0;
    double off_px = 0;
    Mat2 beside = Mat2::Zero();  // share by which it is put where the path field is beside the fit of its bend
    Vec2 lost = Vec2::Zero();  // world: by how much it is off since the bend it was given has lost some, as BendLoss
  };

  // A cubic term of RMS s about its own affine fit over a square of half side 1 has the gradient 4 s at the centre.
  static constexpr double beyond_bend = 4;

  std::vector<SubsetBend> bends_of(const std::vector<piv::AffinePrediction>& predictions) const {
    std::vector<Vec2> from, to;
    std::vector<Mat2> A;
    for (const piv::AffinePrediction& at : predictions) from.push_back(at.from), to.push_back(at.to), A.push_back(at.A);
    return subset_bends(from, to, A, 0.5 * subset.side_px, threads);
  }

  // What the subset takes over from the path field (its bend, and how far its centre is beside it) lacks what smoothing
  // took off. Of that, the subset finds the affine part alone.
  std::vector<SubsetBend> missed_bends(const std::vector<piv::AffinePrediction>& predictions,
                                       const std::vector<Vec2>& lost_px) const {
    std::vector<Vec2> from;
    for (const piv::AffinePrediction& at : predictions) from.push_back(at.from);
    return subset_bends(from, lost_px, std::vector<Mat2>(from.size(), Mat2::Zero()), 0.5 * subset.side_px, threads);
  }

  // A subset finds the place of the quadratic fit; at its centre the path field is beside that, by what is real of what
  // the fit leaves: the rest, of a variance as stated of the paths, is theirs (James & Stein 1961).
  static Vec2 share_that_is_no_noise(const Vec2& left, double sigma) {
    const auto share = [&](double v) { return v > 0 ? std::max(0.0, 1 - 0.5 * sigma * sigma / (v * v)) : 0.0; };
    return {share(left.x()), share(left.y())};
  }

  // Direct estimates of the particles `wanted` from `key`; those that do not count are left out of `found`.
  void match(const np::Tracker& tracker, const np::BendLoss& lost, const KeyFrame& key, const piv::SubsetImage& now,
             int frame, const std::vector<std::size_t>& wanted, double score,
             std::unordered_map<std::size_t, Direct>& found) const {
    const image::Camera &then = setting.camera_at(key.frame), &camera = setting.camera_at(frame);
    // The path field bends as all particles show, those too that are not asked for.
    std::vector<std::size_t> asked;
    std::vector<piv::AffinePrediction> all, predictions;
    std::vector<Vec2> lost_px;
    std::vector<std::uint8_t> is_wanted(key.x.size()), ask;
    for (const std::size_t p : wanted) is_wanted[p] = 1;
    const auto state = tracker.state();
    for (std::size_t p = 0; p < key.x.size(); ++p) {
      if (!key.alive[p] || !alive(state.status(p))) continue;
      const auto particle = state[p];
      piv::AffinePrediction guess;
      guess.from = then.to_pixel(key.x[p]);
      guess.to = camera.to_pixel(particle.x);
      guess.A = camera.jacobian(guess.to).inverse() * particle.F * key.F[p].inverse() * then.jacobian(guess.from);
      if (!guess.from.allFinite() || !guess.to.allFinite() || !guess.A.allFinite()) continue;  // beyond what the lens maps
      all.push_back(guess);
      lost_px.push_back(camera.jacobian(guess.to).inverse() *
                        (lost.lost(p) - particle.F * (key.F[p].inverse() * key.lost[p])));
      ask.push_back(is_wanted[p]);
      if (is_wanted[p]) asked.push_back(p);
    }
    const auto of_asked = [&](std::vector<SubsetBend> bends) {
      std::size_t count = 0;
      for (std::size_t k = 0; k < bends.size(); ++k)
        if (ask[k]) bends[count++] = bends[k];
      bends.resize(count);
      return bends;
    };
    const std::vector<SubsetBend> bends = of_asked(bends_of(all)), missed = of_asked(missed_bends(all, lost_px));
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (!ask[k]) continue;
      predictions.push_back(all[k]);
      if (const SubsetBend& bend = bends[predictions.size() - 1]; bend.whole) predictions.back().bend = bend.bend;
    }
    auto matches = piv::match_subsets(key.image, now, predictions, subset, threads);
    std::vector<Vec2> off(asked.size()), beside(asked.size());
    std::vector<std::uint8_t> good(asked.size());
    for (std::size_t k = 0; k < asked.size(); ++k) {
      const Mat2 J = camera.jacobian(predictions[k].to);
      const double pixel = std::sqrt(std::abs(J.determinant()));
      const Cov& c = state[asked[k]].cov;
      const double sigma = std::isfinite(c[0] + c[1]) ? std::sqrt(std::max(0.0, c[0] + c[1])) / pixel : 0;
      const double noise =
          std::sqrt(std::max(0.0, sigma * sigma - lost.lost(asked[k]).squaredNorm() / (pixel * pixel)));
      beside[k] = share_that_is_no_noise(bends[k].left, noise);
      matches[k].to -= bends[k].whole ? Vec2(beside[k].cwiseProduct(bends[k].centre)) : bends[k].place;
      off[k] = matches[k].to - predictions[k].to;
      // Room for drift: half a pixel, .02 px a frame, and the prediction's own scatter.
      const double room = 0.5 + 0.02 * (frame - key.frame) + 3 * sigma;
      good[k] = matches[k].found && matches[k].score >= score && off[k].norm() <= room;
    }
    keep_those_in_line(predictions, off, good);
    for (std::size_t k = 0; k < asked.size(); ++k) {
      if (!good[k]) continue;
      const Mat2 J0 = then.jacobian(predictions[k].from), J1 = camera.jacobian(matches[k].to);
      Direct d;
      d.x = camera.to_world(matches[k].to);
      Cov c = matches[k].cov;
      // The subset bends as paths do to second order; beyond it the field bends on. One that is not full of particles is affine:
      // as much as was corrected is not known.
      const bool whole = bends[k].whole;
      const Vec2& b = whole ? bends[k].left : bends[k].place;
      c[0] += floor_px * floor_px + b.x() * b.x(), c[1] += floor_px * floor_px + b.y() * b.y();
      if (!whole) c[2] += b.x() * b.y();
      const Vec2 m = whole ? Vec2(missed[k].place + beside[k].cwiseProduct(missed[k].centre)) : missed[k].place;
      c[0] += m.x() * m.x(), c[1] += m.y() * m.y(), c[2] += m.x() * m.y();
      d.lost = -(J1 * m);
      if (whole) d.beside = J1 * beside[k].asDiagonal() * J1.inverse();
      d.cov = carried(J1, c);
      d.f = J1 * matches[k].A * J0.inverse();
      const double edge = floor_px / (subset.side_px / 2);
      const double bent_on = whole ? beyond_bend * bends[k].left.norm() / (std::sqrt(2.0) * subset.side_px / 2) : bends[k].gradient;
      d.var_f = matches[k].var_A + edge * edge + bent_on * bent_on + missed[k].gradient * missed[k].gradient;
      d.off_px = off[k].norm();
      if (d.f.determinant() > 0) found.emplace(asked[k], d);
    }
  }

  // Drift is smooth: an estimate far from what its neighbours within a window say is a false match.
  void keep_those_in_line(const std::vector<piv::AffinePrediction>& at, const std::vector<Vec2>& off,
                          std::vector<std::uint8_t>& good) const {
    const double size = subset.side_px;
    const auto bin = [&](double v) { return std::int64_t(std::floor(v / size)); };
    std::unordered_map<std::int64_t, std::vector<std::size_t>> bins;
    const auto code = [](std::int64_t i, std::int64_t j) { return i * 1000003 + j; };
    for (std::size_t k = 0; k < at.size(); ++k)
      if (good[k]) bins[code(bin(at[k].to.x()), bin(at[k].to.y()))].push_back(k);
    const std::vector<std::uint8_t> before = good;
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (!before[k]) continue;
      std::vector<double> u, v;
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) {
          const auto there = bins.find(code(bin(at[k].to.x()) + di, bin(at[k].to.y()) + dj));
          if (there == bins.end()) continue;
          for (const std::size_t q : there->second)
            if (q != k) u.push_back(off[q].x()), v.push_back(off[q].y());
        }
      if (u.size() < 4) continue;
      const Vec2 mid(median(u), median(v));
      for (double& a : u) a = std::abs(a - mid.x());
      for (double& a : v) a = std::abs(a - mid.y());
      const Vec2 apart = (off[k] - mid).cwiseAbs();
      if (apart.x() > 0.3 + 4 * median(u) || apart.y() > 0.3 + 4 * median(v)) good[k] = 0;
    }
  }

  // Both estimates start from the key frame. What the sum has read wrongly between nodes since then counts as an error
  // of its own; of it, and of its random part, is left what the weight of the direct estimate leaves. What the direct
  // estimate took over from the paths is an error of both, and stays.
  void fuse_one(np::Tracker& tracker, np::BendLoss& lost, const KeyFrame& key, std::size_t p, const Direct& d) {
    const auto now = tracker.state()[p];
    const Mat2 f = now.F * key.F[p].inverse();
    const Cov before = carried(f, key.random[p]);
    const Vec2 bias_before = f * key.bias[p], bias = now.bias - bias_before;
    const Mat2 random = matrix_of(now.random) - matrix_of(before);
    const Cov sum = cov_of(random + bias * bias.transpose());
    const bool known = sum[0] > 0 && sum[1] > 0 && sum[0] * sum[1] > sum[2] * sum[2];
    const UnseenError unseen_before = key.unseen[p].carried(f);
    UnseenError unseen_since = unseen[p].since(unseen_before);
    const Mat2 taken = unseen_since.taken(d.beside), seen = random - taken;
    const np::Estimate summed{now.x, cov_of(seen + bias * bias.transpose())};
    const Mat2 B = matrix_of(d.cov);
    const Mat2 K = known ? np::fusion_weight(summed, {d.x, d.cov}) : Mat2::Identity(), rest = Mat2::Identity() - K;
    np::Tracker::Correction to;
    to.x = now.x + K * (d.x - now.x);
    to.random = cov_of(matrix_of(before) + taken + rest * seen * rest.transpose() + K * B * K.transpose());
    unseen_since.reduce(Mat2::Identity() - K * (Mat2::Identity() - d.beside));
    unseen[p] = unseen_before.with(unseen_since);
    to.bias = bias_before + rest * bias;
    // Of what bends have lost both have a part, and the errors of these parts are one: (a + b)(a + b)^T has a b^T + b
    // a^T beside the squares, which are in both covariances. Counted where they add up.
    const Vec2 lost_before = f * key.lost[p], left = rest * (lost.lost(p) - lost_before), brought = K * d.lost,
               both = left + brought;
    if (const double along = left.dot(brought); along > 0) {
      const Mat2 more = (2 * along / both.squaredNorm()) * (both * both.transpose());
      for (std::size_t k = 0; k < 3; ++k) to.random[k] += cov_of(more)[k];
    }
    lost.correct(p, lost_before + both);
    const Mat2 row_before = 0.5 * f.squaredNorm() * matrix_of(key.cov_F[p]), row = matrix_of(now.cov_F) - row_before;
    const double since = 0.5 * row.trace();
    const np::Weighted w = known && since > 0 ? np::fuse(since, d.var_f) : np::Weighted{1, d.var_f};
    to.F = (f + w.weight * (d.f - f)) * key.F[p];
    to.cov_F = cov_of(row_before + w.variance * key.F[p].transpose() * key.F[p]);
    set(tracker, p, to);
  }

  void replace_one(np::Tracker& tracker, np::BendLoss& lost, const KeyFrame& key, std::size_t p, const Direct& d) {
    np::Tracker::Correction to{d.x, d.f * key.F[p]};
    const UnseenError unseen_before = key.unseen[p].carried(d.f);
    UnseenError unseen_since = unseen[p].since(unseen_before);
    to.random = cov_of(matrix_of(carried(d.f, key.random[p])) + unseen_since.taken(d.beside) + matrix_of(d.cov));
    unseen_since.reduce(d.beside);
    unseen[p] = unseen_before.with(unseen_since);
    to.bias = d.f * key.bias[p];
    lost.correct(p, d.f * key.lost[p] + d.lost);
    to.cov_F = cov_of(0.5 * d.f.squaredNorm() * matrix_of(key.cov_F[p]) + d.var_f * key.F[p].transpose() * key.F[p]);
    set(tracker, p, to);
  }

  static void set(np::Tracker& tracker, std::size_t p, const np::Tracker::Correction& to) {
    if (to.x.allFinite() && to.F.allFinite() && to.F.determinant() > 0) tracker.correct(p, to);
  }

  std::vector<std::size_t> living(const np::Tracker& tracker) const {
    std::vector<std::size_t> out;
    const auto state = tracker.state();
    for (std::size_t p = 0; p < state.size(); ++p) {
      if (alive(state[p].status)) out.push_back(p);
    }
    return out;
  }

  void correct(np::Tracker& tracker, np::BendLoss& lost, int frame, double alike_px, const Image& image) {
    const piv::SubsetImage now(image.view(), mask_of(setting, frame, image.view()).view(), threads);
    unseen.grow(tracker, lost, unseen_shares(0.5 * subset.side_px, alike_px));
    DriftRound round{frame, 0, 0, 0, 0};
    std::vector<std::size_t> wanted = living(tracker);
    round.alive = wanted.size();
    std::vector<double> off;
    std::vector<std::shared_ptr<KeyFrame>> keys = {first};
    if (kept) keys.push_back(kept);
    if (newest && newest != kept) keys.push_back(newest);
    std::size_t from_kept = 0, from_newest = 0;
    for (const auto& key : keys) {
      if (wanted.empty()) break;
      std::unordered_map<std::size_t, Direct> found;
      match(tracker, lost, *key, now, frame, wanted, min_score, found);
      std::vector<std::size_t> rest;
      for (const std::size_t p : wanted) {
        const auto it = found.find(p);
        if (it == found.end()) {
          rest.push_back(p);
          continue;
        }
        fuse_one(tracker, lost, *key, p, it->second);
        off.push_back(it->second.off_px);
      }
      (key == first ? round.from_first : round.from_later) += found.size();
      if (key == kept) from_kept += found.size();
      else if (key == newest) from_newest += found.size();
      wanted = std::move(rest);
    }
    // A key frame is given up for the newest one once more particles hold to that.
    if (newest && (!kept || from_newest > from_kept)) kept = newest;
    unseen.mark(tracker, lost);
    newest = key_frame(tracker, lost, frame, image.view());
    round.median_px = median(std::move(off));
    rounds.push_back(round);
  }

  void follow_reference(np::Tracker& tracker, np::BendLoss& lost, int frame, double alike_px, const Image& image,
                        bool moves_on) {
    const piv::SubsetImage now(image.view(), mask_of(setting, frame, image.view()).view(), threads);
    unseen.grow(tracker, lost, unseen_shares(0.5 * subset.side_px, alike_px));
    const std::vector<std::size_t> wanted = living(tracker);
    std::unordered_map<std::size_t, Direct> found;
    match(tracker, lost, *kept, now, frame, wanted, moves_on ? good_score : min_score, found);
    if (moves_on && newest && newest != kept &&
        double(wanted.size() - found.size()) > share_that_fails * double(wanted.size())) {
      kept = newest;
      found.clear();
      match(tracker, lost, *kept, now, frame, wanted, min_score, found);
    }
    DriftRound round{frame, wanted.size(), 0, 0, 0};
    std::vector<double> off;
    for (const std::size_t p : wanted) {
      const auto it = found.find(p);
      if (it == found.end()) {
        tracker.flag(p);
        continue;
      }
      replace_one(tracker, lost, *kept, p, it->second);
      off.push_back(it->second.off_px);
    }
    (kept == first ? round.from_first : round.from_later) = found.size();
    round.median_px = median(std::move(off));
    rounds.push_back(round);
    unseen.mark(tracker, lost);
    if (moves_on) newest = key_frame(tracker, lost, frame, image.view());
  }
};

DriftCorrector::DriftCorrector(const Case& c, const Setting& setting, int threads)
    : impl_(std::make_unique<Impl>(c, setting, threads)) {}
DriftCorrector::~DriftCorrector() = default;

const std::vector<DriftRound>& DriftCorrector::rounds() const { return impl_->rounds; }

void DriftCorrector::start(const np::Tracker& tracker, const np::BendLoss& lost, const ImageView& image) {
  Impl& s = *impl_;
  if (s.options.drift == np::DriftScheme::none) return;
  s.unseen.mark(tracker, lost);
  s.first = s.key_frame(tracker, lost, 0, image);
  if (s.options.drift != np::DriftScheme::corrected) s.kept = s.first;
}

void DriftCorrector::after_step(np::Tracker& tracker, np::BendLoss& lost, int frame, bool last, double alike_px,
                                const std::function<Image()>& read) {
  Impl& s = *impl_;
  if (s.options.drift == np::DriftScheme::none) return;
  const bool corrects = s.options.drift == np::DriftScheme::corrected;
  if (corrects && frame % s.options.drift_interval != 0 && !last) return;
  const Image image = read();
  if (corrects)
    s.correct(tracker, lost, frame, alike_px, image);
  else
    s.follow_reference(tracker, lost, frame, alike_px, image, s.options.drift == np::DriftScheme::reference_update);
}

}  // namespace pivnp::app
