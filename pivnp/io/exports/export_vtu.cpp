// VTK XML: an unstructured grid of vertices a time, and the collection (.pvd) that gives the times; what ParaView 5 and VTK 9
// read ("VTK file formats", docs.vtk.org). Arrays are base64, as text knows no NaN.
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/io/exports/export_frames.hpp"
#include "pivnp/io/exports/exports.hpp"
#include "pivnp/io/files/files.hpp"

namespace pivnp::io {

namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little);

void append_base64(std::string_view bytes, std::string& to) {
  static constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - k);
    std::uint32_t three = 0;
    for (std::size_t j = 0; j < 3; ++j) three = three << 8 | (j < n ? std::uint8_t(bytes[k + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j) to += j <= n ? letters[three >> (18 - 6 * j) & 63] : '=';
  }
}

// One array: its length in bytes as UInt64, then its numbers.
template <class T>
void append_array(const std::string& type, const std::string& name, int components, const std::vector<T>& values, std::string& to) {
  to += "<DataArray type=\"" + type + "\"" + (name.empty() ? "" : " Name=\"" + name + "\"") + " NumberOfComponents=\"" + std::to_string(components) +
        "\" format=\"binary\">";
  const std::uint64_t length = values.size() * sizeof(T);
  std::string bytes(reinterpret_cast<const char*>(&length), sizeof length);
  bytes.append(reinterpret_cast<const char*>(values.data()), length);
  append_base64(bytes, to);
  to += "</DataArray>\n";
}

std::string piece_of(const ParticleSet& set, const ExportFrame& frame) {
  std::vector<std::size_t> there;  // followed at this time
  for (std::size_t p = 0; p < set.size(); ++p)
    if (alive(frame.state.status[p])) there.push_back(p);
  const std::size_t n = there.size();
  std::vector<float> points, displacement, sigma;
  std::vector<std::int64_t> id, connectivity, offsets;
  std::vector<std::int32_t> label;
  std::vector<std::uint8_t> status, types(n, 1);  // VTK_VERTEX
  for (const std::size_t p : there) {
    const auto& u = frame.state.u[p];
    points.insert(points.end(), {float(set.x0[p].x() + double(u[0])), float(set.x0[p].y() + double(u[1])), 0.0f});
    displacement.insert(displacement.end(), {u[0], u[1], 0.0f});
    id.push_back(set.id[p]);
    label.push_back(set.label[p]);
    status.push_back(std::uint8_t(frame.state.status[p]));
    connectivity.push_back(std::int64_t(connectivity.size()));
    offsets.push_back(std::int64_t(connectivity.size()));
    if (frame.state.cov_u.size() == set.size())
      sigma.push_back(float(std::sqrt((double(frame.state.cov_u[p][0]) + double(frame.state.cov_u[p][1])) / 2)));
  }
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
                     "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" + std::to_string(n) + "\" NumberOfCells=\"" + std::to_string(n) + "\">\n<Points>\n";
  append_array("Float32", "", 3, points, text);
  text += "</Points>\n<Cells>\n";
  append_array("Int64", "connectivity", 1, connectivity, text);
  append_array("Int64", "offsets", 1, offsets, text);
  append_array("UInt8", "types", 1, types, text);
  text += "</Cells>\n<PointData>\n";
  append_array("Int64", "id", 1, id, text);
  append_array("Int32", "label", 1, label, text);
  append_array("UInt8", "status", 1, status, text);
  append_array("Float32", "displacement", 3, displacement, text);
  if (!sigma.empty()) append_array("Float32", "sigma", 1, sigma, text);
  for (const ExportColumn& c : frame.columns) {
    if (c.name == "sigma_x" || c.name == "sigma_y" || c.name == "displacement_x" || c.name == "displacement_y") continue;
    std::vector<float> values;
    for (const std::size_t p : there) values.push_back(float(c.values[p]));
    append_array("Float32", c.name, 1, values, text);
  }
  return text + "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

}  // namespace

std::vector<fs::path> export_vtu(const RecordReader& record, const ExportOptions& options, const fs::path& directory) {
  bool vectors = false;
  std::vector<fs::path> files;
  for (const std::string& name : chosen_motions(record, options, vectors)) {
    const std::unique_ptr<MotionSource> motion = record.motion(name);
    fs::create_directories(directory / name);
    std::string collection = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
    std::size_t k = 0;
    for_each_frame(record, *motion, options, [&](const ExportFrame& frame) {
      char number[16], time[40];
      std::snprintf(number, sizeof number, "_%06zu.vtu", k++);
      std::snprintf(time, sizeof time, "%.17g", frame.time);
      const fs::path file = fs::path(name) / (name + number);
      write_text_file(directory / file, piece_of(motion->particles(), frame));
      collection += "<DataSet timestep=\"" + std::string(time) + "\" part=\"0\" file=\"" + file.generic_string() + "\"/>\n";
    });
    files.push_back(directory / (name + ".pvd"));
    write_text_file(files.back(), collection + "</Collection>\n</VTKFile>\n");
  }
  return files;
}

}  // namespace pivnp::io
