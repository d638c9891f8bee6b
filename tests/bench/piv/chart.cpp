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
#include <functional>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/plot/parts.hpp"
#include "apps/plot/canvas.hpp"

namespace {

using namespace pivnp::report;

// A program or setting: its error by row, px, as far as it was measured and returned anything.
struct Entry {
  std::string name;
  double microseconds = NAN;
  std::map<std::string, double> error;
  bool ours = false;
};

struct Point {
  double microseconds, error, worst;  // worst: NaN if there is one row only
  std::size_t entry;
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

std::vector<Point> points_of(const std::vector<Entry>& entries, const std::string& row) {
  std::vector<Point> points;
  for (std::size_t k = 0; k < entries.size(); ++k)
    if (const auto at = entries[k].error.find(row); at != entries[k].error.end())
      points.push_back({entries[k].microseconds, at->second, NAN, k});
  return points;
}

// Over the rows that an entry has, if those are at least half of them.
std::vector<Point> whole_table(const std::vector<Entry>& entries, const std::vector<std::string>& rows,
                               const std::map<std::string, double>& asked) {
  std::vector<Point> points;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    double sum = 0, worst = 0, count = 0;
    for (const std::string& row : rows) {
      const auto at = entries[k].error.find(row);
      if (at == entries[k].error.end()) continue;
      const double share = std::max(at->second, 1e-6) / asked.at(row);
      sum += std::log(share), worst = std::max(worst, share), ++count;
    }
    if (2 * count >= static_cast<double>(rows.size()))
      points.push_back({entries[k].microseconds, std::exp(sum / count), worst, k});
  }
  return points;
}

// Those that no other point beats in both, quickest first.
std::vector<Point> front(std::vector<Point> points) {
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return a.microseconds < b.microseconds; });
  std::vector<Point> best;
  for (const Point& p : points)
    if (best.empty() || p.error < best.back().error) best.push_back(p);
  return best;
}

void logarithmic(QCPAxis* axis, double lower, double upper, const char* label) {
  set_axis(axis, lower, upper, QString::fromUtf8(label));
  axis->setScaleType(QCPAxis::stLogarithmic);
  axis->setTicker(QSharedPointer<QCPAxisTickerLog>::create());
  axis->setSubTicks(true);
  axis->setSubTickPen(pen(ink, 0.5));
  axis->setSubTickLength(0, int(0.6 * units_per_mm));
}

constexpr double fastest = 0.5, slowest = 1000;  // microseconds
constexpr Rgb pale = 0xe4e4e4;

const QCPScatterStyle::ScatterShape shapes[] = {QCPScatterStyle::ssSquare,    QCPScatterStyle::ssDiamond,
                                                QCPScatterStyle::ssTriangle,  QCPScatterStyle::ssTriangleInverted,
                                                QCPScatterStyle::ssCross,     QCPScatterStyle::ssPlus,
                                                QCPScatterStyle::ssStar,      QCPScatterStyle::ssCrossSquare,
                                                QCPScatterStyle::ssPlusCircle};
constexpr Rgb own_colours[] = {vermilion, blue, red, green, purple, orange, sky, ink};

struct Look {
  QCPScatterStyle::ScatterShape shape;
  Rgb rgb;
  bool filled;
};

// Entries: ours first, then the others.
Look look_of(const std::vector<Entry>& entries, std::size_t k) {
  if (entries[k].ours) return {QCPScatterStyle::ssDisc, own_colours[k % std::size(own_colours)], true};
  std::size_t other = 0;
  for (std::size_t n = 0; n < k; ++n) other += !entries[n].ours;
  return {shapes[other % std::size(shapes)], faint, false};
}

void draw_symbol(QCPPainter& painter, const Look& look, double x, double y, double size_mm) {
  QCPScatterStyle style(look.shape, pen(look.rgb, 0.9), look.filled ? QBrush(colour(look.rgb)) : QBrush(Qt::white),
                        size_mm * units_per_mm);
  style.applyTo(&painter, pen(look.rgb, 0.9));
  style.drawShape(&painter, x, y);
}

// The front as stairs: what is possible lies right of and above it.
void draw_front(Sheet& sheet, QCPAxisRect* panel, const std::vector<Point>& points, double top) {
  const std::vector<Point> best = front(points);
  sheet.paint(panel, [=](QCPPainter& p) {
    p.setPen(pen(ink, 0.6, Qt::DashLine));
    QPolygonF path;
    const auto to = [&](double x, double y) { path << QPointF(x_of(panel, x), y_of(panel, y)); };
    to(best.front().microseconds, top);
    for (std::size_t n = 0; n < best.size(); ++n) {
      to(best[n].microseconds, best[n].error);
      to(n + 1 < best.size() ? best[n + 1].microseconds : slowest, best[n].error);
    }
    p.drawPolyline(path);
  });
}

