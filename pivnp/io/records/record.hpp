// The record of a run: DIR/parts/ while it works, DIR/record.h5 and DIR/record.xdmf at its end. docs/format.md is the
// contract.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/record/camera_motion.hpp"
#include "pivnp/core/record/closure_note.hpp"
#include "pivnp/core/record/remark.hpp"
#include "pivnp/core/record/comparison.hpp"
#include "pivnp/core/record/energy.hpp"
#include "pivnp/core/record/frames.hpp"
#include "pivnp/core/record/reactions.hpp"
#include "pivnp/core/record/stage_cost.hpp"
#include "pivnp/core/record/strain_note.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/core/version.hpp"
#include "pivnp/io/files/directory_lock.hpp"
#include "pivnp/io/files/file_identity.hpp"

namespace pivnp::io {

/// The parts of /, /case, /grid, /camera that are known when a run starts.
struct RecordHead {
  std::string command;    // as typed
  std::string case_text;  // TOML with every default filled in
  std::string length_unit = "m", time_unit = "s";
  Grid grid;
  Mat3 world_from_pixel = Mat3::Identity();
  double camera_residual = 0;
  std::optional<double> metres_per_pixel;  // only if plain
  std::string lens = "none";               // model of the lens, "brown" or "fisheye"
  std::vector<double> distortion;          // its coefficients; empty: none
  std::vector<double> focal, principal;    // of a lens or a window: focal lengths and principal point, px
  std::vector<double> window;              // thickness, distance, refractive index; empty: none
  bool per_radian = false;  // energies and forces are those of a radian about the axis, not of a unit of thickness
  std::vector<FileIdentity> sources;       // files that the run reads beside its case: frames, masks
};

/// What a stage left behind in closed segments.
struct StageState {
  std::size_t items = 0;             // pairs or frames in closed segments
  std::vector<std::byte> checkpoint;  // the engine's state after them
  bool complete = false;
};

/// What of a case's text the results of a stage ("piv", "motion/np" ...) depend on.
using StageKeys = std::function<std::string(const std::string& case_text, const std::string& stage)>;

/// Writes a record. Each stage ("piv", "motion/np", "motion/mpm") leaves segment files of at most 64 items (or 256 MiB,
/// if that is reached earlier): written under a temporary name, closed, fsynced, renamed. Items go to disk as they
/// come; nothing grows with their number. A full disk throws RunError naming file and cause, earlier segments intact,
/// the unfinished file removed; the stage then takes no more. Only one writer may hold a directory (DIR/.lock;
/// InputError if held). std::logic_error: wrong use (another grid, arrays of the wrong length, a stage not begun or
/// already ended). One thread only: HDF5 is not thread-safe.
class RecordWriter {
 public:
  /// Without `resume`, old parts in `directory` are removed and a finished record is replaced only at the end. With it,
  /// closed segments are kept if their case text, sources, grid, camera and units equal those of `head`, and this
  /// program is the one that left them (else InputError saying what differs first); `command` and the time of creation
  /// stay those of the first start. A run that is already finished (record.h5 of the same case, no parts) counts as
  /// complete in every stage: pair() reads from the record, begin_motion, set_*, close_segment, end_stage and finish do
  /// nothing, add_* is wrong use. With nothing there to resume it starts afresh. `threads` pack the record. `held`: the
  /// directory's lock, where the run took it before; nullptr: taken here. `keys`: where the case differs, motions whose own
  /// keys differ begin anew and the rest is kept, of a finished record the measurement ("piv" and "motion/np"); its frames,
  /// camera motion, closure and strain notes then stay as well. Other keys of "piv" are refused as above.
  RecordWriter(const std::filesystem::path& directory, const RecordHead& head, bool resume, int threads = 1,
               std::shared_ptr<const DirectoryLock> held = nullptr, const StageKeys& keys = {});
  ~RecordWriter();  // what is in an open segment is lost: close it first if a resumed run is to go on from there

  /// What a former run left, up to the last segment with a checkpoint.
  StageState stage(const std::string& name) const;

