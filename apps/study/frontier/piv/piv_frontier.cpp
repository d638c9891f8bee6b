#include "apps/study/frontier/piv/piv_frontier.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>

#include "apps/study/frontier/work.hpp"
#include "apps/study/pipeline/statistics.hpp"
#include "pivnp/core/choice.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/piv/methods.hpp"

namespace pivnp::app {

namespace {

using piv::PivOptions;

// What `options` say that `base` does not, as a command line has it.
std::string keys_of(const PivOptions& options, const PivOptions& base) {
  std::string keys;
  PivOptions::fields(options, [&](std::string_view name, const auto& value, const OptionInfo&) {
    PivOptions::fields(base, [&](std::string_view other, const auto& before, const OptionInfo&) {
      if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::decay_t<decltype(before)>>) {
        if (name != other || value == before) return;
        std::string text;
        if constexpr (Choice<std::decay_t<decltype(value)>>) text = name_of(value);
        else if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>) text = value;
        else if constexpr (std::is_same_v<std::decay_t<decltype(value)>, bool>) text = value ? "true" : "false";
        else text = number(double(value));
        keys += (keys.empty() ? "piv." : " piv.") + std::string(name) + "=" + text;
      }
    });
  });
  return keys.empty() ? "as it is" : keys;
}

bool same(const PivOptions& a, const PivOptions& b) { return keys_of(a, b) == "as it is"; }

bool is_dense(const piv::PivMethod& method) { return method.family == piv::MethodFamily::gauss_newton && method.finest == 1; }

// What acts alike is written alike: one name a method, what a method has no use for as it is by default, passes counted.
PivOptions plainly(PivOptions o) {
  const PivOptions plain;
  const piv::PivMethod &recommended = *piv::piv_methods().begin(), &method = piv::piv_methods().at(o.method, "piv.method");
  if (method.make == recommended.make) o.method = recommended.name;
  if (!is_dense(method)) o.smoothing = plain.smoothing;
  if (o.smoothing != piv::Smoothing::window) o.order = plain.order;
  const bool dense = method.family == piv::MethodFamily::gauss_newton;
  if (o.passes == (dense ? 3 : 4) || (dense && method.finest > 1)) o.passes = 0;
  return o;
}

}  // namespace

std::vector<PivChoice> piv_choices(const PivOptions& base) {
  std::vector<PivChoice> all;
  const piv::PivMethod& recommended = *piv::piv_methods().begin();
  for (const piv::PivMethod& method : piv::piv_methods()) {
    if (&method != &recommended && method.make == recommended.make) continue;  // the same by another name
    const bool dense = is_dense(method);
    const auto add = [&](int window, const std::string& more, const auto& change) {
      if (window < method.least_window_px) return;
      PivOptions o = base;
      o.method = method.name;
      o.window_px = window;
      o.smoothing = piv::Smoothing::adaptive;
      o.order = PivOptions().order;
      o.passes = 0;
      change(o);
      all.push_back({method.name + ", " + std::to_string(window) + " px" + more, o});
    };
    const auto nothing = [](PivOptions&) {};
    for (const int window : dense ? std::vector<int>{16, 24, 32, 48, 64} : std::vector<int>{16, 32, 64}) add(window, "", nothing);
    if (!dense) continue;
    for (const int passes : {2, 5}) add(32, ", " + std::to_string(passes) + " passes", [passes](PivOptions& o) { o.passes = passes; });
    for (const int window : {16, 32, 64})
      add(window, ", subsets", [](PivOptions& o) { o.smoothing = piv::Smoothing::window; });
    for (const int order : {0, 2})
      add(32, ", subsets of order " + std::to_string(order), [order](PivOptions& o) { o.smoothing = piv::Smoothing::window, o.order = order; });
  }
  return all;
}

namespace {

struct Scored {
  double rms = NAN, bias = NAN, noise = NAN, gain = NAN;
  double valid = 0, wrong = 0;  // shares of the nodes scored
};

Scored scored(const KnownPairs& known, const KnownPair& pair, const piv::PixelVectors& found) {
  constexpr double far_off = 0.5;  // px
  double sum[2] = {0, 0}, square[2] = {0, 0}, cross = 0, truths = 0, valid = 0, wrong = 0, all = 0;
  for (std::size_t k = 0; k < known.nodes.pixel.size(); ++k) {
    if (!(pair.scored.empty() ? known.scored[k] : pair.scored[k])) continue;
    ++all;
    if (found.status[k] != VectorStatus::valid) continue;
    ++valid;
    const Vec2 truth = pair.truth({double(known.nodes.pixel[k][0]), double(known.nodes.pixel[k][1])}, found.anchor);
    const Vec2 got(double(found.displacement[k][0]), double(found.displacement[k][1])), error = got - truth;
    for (Eigen::Index c = 0; c < 2; ++c) sum[c] += error[c], square[c] += error[c] * error[c];
    cross += truth.dot(got), truths += truth.squaredNorm();
    wrong += error.norm() > far_off;
  }
  Scored s;
  s.valid = valid / all;
  s.wrong = wrong / all;
  if (!(valid > 0)) return s;
  s.rms = std::sqrt(std::max(square[0], square[1]) / valid);
  s.bias = std::max(std::abs(sum[0]), std::abs(sum[1])) / valid;
  double variance = 0;
  for (int c = 0; c < 2; ++c) variance = std::max(variance, square[c] / valid - sum[c] * sum[c] / (valid * valid));
  s.noise = std::sqrt(variance);
  s.gain = truths > 0 ? cross / truths : NAN;
  return s;
}

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

}  // namespace

