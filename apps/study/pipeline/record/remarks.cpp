#include "apps/study/pipeline/record/remarks.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/measure/statistics.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

using Texts = std::vector<std::string>;
using Step = RecordSeen::Step;
using Motion = RecordSeen::Motion;

std::string percent(double share) { return number(100 * share, 3) + " %"; }

std::string step_words(const Step& s) { return "The step " + s.from + " -> " + s.to; }

Step step_of(const VectorField& field, const std::vector<Frame>& frames) {
  const Frame &from = frames.at(std::size_t(field.pair[0])), &to = frames.at(std::size_t(field.pair[1]));
  Step s{from.name, to.name, to.flag, 0, 0, 0, 0, 0, 0};
  std::vector<double> scores, others;
  for (std::size_t n = 0; n < field.status.size(); ++n) {
    const VectorStatus status = field.status[n];
    if (status == VectorStatus::masked || status == VectorStatus::outside) continue;
    ++s.asked;
    s.valid += status == VectorStatus::valid;
    s.replaced += status == VectorStatus::replaced;
    s.rejected += status == VectorStatus::rejected;
    s.failed += status == VectorStatus::failed;
    if (std::isfinite(field.score[n])) (status == VectorStatus::valid ? scores : others).push_back(double(field.score[n]));
  }
  s.score = median(std::move(scores.empty() ? others : scores));
  return s;
}

// Reads every state of a motion that has the field heat_limit.
void look_at_heat(const MotionSource& motion, Motion& m) {
  if (!motion.frame(0).find("heat_limit")) return;
  for (std::size_t k = 0; k < motion.times().size(); ++k) {
    std::size_t hot = 0, open = 0;
    const MotionFrame frame = motion.frame(k);
    for (const float code : frame.field("heat_limit").values) {
      hot += code == 1 || code == 3;
      open += code >= 2;
    }
    m.hot = std::max(m.hot, hot);
    m.open = std::max(m.open, open);
  }
}

// One line for each flagged step, and one for those beyond the first few.
Texts flagged_steps(const RecordSeen& seen, FrameFlag flag, const std::function<std::string(const Step&)>& words) {
  constexpr std::size_t most = 6;
  Texts out;
  std::size_t count = 0;
  for (const Step& s : seen.steps)
    if ((s.flag & flag) && ++count <= most) out.push_back(words(s));
  if (count > most)
    out.push_back("So " + std::string(count == most + 1 ? "does" : "do") + " " + std::to_string(count - most) + " further step" +
                  (count == most + 1 ? "" : "s") + "; /frames/flag in the record marks all of them.");
  return out;
}

Texts find_lost(const RecordSeen& seen) {
  return flagged_steps(seen, frame_decorrelated, [](const Step& s) {
    return step_words(s) + " lost its correlation over most of the image: " + percent(s.valid / std::max(1.0, s.asked)) +
           " of its vectors are valid, median score " + number(s.score, 2) + ".";
  });
}

// Steps that repeat the frame before, as lengths of the holds between two others.
struct Holds {
  std::size_t repeats = 0, shortest = 0, longest = 0;
  bool regular() const { return shortest >= 2 && longest <= shortest + 1; }
};

Holds holds_of(const RecordSeen& seen) {
  Holds h;
  std::vector<std::size_t> steps;
  for (std::size_t k = 0; k < seen.steps.size(); ++k)
    if (seen.steps[k].flag & frame_repeated) ++h.repeats;
    else steps.push_back(k);
  for (std::size_t n = 0; n + 1 < steps.size(); ++n) {
    const std::size_t length = steps[n + 1] - steps[n];
    h.shortest = n == 0 ? length : std::min(h.shortest, length);
    h.longest = std::max(h.longest, length);
  }
  return h;
}

Texts find_held(const RecordSeen& seen) {
  const Holds h = holds_of(seen);
  if (!h.regular()) return {};
  const std::string times = std::to_string(h.shortest) + (h.longest > h.shortest ? " or " + std::to_string(h.longest) : "");
  std::string text = "The recording holds each frame " + times + " times: " + std::to_string(h.repeats) + " of " +
                     std::to_string(seen.steps.size()) + " steps repeat the frame before.";
  const double step = median(seen.time_steps);
  const double kept = double(seen.steps.size() - h.repeats) / double(seen.steps.size());
  const double share = h.longest > h.shortest ? kept : 1.0 / double(h.shortest);
  if (seen.time_unit == "s" && step > 0)
    text += " It was taken at " + number(share / step, 3) + " frames a second, not at " + number(1 / step, 3) + ".";
  if (h.longest == h.shortest) text += " frames.stride = " + std::to_string(h.shortest) + " takes each of them once.";
  return {text};
}

