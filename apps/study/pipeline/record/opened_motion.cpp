#include "apps/study/pipeline/record/opened_motion.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

std::shared_ptr<MotionSource> motion_of(const io::RecordReader& record, const std::string& file,
                                        const std::string& motion) {
  const std::vector<std::string> names = record.motion_names();
  std::string known;
  for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
  if (motion.empty() && names.size() != 1)
    throw InputError(file + ": holds " + std::to_string(names.size()) + " motions (" + known +
                     "); name one as FILE:motion");
  const std::string name = motion.empty() ? names.front() : motion;
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw InputError(file + ": no motion '" + name + "'; it holds: " + known);
  return record.motion(name);
}

}  // namespace

std::string coarser_motion(int level) { return "mpm_coarser_" + std::to_string(level); }

double OpenedMotion::residual() const {
  const bool measured = !motion->times().empty() && !motion->frame(0).cov_u.empty();
  return measured ? head.camera_residual : 0;
}

OpenedMotion open_motion(const std::string& text, const io::ImportOptions& foreign) {
  namespace fs = std::filesystem;
  if (io::is_import(text)) return {io::RecordHead{}, io::open_import(text, foreign), {}};
  fs::path file = text;
  std::string motion;
  const std::size_t colon = text.rfind(':');
  if (!fs::exists(file) && colon != std::string::npos) {
    file = text.substr(0, colon);
    motion = text.substr(colon + 1);
  }
  if (fs::is_directory(file)) file /= "record.h5";
  const io::RecordReader record(file);
  std::shared_ptr<MotionSource> found = motion_of(record, file.string(), motion);
  std::optional<StrainNote> note = record.strain_note(found->name());
  OpenedMotion out{record.head(), std::move(found), std::move(note)};
  out.central = record.pair_count() == 0 || record.pair(0).anchor == Anchor::central;
  const std::vector<std::string> names = record.motion_names();
  for (int level = 1; out.motion->name() == "mpm"; ++level) {
    if (std::find(names.begin(), names.end(), coarser_motion(level)) == names.end()) break;
    out.coarser.push_back(record.motion(coarser_motion(level)));
  }
  return out;
}

}  // namespace pivnp::app