void draw_points(Sheet& sheet, QCPAxisRect* panel, const std::vector<Entry>& entries, const std::vector<Point>& points,
                 double size_mm) {
  sheet.paint_over([=, &entries](QCPPainter& painter) {
    for (auto p = points.rbegin(); p != points.rend(); ++p)  // ours last: on top
      draw_symbol(painter, look_of(entries, p->entry), x_of(panel, p->microseconds), y_of(panel, p->error), size_mm);
  });
}

// Horizontal lines at the decades.
void draw_decades(Sheet& sheet, QCPAxisRect* panel, double lower, double upper) {
  sheet.paint(panel, [=](QCPPainter& p) {
    p.setPen(pen(pale, 0.5));
    for (double y = lower * 10; y < 0.99 * upper; y *= 10)
      p.drawLine(QPointF(x_of(panel, fastest), y_of(panel, y)), QPointF(x_of(panel, slowest), y_of(panel, y)));
  });
}

struct Patch {
  double x, y, width, height;
  bool meets(const Patch& o) const {
    return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height;
  }
};

// Names beside the symbols, where nothing is in the way. Places in mm, within a panel at (x, y).
void draw_names(Sheet& sheet, const std::vector<Entry>& entries, const std::vector<Point>& points,
                const std::function<Patch(const Point&)>& place) {
  std::vector<Patch> taken;
  for (const Point& p : points) taken.push_back(place(p));
  constexpr double line = 3.1;
  for (const Point& p : points) {
    const QString words = qt(entries[p.entry].name);
    const bool ours = entries[p.entry].ours;
    const double wide = text_width(words, small_text, ours);
    const Patch at = place(p);
    const double cx = at.x + at.width / 2, cy = at.y + at.height / 2, off = at.width / 2 + 0.8;
    const double right = cx + off, left = cx - off - wide, above = cy - line - 0.5, below = cy + 0.5;
    // Beside the symbol; ours, whose front is a line to the right, above that.
    const Patch tries[] = {{right, ours ? above : cy - line / 2, wide, line},
                           {left, cy - line / 2, wide, line},
                           {right, below + 0.4, wide, line},
                           {cx - wide / 2, cy + off, wide, line},
                           {cx - wide / 2, cy - off - line, wide, line},
                           {left, below, wide, line},
                           {left, above, wide, line},
                           {right, cy + off, wide, line}};
    const auto free = std::find_if(std::begin(tries), std::end(tries), [&](const Patch& t) {
      return std::none_of(taken.begin(), taken.end(), [&](const Patch& o) { return t.meets(o); });
    });
    const Patch* best = free == std::end(tries) ? tries : free;
    taken.push_back(*best);
    sheet.text(best->x, best->y + line / 2, words, Qt::AlignLeft | Qt::AlignVCenter, small_text, ours,
               ours ? look_of(entries, p.entry).rgb : faint);
  }
}

void draw_whole(Sheet& sheet, const std::vector<Entry>& entries, const std::vector<Point>& points, std::size_t rows) {
  constexpr double x = 17, y = 12, width = 152, height = 74, lower = 0.1, upper = 100;
  QCPAxisRect* panel = sheet.panel(x, y, width, height);
  logarithmic(panel->axis(QCPAxis::atBottom), fastest, slowest, "time per vector (µs)");
  logarithmic(panel->axis(QCPAxis::atLeft), lower, upper, "error / what is asked");
  sheet.text(x, y - 10.5, qt("The table's " + std::to_string(rows) + " rows that others were measured on"),
             Qt::AlignLeft | Qt::AlignTop, 9, true);
  sheet.text(x, y - 5, "symbol: geometric mean of the rows; line: up to the worst row", Qt::AlignLeft | Qt::AlignTop,
             small_text, false, faint);
  draw_decades(sheet, panel, lower, upper);
  sheet.paint(panel, [=, &entries](QCPPainter& p) {
    p.setPen(pen(faint, 0.8));
    p.drawLine(QPointF(x_of(panel, fastest), y_of(panel, 1)), QPointF(x_of(panel, slowest), y_of(panel, 1)));
    for (const Point& at : points) {
      const Look look = look_of(entries, at.entry);
      p.setPen(QPen(colour(look.rgb, 110), 0.7 * units_per_point));
      const double column = x_of(panel, at.microseconds), worst = y_of(panel, std::min(at.worst, upper));
      p.drawLine(QPointF(column, y_of(panel, at.error)), QPointF(column, worst));
      p.drawLine(QPointF(column - 0.8 * units_per_mm, worst), QPointF(column + 0.8 * units_per_mm, worst));
    }
  });
  draw_front(sheet, panel, points, upper);
  draw_points(sheet, panel, entries, points, 2.6);
  const auto place = [=](const Point& p) {
    const double across = std::log(p.microseconds / fastest) / std::log(slowest / fastest),
                 up = std::log(p.error / lower) / std::log(upper / lower);
    constexpr double half = 1.6;
    return Patch{x + across * width - half, y + (1 - up) * height - half, 2 * half, 2 * half};
  };
  draw_names(sheet, entries, points, place);
  sheet.text(x + width, y + height * 2 / 3.0 - 0.8, "met", Qt::AlignRight | Qt::AlignBottom, small_text, false, faint);
}