Texts find_repeated(const RecordSeen& seen) {
  if (holds_of(seen).regular()) return {};
  return flagged_steps(seen, frame_repeated,
                       [](const Step& s) { return step_words(s) + " repeats one exposure; no motion can be read from it."; });
}

Texts find_flashes(const RecordSeen& seen) {
  return flagged_steps(seen, frame_flash, [](const Step& s) {
    return "Frame " + s.to + " is brighter or darker than the frames before and after: a flash, or a lamp that failed.";
  });
}

Texts find_jumps(const RecordSeen& seen) {
  return flagged_steps(seen, frame_jump, [](const Step& s) {
    return step_words(s) + " does not agree with its neighbours: a frame may be missing, or the camera was shaken.";
  });
}

constexpr double hardly_any = 0.01, most_of_them = 0.9;

double valid_share(const RecordSeen& seen) {
  double asked = 0, valid = 0;
  for (const Step& s : seen.steps) {
    asked += s.asked;
    valid += s.valid;
  }
  return asked > 0 ? valid / asked : 0;
}

// Hardly any vector is valid, and those that are score as by chance: a small body in a wide image does not.
bool no_measurement(const RecordSeen& seen) {
  constexpr double by_chance = 0.5;
  return valid_share(seen) < hardly_any &&
         std::none_of(seen.steps.begin(), seen.steps.end(), [](const Step& s) { return s.valid > 0 && s.score > by_chance; });
}

Texts find_no_vectors(const RecordSeen& seen) {
  if (seen.steps.empty() || !no_measurement(seen)) return {};
  return {percent(valid_share(seen)) + " of the vectors are valid, in " + std::to_string(seen.steps.size()) +
          (seen.steps.size() == 1 ? " pair" : " pairs") + ": the measurement is not usable."};
}

Texts find_few_vectors(const RecordSeen& seen) {
  const Step* worst = nullptr;
  std::size_t poor = 0;
  for (const Step& s : seen.steps) {
    if (s.asked == 0 || s.valid >= most_of_them * s.asked || (s.flag & frame_decorrelated)) continue;
    ++poor;
    if (worst == nullptr || s.valid * worst->asked < worst->valid * s.asked) worst = &s;
  }
  if (worst == nullptr || no_measurement(seen)) return {};
  return {"In " + std::to_string(poor) + " of " + std::to_string(seen.steps.size()) + " pairs fewer than 90 % of the vectors are valid; the worst is " +
          worst->from + " -> " + worst->to + ": " + percent(worst->valid / worst->asked) + " valid, " + percent(worst->replaced / worst->asked) +
          " replaced, " + percent(worst->rejected / worst->asked) + " rejected, " + percent(worst->failed / worst->asked) + " failed."};
}

std::size_t ended(const Motion& m) {
  std::size_t sum = 0;
  for (const auto& [reason, count] : m.ends) sum += count;
  return sum;
}

// Particles that left what is seen are none that were lost.
bool lost_all(const Motion& m) {
  std::size_t left = 0;
  for (const auto& [reason, count] : m.ends)
    if (reason == EndReason::left_grid || reason == EndReason::left_image) left += count;
  return m.measured && m.particles > 0 && m.to_the_end == 0 && 2 * left < ended(m);
}

Texts find_no_particles(const RecordSeen& seen) {
  Texts out;
  for (const Motion& m : seen.motions)
    if (lost_all(m)) out.push_back("Motion " + m.name + ": 0 % of the " + std::to_string(m.particles) + " particles reach the end: it is not usable.");
  return out;
}

Texts find_ends(const RecordSeen& seen) {
  Texts out;
  for (const Motion& m : seen.motions)
    for (const auto& [reason, count] : m.ends)
      out.push_back("Motion " + m.name + ": " + std::to_string(count) + " of " + std::to_string(m.particles) + " particles " + words(reason) +
                    "; their histories are kept.");
  return out;
}

