#include <algorithm>
#include <chrono>
#include <ctime>
#include <stdexcept>
#include <system_error>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/files/seal.hpp"
#include "pivnp/io/hdf5/probe.hpp"
#include "pivnp/io/records/motion_file.hpp"
#include "pivnp/io/records/record_impl.hpp"

namespace pivnp::io {

namespace {

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

// As the file holds them: areas in single precision.
bool same(const ParticleSet& a, const ParticleSet& b) {
  return a.id == b.id && a.label == b.label && a.x0 == b.x0 && a.label_names == b.label_names &&
         std::equal(a.area.begin(), a.area.end(), b.area.begin(), b.area.end(),
                    [](double p, double q) { return float(p) == float(q); });
}

void require(bool ok, const std::string& what) {
  if (!ok) throw std::logic_error("record: " + what);
}

}  // namespace

RecordWriter::Impl::Impl(const std::filesystem::path& dir, const RecordHead& h, bool resume,
                         std::shared_ptr<const DirectoryLock> held, const StageKeys& keys)
    : directory(dir),
      parts(dir / "parts"),
      head(h),
      units{h.length_unit, h.time_unit, h.per_radian},
      lock(held ? std::move(held) : std::make_shared<DirectoryLock>(dir)) {
  for (const char* left : {"record.h5.tmp", "record.xdmf.tmp", "parts.old"})
    std::filesystem::remove_all(directory / left);
  const std::filesystem::path record = directory / "record.h5";
  if (resume && std::filesystem::exists(parts / "head.h5")) {
    take_up(keys);
  } else if (resume && std::filesystem::exists(record)) {
    finished = std::make_unique<RecordReader>(record);
    check_same_run(finished->head(), head, record.string(), keys);
    if (keys && finished->head().case_text != head.case_text) {
      const std::vector<std::string> motions = finished->motion_names();
      const auto has = [&](const char* name) { return std::find(motions.begin(), motions.end(), name) != motions.end(); };
      const auto text = [&](const RecordHead& of) { return keys(of.case_text, "motion/mpm"); };
      check_same_case(finished->head(), head, record.string(), keys, "motion/np");
      // Nothing but its comparison or its report is to be done anew; other commands do that.
      if (!has("np") || (has("mpm") && text(finished->head()) == text(head))) check_same_case(finished->head(), head, record.string(), {}, "");
      check_same_program(read_written_by(h5::Source(record)), record.string());
      check_same_instruction_set(h5::Source(record), record.string());
      kept = std::move(finished);
      begin_parts();  // no head yet: what is killed before all is copied is no run to resume
    }
  } else {
    start_afresh();
  }
}

void RecordWriter::Impl::keep_notes(const RecordReader& record) {
  frames = record.frames();
  camera_motion = record.camera_motion();
  closure = record.closure();
  if (const auto note = record.strain_note("np")) strain_notes["np"] = *note;
}

void RecordWriter::Impl::remove_parts() {
  if (!std::filesystem::exists(parts)) return;
  const std::filesystem::path old = directory / "parts.old";
  rename_file(parts, old);  // at once, so that no later run takes a half removed directory for a run to resume
  std::filesystem::remove_all(old);
}

void RecordWriter::Impl::begin_parts() {
  remove_parts();
  std::filesystem::create_directories(parts);
  created = utc_now();
}

void RecordWriter::Impl::commit_head() {
  h5::OutputFile file(parts / "head.h5");
  write_head(file, head, created);
  if (kept) file.attribute("/", "measured_before", 1.0);
  file.commit();
  sync_directory(directory);
}

void RecordWriter::Impl::start_afresh() {
  begin_parts();
  commit_head();
}

void RecordWriter::Impl::take_up(const StageKeys& keys) {
  RecordHead there;
  {
    if (seal_of(parts / "head.h5") != Seal::intact)
      throw InputError((parts / "head.h5").string() + ": is damaged; run without --resume to start again");
    probe_file(parts / "head.h5");
    const h5::Source source(parts / "head.h5");
    const std::string version = source.attribute_text("/", "schema_version");
    if (version != schema_version)
      throw InputError(parts.string() + ": segments of schema version " + shown(version) + ", expected " + schema_version +
                       "; run without --resume to start again");
    there = read_head(source);
    check_same_program(read_written_by(source), parts.string());
    check_same_instruction_set(source, parts.string());
    check_same_run(there, head, parts.string(), keys);
    head.command = there.command;  // the record tells how the run began
    created = source.attribute_text("/", "created");
    if (source.has_attribute("/", "measured_before")) {  // its vectors are those of a record, which its particles have made their own
      check_same_case(there, head, parts.string(), keys, "motion/np");
      kept = std::make_unique<RecordReader>(directory / "record.h5");
      keep_notes(*kept);
    }
  }
  const auto same = [&](const std::string& stage) { return !keys || keys(there.case_text, stage) == keys(head.case_text, stage); };
  for (StageFiles& files : scan_parts(parts)) {
    if (!same(files.stage)) {
      for (const SegmentInfo& segment : files.segments) std::filesystem::remove(segment.path);
      for (const std::filesystem::path& path : {files.end, files.particles})
        if (!path.empty()) std::filesystem::remove(path);
      continue;
    }
    former[files.stage] = files;
    Stage& stage = stages[files.stage];
    stage.complete = !files.end.empty();
    if (!files.particles.empty()) {
      const h5::Source source(files.particles);
      stage.particles = source.dataset("/id").shape()[0];
      stage.order = static_cast<std::int64_t>(source.attribute_number("/", "order"));
    }
    stage.files = std::move(files);
  }
  if (there.case_text != head.case_text) commit_head();
}

RecordWriter::Impl::Stage& RecordWriter::Impl::writable(const std::string& name) {
  require(!finished, "the run is finished; stage '" + name + "' is complete");
  Stage& stage = stages[name];
  stage.files.stage = name;
  require(!stage.complete, "stage '" + name + "' is complete");
  if (stage.failed) throw RunError(directory.string() + ": stage '" + name + "' could not be written before");
  return stage;
}

void RecordWriter::Impl::add(const std::string& name, const std::vector<ItemArray>& arrays) {
  Stage& stage = writable(name);
  if (stage.open && stage.open->full()) close(stage, nullptr);
  try {
    if (!stage.open) stage.open = std::make_unique<OpenSegment>(parts, name, stage.files.items());
    stage.open->add(arrays);
  } catch (...) {
    stage.open.reset();
    stage.failed = true;
    throw;
  }
}

void RecordWriter::Impl::close(Stage& stage, const std::vector<std::byte>* checkpoint) {
  if (!stage.open) return;
  try {
    SegmentInfo info{{}, stage.open->first(), stage.open->count(), checkpoint != nullptr};
    info.path = stage.open->close(stage.rows, checkpoint);
    stage.files.segments.push_back(std::move(info));
  } catch (...) {
    stage.open.reset();
    stage.failed = true;
    throw;
  }
  stage.open.reset();
  stage.rows = {};
}

VectorField RecordWriter::Impl::read_back(const Stage& piv, std::size_t index) const {
  if (piv.open && index >= piv.open->first())
    return read_pair(piv.open->source(), "", head.grid, index - piv.open->first());
  const auto segment = std::find_if(piv.files.segments.begin(), piv.files.segments.end(),
                                    [&](const SegmentInfo& s) { return index < s.first + s.count; });
  if (!last_read || last_read->first != segment->path) {
    // What is computed from a damaged segment would outlive it.
    if (seal_of(segment->path) != Seal::intact)
      throw RunError(segment->path.string() + ": was damaged since it was written; --resume computes it again");
    last_read.emplace(segment->path, h5::Source(segment->path));
  }
  return read_pair(last_read->second, "", head.grid, index - segment->first);
}

std::vector<const RecordWriter::Impl::Stage*> RecordWriter::Impl::motions() const {
  std::vector<const Stage*> out;
  for (const auto& [name, stage] : stages)
    if (name.starts_with("motion/")) out.push_back(&stage);
  std::sort(out.begin(), out.end(), [](const Stage* a, const Stage* b) { return a->order < b->order; });
  return out;
}

std::int64_t RecordWriter::Impl::free_order() const {
  const std::vector<const Stage*> begun = motions();
  std::int64_t order = 1;
  for (const Stage* stage : begun) order += stage->order == order;
  return order;
}

RecordWriter::RecordWriter(const std::filesystem::path& directory, const RecordHead& head, bool resume, int threads,
                           std::shared_ptr<const DirectoryLock> held, const StageKeys& keys)
    : impl_(std::make_unique<Impl>(directory, head, resume, std::move(held), keys)) {
  impl_->threads = threads;
  if (!impl_->kept || std::filesystem::exists(impl_->parts / "head.h5")) return;
  const RecordReader& record = *impl_->kept;
  for (std::size_t k = 0; k < record.pair_count(); ++k) add_pair(record.pair(k));
  if (record.pair_count() > 0) end_stage("piv", nullptr);
  const std::unique_ptr<MotionSource> np = record.motion("np");
  begin_motion("np", np->particles());
  for (std::size_t k = 0; k < np->times().size(); ++k) add_frame("np", np->frame(k));
  end_stage("motion/np", &np->particles());
  impl_->keep_notes(record);
  for (const auto& [name, stage] : impl_->stages) impl_->former[name] = stage.files;
  impl_->commit_head();
}
RecordWriter::~RecordWriter() = default;

StageState RecordWriter::stage(const std::string& name) const {
  StageState state;
  if (impl_->finished) {
    state.complete = true;
    if (name == "piv") state.items = impl_->finished->pair_count();
    for (const std::string& motion : impl_->finished->motion_names())
      if (name == "motion/" + motion) state.items = impl_->finished->motion(motion)->times().size();
    return state;
  }
  const auto it = impl_->former.find(name);
  if (it == impl_->former.end()) return state;
  state.items = it->second.items();
  state.complete = !it->second.end.empty();
  if (!it->second.segments.empty() && it->second.segments.back().has_checkpoint)
    state.checkpoint = h5::Source(it->second.segments.back().path).dataset("/checkpoint").all<std::byte>();
  return state;
}

void RecordWriter::add_pair(const VectorField& field) {
  const std::size_t nodes = field.grid.node_count();
  require(field.grid == impl_->head.grid, "a pair on another grid than the record's");
  require(field.displacement.size() == nodes && field.status.size() == nodes && field.cov.size() == nodes &&
              field.score.size() == nodes && (field.path_factor.empty() || field.path_factor.size() == nodes), "a pair whose arrays do not fit its grid");
  impl_->add("piv", pair_arrays(impl_->head.grid, impl_->units, &field));
}

void RecordWriter::begin_motion(const std::string& name, const ParticleSet& particles) {
  check_name(name, "motion");
  if (particles.size() == 0) throw InputError("motion '" + name + "': no particles, expected at least one");
  if (impl_->finished) return;
  const std::string key = "motion/" + name;
  const bool known = impl_->stages.contains(key);
  Impl::Stage& stage = impl_->stages[key];
  stage.files.stage = key;
  if (known && !stage.files.particles.empty() && (stage.complete || stage.items() > 0)) {
    if (!same(read_particles(h5::Source(stage.files.particles), ""), particles))
      throw InputError(impl_->parts.string() + ": the particles of motion '" + name +
                       "' differ from those of the run to resume; run without --resume to start again");
    return;
  }
  if (stage.order == 0) stage.order = impl_->free_order();
  stage.particles = particles.size();
  const std::filesystem::path path = impl_->parts / (stage_file_name(key) + ".particles.h5");
  h5::OutputFile file(path);
  file.attribute("/", "stage", key);
  file.attribute("/", "order", std::vector<std::int64_t>{stage.order}, true);
  write_particles(file, "", particles, impl_->units);
  file.commit();
  stage.files.particles = path;
}

void RecordWriter::add_frame(const std::string& name, const MotionFrame& frame) {
  const auto it = impl_->stages.find("motion/" + name);
  require(impl_->finished || (it != impl_->stages.end() && it->second.particles > 0),
          "motion '" + name + "' was not begun");
  Impl::Stage& stage = impl_->writable("motion/" + name);
  const std::size_t n = stage.particles;
  for (const MotionField& field : motion_fields()) {
    const std::size_t count = particles_with(frame, field);
    require(count == n || (count == 0 && !field.always),
            "field '" + field.name + "' of a frame does not fit the particles of motion '" + name + "'");
  }
  impl_->add("motion/" + name, frame_arrays(n, impl_->units, &frame));
}

void RecordWriter::add_energy(const std::string& motion, const EnergyRow& row) {
  require(impl_->energy_motion.empty() || impl_->energy_motion == motion, "energies of two motions");
  impl_->energy_motion = motion;
  impl_->writable("motion/" + motion).rows.energy.push_back(row);
}

void RecordWriter::add_reactions(const std::string& motion, const std::vector<std::string>& names, const ReactionRow& row) {
  require(impl_->energy_motion.empty() || impl_->energy_motion == motion, "reactions of two motions");
  require(row.of.size() == names.size(), "a row of reactions does not fit the names");
  impl_->energy_motion = motion;
  SegmentRows& rows = impl_->writable("motion/" + motion).rows;
  require(rows.reactions.empty() || rows.reaction_names == names, "reactions of other names");
  rows.reaction_names = names;
  rows.reactions.push_back(row);
}

bool RecordWriter::segment_full(const std::string& stage) const {
  const auto it = impl_->stages.find(stage);
  return it != impl_->stages.end() && it->second.open && it->second.open->full();
}

void RecordWriter::close_segment(const std::string& stage, const std::vector<std::byte>& checkpoint) {
  if (!impl_->finished) impl_->close(impl_->writable(stage), &checkpoint);
}

void RecordWriter::end_stage(const std::string& name, const ParticleSet* particles) {
  if (impl_->finished) return;
  const auto it = impl_->stages.find(name);
  if (it != impl_->stages.end() && it->second.complete) return;
  const bool motion = name.starts_with("motion/");
  require(motion == (particles != nullptr), "stage '" + name + "' ended with the wrong kind of data");
  Impl::Stage& stage = impl_->writable(name);
  require(!motion || particles->size() == stage.particles,
          "stage '" + name + "' ended with other particles than it began with");
  impl_->close(stage, nullptr);
  const std::filesystem::path path = impl_->parts / (stage_file_name(name) + ".end.h5");
  h5::OutputFile file(path);
  file.attribute("/", "stage", name);
  file.attribute("/", "items", std::vector<std::int64_t>{static_cast<std::int64_t>(stage.items())}, true);
  if (particles) write_particles(file, "", *particles, impl_->units);
  write_rows(file, stage.rows);
  file.commit();
  stage.files.end = path;
  stage.complete = true;
}

void RecordWriter::leave_out(const std::string& motion) {
  if (!impl_->finished) impl_->stages.erase("motion/" + motion);
}

VectorField RecordWriter::pair(std::size_t index) const {
  if (impl_->finished) return impl_->finished->pair(index);
  const auto it = impl_->stages.find("piv");
  require(it != impl_->stages.end() && index < it->second.items(), "pair " + std::to_string(index) + " is not there");
  try {
    return impl_->read_back(it->second, index);
  } catch (const InputError& error) {  // reading back what we wrote ourselves is no matter of input
    throw RunError(error.what());
  }
}

void RecordWriter::set_frames(const std::vector<Frame>& frames) {
  if (!impl_->kept) impl_->frames = frames;
}

void RecordWriter::set_comparison(const Comparison& comparison) {
  for (const Metric& m : comparison.metrics) {
    check_name(m.name, "metric");
    require(m.name != "fields", "a metric cannot be named 'fields'");
  }
  for (const ComparisonField& f : comparison.fields) {
    check_name(f.name, "field of the comparison");
    require(f.values.size() == f.time.size() * f.id.size(), "comparison field '" + f.name + "' is not [time][id]");
  }
  for (const ComparisonTable& t : comparison.tables) {
    check_name(t.name, "table of the comparison");
    for (const ComparisonTable::Column& column : t.columns) {
      check_name(column.name, "column of the comparison's table '" + t.name + "'");
      require(column.values.size() == t.columns.front().values.size(),
              "columns of the comparison's table '" + t.name + "' differ in length");
    }
  }
  impl_->comparison = comparison;
}

void RecordWriter::set_material(const std::string& motion) { impl_->material = motion; }

void RecordWriter::set_remarks(const std::vector<Remark>& remarks) { impl_->remarks = remarks; }

void RecordWriter::set_cost(const RunCost& cost) { impl_->cost = cost; }

void RecordWriter::set_camera_motion(const CameraMotion& motion) {
  if (!impl_->finished && !impl_->kept) impl_->camera_motion = motion;
}

void RecordWriter::set_closure(const ClosureNote& note) {
  if (impl_->finished || impl_->kept) return;
  require(note.repeated.empty() || note.repeated.size() == impl_->head.grid.node_count(),
          "a repeated error that is not of the grid's nodes");
  impl_->closure = note;
}

void RecordWriter::set_output_fields(const std::vector<std::string>& names) {
  for (const std::string& name : names) derived_field(name);  // throws for an unknown one
  impl_->output_fields = names;
}

void RecordWriter::set_strain_note(const std::string& motion, const StrainNote& note) {
  if (impl_->finished || impl_->kept) return;
  require(impl_->stages.contains("motion/" + motion), "no motion '" + motion + "' to note a strain's gauge of");
  impl_->strain_notes[motion] = note;
}

void RecordWriter::pack() {
  if (impl_->finished) return;
  for (const auto& [name, stage] : impl_->stages) require(stage.complete, "stage '" + name + "' was not ended");
  impl_->pack();
}

std::unique_ptr<MotionSource> RecordWriter::motion(const std::string& name) const {
  if (impl_->finished) return impl_->finished->motion(name);
  require(impl_->packed != nullptr, "motion '" + name + "' read before pack()");
  require(impl_->stages.contains("motion/" + name), "no motion '" + name + "'");
  return open_motion(impl_->packed->source(), name, impl_->units, nullptr);
}

void RecordWriter::finish(bool to_be_resumed) {
  if (impl_->finished) return;
  pack();
  impl_->kept.reset();
  impl_->commit_packed();
  write_xdmf(impl_->directory / "record.h5");
  impl_->last_read.reset();
  if (!to_be_resumed) impl_->remove_parts();
  impl_->finished = std::make_unique<RecordReader>(impl_->directory / "record.h5", Trust::known);
}

}  // namespace pivnp::io
