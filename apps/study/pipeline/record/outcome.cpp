#include "apps/study/pipeline/record/outcome.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "apps/study/pipeline/measure/measure.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

void remark_on_steps(const io::RecordReader& record, std::vector<std::string>& remarks) {
  const std::vector<Frame>& frames = record.frames();
  double shift_before = 0;
  for (std::size_t k = 0; k < record.pair_count(); ++k) {
    const VectorField field = record.pair(k);
    const double usual_shift = shift_before;
    shift_before = quality_of(field).median_shift;
    const Frame& before = frames.at(std::size_t(field.pair[0]));
    const Frame& after = frames.at(std::size_t(field.pair[1]));
    if (after.flag == frame_ok) continue;
    const StepQuality q = quality_of(field);
    const std::string step = "The step " + before.name + " -> " + after.name;
    if (after.flag & frame_decorrelated)
      remarks.push_back(step + " lost its correlation: " + number(100 * q.valid, 3) +
                        " % of its vectors are valid, median score " + number(q.median_score, 2) + ".");
    const std::string shifts = "median " + number(q.median_shift, 3) + " spacings, " + number(usual_shift, 3) +
                               " in the step before";
    if (after.flag & frame_repeated) remarks.push_back(step + " hardly moves (" + shifts + "); the exposure may be repeated.");
    if (after.flag & frame_flash)
      remarks.push_back("Frame " + after.name +
                        " is brighter or darker than the frames before and after: a flash, or a lamp that failed.");
    if (after.flag & frame_jump)
      remarks.push_back(step + " does not agree with its neighbours (" + shifts +
                        "); a frame may be missing, or the camera was shaken.");
  }
}

void remark_on_ends(const MotionSource& motion, std::vector<std::string>& remarks) {
  const ParticleSet& set = motion.particles();
  std::map<EndReason, std::size_t> ends;
  for (const EndReason reason : set.end_reason)
    if (reason != EndReason::none) ++ends[reason];
  for (const auto& [reason, count] : ends)
    remarks.push_back("Motion " + motion.name() + ": " + std::to_string(count) + " of " + std::to_string(set.size()) +
                      " particles " + words(reason) + "; their histories are kept.");
}

}  // namespace

std::vector<std::string> remarks_on_heat(const MotionSource& motion) {
  if (motion.times().empty() || !motion.frame(0).find("heat_limit")) return {};
  std::size_t hot = 0, open = 0;  // at most in one state
  for (std::size_t k = 0; k < motion.times().size(); ++k) {
    std::size_t hot_now = 0, open_now = 0;
    const MotionFrame frame = motion.frame(k);
    for (const float code : frame.field("heat_limit").values) {
      hot_now += code == 1 || code == 3;
      open_now += code >= 2;
    }
    hot = std::max(hot, hot_now);
    open = std::max(open, open_now);
  }
  std::vector<std::string> remarks;
  if (hot > 0)
    remarks.push_back("Up to " + std::to_string(hot) + " particles are hotter than 100 C in one of the states: water would boil, so their temperatures and pressures are not reliable (heat_limit).");
  if (open > 0)
    remarks.push_back("Up to " + std::to_string(open) + " particles have a water pressure (in the band, where there is one) above the total mean stress in one of the states: the soil would open (heat_limit).");
  return remarks;
}

std::vector<std::string> remarks_on_energy(const std::vector<EnergyRow>& rows, bool damped) {
  constexpr double much = 0.1;
  if (rows.empty()) return {};
  double supplied = 0;
  for (const EnergyRow& row : rows) supplied = std::max(supplied, std::abs(row.external));
  supplied += rows.front().kinetic + rows.front().elastic;
  const double lost = (damped ? 0 : rows.back().damping) - rows.back().residual;
  if (!(std::abs(lost) > much * supplied)) return {};
  const std::string what = lost > 0 ? "lost" : "gained";
  return {"The simulation's scheme has " + what + " " + number(100 * std::abs(lost) / supplied, 2) + " % of the energy supplied, " +
          number(std::abs(lost), 3) + " J/m (damping less residual). More material points per element, smaller cells or another transfer may help."};
}

std::vector<std::string> remarks_of(const io::RecordReader& record) {
  std::vector<std::string> remarks;
  remark_on_steps(record, remarks);
  for (const std::string& name : record.motion_names()) remark_on_ends(*record.motion(name), remarks);
  return remarks;
}

void add_camera(double residual, compare::CompareOptions& options) {
  if (!options.measurement_uncertainty_m && residual > 0) options.measurement_uncertainty_m = residual;
}

}  // namespace pivnp::app