Texts find_flagged_particles(const RecordSeen& seen) {
  Texts out;
  for (const Motion& m : seen.motions) {
    if (!m.measured || double(m.flagged) < hardly_any * double(m.to_the_end) || m.flagged == 0) continue;
    std::string text = "Motion " + m.name + ": " + std::to_string(m.flagged) + " of the " + std::to_string(m.to_the_end) +
                       " particles at the end are flagged (beside slip surfaces, at free surfaces, where vectors were replaced); "
                       "their displacement may be off by ";
    text += std::isfinite(m.flagged_sigma) ? number(2 * m.flagged_sigma, 2) + " " + m.length_unit + " or more, twice what is stated for them."
                                           : "more than is stated.";
    out.push_back(text);
  }
  return out;
}

Texts up_to(const RecordSeen& seen, std::size_t Motion::*count, const std::string& what) {
  Texts out;
  for (const Motion& m : seen.motions)
    if (m.*count > 0) out.push_back("Up to " + std::to_string(m.*count) + " particles " + what);
  return out;
}

Texts find_hot(const RecordSeen& seen) {
  return up_to(seen, &Motion::hot,
               "are hotter than 100 C in one of the states: water would boil, so their temperatures and pressures are not "
               "reliable (heat_limit).");
}

Texts find_open(const RecordSeen& seen) {
  return up_to(seen, &Motion::open,
               "have a water pressure (in the band, where there is one) above the total mean stress in one of the states: the "
               "soil would open (heat_limit).");
}

Texts find_energy(const RecordSeen& seen) {
  constexpr double much = 0.1;
  const std::vector<EnergyRow>& rows = seen.energy;
  if (rows.empty()) return {};
  double supplied = 0;
  for (const EnergyRow& row : rows) supplied = std::max(supplied, std::abs(row.external));
  supplied += rows.front().kinetic + rows.front().elastic;
  const double gone = (seen.damped ? 0 : rows.back().damping) - rows.back().residual;
  if (!(std::abs(gone) > much * supplied)) return {};
  return {"The simulation's scheme has " + std::string(gone > 0 ? "lost" : "gained") + " " + number(100 * std::abs(gone) / supplied, 2) +
          " % of the energy supplied, " + number(std::abs(gone), 3) + " J/m (damping less residual)."};
}

bool damping_in(const io::RecordReader& record) {
  try {
    const Case c = parse_recorded_case(record.head().case_text, "the record's case", {});
    return c.mpm && c.mpm->damping.value_or(0) > 0;
  } catch (const InputError&) {
    return false;  // of another version
  }
}

}  // namespace

RecordSeen::Motion seen_in(const MotionSource& motion) {
  Motion m{motion.name(), motion.length_unit(), false, motion.particles().size(), 0, 0, std::nan(""), {}, 0, 0};
  std::map<EndReason, std::size_t> ends;
  for (const EndReason reason : motion.particles().end_reason)
    if (reason != EndReason::none) ++ends[reason];
  m.ends.assign(ends.begin(), ends.end());
  if (motion.times().empty()) return m;
  const MotionFrame last = motion.frame(motion.times().size() - 1);
  m.measured = !last.cov_u.empty();
  double variance = 0, known = 0;
  for (std::size_t p = 0; p < last.status.size(); ++p) {
    if (!alive(last.status[p])) continue;
    ++m.to_the_end;
    if (last.status[p] != ParticleStatus::flagged) continue;
    ++m.flagged;
    if (p >= last.cov_u.size()) continue;
    const double trace = double(last.cov_u[p][0]) + double(last.cov_u[p][1]);
    if (!std::isfinite(trace)) continue;
    variance += trace / 2;
    ++known;
  }
  if (known > 0) m.flagged_sigma = std::sqrt(variance / known);
  look_at_heat(motion, m);
  return m;
}

RecordSeen seen_in(const io::RecordReader& record) {
  RecordSeen seen;
  const std::vector<Frame>& frames = record.frames();
  for (std::size_t k = 0; k < record.pair_count(); ++k) seen.steps.push_back(step_of(record.pair(k), frames));
  for (std::size_t k = 1; k < frames.size(); ++k) seen.time_steps.push_back(frames[k].time - frames[k - 1].time);
  seen.time_unit = record.head().time_unit;
  for (const std::string& name : record.motion_names()) seen.motions.push_back(seen_in(*record.motion(name)));
  seen.energy = record.energy();
  seen.damped = !seen.energy.empty() && damping_in(record);
  return seen;
}

