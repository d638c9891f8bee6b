// What a report is made of, wherever it came from: values and motions, no file and no Qt.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/record/camera_motion.hpp"
#include "pivnp/core/record/comparison.hpp"
#include "pivnp/core/record/energy.hpp"
#include "pivnp/core/record/reactions.hpp"
#include "pivnp/core/record/remark.hpp"
#include "pivnp/core/record/frames.hpp"
#include "pivnp/core/record/stage_cost.hpp"
#include "pivnp/core/record/strain_note.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/core/version.hpp"

namespace pivnp::report {

/// A frame to draw under vectors.
struct Picture {
  int frame = 0;
  Image image;  // empty: the frame is not there
  std::optional<Mat3> world_from_pixel = {};  // of a frame whose camera moved or has a lens; left out: the content's
};

/// Another run to show beside this one, or this one.
struct Run {
  std::string name;
  bool measured = false;                  // its curve is a measurement's
  std::vector<double> time, displacement;  // 95th percentile of |u| over the particles followed; length unit
  std::vector<Metric> metrics;            // of its comparison; empty: it has none
};

/// Any part may be missing: the report then has no section on it.
struct Content {
  std::string name;
  std::string command;                             // as typed
  BuildInfo written_by;                            // what wrote the record; empty texts: not known
  std::string case_text;                           // TOML with every default filled in
  std::string length_unit = "m", time_unit = "s";  // of vectors, motions and the camera
  Mat3 world_from_pixel = Mat3::Identity();
  double camera_residual = 0;  // RMS of the targets, length unit
  CameraMotion camera_motion;  // empty: at rest
  std::vector<Frame> frames;
  std::size_t pair_count = 0;
  std::function<VectorField(std::size_t)> pair;  // read one at a time, in order
  std::shared_ptr<const MotionSource> measured, simulated;  // where they are compared: as the comparison sees them
  std::shared_ptr<const MotionSource> tracked;              // the measured one as it is in the frames
  std::string alignment;  // what was done to them before, for captions: one sentence; empty: nothing
  std::optional<StrainNote> strain_note;          // of the measured motion
  std::optional<Comparison> comparison;  // simulated (second) minus measured (first)
  bool per_radian = false;                        // energies and reactions are those of a radian
  std::vector<EnergyRow> energy;                  // J per metre of thickness
  Reactions reactions;                            // of the simulation's boundaries, loads and bodies
  std::span<const Picture> pictures;
  std::shared_ptr<const Picture> last_picture;  // the frame at the last compared time, to draw shear bands on; nullptr: none
  std::vector<std::pair<std::string, std::string>> hardware, setup, simulated_setup;  // rows on the camera as given, the correlation, the simulation
  std::optional<double> gauge;             // over which strains are drawn, where it is not the record's; length unit
  double mobilised = 0;                    // displacement above which material counts as mobilised; 0: not known
  std::vector<Run> runs;             // the record's own first; empty: no others were asked for
  RunCost cost;                      // time and memory of the run's stages
  std::vector<Remark> remarks;       // what the run and its data say: doubts are flags
  std::vector<std::string> notes;    // how the comparison was made, likewise
};

}  // namespace pivnp::report
