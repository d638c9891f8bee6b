#include "apps/report/words/verdict.hpp"

#include <algorithm>
#include <cmath>

#include "apps/plot/numbers.hpp"
#include "apps/report/words/summary.hpp"
#include "apps/report/words/words.hpp"
#include "pivnp/core/particles/alive.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

// Share of the particles that are there at the last time, of those that have not left the view and were not taken away.
double followed_to_the_end(const MotionSource& motion) {
  if (motion.times().empty()) return nan_value;
  const MotionFrame last = motion.frame(motion.times().size() - 1);
  const std::vector<EndReason>& reason = motion.particles().end_reason;
  double there = 0, lost = 0;
  for (std::size_t p = 0; p < last.status.size(); ++p) {
    const EndReason why = p < reason.size() ? reason[p] : EndReason::none;
    if (alive(last.status[p])) ++there;
    else if (last.status[p] == ParticleStatus::ended && (why == EndReason::no_vectors || why == EndReason::bad_state || why == EndReason::none)) ++lost;
  }
  return there / (there + lost);
}

// Plainly, where most of what was measured is not there.
std::string not_usable(const Content& content, double valid_share) {
  constexpr double half = 0.5;
  if (!content.measured) return "";
  if (std::any_of(content.remarks.begin(), content.remarks.end(), [](const Remark& r) { return r.weight == RemarkWeight::unusable; })) return "";  // said
  const double followed = followed_to_the_end(*content.measured);
  const bool vectors = valid_share < half, particles = followed < half;
  if (!vectors && !particles) return "";
  std::string why;
  if (vectors) why = "only " + percent(valid_share) + " of the vectors are valid";
  if (particles) why += std::string(why.empty() ? "" : ", and ") + "only " + percent(followed) + " of the particles were followed to the end";
  return "This measurement is not usable as it is: " + why + ". ";
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

std::string basis(const Content& content, const DataSetNames& names) {
  if (!content.comparison || find(content.comparison->metrics, "history_rms")) return "";
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

std::string verdict(const Content& content, const DataSetNames& names, const std::vector<PairQuality>& pairs,
                    const DifferenceCurve& differences) {
  std::string text;
  std::size_t nodes = 0, valid = 0;
  for (const PairQuality& q : pairs) nodes += q.nodes, valid += q.valid;
  const std::string warning = not_usable(content, nodes > 0 ? double(valid) / double(nodes) : nan_value);
  if (content.comparison)
    return find(content.comparison->metrics, "history_rms") ? histories_summary(content) : warning + summary(content, names, differences);
  if (content.measured) text = motion_sentence(*content.measured, "followed through the measured increments");
  if (content.simulated) {
    if (!text.empty()) text += " Simulated: ";
    text += motion_sentence(*content.simulated, "simulated");
  }
  if (nodes > 0) {
    if (!text.empty()) text += " ";
    text += count(pairs.size(), "pair of frames was", "pairs of frames were") + " measured; " +
            percent(double(valid) / double(nodes)) + " of the vectors" + (pairs.front().material_known ? " in the material" : "") +
            " are valid.";
  }
  if (text.empty()) return "The record holds neither vectors nor a motion.";
  text.insert(0, warning);
  if (content.measured && content.simulated) text += " The two were not compared.";
  else if (content.measured) text += " No simulation was compared with the measurement.";
  else if (content.simulated) text += " No measurement was compared with the simulation.";
  return text;
}

}  // namespace pivnp::report
