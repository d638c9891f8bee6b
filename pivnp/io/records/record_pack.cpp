// From segments to DIR/record.h5.
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/coverage.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/record/reactions.hpp"
#include "pivnp/io/files/seal.hpp"
#include "pivnp/io/records/motion_file.hpp"
#include "pivnp/io/records/record_impl.hpp"
#include "pivnp/io/records/xdmf.hpp"

namespace pivnp::io {

namespace {

using h5::Packing;
using h5::Shape;
using h5::Type;

constexpr std::size_t copy_bytes = std::size_t{32} << 20;  // held in memory while copying

// Copies one array of all segments to GROUP/NAME, a block of items at a time. Arrays that no segment has are left out;
// items that lack an array others have are NaN. `change`: of each item, before it is written.
void pack_array(h5::OutputFile& out, const std::string& group, const ItemArray& a, const StageFiles& files,
                const std::function<void(std::size_t item, std::byte*)>& change = {}) {
  const std::size_t total = files.items();
  const bool present = std::any_of(files.segments.begin(), files.segments.end(),
                                   [&](const SegmentInfo& s) { return h5::Source(s.path).has("/" + a.name); });
  if (!present && total > 0) return;
  h5::Dataset to = out.series(group + "/" + a.name, a.type, a.item, total, false, a.unit, Packing::deflated);
  const std::size_t block = std::clamp<std::size_t>(
      std::bit_floor(copy_bytes / std::max<std::size_t>(1, a.bytes())), 1, segment_items);  // whole chunks
  std::vector<std::byte> buffer;
  for (const SegmentInfo& s : files.segments) {
    const h5::Source source(s.path);
    if (!source.has("/" + a.name)) continue;
    const h5::Dataset from = source.dataset("/" + a.name);
    Shape expected{s.count};
    expected.insert(expected.end(), a.item.begin(), a.item.end());
    from.expect(expected);
    for (std::size_t k = 0; k < s.count; k += block) {
      const std::size_t count = std::min(block, s.count - k);
      buffer.resize(count * a.bytes());
      from.read(a.type, k, count, buffer.data());
      for (std::size_t j = 0; change && j < count; ++j) change(s.first + k + j, buffer.data() + j * a.bytes());
      out.write_items(to, a.type, s.first + k, count, buffer.data());
    }
  }
}

void pack_frames(h5::OutputFile& out, const std::vector<Frame>& frames, const Units& units) {
  std::vector<std::string> names;
  std::vector<double> times;
  std::vector<std::uint8_t> flags;
  for (const Frame& f : frames) {
    names.push_back(f.name);
    times.push_back(f.time);
    flags.push_back(f.flag);
  }
  out.group("/frames");
  out.write_texts("/frames/name", names);
  out.write("/frames/time", times, units.time);
  out.write("/frames/flag", flags, "");
}

void pack_camera_motion(h5::OutputFile& out, const CameraMotion& motion) {
  const std::size_t frames = motion.at.size();
  std::vector<double> turn, scale, residual;
  std::vector<Vec2> shift;
  std::vector<std::array<std::int32_t, 2>> points;
  std::vector<std::array<double, 2>> variance;
  for (const CameraPlace& p : motion.at) {
    shift.push_back(p.shift);
    turn.push_back(p.turn);
    scale.push_back(p.scale);
    residual.push_back(p.residual);
    points.push_back({p.points, p.agree});
    variance.push_back({p.var_shift, p.var_turn});
  }
  out.attribute("/frames", "camera_centre", motion.centre.data(), {2});
  out.write("/frames/camera_shift", Type::f64, {frames, 2}, shift.data(), "px", Packing::plain);
  out.write("/frames/camera_turn", turn, "rad");
  out.write("/frames/camera_scale", scale, "1");
  out.write("/frames/camera_residual", residual, "px");
  out.write("/frames/camera_points", Type::i32, {frames, 2}, points.data(), "", Packing::plain);
  out.write("/frames/camera_variance", Type::f64, {frames, 2}, variance.data(), "px^2, rad^2", Packing::plain);
}

void pack_reactions(h5::OutputFile& out, const Reactions& reactions, const Units& units) {
  if (reactions.series.empty()) return;
  out.group("/reactions");
  out.write("/reactions/time", reactions.time, units.time);
  const auto pairs = [&](const std::string& path, const std::vector<Vec2>& values, const std::string& unit) {
    out.write(path, h5::Type::f64, {values.size(), 2}, values.data(), unit, h5::Packing::plain);
  };
  for (const ReactionSeries& s : reactions.series) {
    std::string name = s.name;
    for (char& c : name)
      if (c == '/' || static_cast<unsigned char>(c) < 32 || c == 127) c = '_';  // HDF5's own separator, and what does not print
    while (out.source().has("/reactions/" + name)) name += '_';
    const std::string group = "/reactions/" + name;
    out.group(group);
    pairs(group + "/force", s.force, units.force());
    out.write(group + "/moment", s.moment, units.moment());
    if (s.displacement.empty()) continue;
    pairs(group + "/displacement", s.displacement, units.length);
    out.write(group + "/turn", s.turn, "rad");
  }
}

void pack_energy(h5::OutputFile& out, const std::vector<const StageFiles*>& motions, const Units& units) {
  for (const StageFiles* files : motions) {
    SegmentRows all;
    for (const SegmentInfo& s : files->segments) read_rows(h5::Source(s.path), all);
    read_rows(h5::Source(files->end), all);
    pack_reactions(out, reactions_of(all.reaction_names, all.reactions), units);
    const std::vector<EnergyRow>& rows = all.energy;
    if (rows.empty()) continue;
    if (out.source().has("/energy")) throw std::logic_error("record: energies of two motions");
    out.group("/energy");
    out.attribute("/energy", "motion", files->stage.substr(7));
    for (const EnergyColumn& column : energy_table()) {
      std::vector<double> values;
      for (const EnergyRow& row : rows) values.push_back(row.*column.member);
      if (column.optional && std::all_of(values.begin(), values.end(), [](double v) { return v == 0; })) continue;
      const bool own_unit = *column.unit != '\0';
      out.write(std::string("/energy/") + column.name, values,
                own_unit ? units.of_thickness(column.unit) : column.member == &EnergyRow::time ? units.time : units.energy());
    }
  }
}

void pack_comparison(h5::OutputFile& out, const Comparison& c, const Units& units) {
  out.group("/compare");
  out.attribute("/compare", "measured", c.names[std::size_t(DataSetRole::first)]);
  out.attribute("/compare", "simulated", c.names[std::size_t(DataSetRole::second)]);
  for (const Metric& m : c.metrics) {
    const std::string group = "/compare/" + m.name;
    out.group(group);
    out.attribute(group, "value", m.value);
    out.attribute(group, "unit", m.unit);
    out.attribute(group, "uncertainty", m.uncertainty);
    out.attribute(group, "definition", m.definition);
    out.attribute(group, "verdict", std::string(name_of(m.verdict)));
    if (m.limit != LimitFate::none) out.attribute(group, "limit", std::string(name_of(m.limit)));
    if (m.lost_in != LostIn::nothing) out.attribute(group, "lost_in", std::string(name_of(m.lost_in)));
    if (std::isfinite(m.numerical)) out.attribute(group, "u_num", m.numerical);
    if (std::isfinite(m.input)) out.attribute(group, "u_input", m.input);
    if (std::isfinite(m.factor)) {
      out.attribute(group, "factor", m.factor);
      out.attribute(group, "within_95", m.within());
      out.attribute(group, "seen_95", m.seen());
    }
  }
  if (!c.tables.empty()) out.group("/compare/tables");
  for (const ComparisonTable& t : c.tables) {
    const std::string group = "/compare/tables/" + t.name;
    out.group(group);
    out.attribute(group, "definition", t.definition);
    for (const ComparisonTable::Column& column : t.columns) {
      out.write(group + "/" + column.name, column.values, column.unit);
      if (!column.definition.empty()) out.attribute(group + "/" + column.name, "definition", column.definition);
    }
  }
  if (c.fields.empty()) return;
  out.group("/compare/fields");
  for (const ComparisonField& f : c.fields) {
    const std::string group = "/compare/fields/" + f.name;
    out.group(group);
    out.attribute(group, "definition", f.definition);
    out.write(group + "/time", f.time, units.time);
    out.write(group + "/id", f.id, "");
    out.write(group + "/value", Type::f32, {f.time.size(), f.id.size()}, f.values.data(), f.unit, Packing::deflated);
  }
}

// The statuses of vectors, those in front of no material made `outside`.
void pack_status(h5::OutputFile& out, const ItemArray& status, const StageFiles& files, const MotionSource& material,
                 const std::vector<Frame>& frames, const Grid& grid) {
  const auto pairs = out.source().dataset("/piv/pair").all<std::int32_t>();
  pack_array(out, "/piv", status, files, [&](std::size_t k, std::byte* item) {
    const auto first = std::size_t(pairs[2 * k]);
    if (first >= frames.size()) return;
    const std::vector<std::uint8_t> covered = covered_nodes(material, frames[first].time, grid);
    for (std::size_t n = 0; n < covered.size(); ++n)
      if (!covered[n] && VectorStatus(item[n]) != VectorStatus::masked) item[n] = std::byte(VectorStatus::outside);
  });
}

// Attributes alone: what a run took is no result, and two runs of a case hold the same datasets.
void pack_cost(h5::OutputFile& out, const RunCost& cost) {
  const auto number = [&](const std::string& group, const char* name, double value) {
    if (std::isfinite(value)) out.attribute(group, name, value);
  };
  out.group("/cost");
  out.attribute("/cost", "machine", cost.machine);
  number("/cost", "memory_before", cost.before_bytes);
  number("/cost", "expected_memory", cost.expected_bytes);
  for (const StageCost& stage : cost.stages) {
    const std::string group = "/cost/" + stage.name;
    if (out.source().has(group)) throw std::logic_error("record: two costs of " + stage.name);
    out.group(group);
    number(group, "wall_time", stage.wall_s);
    number(group, "processor_time", stage.processor_s);
    number(group, "peak_memory", stage.peak_bytes);
    number(group, "expected_time", stage.expected_s);
  }
}

// Fields of output.fields, frame by frame. A field whose source this motion lacks is left out.
void pack_fields(h5::OutputFile& out, const MotionSource& motion, const std::vector<std::string>& names, bool central,
                 const Units& units) {
  const std::size_t frames = motion.times().size(), particles = motion.particles().size();
  if (frames == 0) return;
  const MotionFrame first = motion.frame(0);
  const std::string group = "/motion/" + motion.name() + "/fields";
  std::vector<std::pair<std::string, h5::Dataset>> fields;
  for (const std::string& name : names) {
    const DerivedField field = derived_field(name);
    if (!field.source.empty() && !first.find(field.source)) continue;
    if (fields.empty()) out.group(group);
    const std::string path = group + "/" + name;
    if (out.source().has(path)) continue;  // named twice
    fields.emplace_back(
        name, out.series(path, Type::f32, {particles}, frames, false, units.of(field.unit), Packing::deflated));
    out.attribute(path, "definition", field.definition);
  }
  if (fields.empty()) return;
  DerivedReader reader(motion, central);
  std::vector<float> values(particles);
  for (std::size_t k = 0; k < frames; ++k)
    for (auto& [name, dataset] : fields) {
      const std::vector<double> exact = reader.values(name, k);
      std::transform(exact.begin(), exact.end(), values.begin(), [](double v) { return static_cast<float>(v); });
      out.write_items(dataset, Type::f32, k, 1, values.data());
    }
}

void pack_strain_note(h5::OutputFile& out, const std::string& motion, const StrainNote& note) {
  const std::string group = "/motion/" + motion;
  out.attribute(group, "gauge_length", note.gauge_length);
  out.attribute(group, "strain_floor_source", std::string(name_of(note.floor_source)));
  if (!std::isfinite(note.floor_dev)) return;
  out.attribute(group, "strain_floor_dev", note.floor_dev);
  out.attribute(group, "strain_floor_vol", note.floor_vol);
  out.attribute(group, "strain_floor_path", note.floor_path);
}

// Attributes: what a run that was taken up again did not see it does not say, and its data are the same.
void pack_remarks(h5::OutputFile& out, const std::vector<Remark>& remarks) {
  constexpr std::size_t most = 60000;  // HDF5 holds 64 KiB
  out.group("/remarks");
  for (const RemarkWeight weight : remark_weights) {
    std::string lines;
    for (Remark remark : remarks) {
      std::replace(remark.text.begin(), remark.text.end(), '\n', ' ');
      if (remark.weight == weight && lines.size() + remark.text.size() < most) lines += remark.text + "\n";
    }
    if (!lines.empty()) out.attribute("/remarks", name_of(weight), lines);
  }
}

void pack_closure(h5::OutputFile& out, const ClosureNote& note, const Grid& grid, const Units& units) {
  out.attribute("/piv", "closure", note.verdict);
  if (note.threshold > 0) {
    out.attribute("/piv", "closure_strength", note.strength);
    out.attribute("/piv", "closure_threshold", note.threshold);
  }
  if (!note.chains.empty())
    out.write("/piv/closure_chain", Type::i32, {note.chains.size(), 2}, note.chains.data(), "", Packing::plain);
  if (!note.repeated.empty())
    out.write("/piv/repeated_cov", Type::f32, {std::size_t(grid.ny), std::size_t(grid.nx), 3}, note.repeated.data(),
              units.length2(), Packing::deflated);
}

// What was damaged since it was closed must not enter the record.
void check_seals(const StageFiles& files) {
  std::vector<std::filesystem::path> paths;
  for (const SegmentInfo& segment : files.segments) paths.push_back(segment.path);
  for (const std::filesystem::path& path : {files.particles, files.end})
    if (!path.empty()) paths.push_back(path);
  for (const std::filesystem::path& path : paths)
    if (seal_of(path) != Seal::intact)
      throw RunError(path.string() + ": was damaged after it was written; --resume computes it again");
}

// The anchor of the measurement decides how increments are summed; without one, central.
bool central_anchor(const h5::Source& record) {
  if (!record.has("/piv/anchor")) return true;
  const auto anchors = record.dataset("/piv/anchor").all<std::uint8_t>();
  return anchors.empty() || static_cast<Anchor>(anchors[0]) == Anchor::central;
}

}  // namespace

// Reading back what we wrote ourselves is no matter of input.
void RecordWriter::Impl::guarded(h5::OutputFile& out, const std::function<void()>& work) const {
  try {
    work();
  } catch (const InputError& error) {
    out.verify();
    throw RunError(error.what());
  }
}

void RecordWriter::Impl::pack() {
  if (packed) return;
  for (const auto& [name, stage] : stages) check_seals(stage.files);
  auto out = std::make_unique<h5::OutputFile>(directory / "record.h5", threads);
  guarded(*out, [&] { pack_into(*out); });
  packed = std::move(out);
}

void RecordWriter::Impl::commit_packed() {
  guarded(*packed, [&] {
    if (closure && stages.contains("piv")) pack_closure(*packed, *closure, head.grid, units);
    for (const auto& [motion, note] : strain_notes) pack_strain_note(*packed, motion, note);
    if (comparison) pack_comparison(*packed, *comparison, units);
    if (cost) pack_cost(*packed, *cost);
    pack_remarks(*packed, remarks);
    pack_views(*packed, head.grid, units);
  });
  packed->commit();
  packed.reset();
}

void RecordWriter::Impl::pack_into(h5::OutputFile& out) const {
  write_head(out, head, created);
  if (!frames.empty()) pack_frames(out, frames, units);
  if (!camera_motion.empty() && camera_motion.at.size() == frames.size()) pack_camera_motion(out, camera_motion);
  if (const auto piv = stages.find("piv"); piv != stages.end()) {
    out.group("/piv");
    for (const ItemArray& a : pair_arrays(head.grid, units, nullptr))
      if (a.name != "status" || material.empty()) pack_array(out, "/piv", a, piv->second.files);
  }
  const std::vector<const Stage*> moved = motions();
  if (!moved.empty()) out.group("/motion");
  const bool central = central_anchor(out.source());
  for (const Stage* stage : moved) {
    const std::string group = "/" + stage->files.stage, name = stage->files.stage.substr(7);
    out.group(group);
    write_particles(out, group, read_particles(h5::Source(stage->files.end), ""), units);
    for (const ItemArray& a : frame_arrays(stage->particles, units, nullptr)) pack_array(out, group, a, stage->files);
    if (!output_fields.empty() && stage->items() > 0)
      pack_fields(out, *open_motion(out.source(), name, units, nullptr), output_fields, central, units);
  }
  if (const auto piv = stages.find("piv"); piv != stages.end() && !material.empty())
    for (const ItemArray& a : pair_arrays(head.grid, units, nullptr))
      if (a.name == "status")
        pack_status(out, a, piv->second.files, *open_motion(out.source(), material, units, nullptr), frames, head.grid);
  std::vector<const StageFiles*> files;
  for (const Stage* stage : moved) files.push_back(&stage->files);
  pack_energy(out, files, units);
}

}  // namespace pivnp::io
