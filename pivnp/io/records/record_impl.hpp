// The writer's insides. Private to this folder's sources.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/io/files/files.hpp"
#include "pivnp/io/records/record.hpp"
#include "pivnp/io/records/segment.hpp"

namespace pivnp::io {

struct RecordWriter::Impl {
  struct Stage {
    StageFiles files;
    std::unique_ptr<OpenSegment> open;
    SegmentRows rows;               // of items that are not yet in a closed segment
    bool complete = false;
    bool failed = false;            // a write failed: nothing more is taken
    std::size_t particles = 0;
    std::int64_t order = 0;         // of motions

    std::size_t items() const { return open ? open->first() + open->count() : files.items(); }
  };

  Impl(const std::filesystem::path& dir, const RecordHead& h, bool resume, std::shared_ptr<const DirectoryLock> held, const StageKeys& keys);

  Stage& writable(const std::string& name);
  void add(const std::string& name, const std::vector<ItemArray>& arrays);
  void close(Stage& stage, const std::vector<std::byte>* checkpoint);
  VectorField read_back(const Stage& piv, std::size_t index) const;
  std::vector<const Stage*> motions() const;  // in the order of their beginning
  std::int64_t free_order() const;            // the least that no motion has
  void pack();           // everything that the stages left, into `packed`
  void commit_packed();  // comparison and views added, closed, put in place
  void pack_into(h5::OutputFile& out) const;
  void guarded(h5::OutputFile& out, const std::function<void()>& work) const;
  void remove_parts();
  void commit_head();
  void keep_notes(const RecordReader& record);

  std::filesystem::path directory, parts;
  RecordHead head;
  int threads = 1;  // for packing
  std::string created;
  Units units;
  std::shared_ptr<const DirectoryLock> lock;
  std::map<std::string, Stage> stages;
  std::string energy_motion;                   // the one whose energies and reactions are kept
  std::map<std::string, StageFiles> former;    // as found on disk
  std::unique_ptr<RecordReader> finished;      // resumed, but there is nothing left to do
  std::unique_ptr<RecordReader> kept;          // a finished record whose measurement this run goes on from
  std::vector<Frame> frames;
  CameraMotion camera_motion;
  std::optional<ClosureNote> closure;
  std::optional<Comparison> comparison;
  std::optional<RunCost> cost;
  std::vector<Remark> remarks;
  std::string material;                        // the motion that tells where nodes are outside; empty: none
  std::map<std::string, StrainNote> strain_notes;  // by motion
  std::vector<std::string> output_fields;
  std::unique_ptr<h5::OutputFile> packed;      // between pack() and finish()
  mutable std::optional<std::pair<std::filesystem::path, h5::Source>> last_read;

 private:
  void start_afresh();
  void take_up(const StageKeys& keys);
  void begin_parts();
};

/// /, /case, /grid and /camera.
void write_head(h5::OutputFile& file, const RecordHead& head, const std::string& created);
RecordHead read_head(const h5::Source& source);
BuildInfo read_written_by(const h5::Source& source);

/// Throw InputError with a line that starts with `where` if a run of `there` cannot go on as `now`, or in this program.
void check_same_program(const BuildInfo& there, const std::string& where);
/// Throws InputError if the run to resume began with another instruction set than the kernels run on now.
void check_same_instruction_set(const h5::Source& source, const std::string& where);
void check_same_run(const RecordHead& there, const RecordHead& now, const std::string& where, const StageKeys& keys = {});
/// The same of the case alone, as far as `stage` depends on it; all of it where `keys` are none.
void check_same_case(const RecordHead& there, const RecordHead& now, const std::string& where, const StageKeys& keys, const std::string& stage);

}  // namespace pivnp::io