FrontierStage piv_frontier(const KnownPairs& known, const PivOptions& given, bool own, int repeats, int threads, Progress& progress,
                           const std::vector<PivChoice>& only, std::size_t first_compared) {
  const PivOptions base = plainly(given);
  FrontierStage stage;
  stage.name = "piv";
  stage.title = "Image correlation";
  stage.made_of = known.made_of;
  stage.error_label = "error, rms over all pairs (px)";
  stage.time_label = "time per pair of frames (ms)";
  stage.time_unit = 1e-3;
  stage.columns = {{"bias_px", "bias (px)", "greatest mean error of a component in any pair"},
                   {"valid", "valid", "least share of the nodes that is valid in any pair"},
                   {"wrong", "wrong", "share of the nodes, in the worst pair, that is valid and more than 0.5 px off"},
                   {"noise_px", "noise (px)", "standard deviation of the worse component in the even shift"},
                   {"wavelength_90_px", "λ90 (px)", "shortest wave of which 90 % is found; the shortest of the pairs where all are"},
                   {"efficiency_px2", "MEI (px²)", "noise times that wave-length, the metrological efficiency indicator: less is better"}};

  std::vector<PivChoice> all = only.empty() ? piv_choices(base) : only;
  const PivOptions standard = [&] {  // the case's own tests and anchor, else what is given to who says nothing
    PivOptions o = base;
    const PivOptions plain;
    o.method = plain.method, o.window_px = plain.window_px, o.smoothing = plain.smoothing, o.order = plain.order, o.passes = plain.passes;
    return o;
  }();
  if (own && std::none_of(all.begin(), all.end(), [&](const PivChoice& c) { return same(c.options, base); })) all.push_back({base.method + ", " + std::to_string(base.window_px) + " px" + (base.smoothing == piv::Smoothing::window ? ", subsets" : ""), base});

  struct Run {
    std::unique_ptr<piv::PairCorrelator> correlator;
    FrontierPoint point;
    std::vector<std::vector<double>> seconds;  // of each pair, by repeat
    std::vector<Scored> pairs;
  };
  std::vector<Run> runs;
  for (const PivChoice& c : all) {
    Run run;
    try {
      const Effort work = measured(threads, [&] {  // with the buffers that it keeps from pair to pair
        run.correlator = std::make_unique<piv::PairCorrelator>(c.options, known.nodes, known.width, known.height, threads);
        run.correlator->correlate(known.pairs.front().first.view(), known.pairs.front().second.view(), known.mask.view());
      });
      run.point.bytes = work.bytes, run.point.instructions = work.instructions;
    } catch (const InputError& error) {
      stage.left_out.push_back(c.name + ": " + error.what());
      continue;
    }
    run.point.name = c.name;
    run.point.keys = keys_of(c.options, base);
    run.point.standard = same(c.options, standard);
    run.point.own = own && same(c.options, base);
    if (run.point.own && run.point.keys == "as it is") run.point.keys = "the case as it is";
    runs.push_back(std::move(run));
  }
  const std::int64_t total = std::int64_t(runs.size() * known.pairs.size()) * repeats;
  std::int64_t done = 0;
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t number = 0; number < known.pairs.size(); ++number)
      for (Run& run : runs) {
        const KnownPair& pair = known.pairs[number];
        progress.update("settings", done++, total);
        if (progress.stop_requested()) throw Interrupted();
        piv::PixelVectors found;
        const double seconds = seconds_of([&] { found = run.correlator->correlate(pair.first.view(), pair.second.view(), known.mask.view()); });
        run.seconds.resize(known.pairs.size());
        run.seconds[number].push_back(seconds);
        if (repeat == 0) run.pairs.push_back(scored(known, pair, found));
      }
  progress.update("settings", total, total);

  for (Run& run : runs) {
    FrontierPoint& p = run.point;
    std::vector<double> of_repeats;  // of each, the median over the pairs
    for (int repeat = 0; repeat < repeats; ++repeat) {
      std::vector<double> of_pairs;
      for (const std::vector<double>& seconds : run.seconds) of_pairs.push_back(seconds[std::size_t(repeat)]);
      of_repeats.push_back(median(std::move(of_pairs)));
    }
    set_times(of_repeats, p);
    double square = 0, worst = 0, bias = 0, valid = 1, wrong = 0;
    std::vector<std::pair<double, double>> gains;
    for (std::size_t k = 0; k < known.pairs.size(); ++k) {
      const Scored& s = run.pairs[k];
      if (known.pairs[k].wavelength > 0) gains.push_back({known.pairs[k].wavelength, s.gain});
      if (k < first_compared) continue;
      square += s.rms * s.rms / double(known.pairs.size() - first_compared);  // NaN where a pair gave nothing
      worst = std::max(worst, s.rms), bias = std::max(bias, s.bias), valid = std::min(valid, s.valid), wrong = std::max(wrong, s.wrong);
    }
    p.error = std::sqrt(square);
    p.worst = worst;
    const double noise = run.pairs.front().noise, length = resolution(gains);
    p.columns = {bias, valid, wrong, noise, length, noise * length};
    stage.points.push_back(std::move(p));
  }
  // What rejects more has an easier task: it is compared only where it gives as much.
  constexpr std::size_t valid_column = 1;
  const auto reference = std::find_if(stage.points.begin(), stage.points.end(), [&](const FrontierPoint& p) { return own ? p.own : p.standard; });
  if (reference != stage.points.end())
    for (FrontierPoint& p : stage.points) p.complete = p.columns[valid_column] >= reference->columns[valid_column] - 0.02;
  find_front(stage.points);
  return stage;
}

}  // namespace pivnp::app
