#include "apps/study/frontier/piv/pairs_in_turn.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "apps/study/frontier/work.hpp"
#include "apps/study/pipeline/measure/statistics.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

// Waves from long to short; NaN where the longest is damped.
double resolution(const std::vector<std::pair<double, double>>& gains) {
  constexpr double asked = 0.9;
  for (std::size_t k = 0; k < gains.size(); ++k) {
    if (gains[k].second >= asked) continue;
    if (k == 0) return NAN;
    const auto [longer, more] = gains[k - 1];
    const auto [shorter, less] = gains[k];
    return longer * std::pow(shorter / longer, (more - asked) / (more - less));
  }
  return gains.empty() ? NAN : gains.back().first;
}

// A run, and what has been found so far.
struct Running {
  PivRun run;
  std::unique_ptr<piv::PairCorrelator> correlator;
  std::vector<std::vector<double>> seconds;  // of each pair, by repeat
  std::vector<Scored> pairs;
};

FrontierPoint summed_up(Running& r, const KnownPairs& known, std::size_t first_compared, int repeats) {
  FrontierPoint p = std::move(r.run.point);
  std::vector<double> of_repeats;  // of each, the median over the pairs
  for (int repeat = 0; repeat < repeats; ++repeat) {
    std::vector<double> of_pairs;
    for (const std::vector<double>& seconds : r.seconds) of_pairs.push_back(seconds[std::size_t(repeat)]);
    of_repeats.push_back(median(std::move(of_pairs)));
  }
  set_times(of_repeats, p);
  double square = 0, worst = 0, bias = 0, valid = 1, wrong = 0;
  std::vector<std::pair<double, double>> gains;
  for (std::size_t k = 0; k < known.pairs.size(); ++k) {
    const Scored& s = r.pairs[k];
    if (known.pairs[k].wavelength > 0) gains.push_back({known.pairs[k].wavelength, s.gain});
    if (k < first_compared) continue;
    square += s.rms * s.rms / double(known.pairs.size() - first_compared);  // NaN where a pair gave nothing
    worst = std::max(worst, s.rms), bias = std::max(bias, s.bias), valid = std::min(valid, s.valid), wrong = std::max(wrong, s.wrong);
  }
  p.error = std::sqrt(square);
  p.worst = worst;
  const double noise = r.pairs.front().noise, length = resolution(gains);
  p.columns = {bias, valid, wrong, noise, length, noise * length};
  return p;
}

}  // namespace

void Scores::add(const Vec2& got, const Vec2& truth) {
  constexpr double far_off = 0.5;  // px
  const Vec2 error = got - truth;
  for (Eigen::Index c = 0; c < 2; ++c) sum_[c] += error[c], square_[c] += error[c] * error[c];
  cross_ += truth.dot(got), truths_ += truth.squaredNorm();
  wrong_ += error.norm() > far_off;
  ++valid_, ++all_;
}

Scored Scores::result() const {
  Scored s;
  s.valid = valid_ / all_;
  s.wrong = wrong_ / all_;
  if (!(valid_ > 0)) return s;
  s.rms = std::sqrt(std::max(square_[0], square_[1]) / valid_);
  s.bias = std::max(std::abs(sum_[0]), std::abs(sum_[1])) / valid_;
  double variance = 0;
  for (int c = 0; c < 2; ++c) variance = std::max(variance, square_[c] / valid_ - sum_[c] * sum_[c] / (valid_ * valid_));
  s.noise = std::sqrt(variance);
  s.gain = truths_ > 0 ? cross_ / truths_ : NAN;
  return s;
}

std::vector<FrontierColumn> pair_columns() {
  return {{"bias_px", "bias (px)", "greatest mean error of a component in any pair"},
          {"valid", "valid", "least share of the nodes that is valid in any pair"},
          {"wrong", "wrong", "share of the nodes, in the worst pair, that is valid and more than 0.5 px off"},
          {"noise_px", "noise (px)", "standard deviation of the worse component in the even shift"},
          {"wavelength_90_px", "λ90 (px)", "shortest wave of which 90 % is found; the shortest of the pairs where all are"},
          {"efficiency_px2", "MEI (px²)", "noise times that wave-length, the metrological efficiency indicator: less is better"}};
}

void measure_in_turn(std::vector<PivRun> runs, const KnownPairs& known, std::size_t first_compared, int repeats, int threads, Progress& progress,
                     FrontierStage& stage) {
  std::vector<Running> all;
  for (PivRun& given : runs) {
    Running r{std::move(given), {}, {}, {}};
    try {
      const Effort work = measured(threads, [&] {  // with the buffers that it keeps from pair to pair
        r.correlator = std::make_unique<piv::PairCorrelator>(r.run.options, r.run.nodes, known.width, known.height, threads);
        r.correlator->correlate(known.pairs.front().first.view(), known.pairs.front().second.view(), known.mask.view());
      });
      r.run.point.bytes = work.bytes, r.run.point.instructions = work.instructions;
    } catch (const InputError& error) {
      stage.left_out.push_back(r.run.point.name + ": " + error.what());
      continue;
    }
    all.push_back(std::move(r));
  }
  const std::int64_t total = std::int64_t(all.size() * known.pairs.size()) * repeats;
  std::int64_t done = 0;
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t number = 0; number < known.pairs.size(); ++number)
      for (Running& r : all) {
        const KnownPair& pair = known.pairs[number];
        progress.update("settings", done++, total);
        if (progress.stop_requested()) throw Interrupted();
        piv::PixelVectors found;
        const double seconds = seconds_of(threads, [&] { found = r.correlator->correlate(pair.first.view(), pair.second.view(), known.mask.view()); });
        r.seconds.resize(known.pairs.size());
        r.seconds[number].push_back(seconds);
        if (repeat == 0) r.pairs.push_back(r.run.score(pair, found));
      }
  progress.update("settings", total, total);
  for (Running& r : all) stage.points.push_back(summed_up(r, known, first_compared, repeats));
}

void compare_alike(const FrontierPoint* reference, std::vector<FrontierPoint>& points) {
  if (reference) {
    const double least = reference->columns[valid_column] - 0.02;
    for (FrontierPoint& p : points) p.complete = p.columns[valid_column] >= least;
  }
  find_front(points);
}

}  // namespace pivnp::app