  void add_pair(const VectorField& field);  // stage "piv": in order
  /// `name`: letters, digits, '_' and '-'. In a resumed run the particles must be those it began with (InputError).
  void begin_motion(const std::string& name, const ParticleSet& particles);
  void add_frame(const std::string& name, const MotionFrame& frame);  // arrays that a frame lacks are NaN
  /// To be called before the segment with the frame of that time is closed. One motion only.
  void add_energy(const std::string& motion, const EnergyRow& row);
  /// Likewise; the same names each time.
  void add_reactions(const std::string& motion, const std::vector<std::string>& names, const ReactionRow& row);
  /// True when the stage's open segment is full: the caller should then hand over its checkpoint and close it. If it
  /// does not, the next item closes it without one, and a resumed run does those items again.
  bool segment_full(const std::string& stage) const;
  void close_segment(const std::string& stage, const std::vector<std::byte>& checkpoint);
  /// Closes the stage; `particles` carries the final ends of a motion (nullptr for "piv").
  void end_stage(const std::string& stage, const ParticleSet* particles);

  /// Leaves a motion out of the record, whatever it has come to; its closed segments stay for `resume`.
  void leave_out(const std::string& motion);

  VectorField pair(std::size_t index) const;  // read back from closed or open segments
  void set_frames(const std::vector<Frame>& frames);
  /// How the camera moved; of as many frames as set_frames() gives.
  void set_camera_motion(const CameraMotion& motion);
  /// What closure said of the pairs. Throws std::logic_error where the repeated error is not of the grid's nodes.
  void set_closure(const ClosureNote& note);
  /// Before pack(): nodes that no particle of that motion covers at a pair's first frame (pivnp/core/particles/coverage.hpp)
  /// become VectorStatus::outside in the record. What is read back before that keeps its status.
  void set_material(const std::string& motion);
  void set_comparison(const Comparison& comparison);
  /// What the run said of itself; before finish().
  void set_remarks(const std::vector<Remark>& remarks);
  /// What the run took so far; before finish().
  void set_cost(const RunCost& cost);
  /// Fields of DerivedReader to store per motion (output.fields) when packing. Throws InputError for an unknown name.
  void set_output_fields(const std::vector<std::string>& names);

  /// Packs all stages (each ended) into the file that will be the record, so that motion() can read them.
  void pack();
  /// A motion of this run, after pack() and before finish(); the writer must outlive it.
  std::unique_ptr<MotionSource> motion(const std::string& name) const;

  /// What goes with a motion's strains. After pack(), before finish().
  void set_strain_note(const std::string& motion, const StrainNote& note);

  /// Packs (if that is not done), adds the comparison, puts record.h5 in place (write, fsync, rename), writes
  /// record.xdmf, removes parts/; with `to_be_resumed` parts/ stay, since a stage is missing.
  void finish(bool to_be_resumed = false);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether a record may be other than it was written.
enum class Trust {
  verify,  // its checksum is read first; a file without one is tried out in a child process
  known,   // this process wrote or verified it
};

/// Reads a finished record; frames and pairs when they are asked for. Throws InputError naming the file and what is
/// damaged, missing, of the wrong shape or of the wrong version. Codes, sections and datasets that a later 1.y added
/// are no errors. One thread only.
class RecordReader {
 public:
  explicit RecordReader(const std::filesystem::path& file, Trust trust = Trust::verify);
  ~RecordReader();

  const RecordHead& head() const;
  /// Of docs/format.md: "1.4".
  std::string schema_version() const;
  /// The program that packed the record; empty texts where the record does not say (schema 1.1 and before).
  BuildInfo written_by() const;
  const std::vector<Frame>& frames() const;  // none, or all that pairs are of
  CameraMotion camera_motion() const;  // empty where the record states none: the camera was taken to be at rest
  std::size_t pair_count() const;
  VectorField pair(std::size_t index) const;
  /// Nothing where the record states none (no pairs, an older record).
  std::optional<ClosureNote> closure() const;
  /// What the run said of itself.
  std::vector<Remark> remarks() const;
  std::vector<std::string> motion_names() const;
  std::unique_ptr<MotionSource> motion(const std::string& name) const;  // reads frame by frame
  /// Nothing where the record states none (a simulation, an older record).
  std::optional<StrainNote> strain_note(const std::string& motion) const;
  std::vector<EnergyRow> energy() const;
  Reactions reactions() const;  // empty where the record has none (an older record)
  std::optional<Comparison> comparison() const;
  RunCost cost() const;  // no stages where the record states none (an older record)

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;  // shared with the motions it handed out
};

/// The first line by which two cases' texts differ, "first in line 12: 'window_px = 24' there, 'window_px = 32' now"; empty if
/// they are equal.
std::string difference_of_cases(const std::string& there, const std::string& now);

/// Writes DIR/record.xdmf for DIR/record.h5: a temporal collection of the particles of every motion and one of the
/// grid's vectors, for ParaView.
void write_xdmf(const std::filesystem::path& record);

}  // namespace pivnp::io
