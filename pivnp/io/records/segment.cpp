#include "pivnp/io/records/segment.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <system_error>

#include "pivnp/core/error.hpp"
#include "pivnp/core/printable.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/files/seal.hpp"
#include "pivnp/io/hdf5/probe.hpp"

namespace pivnp::io {

namespace {

std::string segment_file_name(const std::string& stage, std::size_t first) {
  char digits[32];
  std::snprintf(digits, sizeof digits, ".%08zu.h5", first);
  return stage_file_name(stage) + digits;
}

// Drops the segments from `from` on, the last first: what remains is without a gap at every moment.
void remove_from(StageFiles& stage, std::size_t from) {
  while (stage.segments.size() > from) {
    std::filesystem::remove(stage.segments.back().path);
    stage.segments.pop_back();
  }
}

// Cuts a stage back to what a resumed engine can go on from.
void cut_back(StageFiles& stage) {
  std::sort(stage.segments.begin(), stage.segments.end(),
            [](const SegmentInfo& a, const SegmentInfo& b) { return a.first < b.first; });
  std::size_t good = 0, next = 0;
  if (stage.stage.starts_with("motion/") && stage.particles.empty()) {  // damaged: nothing to go on from
    std::filesystem::remove(stage.end);
    stage.end.clear();
    return remove_from(stage, 0);
  }
  while (good < stage.segments.size() && stage.segments[good].first == next) next += stage.segments[good++].count;
  if (!stage.end.empty()) {
    const bool whole = good == stage.segments.size() &&
                       h5::Source(stage.end).attribute_number("/", "items") == static_cast<double>(next);
    if (whole) return;
    std::filesystem::remove(stage.end);
    stage.end.clear();
  }
  while (good > 0 && !stage.segments[good - 1].has_checkpoint) --good;
  remove_from(stage, good);
}

}  // namespace

std::string stage_file_name(const std::string& stage) {
  std::string name = stage;
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

OpenSegment::OpenSegment(const std::filesystem::path& parts, const std::string& stage, std::size_t first)
    : path_(parts / segment_file_name(stage, first)), stage_(stage), first_(first),
      file_(std::make_unique<h5::OutputFile>(path_)) {}

void OpenSegment::add(const std::vector<ItemArray>& arrays) {
  for (const ItemArray& a : arrays) {
    if (!a.data) continue;
    auto it = std::find_if(series_.begin(), series_.end(), [&](const Series& s) { return s.name == a.name; });
    if (it == series_.end()) {
      series_.push_back({a.name, file_->series("/" + a.name, a.type, a.item, 0, true, a.unit, h5::Packing::plain)});
      it = std::prev(series_.end());
    }
    file_->extend(it->dataset, count_ + 1);
    file_->write_items(it->dataset, a.type, count_, 1, a.data);
    bytes_ += a.bytes();
  }
  ++count_;
}

std::filesystem::path OpenSegment::close(const SegmentRows& rows, const std::vector<std::byte>* checkpoint) {
  for (Series& s : series_)
    if (s.dataset.shape()[0] < count_) file_->extend(s.dataset, count_);
  file_->attribute("/", "schema", schema_name);
  file_->attribute("/", "schema_version", schema_version);
  file_->attribute("/", "stage", stage_);
  file_->attribute("/", "first", std::vector<std::int64_t>{static_cast<std::int64_t>(first_)}, true);
  file_->attribute("/", "count", std::vector<std::int64_t>{static_cast<std::int64_t>(count_)}, true);
  write_rows(*file_, rows);
  if (checkpoint) file_->write("/checkpoint", *checkpoint, "", h5::Packing::plain);
  series_.clear();
  file_->commit();
  return path_;
}

std::vector<StageFiles> scan_parts(const std::filesystem::path& parts) {
  std::map<std::string, StageFiles> stages;
  std::vector<std::filesystem::path> unusable, closed;
  for (const auto& entry : std::filesystem::directory_iterator(parts)) {
    const std::filesystem::path& path = entry.path();
    if (path.extension() == ".tmp") unusable.push_back(path);
    if (path.extension() != ".h5" || path.filename() == "head.h5") continue;
    (seal_of(path) == Seal::intact ? closed : unusable).push_back(path);  // damaged: as if it had never been closed
  }
  // A folder to resume may come from anyone. All at once; one by one where one of them is to be found out.
  bool known = true;
  try {
    probe_files(closed);
  } catch (const InputError&) {
    known = false;
  }
  for (const std::filesystem::path& path : closed) {
    try {
      if (!known) probe_file(path);
      const h5::Source source(path);
      const std::string stage = source.attribute_text("/", "stage");
      StageFiles& files = stages[stage];
      files.stage = stage;
      const std::string part = path.stem().extension();  // ".00000064", ".particles", ".end"
      if (part == ".particles") files.particles = path;
      else if (part == ".end") files.end = path;
      else
        files.segments.push_back({path, static_cast<std::size_t>(source.attribute_number("/", "first")),
                                  static_cast<std::size_t>(source.attribute_number("/", "count")),
                                  source.has("/checkpoint")});
    } catch (const InputError&) {
      unusable.push_back(path);
    }
  }
  for (const auto& path : unusable) std::filesystem::remove(path);
  std::vector<StageFiles> out;
  for (auto& [name, files] : stages) {
    cut_back(files);
    out.push_back(std::move(files));
  }
  return out;
}

void write_rows(h5::OutputFile& file, const SegmentRows& rows) {
  const auto write = [&](const char* name, std::size_t count, const std::vector<double>& table) {
    if (count > 0) file.write(name, h5::Type::f64, {count, table.size() / count}, table.data(), "", h5::Packing::plain);
  };
  std::vector<double> energy, reactions;
  for (const EnergyRow& row : rows.energy)
    for (const EnergyColumn& column : energy_table()) energy.push_back(row.*column.member);
  write("/energy", rows.energy.size(), energy);
  for (const ReactionRow& row : rows.reactions) {
    reactions.insert(reactions.end(), {row.time, row.stepped});
    for (const ReactionRow::Of& r : row.of)
      reactions.insert(reactions.end(), {r.impulse.x(), r.impulse.y(), r.moment, r.displacement.x(), r.displacement.y(), r.turn});
  }
  write("/reactions", rows.reactions.size(), reactions);
  if (!rows.reactions.empty()) file.write_texts("/reaction_names", rows.reaction_names);
}

void read_rows(const h5::Source& source, SegmentRows& rows) {
  if (source.has("/energy")) {
    const std::vector<double> table = source.dataset("/energy").all<double>();
    const std::size_t columns = energy_table().size();
    for (std::size_t at = 0; at + columns <= table.size(); at += columns) {
      rows.energy.emplace_back();
      for (std::size_t c = 0; c < columns; ++c) rows.energy.back().*energy_table()[c].member = table[at + c];
    }
  }
  if (source.has("/reactions")) {
    std::vector<std::string> names = source.texts("/reaction_names");
    if (!rows.reactions.empty() && names != rows.reaction_names)
      throw InputError(source.name() + ": /reaction_names: not those of the segment before");
    rows.reaction_names = std::move(names);
    const std::vector<double> table = source.dataset("/reactions").all<double>();
    const std::size_t columns = 2 + 6 * rows.reaction_names.size();
    for (std::size_t at = 0; at + columns <= table.size(); at += columns) {
      rows.reactions.push_back({.time = table[at], .stepped = table[at + 1], .of = {}});
      for (std::size_t c = at + 2; c < at + columns; c += 6)
        rows.reactions.back().of.push_back({{table[c], table[c + 1]}, table[c + 2], {table[c + 3], table[c + 4]}, table[c + 5]});
    }
  }
}

void write_particles(h5::OutputFile& file, const std::string& group, const ParticleSet& p, const Units& units) {
  const std::size_t n = p.size();
  if (p.label.size() != n || p.x0.size() != n || p.area.size() != n || p.born.size() != n || p.end.size() != n ||
      p.end_reason.size() != n)
    throw std::logic_error("particles: arrays of different length");
  const auto write = [&](const char* name, h5::Type type, const h5::Shape& shape, const void* data,
                         const std::string& unit) {
    file.write(group + "/" + name, type, shape, data, unit, h5::Packing::deflated);
  };
  static_assert(sizeof(Vec2) == 2 * sizeof(double));
  write("id", h5::Type::i64, {n}, p.id.data(), "");
  write("label", h5::Type::i32, {n}, p.label.data(), "");
  file.write_texts(group + "/label_name", p.label_names);
  write("x0", h5::Type::f64, {n, 2}, p.x0.data(), units.length);
  const std::vector<float> area(p.area.begin(), p.area.end());
  write("area", h5::Type::f32, {n}, area.data(), units.length2());
  write("born", h5::Type::f64, {n}, p.born.data(), units.time);
  write("end", h5::Type::f64, {n}, p.end.data(), units.time);
  write("end_reason", h5::Type::u8, {n}, p.end_reason.data(), "");
}

ParticleSet read_particles(const h5::Source& source, const std::string& group) {
  ParticleSet p;
  const h5::Dataset ids = source.dataset(group + "/id");
  p.id = ids.all<std::int64_t>();
  const hsize_t n = p.id.size();
  const auto open = [&](const char* name, const h5::Shape& shape) {
    h5::Dataset d = source.dataset(group + "/" + name);
    d.expect(shape);
    return d;
  };
  p.label = open("label", {n}).all<std::int32_t>();
  p.label_names = source.texts(group + "/label_name");
  for (const std::string& name : p.label_names)
    if (!prints(name)) throw InputError(source.name() + ": " + group + "/label_name: holds '" + shown(name) + "', expected a name that prints");
  p.x0.resize(n);
  open("x0", {n, 2}).read(h5::Type::f64, 0, n, p.x0.data());
  const std::vector<float> area = open("area", {n}).all<float>();
  p.area.assign(area.begin(), area.end());
  p.born = open("born", {n}).all<double>();
  p.end = open("end", {n}).all<double>();
  p.end_reason.resize(n);
  open("end_reason", {n}).read(h5::Type::u8, 0, n, p.end_reason.data());
  return p;
}

VectorField read_pair(const h5::Source& source, const std::string& group, const Grid& grid, std::size_t index) {
  VectorField f;
  f.grid = grid;
  std::vector<h5::Dataset> datasets;  // of the right shapes, before there is room for what they hold
  const bool factors = source.has(group + "/path_factor");
  for (const ItemArray& a : pair_arrays(grid, Units{}, nullptr)) {
    if (a.optional && !factors) continue;
    h5::Dataset d = source.dataset(group + "/" + a.name);
    h5::Shape expected{d.shape().empty() ? 0 : d.shape()[0]};
    expected.insert(expected.end(), a.item.begin(), a.item.end());
    d.expect(expected);
    datasets.push_back(std::move(d));
  }
  const std::size_t nodes = grid.node_count();
  f.displacement.resize(nodes);
  f.status.resize(nodes);
  f.cov.resize(nodes);
  f.score.resize(nodes);
  if (factors) f.path_factor.resize(nodes);
  const std::vector<ItemArray> arrays = pair_arrays(grid, Units{}, &f);
  for (std::size_t k = 0; k < datasets.size(); ++k)
    datasets[k].read(arrays[k].type, index, 1, const_cast<void*>(arrays[k].data));  // `f`'s own
  // A pair without one among others that have it.
  if (std::all_of(f.path_factor.begin(), f.path_factor.end(), [](float v) { return !(std::abs(v) > 0); })) f.path_factor.clear();
  if (f.anchor != Anchor::forward && f.anchor != Anchor::central)
    throw InputError(source.name() + ": " + group + "/anchor: pair " + std::to_string(index) + " has anchor " +
                     std::to_string(int(f.anchor)) + ", expected 0 or 1");
  // What a later version calls a vector is not known to be of use.
  for (VectorStatus& status : f.status)
    if (status > VectorStatus::outside) status = VectorStatus::rejected;
  return f;
}

}  // namespace pivnp::io
