// One motion as a command line names it: of a record, or of another program's files.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/record/strain_note.hpp"
#include "pivnp/io/imports/import_motion.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

/// The mesh study's motion on a grid whose cells are mesh_study_ratio^level times as large.
std::string coarser_motion(int level);
inline constexpr double mesh_study_ratio = 1.3;

struct OpenedMotion {
  io::RecordHead head;  // of the record it comes from; units and grid of nothing for other programs' results
  std::shared_ptr<MotionSource> motion;
  std::optional<StrainNote> note;
  std::vector<std::shared_ptr<MotionSource>> coarser = {};  // of the record's mesh study, the finer grid first
  bool central = true;  // the vectors that it follows; decides the summed strain only

  /// Of the camera's targets, if this motion was measured (it then carries a covariance).
  double residual() const;
};

/// "RECORD.h5" or a folder that holds it (a record with one motion needs no name), "RECORD.h5:motion", or
/// "FORMAT=PATTERN" (pivnp/io/imports/import_motion.hpp). A colon inside a path that exists belongs to the path. Throws
/// InputError naming the file and what it holds.
OpenedMotion open_motion(const std::string& text, const io::ImportOptions& foreign);

}  // namespace pivnp::app
