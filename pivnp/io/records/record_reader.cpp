#include <algorithm>
#include <array>
#include <charconv>

#include "pivnp/core/error.hpp"
#include "pivnp/core/printable.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/files/seal.hpp"
#include "pivnp/io/hdf5/probe.hpp"
#include "pivnp/io/records/motion_file.hpp"
#include "pivnp/io/records/record_impl.hpp"

namespace pivnp::io {

namespace {

// The file to open, if nothing shows that it was damaged and it is no danger to read.
const std::filesystem::path& checked(const std::filesystem::path& file, Trust trust) {
  if (trust == Trust::known || !std::filesystem::is_regular_file(file)) return file;
  if (seal_of(file) == Seal::broken)
    throw InputError(file.string() +
                     ": damaged: its content is not the one its checksum was made of; expected the file as it was "
                     "written (a copy of it, or the run again)");
  probe_file(file);
  return file;
}

void check_version(const h5::Source& source) {
  const std::string& file = source.name();
  if (!source.has_attribute("/", "schema"))
    throw InputError(file + ": an HDF5 file without the attribute 'schema', expected a record of pivnp");
  const std::string schema = source.attribute_text("/", "schema");
  if (schema != schema_name) throw InputError(file + ": schema '" + shown(schema) + "', expected '" + schema_name + "'");
  const std::string version = source.attribute_text("/", "schema_version");
  int major = 0;
  const auto [end, error] = std::from_chars(version.data(), version.data() + version.size(), major);
  const bool whole = error == std::errc() && (end == version.data() + version.size() || *end == '.');
  if (!whole || major < 1 || major > schema_major)
    throw InputError(file + ": schema version '" + shown(version) + "', expected " + std::to_string(schema_major) +
                     ".x (a newer program wrote it)");
  if (source.has_attribute("/", "stage"))
    throw InputError(file + ": a segment of a run at work, expected a finished record (record.h5)");
}

std::vector<Frame> read_frames(const h5::Source& source) {
  std::vector<Frame> frames;
  if (!source.has("/frames")) return frames;
  const std::vector<std::string> names = source.texts("/frames/name");
  const h5::Dataset time = source.dataset("/frames/time"), flag = source.dataset("/frames/flag");
  time.expect({names.size()});
  flag.expect({names.size()});
  const std::vector<double> times = time.all<double>();
  const std::vector<std::uint8_t> flags = flag.all<std::uint8_t>();
  for (std::size_t k = 0; k < names.size(); ++k) frames.push_back({printable(names[k]), times[k], flags[k]});
  return frames;
}

// Whatever the file says, pairs are of frames that it holds (where it holds any).
std::size_t read_pairs(const h5::Source& source, std::size_t frames) {
  if (!source.has("/piv")) return 0;
  const h5::Dataset pair = source.dataset("/piv/pair");
  const std::size_t pairs = pair.shape().empty() ? 0 : pair.shape()[0];
  pair.expect({pairs, 2});
  const std::vector<std::int32_t> indices = pair.all<std::int32_t>();
  for (std::size_t k = 0; k < indices.size(); ++k)
    if (indices[k] < 0 || (frames > 0 && std::size_t(indices[k]) >= frames))
      throw InputError(pair.label() + ": pair " + std::to_string(k / 2) + " is of frame " + std::to_string(indices[k]) +
                       ", expected one of " + std::to_string(frames));
  return pairs;
}

}  // namespace

struct RecordReader::Impl {
  Impl(const std::filesystem::path& file, Trust trust) : source(checked(file, trust)) {
    check_version(source);
    head = read_head(source);
    units = {head.length_unit, head.time_unit, head.per_radian};
    frames = read_frames(source);
    motions = source.children("/motion");
    pairs = read_pairs(source, frames.size());
  }

