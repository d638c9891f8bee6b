// Tables of tracks: one row a particle and time. Columns by name, in any order, separated by comma, semicolon or tab:
// x, y; id (or particle, track, "Particle Id"); time or t (times) or frame or step (counted by `step`); where known ux,
// uy (displacement), vx, vy (velocity), sigma_x, sigma_y (standard uncertainty of the position), area. Without a column
// of times every file is one time.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>

#include "pivnp/core/error.hpp"
#include "pivnp/io/imports/import_format.hpp"

namespace pivnp::io {

namespace {

std::string lower(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (c != ' ' && c != '"') out += char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '"')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '"' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    cells.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return cells;
}

// Place of the first of `names` among the columns; -1 if none is there.
int column(const std::vector<std::string>& header, const std::vector<const char*>& names) {
  for (const char* name : names)
    for (std::size_t k = 0; k < header.size(); ++k)
      if (header[k] == name) return int(k);
  return -1;
}

struct Columns {
  int x, y, id, time, frame, ux, uy, vx, vy, sx, sy, area;
};

Columns find_columns(const std::vector<std::string>& h) {
  return {column(h, {"x", "coord_x", "position_x", "points_0", "points:0", "positionx"}),
          column(h, {"y", "coord_y", "position_y", "points_1", "points:1", "positiony"}),
          column(h, {"id", "particle", "particleid", "particle_id", "track", "track_id", "trackid"}),
          column(h, {"time", "t", "time_s"}),
          column(h, {"frame", "step"}),
          column(h, {"ux", "u_x", "displacement_x", "displacement_0", "displacement:0", "displacementx"}),
          column(h, {"uy", "u_y", "displacement_y", "displacement_1", "displacement:1", "displacementy"}),
          column(h, {"vx", "v_x", "velocity_x", "velocity_0", "velocity:0", "velocityx"}),
          column(h, {"vy", "v_y", "velocity_y", "velocity_1", "velocity:1", "velocityy"}),
          column(h, {"sigma_x", "sigmax"}),
          column(h, {"sigma_y", "sigmay"}),
          column(h, {"area", "volume"})};
}

}  // namespace

ImportedTable read_csv(const std::filesystem::path& file, double step) {
  const std::string text = read_text(file);
  std::string_view rest = text;
  if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
  int line_number = 0;
  const auto next_line = [&](std::string_view& line) {
    if (rest.empty()) return false;
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    line = rest.substr(0, end);
    rest.remove_prefix(std::min(rest.size(), end + 1));
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++line_number;
    return true;
  };
  const auto at = [&] { return file.string() + ":" + std::to_string(line_number) + ": "; };

  std::string_view line;
  do {
    if (!next_line(line)) throw InputError(file.string() + ": is empty, expected a line of column names");
  } while (line.empty() || line.starts_with('#'));
  const char separator = line.find(';') != line.npos ? ';' : line.find('\t') != line.npos ? '\t' : ',';
  std::vector<std::string> header;
  for (const std::string_view cell : split(line, separator)) header.push_back(lower(cell));
  const Columns c = find_columns(header);
  if (c.x < 0 || c.y < 0)
    throw InputError(at() + "no column '" + (c.x < 0 ? "x" : "y") + "' among the names, expected x and y");
  const bool timed = c.time >= 0 || c.frame >= 0;
  if (timed && c.id < 0) throw InputError(at() + "times without ids: expected a column 'id'");

  std::map<double, ImportedState> states;
  while (next_line(line)) {
    if (line.empty() || line.starts_with('#')) continue;
    const std::vector<std::string_view> cells = split(line, separator);
    if (cells.size() < header.size())
      throw InputError(at() + "found " + std::to_string(cells.size()) + " values, expected " +
                       std::to_string(header.size()));
    const auto value = [&](int k) {
      const std::string_view cell = cells[std::size_t(k)];
      double v = 0;
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), v);
      if (cell.empty() || lower(cell) == "nan") return std::nan("");
      if (error != std::errc() || end != cell.data() + cell.size())
        throw InputError(at() + "column '" + shown(header[std::size_t(k)]) + "': found '" + shown(cell) +
                         "', expected a number");
      if (std::isnan(v)) return v;  // "-nan", as some programs write it
      if (!(std::abs(v) <= double(std::numeric_limits<float>::max())))
        throw InputError(at() + "column '" + shown(header[std::size_t(k)]) + "': found '" + shown(cell) +
                         "', expected a finite number (of single precision), or nan where nothing is known");
      return v;
    };
    const double time = c.time >= 0 ? value(c.time) : c.frame >= 0 ? value(c.frame) * step : 0;
    if (!std::isfinite(time)) throw InputError(at() + "no time, expected a number");
    ImportedState& s = states[time];
    if (c.id >= 0) {
      const double id = value(c.id);
      if (!(std::abs(id) < 9e15) || id != std::floor(id)) throw InputError(at() + "id: expected a whole number");
      s.id.push_back(std::int64_t(id));
    }
    s.x.push_back({value(c.x), value(c.y)});
    if (c.ux >= 0 && c.uy >= 0) s.u.push_back({value(c.ux), value(c.uy)});
    if (c.vx >= 0 && c.vy >= 0) s.v.push_back({value(c.vx), value(c.vy)});
    if (c.sx >= 0 && c.sy >= 0) s.sigma.push_back({value(c.sx), value(c.sy)});
    if (c.area >= 0) s.area.push_back(value(c.area));
  }
  if (states.empty()) throw InputError(file.string() + ": no row of values");
  ImportedTable table;
  table.timed = timed;
  for (auto& [time, state] : states) {
    table.time.push_back(time);
    table.state.push_back(std::move(state));
  }
  return table;
}

}  // namespace pivnp::io
