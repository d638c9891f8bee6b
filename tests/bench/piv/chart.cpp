// Error against time per vector: our methods from a CSV of piv_table, other programs from peers.csv (measured on the
// same images and a machine of the same kind, one thread, all vectors they returned; the best speed seen of each.
// PIVlab's 64-32 stands for its 64-32-32, whose errors are shown; OpenCV's dense flow is counted at nodes 8 px apart).
// Above, the whole table: the geometric mean over peers.csv's rows of error over what is asked of the default, and a
// line up to the worst of them. Below, single rows.
// Usage: piv_chart TABLE.csv PEERS.csv OUT   writes OUT.svg and OUT.png
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "apps/plot/error_time.hpp"

namespace {

using namespace pivnp::plot;
using pivnp::Vec2;

// A program or setting: its error by row, px, as far as it was measured and returned anything.
struct Entry {
  std::string name;
  double microseconds = NAN;
  std::map<std::string, double> error;
  bool ours = false;
};

using Rows = std::vector<std::map<std::string, std::string>>;

Rows read(const char* file) {
  std::ifstream stream(file);
  const auto cells = [](const std::string& line) {
    std::vector<std::string> parts;
    std::stringstream text(line);
    for (std::string part; std::getline(text, part, ',');) parts.push_back(part);
    return parts;
  };
  std::string line;
  if (!std::getline(stream, line)) throw std::runtime_error(std::string(file) + ": found nothing, expected a table");
  const std::vector<std::string> head = cells(line);
  Rows rows;
  while (std::getline(stream, line)) {
    const std::vector<std::string> parts = cells(line);
    for (std::size_t k = 0; k < parts.size() && k < head.size(); ++k) {
      if (k == 0) rows.emplace_back();
      rows.back()[head[k]] = parts[k];
    }
  }
  return rows;
}

double number(const std::string& text) { return text.empty() ? NAN : std::stod(text); }

const std::array<const char*, 6> panels = {"uniform 0..1", "shear 20 %", "band w=8 A=2",
                                           "sine 64",      "noise 5 %",  "loss 20 %"};

// "default:window_px=64" -> "default, 64 px".
std::string plain_name(std::string setting) {
  for (const auto& [from, to] : {std::pair<std::string, std::string>{":smoothing=window", ", no shrinkage"}})
    if (const auto at = setting.find(from); at != std::string::npos) setting.replace(at, from.size(), to);
  const std::string key = ":window_px=";
  if (const auto at = setting.find(key); at != std::string::npos) setting.replace(at, key.size(), ", ") += " px";
  return setting;
}

// Of a setting: the worst error over seeds (and over the uniform shifts), the median speed. `asked`: by row.
std::vector<Entry> ours(const Rows& table, std::map<std::string, double>& asked) {
  std::vector<Entry> entries;  // in the file's order
  std::map<std::string, std::vector<double>> speeds;
  for (auto row : table) {
    const std::string name = row["row"].starts_with("uniform") ? "uniform 0..1" : row["row"],
                      setting = plain_name(row["setting"]);
    auto at = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.name == setting; });
    if (at == entries.end()) at = entries.insert(at, {setting, NAN, {}, true});
    double& error = at->error[name];
    error = std::max(error, number(row["rms_px"]));
    speeds[setting].push_back(number(row["vectors_per_s"]));
    asked[name] = number(row["asked_px"]);
  }
  for (Entry& e : entries) {
    std::vector<double>& all = speeds[e.name];
    std::sort(all.begin(), all.end());
    e.microseconds = 1e6 / all[all.size() / 2];
  }
  return entries;
}

std::vector<Entry> peers(const Rows& table, std::vector<std::string>& rows) {
  std::vector<Entry> entries;
  for (const auto& line : table) {
    Entry& e = entries.emplace_back();
    for (const auto& [key, value] : line) {
      if (key == "program") {
        e.name = value;
      } else if (key == "vectors_per_s") {
        e.microseconds = 1e6 / number(value);
      } else {
        if (std::find(rows.begin(), rows.end(), key) == rows.end()) rows.push_back(key);
        if (!std::isnan(number(value))) e.error[key] = number(value);
      }
    }
  }
  return entries;
}

constexpr double quickest = 0.5, slowest = 1000;  // microseconds

// The entry's point, without its error.
ErrorTimePoint point_of(const std::vector<Entry>& entries, std::size_t k, const std::vector<Symbol>& symbols) {
  ErrorTimePoint point;
  point.name = entries[k].name;
  point.symbol = symbols[k];
  point.own = entries[k].ours;
  point.time = entries[k].microseconds;
  return point;
}

std::vector<Symbol> symbols_of(const std::vector<Entry>& entries, double size_mm) {
  std::vector<bool> own;
  for (const Entry& e : entries) own.push_back(e.ours);
  return entry_symbols(own, size_mm);
}

std::vector<ErrorTimePoint> points_of(const std::vector<Entry>& entries, const std::string& row, double size_mm) {
  const std::vector<Symbol> symbols = symbols_of(entries, size_mm);
  std::vector<ErrorTimePoint> points;
  for (std::size_t k = 0; k < entries.size(); ++k)
    if (const auto at = entries[k].error.find(row); at != entries[k].error.end()) {
      points.push_back(point_of(entries, k, symbols));
      points.back().error = at->second;
    }
  return points;
}

