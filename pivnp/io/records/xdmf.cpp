#include "pivnp/io/records/xdmf.hpp"

#include <cstdio>
#include <numeric>
#include <sstream>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/fields.hpp"
#include "pivnp/io/records/motion_file.hpp"
#include "pivnp/io/records/record.hpp"
#include "pivnp/io/records/segment.hpp"

namespace pivnp::io {

namespace {

using h5::Shape;
using h5::Type;

std::string item_name(std::size_t index) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%06zu", index);
  return digits;
}

// One dataset an item of the series `from`, below GROUP/NAME.
void view_series(h5::OutputFile& out, const std::string& group, const std::string& name, const std::string& from,
                 Type type, const std::string& unit, bool plane) {
  const h5::Source source = out.source();
  if (!source.has(from) || source.has(group + "/" + name)) return;
  const h5::Dataset series = source.dataset(from);
  out.group(group + "/" + name);
  Shape shape(series.shape().begin() + 1, series.shape().end());
  if (plane) shape.insert(shape.begin(), 1);  // a grid in the plane is one layer of a grid in space
  for (std::size_t k = 0; k < series.shape()[0]; ++k)
    out.view_item(group + "/" + name + "/" + item_name(k), series, from, type, k, shape, unit);
}

void store_positions(h5::OutputFile& out, const std::string& group, const MotionSource& motion) {
  const ParticleSet& particles = motion.particles();
  const std::size_t count = particles.size();
  std::vector<std::int32_t> vertex(count);
  std::iota(vertex.begin(), vertex.end(), 0);
  out.write(group + "/vertex", Type::i32, {count, 1}, vertex.data(), "", h5::Packing::deflated);
  out.group(group + "/position");
  const h5::Dataset displacement = out.source().dataset("/motion/" + motion.name() + "/u");  // alone: the rest of a frame is larger
  std::vector<std::array<float, 2>> u(count);
  std::vector<std::array<float, 3>> position(count);
  for (std::size_t k = 0; k < motion.times().size(); ++k) {
    displacement.read(Type::f32, k, 1, u.data());
    for (std::size_t p = 0; p < count; ++p)
      position[p] = {static_cast<float>(particles.x0[p].x() + double(u[p][0])),
                     static_cast<float>(particles.x0[p].y() + double(u[p][1])), 0.0f};
    out.write(group + "/position/" + item_name(k), Type::f32, {count, 3}, position.data(), motion.length_unit(),
              h5::Packing::deflated);
  }
}

// What a reader looks at first, and its standard uncertainty; but for those that output.fields has stored.
void store_computed(h5::OutputFile& out, const std::string& group, const MotionSource& motion) {
  if (motion.times().empty()) return;
  const MotionFrame first = motion.frame(0);
  const std::string stored = "/motion/" + motion.name() + "/fields/";
  std::vector<DerivedField> fields;
  for (const char* name : {"strain_dev", "strain_vol", "sigma_displacement_magnitude", "sigma_strain_dev"}) {
    const DerivedField field = derived_field(name);
    const bool known = field.source.empty() || particles_with(first, *motion_fields().find(field.source)) > 0;
    if (!known || out.source().has(stored + name)) continue;
    out.group(group + "/" + name);
    fields.push_back(field);
  }
  DerivedReader reader(motion, true);
  for (std::size_t k = 0; k < motion.times().size() && !fields.empty(); ++k)
    for (const DerivedField& field : fields) {
      const std::vector<double> values = reader.values(field.name, k);
      const std::vector<float> single(values.begin(), values.end());
      out.write(group + "/" + field.name + "/" + item_name(k), Type::f32, {single.size()}, single.data(),
                unit_in(field.unit, motion.length_unit(), motion.time_unit()), h5::Packing::deflated);
    }
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') out += "&amp;";
    else if (c == '<') out += "&lt;";
    else if (c == '>') out += "&gt;";
    else if (c == '"') out += "&quot;";
    else out += c;
  }
  return out;
}

std::string exact_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string dimensions(const Shape& shape) {
  std::string out;
  for (const hsize_t n : shape) {
    if (!out.empty()) out += ' ';
    out += std::to_string(n);
  }
  return out;
}

