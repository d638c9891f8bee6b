// Tables of tracks: one row a particle and time. Columns by name, in any order, separated by comma, semicolon or tab:
// x, y; id (or particle, track, "Particle Id"); time or t (times) or frame or step (counted by `step`); where known ux,
// uy (displacement), vx, vy (velocity), sigma_x, sigma_y (standard uncertainty of the position), area, status (as `pivnp export`
// writes it: a particle that is not followed at a time has no position there). A name may state its unit, "x (mm)". Without a
// column of times every file is one time.
#include <cmath>
#include <map>
#include <string_view>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "pivnp/io/imports/text_table.hpp"

namespace pivnp::io {

namespace {

struct Columns {
  int x, y, id, time, frame, ux, uy, vx, vy, sx, sy, area, status;
};

// The unit goes from "x(mm)"; what it was is returned.
std::string take_unit(std::string& name) {
  const std::size_t at = name.find('(');
  if (at == name.npos || at == 0 || !name.ends_with(')')) return "";
  const std::string unit = name.substr(at + 1, name.size() - at - 2);
  name.resize(at);
  return unit;
}

Columns find_columns(const std::vector<std::string>& h) {
  return {column_of(h, {"x", "coord_x", "position_x", "points_0", "points:0", "positionx"}),
          column_of(h, {"y", "coord_y", "position_y", "points_1", "points:1", "positiony"}),
          column_of(h, {"id", "particle", "particleid", "particle_id", "track", "track_id", "trackid"}),
          column_of(h, {"time", "t", "time_s"}),
          column_of(h, {"frame", "step"}),
          column_of(h, {"ux", "u_x", "displacement_x", "displacement_0", "displacement:0", "displacementx"}),
          column_of(h, {"uy", "u_y", "displacement_y", "displacement_1", "displacement:1", "displacementy"}),
          column_of(h, {"vx", "v_x", "velocity_x", "velocity_0", "velocity:0", "velocityx"}),
          column_of(h, {"vy", "v_y", "velocity_y", "velocity_1", "velocity:1", "velocityy"}),
          column_of(h, {"sigma_x", "sigmax"}),
          column_of(h, {"sigma_y", "sigmay"}),
          column_of(h, {"area", "volume"}),
          column_of(h, {"status"})};
}

}  // namespace

ImportedTable read_csv(const std::filesystem::path& file, double step) {
  TextLines lines(file);
  std::string_view line = line_of_names(lines);
  const char separator = line.find(';') != line.npos ? ';' : line.find('\t') != line.npos ? '\t' : ',';
  std::vector<std::string> header = header_of(line, separator), units;
  for (std::string& name : header) units.push_back(take_unit(name));
  const Columns c = find_columns(header);
  if (c.x < 0 || c.y < 0)
    throw InputError(lines.at() + "no column '" + (c.x < 0 ? "x" : "y") + "' among the names, expected x and y");
  const bool timed = c.time >= 0 || c.frame >= 0;
  if (timed && c.id < 0) throw InputError(lines.at() + "times without ids: expected a column 'id'");

  ImportedTable table;
  table.timed = timed;
  table.length_unit = units[std::size_t(c.x)];
  if (c.time >= 0) table.time_unit = units[std::size_t(c.time)];
  for (const int k : {c.y, c.ux, c.uy, c.sx, c.sy})
    if (k >= 0 && units[std::size_t(k)] != table.length_unit)
      throw InputError(lines.at() + "column '" + header[std::size_t(k)] + "' is in '" + units[std::size_t(k)] + "', expected the unit of x, '" + table.length_unit + "'");

  std::map<double, ImportedState> states;
  while (lines.next(line)) {
    if (line.empty() || line.starts_with('#')) continue;
    const std::vector<std::string_view> cells = cells_of(line, separator);
    if (cells.size() < header.size())
      throw InputError(lines.at() + "found " + std::to_string(cells.size()) + " values, expected " +
                       std::to_string(header.size()));
    const auto value = [&](int k) { return lines.value(cells[std::size_t(k)], header[std::size_t(k)]); };
    const double time = c.time >= 0 ? value(c.time) : c.frame >= 0 ? value(c.frame) * step : 0;
    if (!std::isfinite(time)) throw InputError(lines.at() + "no time, expected a number");
    ImportedState& s = states[time];
    if (c.id >= 0) {
      const double id = value(c.id);
      if (!(std::abs(id) < 9e15) || id != std::floor(id)) throw InputError(lines.at() + "id: expected a whole number");
      s.id.push_back(std::int64_t(id));
    }
    const bool away = c.status >= 0 && value(c.status) != double(ParticleStatus::active) && value(c.status) != double(ParticleStatus::flagged);
    s.x.push_back(away ? std::array{std::nan(""), std::nan("")} : std::array{value(c.x), value(c.y)});
    if (c.ux >= 0 && c.uy >= 0) s.u.push_back({value(c.ux), value(c.uy)});
    if (c.vx >= 0 && c.vy >= 0) s.v.push_back({value(c.vx), value(c.vy)});
    if (c.sx >= 0 && c.sy >= 0) s.sigma.push_back({value(c.sx), value(c.sy)});
    if (c.area >= 0) s.area.push_back(value(c.area));
  }
  if (states.empty()) throw InputError(file.string() + ": no row of values");
  for (auto& [time, state] : states) {
    table.time.push_back(time);
    table.state.push_back(std::move(state));
  }
  return table;
}

}  // namespace pivnp::io