// Over the rows that an entry has, if those are at least half of them; `rest`: the others.
std::vector<ErrorTimePoint> whole_table(const std::vector<Entry>& entries, const std::vector<std::string>& rows,
                                        const std::map<std::string, double>& asked, double size_mm,
                                        std::vector<std::size_t>& rest) {
  const std::vector<Symbol> symbols = symbols_of(entries, size_mm);
  std::vector<ErrorTimePoint> points;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    double sum = 0, worst = 0, count = 0;
    for (const std::string& row : rows) {
      const auto at = entries[k].error.find(row);
      if (at == entries[k].error.end()) continue;
      const double share = std::max(at->second, 1e-6) / asked.at(row);
      sum += std::log(share), worst = std::max(worst, share), ++count;
    }
    if (2 * count < static_cast<double>(rows.size())) {
      rest.push_back(k);
      continue;
    }
    points.push_back(point_of(entries, k, symbols));
    points.back().error = std::exp(sum / count);
    points.back().worst = worst;
  }
  return points;
}

void draw_whole(Canvas& canvas, std::vector<ErrorTimePoint> points, std::size_t rows) {
  constexpr double x = 17, y = 12, width = 152, height = 74;
  canvas.text(x, y - 10.5, "The table's " + std::to_string(rows) + " rows that others were measured on", Align::top_left,
              {.points = 9, .bold = true});
  canvas.text(x, y - 5, "symbol: geometric mean of the rows; line: up to the worst row", Align::top_left,
              {.points = small_text, .rgb = faint});
  ErrorTimeChart chart{"time per vector (µs)", "error / what is asked"};
  chart.quickest = quickest, chart.slowest = slowest;
  chart.least = 0.1, chart.greatest = 100;
  chart.names = true;
  chart.asked = 1;
  chart.points = std::move(points);
  draw_error_time(canvas, x, y, width, height, chart);
  canvas.text(x + width, y + height * 2 / 3.0 - 0.8, "met", Align::bottom_right, {.points = small_text, .rgb = faint});
}

void draw_panel(Canvas& canvas, const std::string& name, std::size_t k, const std::vector<Entry>& entries) {
  constexpr double width = 46, height = 40;
  const double x = 17 + double(k % 3) * 53, y = 106 + double(k / 3) * 53;
  canvas.text(x + width / 2, y - 5, name, Align::top, {.bold = true});
  ErrorTimeChart chart{k < 3 ? "" : "time per vector (µs)", k % 3 == 0 ? "error, rms (px)" : ""};
  chart.quickest = quickest, chart.slowest = slowest;
  chart.least = 0.001, chart.greatest = 1;
  chart.time_numbers = k >= 3, chart.error_numbers = k % 3 == 0;  // one range for all
  chart.points = points_of(entries, name, 2.1);
  draw_error_time(canvas, x, y, width, height, chart);
}

// Programs that the large panel does not name: measured on few rows.
void draw_rest(Canvas& canvas, const std::vector<Entry>& entries, const std::vector<std::size_t>& rest, double y) {
  const std::vector<Symbol> symbols = symbols_of(entries, 2.1);
  double x = 17;
  for (const std::size_t k : rest) {
    canvas.paint_over([symbol = symbols[k], at = Vec2((x + 1.2) * units_per_mm, y * units_per_mm)](Painter& p) {
      p.symbol(symbol, at);
    });
    const std::string words = entries[k].name + " (on few rows)";
    canvas.text(x + 3.4, y, words, Align::left, {.points = small_text, .rgb = faint});
    x += 9 + text_width(words, small_text);
  }
}

void draw_notes(Canvas& canvas, double y) {
  const char* notes[] = {
      "Dashed: the front; nothing is both quicker and more accurate. Colours: pivnp, over valid vectors; grey: other "
      "programs, over all",
      "vectors they returned, rows that they fail left out in their favour. One thread, the same images, 1024 x 1024 "
      "px, "
      "nodes 8 px apart;",
      "windows of 32 px unless named. Noise and loss rows move evenly: larger windows gain there what they lose in "
      "bands "
      "and waves."};
  for (const char* note : notes) canvas.text(17, y += 3.9, note, Align::top_left, {.points = 6.5, .rgb = faint});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: piv_chart TABLE.csv PEERS.csv OUT\n");
    return 2;
  }
  try {
    std::map<std::string, double> asked;
    std::vector<std::string> rows;
    std::vector<Entry> entries = ours(read(argv[1]), asked);
    for (Entry& e : peers(read(argv[2]), rows)) entries.push_back(std::move(e));
    for (const std::string& row : rows)
      if (!asked.contains(row))
        throw std::runtime_error(std::string(argv[1]) + ": found no row '" + row + "', expected it");
    Canvas canvas(175, 226);
    std::vector<std::size_t> rest;
    draw_whole(canvas, whole_table(entries, rows, asked, 2.6, rest), rows.size());
    for (std::size_t k = 0; k < panels.size(); ++k) draw_panel(canvas, panels[k], k, entries);
    draw_rest(canvas, entries, rest, 211);
    draw_notes(canvas, 210.5);
    save(canvas, argv[3], 150);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "piv_chart: %s\n", e.what());
    return 2;
  }
  return 0;
}