void draw_panel(Sheet& sheet, const std::string& name, std::size_t k, const std::vector<Entry>& entries) {
  constexpr double width = 46, height = 40, lower = 0.001, upper = 1;
  const double x = 17 + double(k % 3) * 53, y = 106 + double(k / 3) * 53;
  QCPAxisRect* panel = sheet.panel(x, y, width, height);
  logarithmic(panel->axis(QCPAxis::atBottom), fastest, slowest, k < 3 ? "" : "time per vector (µs)");
  logarithmic(panel->axis(QCPAxis::atLeft), lower, upper, k % 3 == 0 ? "error, rms (px)" : "");
  panel->axis(QCPAxis::atLeft)->setTickLabels(k % 3 == 0);  // one range for all
  panel->axis(QCPAxis::atBottom)->setTickLabels(k >= 3);
  sheet.text(x + width / 2, y - 5, qt(name), Qt::AlignHCenter | Qt::AlignTop, normal_text, true);
  draw_decades(sheet, panel, lower, upper);
  const std::vector<Point> points = points_of(entries, name);
  draw_front(sheet, panel, points, upper);
  draw_points(sheet, panel, entries, points, 2.1);
}

// Programs that the large panel does not name: measured on few rows.
void draw_rest(Sheet& sheet, const std::vector<Entry>& entries, const std::vector<Point>& named, double y) {
  double x = 17;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    if (std::any_of(named.begin(), named.end(), [&](const Point& p) { return p.entry == k; })) continue;
    const double at = x;
    sheet.paint_over([=, &entries](QCPPainter& p) {
      draw_symbol(p, look_of(entries, k), (at + 1.2) * units_per_mm, y * units_per_mm, 2.1);
    });
    const QString words = qt(entries[k].name) + " (on few rows)";
    sheet.text(x + 3.4, y, words, Qt::AlignLeft | Qt::AlignVCenter, small_text, false, faint);
    x += 9 + text_width(words, small_text);
  }
}

void draw_notes(Sheet& sheet, double y) {
  const char* notes[] = {
      "Dashed: the front; nothing is both quicker and more accurate. Colours: pivnp, over valid vectors; grey: other "
      "programs, over all",
      "vectors they returned, rows that they fail left out in their favour. One thread, the same images, 1024 x 1024 "
      "px, "
      "nodes 8 px apart;",
      "windows of 32 px unless named. Noise and loss rows move evenly: larger windows gain there what they lose in "
      "bands "
      "and waves."};
  for (const char* note : notes) sheet.text(17, y += 3.9, note, Qt::AlignLeft | Qt::AlignTop, 6.5, false, faint);
}

void write(const std::string& file, const QByteArray& bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(bytes.constData(), bytes.size());
  if (!stream.flush()) throw std::runtime_error(file + ": cannot be written");
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
    start_qt();
    Sheet sheet(175, 226);
    const std::vector<Point> whole = whole_table(entries, rows, asked);
    draw_whole(sheet, entries, whole, rows.size());
    for (std::size_t k = 0; k < panels.size(); ++k) draw_panel(sheet, panels[k], k, entries);
    draw_rest(sheet, entries, whole, 211);
    draw_notes(sheet, 210.5);
    write(std::string(argv[3]) + ".svg", sheet.svg());
    write(std::string(argv[3]) + ".png", sheet.png(150));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "piv_chart: %s\n", e.what());
    return 2;
  }
  return 0;
}