class Xml {
 public:
  explicit Xml(const std::string& heavy) : heavy_(escaped(heavy)) {
    text_ << "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n";
  }
  std::string finish() {
    text_ << "</Domain>\n</Xdmf>\n";
    return text_.str();
  }
  void begin_collection(const std::string& name) {
    text_ << "<Grid Name=\"" << escaped(name) << "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  }
  void begin_grid(const std::string& name, double time) {
    text_ << "<Grid Name=\"" << escaped(name) << "\" GridType=\"Uniform\">\n<Time Value=\"" << exact_number(time) << "\"/>\n";
  }
  void end_grid() { text_ << "</Grid>\n"; }
  void item(const std::string& path, const Shape& shape, const char* type, int bytes) {
    text_ << "<DataItem Dimensions=\"" << dimensions(shape) << "\" NumberType=\"" << type << "\" Precision=\"" << bytes
          << "\" Format=\"HDF\">" << heavy_ << ":" << path << "</DataItem>";
  }
  void attribute(const std::string& name, const std::string& path, const Shape& shape, std::size_t components,
                 const char* type, int bytes) {
    const char* kind = components == 1 ? "Scalar" : components <= 3 ? "Vector" : "Matrix";
    text_ << "<Attribute Name=\"" << escaped(name) << "\" AttributeType=\"" << kind << "\" Center=\"Node\">";
    item(path, shape, type, bytes);
    text_ << "</Attribute>\n";
  }
  std::ostream& raw() { return text_; }

 private:
  std::string heavy_;
  std::ostringstream text_;
};

void describe_motion(Xml& xml, const h5::Source& record, const std::string& name) {
  const std::string view = "/xdmf/motion/" + name, motion = "/motion/" + name;
  const std::vector<double> times = record.dataset(motion + "/time").all<double>();
  const hsize_t count = record.dataset(view + "/vertex").shape()[0];
  xml.begin_collection(name);
  for (std::size_t k = 0; k < times.size(); ++k) {
    xml.begin_grid(name, times[k]);
    xml.raw() << "<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" << count << "\" NodesPerElement=\"1\">";
    xml.item(view + "/vertex", {count, 1}, "Int", 4);
    xml.raw() << "</Topology>\n<Geometry GeometryType=\"XYZ\">";
    xml.item(view + "/position/" + item_name(k), {count, 3}, "Float", 4);
    xml.raw() << "</Geometry>\n";
    xml.attribute("id", motion + "/id", {count}, 1, "Int", 8);
    xml.attribute("label", motion + "/label", {count}, 1, "Int", 4);
    for (const std::string& field : record.children(view)) {
      if (field == "vertex" || field == "position") continue;
      const std::string path = view + "/" + field + "/" + item_name(k);
      const Shape shape = record.dataset(path).shape();
      const bool code = field == "status";
      xml.attribute(field, path, shape, h5::product(shape, 1), code ? "UChar" : "Float", code ? 1 : 4);
    }
    xml.end_grid();
  }
  xml.end_grid();
}

// A vector stands at the time of its pair's second frame, where the particles it moved are shown too.
std::vector<double> pair_times(const h5::Source& record) {
  const std::vector<std::int32_t> pairs = record.dataset("/piv/pair").all<std::int32_t>();
  std::vector<double> frames, out;
  if (record.has("/frames/time")) frames = record.dataset("/frames/time").all<double>();
  for (std::size_t k = 1; k < pairs.size(); k += 2) {
    const auto second = static_cast<std::size_t>(pairs[k]);
    out.push_back(second < frames.size() ? frames[second] : static_cast<double>(second));
  }
  return out;
}

void describe_vectors(Xml& xml, const h5::Source& record, const Grid& grid) {
  const std::vector<double> times = pair_times(record);
  const auto nx = static_cast<hsize_t>(grid.nx), ny = static_cast<hsize_t>(grid.ny);
  xml.begin_collection("piv");
  for (std::size_t k = 0; k < times.size(); ++k) {
    xml.begin_grid("piv", times[k]);
    // Slowest axis first: z y x.
    xml.raw() << "<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"1 " << ny << " " << nx << "\"/>\n"
              << "<Geometry GeometryType=\"ORIGIN_DXDYDZ\">"
              << "<DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">0 "
              << exact_number(grid.origin.y()) << " " << exact_number(grid.origin.x()) << "</DataItem>"
              << "<DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">1 "
              << exact_number(grid.spacing.y()) << " " << exact_number(grid.spacing.x()) << "</DataItem></Geometry>\n";
    const std::string view = "/xdmf/piv/";
    xml.attribute("displacement", view + "displacement/" + item_name(k), {1, ny, nx, 2}, 2, "Float", 4);
    xml.attribute("status", view + "status/" + item_name(k), {1, ny, nx}, 1, "UChar", 1);
    xml.attribute("score", view + "score/" + item_name(k), {1, ny, nx}, 1, "Float", 4);
    xml.end_grid();
  }
  xml.end_grid();
}

}  // namespace

void pack_views(h5::OutputFile& out, const Grid& grid, const Units& units) {
  const h5::Source source = out.source();
  const std::vector<std::string> names = source.children("/motion");
  const bool vectors = source.has("/piv") && grid.node_count() > 0;
  if (names.empty() && !vectors) return;
  out.group("/xdmf");
  if (vectors) {
    out.group("/xdmf/piv");
    for (const ItemArray& a : pair_arrays(grid, units, nullptr))
      if (a.name == "displacement" || a.name == "status" || a.name == "score")
        view_series(out, "/xdmf/piv", a.name, "/piv/" + a.name, a.type, a.unit, true);
  }
  if (!names.empty()) out.group("/xdmf/motion");
  for (const std::string& name : names) {
    const std::string group = "/xdmf/motion/" + name, from = "/motion/" + name + "/";
    out.group(group);
    const auto motion = open_motion(source, name, units, nullptr);
    store_positions(out, group, *motion);
    store_computed(out, group, *motion);
    for (const ItemArray& a : frame_arrays(0, units, nullptr))
      if (const MotionField* field = motion_fields().find(a.name); field && field->shown_as != "")
        view_series(out, group, field->shown_as.value_or(a.name), from + a.name, a.type, a.unit, false);
    for (const std::string& field : source.children(from + "fields")) {
      const std::string path = from + "fields/" + field;
      view_series(out, group, field, path, Type::f32, source.attribute_text(path, "unit"), false);
    }
  }
}

void write_xdmf(const std::filesystem::path& record) {
  const h5::Source source(record);
  const RecordReader reader(record);
  Xml xml(record.filename().string());
  for (const std::string& name : source.children("/xdmf/motion")) describe_motion(xml, source, name);
  if (source.has("/xdmf/piv")) describe_vectors(xml, source, reader.head().grid);
  write_text_file(std::filesystem::path(record).replace_extension(".xdmf"), xml.finish());
}

}  // namespace pivnp::io
