// Segments: what a stage leaves on disk while it works. Private to this folder's sources.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/record/reactions.hpp"
#include "pivnp/io/records/schema.hpp"

namespace pivnp::io {

inline constexpr std::size_t segment_items = 64;
inline constexpr std::size_t segment_bytes = std::size_t{256} << 20;  // large items: a segment is full earlier

/// "motion/np" -> "motion.np": the beginning of the stage's file names.
std::string stage_file_name(const std::string& stage);

/// What a simulation tells at its output times beside the particles.
struct SegmentRows {
  std::vector<EnergyRow> energy;
  std::vector<std::string> reaction_names;
  std::vector<ReactionRow> reactions;
};

/// The segment a stage is writing. Items go straight into the (temporary) file, uncompressed.
class OpenSegment {
 public:
  OpenSegment(const std::filesystem::path& parts, const std::string& stage, std::size_t first);

  void add(const std::vector<ItemArray>& arrays);
  std::size_t first() const { return first_; }
  std::size_t count() const { return count_; }
  bool full() const { return count_ >= segment_items || bytes_ >= segment_bytes; }
  /// Closed, fsynced, renamed. `checkpoint`: nullptr if there is none. Throws RunError; the segment is then lost.
  std::filesystem::path close(const SegmentRows& rows, const std::vector<std::byte>* checkpoint);
  h5::Source source() const { return file_->source(); }

 private:
  struct Series {
    std::string name;
    h5::Dataset dataset;
  };
  std::filesystem::path path_;
  std::string stage_;
  std::size_t first_, count_ = 0, bytes_ = 0;
  std::unique_ptr<h5::OutputFile> file_;
  std::vector<Series> series_;  // after file_: they let go of it first
};

/// A closed segment.
struct SegmentInfo {
  std::filesystem::path path;
  std::size_t first = 0, count = 0;
  bool has_checkpoint = false;
};

/// What is on disk of one stage.
struct StageFiles {
  std::string stage;
  std::vector<SegmentInfo> segments;         // in order, without a gap
  std::filesystem::path particles;           // empty: none
  std::filesystem::path end;                 // empty: not complete
  std::size_t items() const { return segments.empty() ? 0 : segments.back().first + segments.back().count; }
};

/// Reads the directory of parts. Temporary files are removed; so are segments after a gap or a damaged one, and, in a
/// stage that is not complete, those after the last one with a checkpoint: a resumed engine could not go on from them.
std::vector<StageFiles> scan_parts(const std::filesystem::path& parts);

/// Energies are kept as rows of the columns of energy_table(), reactions as rows of the time and six numbers for each name.
void write_rows(h5::OutputFile& file, const SegmentRows& rows);
/// Appends those of a segment.
void read_rows(const h5::Source& source, SegmentRows& rows);

/// The constants of a motion's particles below `group` ("" in a file of parts, "/motion/NAME" in a record).
void write_particles(h5::OutputFile& file, const std::string& group, const ParticleSet& particles, const Units& units);
ParticleSet read_particles(const h5::Source& source, const std::string& group);

/// One pair at position `index` of the series below `group`.
VectorField read_pair(const h5::Source& source, const std::string& group, const Grid& grid, std::size_t index);

}  // namespace pivnp::io