const Registry<RemarkRow>& remark_rows() {
  using enum RemarkWeight;
  static const Registry<RemarkRow> rows = {
      {"no_vectors", unusable, "the measurement is not usable",
       "Is there texture, does the region lie on it, and does it move by less than a quarter of piv.first_window_px a step?",
       "Fewer than 1 % of the vectors are valid. Record and report are written; the exit code is 1.", find_no_vectors},
      {"no_particles", unusable, "particles reach the end: it is not usable", "",
       "All were lost, most of them not by leaving the image or the grid. The exit code is 1. Steps that lost their "
       "correlation, or shares of valid vectors, tell from where on.",
       find_no_particles},
      {"step_lost", doubt, "lost its correlation over most of the image",
       "The second frame does not show the texture of the first: a flash, a shake, or motion beyond a quarter of piv.first_window_px a step.",
       "Raise that key, take frames closer together, or leave frames out (`frames.first`, `frames.last`).", find_lost},
      {"frames_held", doubt, "The recording holds each frame", "",
       "The recorder or a conversion stored each exposure several times. With `frames.stride` each is used once; speeds are "
       "then right if `frames.rate_hz` is that of the file.",
       find_held},
      {"step_repeated", doubt, "no motion can be read from it", "",
       "Its second frame is the first once more: the recorder doubled a frame. Leave it out, or state the true `frames.rate_hz`.", find_repeated},
      {"frame_flash", doubt, "is brighter or darker than the frames before and after", "",
       "Vectors follow an even change of light; look at the step, or leave the frame out.", find_flashes},
      {"step_jump", doubt, "does not agree with its neighbours", "",
       "Paths follow the motion all the same; speeds of the step are wrong where a frame is missing. A camera that moves is followed by `camera.motion.from`.",
       find_jumps},
      {"few_vectors", doubt, "fewer than 90 % of the vectors are valid", "",
       "Vectors that were replaced are interpolated from their neighbours, and particles there are flagged. Shadows, glare, "
       "loose grains and large strain in a step are the usual causes: mask them, or take frames closer together.",
       find_few_vectors},
      {"particles_flagged", doubt, "their displacement may be off by", "",
       "Status 2 in the record ([format](format.md)): their last step rests on replaced vectors or a local fit, or what the "
       "window averages adds up along the path. Leave them out of figures, or use smaller windows.",
       find_flagged_particles},
      {"particles_ended", doubt, "their histories are kept", "",
       "They ended before the last frame, for the reason that is said; `end` and `end_reason` in the record tell when and why.", find_ends},
      {"heat_hot", doubt, "are hotter than 100 C", "", "The equations hold liquid water. Look at the heat source, the friction, and how thick the shear band is.", find_hot},
      {"heat_open", doubt, "the soil would open", "", "The equations hold soil in contact. Permeability, compressibility or the band's thickness may be too small.", find_open},
      {"energy", doubt, "% of the energy supplied", "More material points per element, smaller cells or another transfer may help.",
       "Damping less residual of the energy balance exceeds a tenth of what was supplied. The report shows the energies.", find_energy}};
  return rows;
}

std::string remark_reference() {
  std::string out;
  for (const RemarkRow& row : remark_rows()) {
    out += "### `" + std::string(row.said) + "`\n";
    if (!row.advice.empty()) out += std::string(row.advice) + " ";
    out += std::string(row.meaning) + "\n\n";
  }
  return out;
}

std::vector<Remark> remarks_of(const RecordSeen& seen) {
  std::vector<Remark> out;
  for (const RemarkRow& row : remark_rows()) {
    Texts texts = row.find(seen);
    if (!texts.empty() && !row.advice.empty()) texts.back() += " " + std::string(row.advice);
    for (std::string& text : texts) out.push_back({std::move(text), row.weight, std::string(row.name)});
  }
  return out;
}

std::vector<Remark> remarks_of(const io::RecordReader& record) {
  std::vector<Remark> out = record.remarks();
  for (Remark& remark : remarks_of(seen_in(record))) out.push_back(std::move(remark));
  return out;
}

void append(std::vector<std::string> texts, std::vector<Remark>& remarks, RemarkWeight weight) {
  for (std::string& text : texts) remarks.push_back({std::move(text), weight, {}});
}

}  // namespace pivnp::app
