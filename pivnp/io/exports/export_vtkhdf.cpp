// VTKHDF, an unstructured grid of vertices with steps in time: docs.vtk.org, "VTK file formats", VTKHDF 2.0.
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/io/exports/export_frames.hpp"
#include "pivnp/io/exports/exports.hpp"
#include "pivnp/io/hdf5/hdf5.hpp"

namespace pivnp::io {

namespace {

namespace fs = std::filesystem;
using h5::Packing;
using h5::Type;

// Everything of a motion, one time after the other, as the format wants it.
struct Gathered {
  std::vector<double> times;
  std::vector<float> points, displacement, sigma;
  std::vector<std::uint8_t> status;
  std::vector<std::pair<ExportColumn, std::vector<float>>> columns;
};

Gathered gather(const RecordReader& record, const MotionSource& motion, const ExportOptions& options) {
  Gathered g;
  const ParticleSet& set = motion.particles();
  for_each_frame(record, motion, options, [&](const ExportFrame& frame) {
    g.times.push_back(frame.time);
    for (std::size_t p = 0; p < set.size(); ++p) {
      const auto& u = frame.state.u[p];
      g.points.insert(g.points.end(), {float(set.x0[p].x() + double(u[0])), float(set.x0[p].y() + double(u[1])), 0.0f});
      g.displacement.insert(g.displacement.end(), {u[0], u[1], 0.0f});
      g.status.push_back(std::uint8_t(frame.state.status[p]));
      if (frame.state.cov_u.size() == set.size())
        g.sigma.push_back(float(std::sqrt((double(frame.state.cov_u[p][0]) + double(frame.state.cov_u[p][1])) / 2)));
    }
    if (g.columns.empty())
      for (const ExportColumn& c : frame.columns)
        if (!c.name.starts_with("sigma_") && c.name != "displacement_x" && c.name != "displacement_y")
          g.columns.emplace_back(ExportColumn{c.name, c.unit, {}}, std::vector<float>{});
    for (auto& [column, values] : g.columns)
      for (const ExportColumn& c : frame.columns)
        if (c.name == column.name)
          for (const double v : c.values) values.push_back(float(v));
  });
  return g;
}

void write_motion(const RecordReader& record, const MotionSource& motion, const ExportOptions& options, const fs::path& file) {
  const Gathered g = gather(record, motion, options);
  const ParticleSet& set = motion.particles();
  const std::size_t n = set.size(), steps = g.times.size();
  h5::OutputFile out(file);
  out.group("/VTKHDF");
  out.attribute("/VTKHDF", "Version", std::vector<std::int64_t>{2, 0});
  out.attribute_ascii("/VTKHDF", "Type", "UnstructuredGrid");
  const std::vector<std::int64_t> count(steps, std::int64_t(n));
  for (const char* name : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
    out.write(std::string("/VTKHDF/") + name, count, "");
  out.write("/VTKHDF/Points", Type::f32, {n * steps, 3}, g.points.data(), motion.length_unit(), Packing::deflated);
  std::vector<std::int64_t> connectivity, offsets, id, label, point_offset, cell_offset, part_offset, parts(steps, 1);
  for (std::size_t k = 0; k < steps; ++k) {
    for (std::size_t p = 0; p <= n; ++p) offsets.push_back(std::int64_t(p));
    for (std::size_t p = 0; p < n; ++p) {
      connectivity.push_back(std::int64_t(p));
      id.push_back(set.id[p]);
      label.push_back(set.label[p]);
    }
    part_offset.push_back(std::int64_t(k));
    point_offset.push_back(std::int64_t(k * n));
  }
  constexpr std::uint8_t vertex = 1;  // VTK_VERTEX
  out.write("/VTKHDF/Types", std::vector<std::uint8_t>(n * steps, vertex), "");
  out.write("/VTKHDF/Connectivity", connectivity, "");
  out.write("/VTKHDF/Offsets", offsets, "");

  out.group("/VTKHDF/PointData");
  const auto data = [](const std::string& name) { return "/VTKHDF/PointData/" + name; };
  std::vector<std::string> names = {"id", "label", "status", "displacement"};
  out.write(data("id"), id, "");
  out.write(data("label"), label, "");
  out.write(data("status"), g.status, "");
  out.write(data("displacement"), Type::f32, {n * steps, 3}, g.displacement.data(), motion.length_unit(), Packing::deflated);
  if (!g.sigma.empty()) {
    out.write(data("sigma"), g.sigma, motion.length_unit());
    names.push_back("sigma");
  }
  for (const auto& [column, values] : g.columns) {
    out.write(data(column.name), values, column.unit);
    names.push_back(column.name);
  }

  out.group("/VTKHDF/Steps");
  out.attribute("/VTKHDF/Steps", "NSteps", std::vector<std::int64_t>{std::int64_t(steps)}, true);
  out.write("/VTKHDF/Steps/Values", g.times, motion.time_unit());
  out.write("/VTKHDF/Steps/PartOffsets", part_offset, "");
  out.write("/VTKHDF/Steps/NumberOfParts", parts, "");
  out.write("/VTKHDF/Steps/PointOffsets", point_offset, "");
  for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"})
    out.write(std::string("/VTKHDF/Steps/") + name, Type::i64, {steps, 1}, point_offset.data(), "", Packing::plain);
  out.group("/VTKHDF/Steps/PointDataOffsets");
  for (const std::string& name : names) out.write("/VTKHDF/Steps/PointDataOffsets/" + name, point_offset, "");
  out.commit();
}

}  // namespace

std::vector<fs::path> export_vtkhdf(const RecordReader& record, const ExportOptions& options, const fs::path& directory) {
  bool vectors = false;
  std::vector<fs::path> files;
  for (const std::string& name : chosen_motions(record, options, vectors)) {
    files.push_back(directory / (name + ".vtkhdf"));
    write_motion(record, *record.motion(name), options, files.back());
  }
  return files;
}

}  // namespace pivnp::io
