#include "apps/report/words/verdict.hpp"

#include <algorithm>
#include <cmath>

#include "apps/plot/numbers.hpp"
#include "apps/report/words/words.hpp"
#include "pivnp/core/particles/alive.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

std::string quantity(const Metric& m) { return value_with_uncertainty(m.value, m.uncertainty) + unit_suffix(m.unit); }

// Limits that were stated, met or exceeded.
std::string limits_sentence(const std::vector<Metric>& metrics, const DataSetNames& names) {
  const auto list = [&](Verdict verdict, const char* what) {
    std::string text;
    for (const Metric& m : metrics)
      if (m.verdict == verdict) text += (text.empty() ? "" : "; ") + metric_words(m.name, names);
    return text.empty() ? "" : what + text + ".";
  };
  return list(Verdict::exceeded, " Limits exceeded: ") + list(Verdict::met, " Limits met: ");
}

std::string displacement_sentence(const Metric& rms, const DataSetNames& names) {
  if (!std::isfinite(rms.value)) return "How far their displacements differ is not known.";
  std::string text = "Their displacements differ by " + quantity(rms) + " (RMS). ";
  const double ratio = rms.value / rms.uncertainty;
  if (!std::isfinite(rms.uncertainty) || !(rms.uncertainty > 0) || !std::isfinite(ratio))
    return text + (names.alike ? "Their uncertainty" : "The measurement\u2019s uncertainty") +
           " is not known, so it cannot be said whether this means anything.";
  if (ratio < 2)
    return text + (names.alike ? "They" : "Simulation and measurement") +
           " are not distinguishable at this u_val: a difference of less than " + significant(2 * rms.uncertainty, 2) +
           unit_suffix(rms.unit) + " would not be seen.";
  return text + "This is " + significant(ratio, 2) +
         " times its standard uncertainty u_val: the two motions are distinguishable, and " +
         (names.alike ? "their uncertainty" : "the measurement") + " is not what limits the comparison.";
}

std::string strain_sentence(const Metric& rms) {
  if (!std::isfinite(rms.value)) return "";
  std::string text = " The deviatoric strains differ by " + quantity(rms) + " (RMS)";
  if (std::isfinite(rms.uncertainty) && rms.uncertainty > 0)
    text += std::abs(rms.value) < 2 * rms.uncertainty ? ", not distinguishable at this u_val"
                                                      : ", more than the uncertainty explains";
  return text + ".";
}

std::string compared_sentence(const Content& content, const DataSetNames& names) {
  const Comparison& c = *content.comparison;
  const std::size_t particles = c.fields.empty() ? 0 : c.fields[0].id.size();
  const std::vector<double>& times = c.times();
  std::string text = (names.alike ? "Two motions" : "Simulation and measurement") + std::string(" were compared");
  if (particles > 0) text += " at " + count(particles, "particle");
  if (times.size() > 1)
    text += " and " + count(times.size(), "time") + " between " + plain(times.front()) + " and " + plain(times.back()) +
            unit_suffix(content.time_unit);
  const Metric *first = find(c.metrics, "coverage_first"), *second = find(c.metrics, "coverage_second");
  if (first != nullptr && second != nullptr)
    text += "; " + percent(first->value) + " of the " + names.first + " and " + percent(second->value) + " of the " +
            names.second + " particles found a partner";
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
                     : ", " + significant(rms.value / rms.uncertainty, 2) + " times its standard uncertainty u_val.");
}

std::string motion_sentence(const MotionSource& motion, const std::string& verb) {
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
    std::size_t followed = 0, known = 0;
    for (std::size_t p = 0; p < last.u.size(); ++p) {
      if (!alive(last.status[p])) continue;
      ++followed;
      u.push_back(std::hypot(double(last.u[p][0]), double(last.u[p][1])));
      if (p >= last.cov_u.size()) continue;
      const double trace = double(last.cov_u[p][0]) + double(last.cov_u[p][1]);
      if (std::isfinite(trace)) variance += trace, ++known;
    }
    text += "; " + percent(last.u.empty() ? 0 : double(followed) / double(last.u.size())) + " of them to the end";
    if (followed > 0)
      text += ", where the greatest displacement is " + significant(quantile(u, 1)) + unit_suffix(motion.length_unit());
    if (known > 0)
      text += " and the standard uncertainty of a displacement " + significant(std::sqrt(variance / double(known)), 2) +
              unit_suffix(motion.length_unit()) + " (RMS, random error)";
  }
  return text + ".";
}

}  // namespace

std::string verdict(const Content& content, const DataSetNames& names, const std::vector<PairQuality>& pairs,
                    const DifferenceCurve& differences) {
  std::string text;
  if (content.comparison) {
    const std::vector<Metric>& metrics = content.comparison->metrics;
    if (const Metric* rms = find(metrics, "history_rms"))
      return history_sentence(content, *rms) + limits_sentence(metrics, names);
    text = compared_sentence(content, names) + " ";
    if (const Metric* rms = find(metrics, "displacement_rms")) {
      text += displacement_sentence(*rms, names);
    } else if (!differences.rms.empty()) {
      const Metric last{"displacement_rms", differences.rms.back(), content.length_unit, differences.sigma.back(), ""};
      text += "At the last time: " + displacement_sentence(last, names);
    }
    if (const Metric* rms = find(metrics, "strain_dev_rms")) text += strain_sentence(*rms);
    return text + limits_sentence(metrics, names);
  }
  if (content.measured) text = motion_sentence(*content.measured, "followed through the measured increments");
  if (content.simulated) {
    if (!text.empty()) text += " Simulated: ";
    text += motion_sentence(*content.simulated, "simulated");
  }
  std::size_t nodes = 0, valid = 0;
  for (const PairQuality& q : pairs) nodes += q.nodes, valid += q.valid;
  if (nodes > 0) {
    if (!text.empty()) text += " ";
    text += count(pairs.size(), "pair of frames was", "pairs of frames were") + " measured; " +
            percent(double(valid) / double(nodes)) + " of the vectors" + (pairs.front().material_known ? " in the material" : "") +
            " are valid.";
  }
  if (text.empty()) return "The record holds neither vectors nor a motion.";
  if (content.measured && content.simulated) text += " The two were not compared.";
  else if (content.measured) text += " No simulation was compared with the measurement.";
  else if (content.simulated) text += " No measurement was compared with the simulation.";
  return text;
}

}  // namespace pivnp::report
