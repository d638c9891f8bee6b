// The record of a run: DIR/parts/ while it works, DIR/record.h5 and DIR/record.xdmf at its end. docs/format.md is the
// contract.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/record/energy.hpp"
#include "pivnp/core/record/frames.hpp"
#include "pivnp/core/record/metric.hpp"
#include "pivnp/core/record/vectors.hpp"

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
  std::vector<double> distortion;          // coefficients of a lens model; empty: none
};

/// One comparison: metrics, and fields on particles to look at.
struct ComparisonData {
  std::string measured, simulated;  // names of the motions
  std::vector<Metric> metrics;
  struct Field {
    std::string name, unit, definition;
    std::vector<double> time;
    std::vector<std::int64_t> id;
    std::vector<float> values;  // [time][id], NaN where no partner
  };
  std::vector<Field> fields;
};

/// What a stage left behind in closed segments.
struct StageState {
  std::size_t items = 0;             // pairs or frames in closed segments
  std::vector<std::byte> checkpoint;  // the engine's state after them
  bool complete = false;
};

/// Writes a record. Each stage ("piv", "motion/np", "motion/mpm") leaves segment files of at most 64 items: written
/// under a temporary name, closed, fsynced, renamed. A full disk throws RunError naming file and cause, earlier
/// segments intact. Only one writer may hold a directory (lock file; InputError if held).
class RecordWriter {
 public:
  /// Without `resume`, old parts in `directory` are removed and a finished record is replaced only at the end. With it,
  /// closed segments are kept if their case text equals `head.case_text` (else InputError saying what differs).
  RecordWriter(const std::filesystem::path& directory, const RecordHead& head, bool resume);
  ~RecordWriter();

  StageState stage(const std::string& name) const;  // what a former run left

  void add_pair(const VectorField& field);  // stage "piv": in order
  void begin_motion(const std::string& name, const ParticleSet& particles);
  void add_frame(const std::string& name, const MotionFrame& frame);
  void add_energy(const std::string& motion, const EnergyRow& row);
  /// True when the stage's open segment is full: the caller may then hand over its checkpoint and close it.
  bool segment_full(const std::string& stage) const;
  void close_segment(const std::string& stage, const std::vector<std::byte>& checkpoint);
  /// Closes the stage; `particles` carries the final ends of a motion (nullptr for "piv").
  void end_stage(const std::string& stage, const ParticleSet* particles);

  VectorField pair(std::size_t index) const;  // read back from closed or open segments
  void set_frames(const std::vector<Frame>& frames);
  void set_comparison(const ComparisonData& comparison);
  /// Extra fields to store per motion beside the fixed ones (output.fields), computed on reading.
  void set_output_fields(const std::vector<std::string>& names);

  /// Packs everything into record.h5 (write, fsync, rename), writes record.xdmf, removes parts/.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads a finished record. Throws InputError naming the file and what is missing or of the wrong version.
class RecordReader {
 public:
  explicit RecordReader(const std::filesystem::path& file);
  ~RecordReader();

  const RecordHead& head() const;
  const std::vector<Frame>& frames() const;
  std::size_t pair_count() const;
  VectorField pair(std::size_t index) const;
  std::vector<std::string> motion_names() const;
  std::unique_ptr<MotionSource> motion(const std::string& name) const;  // reads frame by frame
  std::vector<EnergyRow> energy() const;
  std::optional<ComparisonData> comparison() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;  // shared with the motions it handed out
};

/// Writes DIR/record.xdmf for DIR/record.h5: a temporal collection of the particles of every motion and of the grid's
/// vectors, readable by ParaView and meshio.
void write_xdmf(const std::filesystem::path& record);

}  // namespace pivnp::io
