#include <cmath>
#include <cstdio>
#include <string>

#include "pivnp/core/error.hpp"
#include "pivnp/io/exports/export_frames.hpp"
#include "pivnp/io/exports/exports.hpp"
#include "pivnp/io/files/files.hpp"

namespace pivnp::io {

namespace {

namespace fs = std::filesystem;

// Nine digits hold any single-precision number of a record exactly.
std::string cell(double value) {
  if (!std::isfinite(value)) return "";
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string head(const std::string& name, const std::string& unit) {
  return unit.empty() || unit == "1" ? name : name + " (" + unit + ")";
}

std::string motion_text(const RecordReader& record, const MotionSource& motion, const ExportOptions& options) {
  const ParticleSet& set = motion.particles();
  const std::string &length = motion.length_unit(), &clock = motion.time_unit();
  std::string text;
  for_each_frame(record, motion, options, [&](const ExportFrame& frame) {
    if (text.empty()) {
      text = head("time", clock) + ",id,label," + head("x0", length) + "," + head("y0", length) + "," + head("x", length) + "," +
             head("y", length) + ",status";
      for (const ExportColumn& c : frame.columns) text += "," + head(c.name, c.unit);
      text += "\n";
    }
    for (std::size_t p = 0; p < set.size(); ++p) {
      const auto& u = frame.state.u[p];
      text += cell(frame.time) + "," + std::to_string(set.id[p]) + "," + std::to_string(set.label[p]) + "," + cell(set.x0[p].x()) + "," +
              cell(set.x0[p].y()) + "," + cell(set.x0[p].x() + double(u[0])) + "," + cell(set.x0[p].y() + double(u[1])) + "," +
              std::to_string(int(frame.state.status[p]));
      for (const ExportColumn& c : frame.columns) text += "," + cell(c.values[p]);
      text += "\n";
    }
  });
  return text;
}

std::string vectors_text(const RecordReader& record, const ExportOptions& options) {
  const std::string &length = record.head().length_unit, &clock = record.head().time_unit;
  std::string text = "first frame,second frame," + head("time", clock) + ",i,j," + head("x", length) + "," + head("y", length) + "," +
                     head("u_x", length) + "," + head("u_y", length) + "," + head("sigma_x", length) + "," + head("sigma_y", length) + ",status,score\n";
  std::vector<double> times;
  for (std::size_t k = 0; k < record.pair_count(); ++k) {
    const auto second = std::size_t(record.pair(k).pair[1]);
    times.push_back(second < record.frames().size() ? record.frames()[second].time : double(second));
  }
  for (const std::size_t k : chosen_frames(times, options.times)) {
    const VectorField field = record.pair(k);
    for (int j = 0; j < field.grid.ny; ++j)
      for (int i = 0; i < field.grid.nx; ++i) {
        const std::size_t n = field.grid.node(i, j);
        const Vec2 x = field.grid.position(i, j);
        text += std::to_string(field.pair[0]) + "," + std::to_string(field.pair[1]) + "," + cell(times[k]) + "," + std::to_string(i) + "," +
                std::to_string(j) + "," + cell(x.x()) + "," + cell(x.y()) + "," + cell(double(field.displacement[n][0])) + "," +
                cell(double(field.displacement[n][1])) + "," + cell(std::sqrt(double(field.cov[n][0]))) + "," +
                cell(std::sqrt(double(field.cov[n][1]))) + "," + std::to_string(int(field.status[n])) + "," + cell(double(field.score[n])) + "\n";
      }
  }
  return text;
}

}  // namespace

std::vector<fs::path> export_csv(const RecordReader& record, const ExportOptions& options, const fs::path& directory) {
  bool vectors = false;
  const std::vector<std::string> names = chosen_motions(record, options, vectors);
  std::vector<fs::path> files;
  for (const std::string& name : names) {
    files.push_back(directory / (name + ".csv"));
    write_text_file(files.back(), motion_text(record, *record.motion(name), options));
  }
  if (vectors) {
    files.push_back(directory / "piv.csv");
    write_text_file(files.back(), vectors_text(record, options));
  }
  return files;
}

}  // namespace pivnp::io
