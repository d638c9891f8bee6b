#include "apps/report/words/summary.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "apps/report/words/data_sets.hpp"
#include "apps/report/words/words.hpp"
#include "compare/metrics/words.hpp"
#include "pivnp/core/particles/derived.hpp"

namespace pivnp::report {

namespace {

std::string quantity(const Metric& m) { return value_with_uncertainty(m.value, m.uncertainty) + unit_suffix(m.unit); }

std::string frame_name(const Content& content, int k) {
  const auto n = std::size_t(k);
  return k >= 0 && n < content.frames.size() && !content.frames[n].name.empty() ? content.frames[n].name
                                                                                : "frame " + std::to_string(k);
}

// Limits that were stated, met or exceeded.
std::string limits_sentence(const std::vector<Metric>& metrics) {
  const auto list = [&](Verdict verdict, const char* what) {
    std::string text;
    for (const Metric& m : metrics)
      if (m.verdict == verdict) text += (text.empty() ? "" : "; ") + compare::words_of(m.name);
    return text.empty() ? "" : what + text + ".";
  };
  return list(Verdict::exceeded, " Limits exceeded: ") + list(Verdict::met, " Limits met: ");
}

std::string displacement_sentence(const Metric& rms) {
  if (!std::isfinite(rms.value)) return "How far their displacements differ is not known.";
  std::string text = "Their displacements differ by " + quantity(rms) + " (RMS). ";
  const double ratio = rms.value / rms.uncertainty;
  if (!std::isfinite(rms.uncertainty) || !(rms.uncertainty > 0) || !std::isfinite(ratio))
    return text + "The measurement\u2019s uncertainty is not known, so it cannot be said whether this means anything.";
  if (ratio < 2)
    return text + "Simulation and measurement are not distinguishable at this u_val: a difference of less than " +
           number(2 * rms.uncertainty, 2) + unit_suffix(rms.unit) + " would not be seen.";
  return text + "This is " + number(ratio, 2) +
         " times its standard uncertainty u_val: the two motions are distinguishable, "
         "and the measurement is not what limits the comparison.";
}

std::string strain_sentence(const Metric& rms) {
  if (!std::isfinite(rms.value)) return "";
  std::string text = " The deviatoric strains differ by " + quantity(rms) + " (RMS)";
  if (std::isfinite(rms.uncertainty) && rms.uncertainty > 0)
    text += std::abs(rms.value) < 2 * rms.uncertainty ? ", not distinguishable at this u_val"
                                                      : ", more than the uncertainty explains";
  return text + ".";
}

std::string compared_sentence(const Content& content) {
  const Comparison& c = *content.comparison;
  const std::size_t particles = c.fields.empty() ? 0 : c.fields[0].id.size();
  const std::vector<double>& times = c.times();
  std::string text = "Simulation and measurement were compared";
  if (particles > 0) text += " at " + count(particles, "particle");
  if (times.size() > 1)
    text += " and " + count(times.size(), "time") + " between " + plain(times.front()) + " and " +
            plain(times.back()) + unit_suffix(content.time_unit);
  const Metric *measured = find(c.metrics, "coverage_first"), *simulated = find(c.metrics, "coverage_second");
  if (measured != nullptr && simulated != nullptr)
    text += "; " + percent(measured->value) + " of the measured and " + percent(simulated->value) +
            " of the simulated particles found a partner";
  return text + ".";
}

std::string history_sentence(const Content& content, const Metric& rms) {
  const std::vector<double>& t = content.comparison->times();
  std::string text = "Two histories were compared";
  if (t.size() > 1)
    text += " between " + plain(t.front()) + " and " + plain(t.back()) + unit_suffix(content.time_unit);
  text += ". They differ by " + quantity(rms) + " (RMS)";
  if (!(rms.uncertainty > 0)) return text + "; the uncertainty of their values is not given.";
  return text + (rms.value < 2 * rms.uncertainty
                     ? ", not distinguishable at this u_val."
                     : ", " + number(rms.value / rms.uncertainty, 2) + " times its standard uncertainty u_val.");
}

std::string side_sentence(const MotionSource& motion, const std::string& verb) {
  const std::vector<double>& t = motion.times();
  std::string text =
      count(motion.particles().size(), "particle") + (motion.particles().size() == 1 ? " was " : " were ") + verb;
  if (t.size() > 1)
    text += " through " + count(t.size(), "instant") + ", from t = " + plain(t.front()) + " to " + plain(t.back()) +
            unit_suffix(motion.time_unit());
  if (!t.empty()) {
    const MotionFrame last = motion.frame(t.size() - 1);
    std::vector<double> u;
    double variance = 0;
    std::size_t alive = 0, known = 0;
    for (std::size_t p = 0; p < last.u.size(); ++p) {
      if (last.status[p] != ParticleStatus::active && last.status[p] != ParticleStatus::flagged) continue;
      ++alive;
      u.push_back(std::hypot(double(last.u[p][0]), double(last.u[p][1])));
      if (p >= last.cov_u.size()) continue;
      const double trace = double(last.cov_u[p][0]) + double(last.cov_u[p][1]);
      if (std::isfinite(trace)) variance += trace, ++known;
    }
    text += "; " + percent(last.u.empty() ? 0 : double(alive) / double(last.u.size())) + " of them to the end";
    if (alive > 0)
      text += ", where the greatest displacement is " + number(quantile(u, 1)) + unit_suffix(motion.length_unit());
    if (known > 0)
      text += " and the standard uncertainty of a displacement " + number(std::sqrt(variance / double(known)), 2) +
              unit_suffix(motion.length_unit()) + " (RMS, random error)";
  }
  return text + ".";
}

}  // namespace

std::string verdict(const Content& content, const std::vector<PairQuality>& pairs,
                    const DifferenceHistory& differences) {
  std::string text;
  if (content.comparison) {
    const std::vector<Metric>& metrics = content.comparison->metrics;
    if (const Metric* rms = find(metrics, "history_rms"))
      return history_sentence(content, *rms) + in_sides(content, limits_sentence(metrics));
    text = compared_sentence(content) + " ";
    if (const Metric* rms = find(metrics, "displacement_rms")) {
      text += displacement_sentence(*rms);
    } else if (!differences.rms.empty()) {
      const Metric last{"displacement_rms", differences.rms.back(), content.length_unit, differences.sigma.back(), ""};
      text += "At the last time: " + displacement_sentence(last);
    }
    if (const Metric* rms = find(metrics, "strain_dev_rms")) text += strain_sentence(*rms);
    text += limits_sentence(metrics);
    return in_sides(content, text);
  }
  if (content.measured) text = side_sentence(*content.measured, "followed through the measured increments");
  if (content.simulated) {
    if (!text.empty()) text += " Simulated: ";
    text += side_sentence(*content.simulated, "simulated");
  }
  std::size_t nodes = 0, valid = 0;
  for (const PairQuality& q : pairs) nodes += q.nodes, valid += q.valid;
  if (nodes > 0) {
    if (!text.empty()) text += " ";
    text += count(pairs.size(), "pair of frames was", "pairs of frames were") + " measured; " +
            percent(double(valid) / double(nodes)) + " of the vectors are valid.";
  }
  if (text.empty()) return "The record holds neither vectors nor a motion.";
  if (content.measured && content.simulated) text += " The two were not compared.";
  else if (content.measured) text += " No simulation was compared with the measurement.";
  else if (content.simulated) text += " No measurement was compared with the simulation.";
  return text;
}

std::vector<std::string> flags(const Content& content, const std::vector<PairQuality>& pairs) {
  std::vector<std::string> list = content.remarks;
  const bool many = std::count_if(pairs.begin(), pairs.end(), [](const PairQuality& q) { return q.flag != 0; }) > 12;
  std::size_t flagged = 0;
  for (const PairQuality& q : pairs) {
    if (q.flag == 0 || (many && ++flagged > 12)) continue;
    const std::string step =
        "Step " + frame_name(content, q.frames[0]) + " to " + frame_name(content, q.frames[1]) + ": ";
    if (q.flag & frame_decorrelated)
      list.push_back(step + "the pair lost its correlation over most of the image (median score " +
                     number(q.score_median, 2) + ", " + percent(q.share(q.valid)) + " valid).");
    if (q.flag & frame_repeated)
      list.push_back(step + "the second exposure repeats the first; no motion can be read from it.");
    if (q.flag & frame_jump)
      list.push_back(step + "the motion is out of line with the steps before and after: a frame may be missing, or "
                            "the camera was shaken.");
  }
  if (many)
    list.push_back("Further steps are flagged; the figure of the measurement\u2019s quality marks all of them.");

  // A pair that is short of valid vectors is named once, by its worst.
  const PairQuality* worst = nullptr;
  std::size_t poor = 0;
  for (const PairQuality& q : pairs) {
    if (q.nodes == 0 || q.share(q.valid) >= 0.9) continue;
    ++poor;
    if (worst == nullptr || q.share(q.valid) < worst->share(worst->valid)) worst = &q;
  }
  if (worst != nullptr)
    list.push_back("In " + std::to_string(poor) + " of " + count(pairs.size(), "pair") +
                   " fewer than 90 % of the vectors are valid; the worst is " + frame_name(content, worst->frames[0]) +
                   " to " + frame_name(content, worst->frames[1]) + ": " + percent(worst->share(worst->valid)) +
                   " valid, " + percent(worst->share(worst->replaced)) + " replaced, " +
                   percent(worst->share(worst->rejected)) + " rejected, " + percent(worst->share(worst->failed)) +
                   " failed.");
  for (const auto& [motion, side] : {std::pair{content.measured.get(), in_sides(content, "measured")},
                                     {content.simulated.get(), in_sides(content, "simulated")}}) {
    if (motion == nullptr) continue;
    std::size_t ended = 0;
    for (const Ends& e : ends_by_reason(motion->particles())) ended += e.particles;
    if (ended > 0)
      list.push_back(count(ended, "particle") + " of " + std::to_string(motion->particles().size()) + " on the " +
                     side + " side ended before the last frame (reasons in the table below).");
  }
  return list;
}

}  // namespace pivnp::report