  h5::Source source;
  RecordHead head;
  Units units;
  std::vector<Frame> frames;
  std::vector<std::string> motions;
  std::size_t pairs = 0;
};

RecordReader::RecordReader(const std::filesystem::path& file, Trust trust)
    : impl_(std::make_shared<Impl>(file, trust)) {}
RecordReader::~RecordReader() = default;

const RecordHead& RecordReader::head() const { return impl_->head; }
const std::vector<Frame>& RecordReader::frames() const { return impl_->frames; }
std::string RecordReader::schema_version() const { return impl_->source.attribute_text("/", "schema_version"); }
BuildInfo RecordReader::written_by() const { return read_written_by(impl_->source); }
CameraMotion RecordReader::camera_motion() const {
  const h5::Source& source = impl_->source;
  CameraMotion motion;
  if (!source.has("/frames/camera_shift")) return motion;
  const std::size_t frames = impl_->frames.size();
  const std::vector<double> centre = source.attribute_numbers("/frames", "camera_centre");
  if (centre.size() != 2) throw InputError(source.name() + ": /frames: attribute 'camera_centre' has " + std::to_string(centre.size()) + " numbers, expected 2");
  motion.centre = {centre[0], centre[1]};
  motion.at.resize(frames);
  const auto column = [&](const char* name, const auto& put) {
    const h5::Dataset set = source.dataset(name);
    set.expect({frames});
    const std::vector<double> values = set.all<double>();
    for (std::size_t k = 0; k < frames; ++k) put(motion.at[k], values[k]);
  };
  const auto pairs = [&](const char* name, h5::Type type, auto& values) {
    const h5::Dataset set = source.dataset(name);
    set.expect({frames, 2});
    values.resize(frames);
    set.read(type, 0, frames, values.data());
  };
  std::vector<std::array<double, 2>> shift, variance;
  std::vector<std::array<std::int32_t, 2>> points;
  pairs("/frames/camera_shift", h5::Type::f64, shift);
  pairs("/frames/camera_variance", h5::Type::f64, variance);
  pairs("/frames/camera_points", h5::Type::i32, points);
  column("/frames/camera_turn", [](CameraPlace& p, double v) { p.turn = v; });
  column("/frames/camera_scale", [](CameraPlace& p, double v) { p.scale = v; });
  column("/frames/camera_residual", [](CameraPlace& p, double v) { p.residual = v; });
  for (std::size_t k = 0; k < frames; ++k) {
    CameraPlace& p = motion.at[k];
    p.shift = {shift[k][0], shift[k][1]};
    p.var_shift = variance[k][0], p.var_turn = variance[k][1];
    p.points = points[k][0], p.agree = points[k][1];
    if (!p.shift.allFinite() || !std::isfinite(p.turn) || !(p.scale > 0))
      throw InputError(source.name() + ": /frames/camera_shift: frame " + std::to_string(k) + " has no finite place of the camera");
  }
  return motion;
}

std::size_t RecordReader::pair_count() const { return impl_->pairs; }
std::vector<std::string> RecordReader::motion_names() const { return impl_->motions; }

VectorField RecordReader::pair(std::size_t index) const {
  return read_pair(impl_->source, "/piv", impl_->head.grid, index);
}

std::optional<ClosureNote> RecordReader::closure() const {
  const h5::Source& source = impl_->source;
  if (!source.has("/piv") || !source.has_attribute("/piv", "closure")) return std::nullopt;
  ClosureNote note;
  note.verdict = source.attribute_text("/piv", "closure");
  if (source.has_attribute("/piv", "closure_strength")) {
    note.strength = source.attribute_number("/piv", "closure_strength");
    note.threshold = source.attribute_number("/piv", "closure_threshold");
  }
  if (source.has("/piv/closure_chain")) {
    const h5::Dataset chains = source.dataset("/piv/closure_chain");
    const std::size_t count = chains.shape().empty() ? 0 : chains.shape()[0];
    chains.expect({count, 2});
    note.chains.resize(count);
    chains.read(h5::Type::i32, 0, count, note.chains.data());
  }
  if (source.has("/piv/repeated_cov")) {
    const Grid& grid = impl_->head.grid;
    const h5::Dataset repeated = source.dataset("/piv/repeated_cov");
    repeated.expect({std::size_t(grid.ny), std::size_t(grid.nx), 3});
    note.repeated.resize(grid.node_count());
    repeated.read(h5::Type::f32, 0, std::size_t(grid.ny), note.repeated.data());
  }
  return note;
}

std::vector<Remark> RecordReader::remarks() const {
  const h5::Source& source = impl_->source;
  std::vector<Remark> out;
  if (!source.has("/remarks")) return out;
  for (const RemarkWeight weight : remark_weights) {
    if (!source.has_attribute("/remarks", name_of(weight))) continue;
    const std::string lines = source.attribute_text("/remarks", name_of(weight), true);
    for (std::size_t begin = 0; begin < lines.size();) {
      const std::size_t end = std::min(lines.find('\n', begin), lines.size());
      out.push_back({lines.substr(begin, end - begin), weight, {}});
      begin = end + 1;
    }
  }
  return out;
}

std::optional<StrainNote> RecordReader::strain_note(const std::string& motion) const {
  const std::string group = "/motion/" + motion;
  const h5::Source& source = impl_->source;
  if (!source.has(group) || !source.has_attribute(group, "gauge_length")) return std::nullopt;
  StrainNote note;
  note.gauge_length = source.attribute_number(group, "gauge_length");
  note.floor_source =
      value_named<StrainFloor>(source.attribute_text(group, "strain_floor_source")).value_or(StrainFloor::not_measured);
  if (!source.has_attribute(group, "strain_floor_dev")) return note;
  note.floor_dev = source.attribute_number(group, "strain_floor_dev");
  note.floor_vol = source.attribute_number(group, "strain_floor_vol");
  note.floor_path = source.attribute_number(group, "strain_floor_path");
  return note;
}

std::unique_ptr<MotionSource> RecordReader::motion(const std::string& name) const {
  bool known = false;
  for (const std::string& m : impl_->motions) known = known || m == name;
  if (!known)
    throw InputError(impl_->source.name() + ": no motion '" + name + "'" +
                     (impl_->motions.empty() ? "; it holds none" : did_you_mean(name, impl_->motions)));
  return open_motion(impl_->source, name, impl_->units, impl_);
}

std::vector<EnergyRow> RecordReader::energy() const {
  std::vector<EnergyRow> rows;
  if (!impl_->source.has("/energy")) return rows;
  const h5::Dataset time = impl_->source.dataset("/energy/time");
  rows.resize(h5::product(time.shape()));
  time.expect({rows.size()});
  for (const EnergyColumn& column : energy_table()) {
    const std::string name = std::string("/energy/") + column.name;
    if (!impl_->source.has(name) && column.since_minor > 0) continue;
    const h5::Dataset d = impl_->source.dataset(name);
    d.expect({rows.size()});
    const std::vector<double> values = d.all<double>();
    for (std::size_t r = 0; r < rows.size(); ++r) rows[r].*column.member = values[r];
  }
  return rows;
}

Reactions RecordReader::reactions() const {
  Reactions out;
  const h5::Source& source = impl_->source;
  if (!source.has("/reactions")) return out;
  const h5::Dataset time = source.dataset("/reactions/time");
  out.time = time.all<double>();
  const std::size_t n = out.time.size();
  time.expect({n});
  const auto numbers = [&](const std::string& path, const h5::Shape& shape) {
    const h5::Dataset d = source.dataset(path);
    d.expect(shape);
    return d.all<double>();
  };
  const auto pairs = [&](const std::string& path) {
    const std::vector<double> values = numbers(path, {n, 2});
    std::vector<Vec2> all;
    for (std::size_t k = 0; k < n; ++k) all.emplace_back(values[2 * k], values[2 * k + 1]);
    return all;
  };
  for (const std::string& name : source.children("/reactions")) {
    if (name == "time") continue;
    const std::string group = "/reactions/" + name;
    ReactionSeries s{.name = name, .force = pairs(group + "/force"), .moment = numbers(group + "/moment", {n}),
                     .displacement = {}, .turn = {}};
    if (source.has(group + "/displacement")) {
      s.displacement = pairs(group + "/displacement");
      s.turn = numbers(group + "/turn", {n});
    }
    out.series.push_back(std::move(s));
  }
  return out;
}

std::optional<Comparison> RecordReader::comparison() const {
  const h5::Source& source = impl_->source;
  if (!source.has("/compare")) return std::nullopt;
  Comparison c;
  c.names = {source.attribute_text("/compare", "measured"), source.attribute_text("/compare", "simulated")};
  for (const std::string& name : source.children("/compare")) {
    if (name == "fields" || name == "tables") continue;
    const std::string group = "/compare/" + name;
    const auto number_or_nan = [&](const char* what) {
      return source.has_attribute(group, what) ? source.attribute_number(group, what) : nan_value;
    };
    c.metrics.push_back({name, source.attribute_number(group, "value"), source.attribute_text(group, "unit"),
                         source.attribute_number(group, "uncertainty"), source.attribute_text(group, "definition"),
                         verdict_named(source.attribute_text(group, "verdict")),
                         number_or_nan("factor")});
    Metric& m = c.metrics.back();
    m.numerical = number_or_nan("u_num");
    m.input = number_or_nan("u_input");
    m.limit = limit_fate_named(
        source.attribute_text(group, source.has_attribute(group, "limit") ? "limit" : "verdict"));
    if (source.has_attribute(group, "lost_in"))
      m.lost_in = value_named<LostIn>(source.attribute_text(group, "lost_in")).value_or(LostIn::nothing);
  }
  if (source.has("/compare/tables"))
    for (const std::string& name : source.children("/compare/tables")) {
      const std::string group = "/compare/tables/" + name;
      ComparisonTable t{name, source.attribute_text(group, "definition"), {}};
      for (const std::string& column : source.children(group)) {
        const std::string place = group + "/" + column;
        t.columns.push_back({column, source.attribute_text(place, "unit"), source.dataset(place).all<double>(),
                             source.has_attribute(place, "definition") ? source.attribute_text(place, "definition") : ""});
      }
      c.tables.push_back(std::move(t));
    }
  for (const std::string& name : source.children("/compare/fields")) {
    const std::string group = "/compare/fields/" + name;
    ComparisonField f{name,
                            source.attribute_text(group + "/value", "unit"),
                            source.attribute_text(group, "definition"),
                            source.dataset(group + "/time").all<double>(),
                            source.dataset(group + "/id").all<std::int64_t>(),
                            {}};
    const h5::Dataset values = source.dataset(group + "/value");
    values.expect({f.time.size(), f.id.size()});
    f.values = values.all<float>();
    c.fields.push_back(std::move(f));
  }
  return c;
}

RunCost RecordReader::cost() const {
  const h5::Source& source = impl_->source;
  RunCost cost;
  if (!source.has("/cost")) return cost;
  const auto number = [&](const std::string& group, const char* name) {
    return source.has_attribute(group, name) ? source.attribute_number(group, name) : nan_value;
  };
  if (source.has_attribute("/cost", "machine")) cost.machine = source.attribute_text("/cost", "machine");
  cost.before_bytes = number("/cost", "memory_before");
  cost.expected_bytes = number("/cost", "expected_memory");
  for (const std::string& name : source.children("/cost")) {
    const std::string group = "/cost/" + name;
    cost.stages.push_back({name, number(group, "wall_time"), number(group, "processor_time"), number(group, "peak_memory"),
                           number(group, "expected_time")});
  }
  return cost;
}

}  // namespace pivnp::io
