// Error against time per vector: our methods from a CSV of piv_table, other programs from peers.csv (measured on the
// same images and a machine of the same kind, one thread, all vectors they returned; the best speed seen of each.
// PIVlab's 64-32 stands for its 64-32-32, whose errors are shown; OpenCV's dense flow is counted at nodes 8 px apart).
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
#include <vector>

#include "apps/report/figure_parts.hpp"
#include "apps/report/sheet.hpp"

namespace {

using namespace pivnp::report;

struct Point {
  std::string name;
  double microseconds = NAN, error = NAN;
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

// Of a setting: the worst error over seeds (and over the uniform shifts), the median speed.
std::vector<Point> ours(const Rows& rows, const std::string& panel) {
  std::vector<std::pair<std::string, std::pair<double, std::vector<double>>>> settings;  // in the file's order
  for (auto row : rows) {
    const std::string name = row["row"].starts_with("uniform") ? "uniform 0..1" : row["row"];
    if (name != panel) continue;
    const std::string setting = row["setting"];
    auto at = std::find_if(settings.begin(), settings.end(), [&](const auto& s) { return s.first == setting; });
    if (at == settings.end()) at = settings.insert(at, {setting, {0, {}}});
    auto& [error, speeds] = at->second;
    error = std::max(error, number(row["rms_px"]));
    speeds.push_back(number(row["vectors_per_s"]));
  }
  std::vector<Point> points;
  for (auto& [name, figures] : settings) {
    auto& [error, speeds] = figures;
    std::sort(speeds.begin(), speeds.end());
    points.push_back({name, 1e6 / speeds[speeds.size() / 2], error, true});
  }
  return points;
}

std::vector<Point> peers(const Rows& rows, const std::string& panel) {
  std::vector<Point> points;
  for (auto row : rows) {
    const double error = number(row[panel]);
    if (!std::isnan(error)) points.push_back({row["program"], 1e6 / number(row["vectors_per_s"]), error});
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

const QCPScatterStyle::ScatterShape shapes[] = {QCPScatterStyle::ssSquare,    QCPScatterStyle::ssDiamond,
                                                QCPScatterStyle::ssTriangle,  QCPScatterStyle::ssTriangleInverted,
                                                QCPScatterStyle::ssCross,     QCPScatterStyle::ssPlus,
                                                QCPScatterStyle::ssStar,      QCPScatterStyle::ssCrossSquare,
                                                QCPScatterStyle::ssPlusCircle};
constexpr Rgb own_colours[] = {vermilion, blue, green, purple, orange, sky, ink, red};

void mark(Sheet& sheet, QCPAxisRect* panel, const Point& p, QCPScatterStyle::ScatterShape shape, Rgb rgb) {
  QCPGraph* graph = sheet.graph(panel);
  graph->setData({p.microseconds}, {p.error}, true);
  graph->setLineStyle(QCPGraph::lsNone);
  graph->setScatterStyle(
      QCPScatterStyle(shape, pen(rgb, 0.9), p.ours ? QBrush(colour(rgb)) : QBrush(Qt::white), 2.1 * units_per_mm));
}

struct Legend {
  std::vector<std::string> ours, peers;
  std::size_t index(bool own, const std::string& name) {
    std::vector<std::string>& names = own ? ours : peers;
    const auto at = std::find(names.begin(), names.end(), name);
    if (at != names.end()) return std::size_t(at - names.begin());
    names.push_back(name);
    return names.size() - 1;
  }
  Rgb colour_of(const Point& p) { return p.ours ? own_colours[index(true, p.name) % std::size(own_colours)] : faint; }
  QCPScatterStyle::ScatterShape shape_of(const Point& p) {
    return p.ours ? QCPScatterStyle::ssDisc : shapes[index(false, p.name) % std::size(shapes)];
  }
};

void draw_panel(Sheet& sheet, const std::string& name, std::size_t k, const std::vector<Point>& points,
                Legend& legend) {
  constexpr double width = 64, height = 48;
  const double x = 17 + double(k % 2) * 84, y = 9 + double(k / 2) * 66;
  QCPAxisRect* panel = sheet.panel(x, y, width, height);
  double least = HUGE_VAL, most = 0;
  for (const Point& p : points) least = std::min(least, p.error), most = std::max(most, p.error);
  logarithmic(panel->axis(QCPAxis::atBottom), 0.5, 1000, "time per vector (µs)");
  least = std::pow(10, std::floor(std::log10(least))), most = std::pow(10, std::ceil(std::log10(1.2 * most)));
  logarithmic(panel->axis(QCPAxis::atLeft), least, most, "error, rms (px)");
  sheet.text(x + width / 2, y - 5, qt(name), Qt::AlignHCenter | Qt::AlignTop, normal_text, true);
  const std::vector<Point> best = front(points);
  QVector<double> fx, fy;  // the front as stairs: what is possible right of and above it
  for (const Point& p : best) {
    if (!fy.isEmpty()) fx.push_back(p.microseconds), fy.push_back(fy.back());
    fx.push_back(p.microseconds), fy.push_back(p.error);
  }
  fx.push_back(1000), fy.push_back(fy.back());
  fx.push_front(fx.front()), fy.push_front(most);
  sheet.paint(panel, [=](QCPPainter& p) {  // a graph sorts by x: stairs are drawn by hand
    p.setPen(pen(ink, 0.6, Qt::DashLine));
    QPolygonF path;
    for (int n = 0; n < fx.size(); ++n) path << QPointF(x_of(panel, fx[n]), y_of(panel, fy[n]));
    p.drawPolyline(path);
  });
  for (const Point& p : points) mark(sheet, panel, p, legend.shape_of(p), legend.colour_of(p));
}

void draw_legend(Sheet& sheet, Legend& legend, double y) {
  double x = 14;
  const auto entry = [&](const Point& p) {
    const double wide = 6 + text_width(qt(p.name), small_text);
    if (x + wide > 166) x = 14, y += 5;
    const auto shape = legend.shape_of(p);
    const Rgb rgb = legend.colour_of(p);
    const double at = x;
    sheet.paint_over([=](QCPPainter& painter) {
      QCPScatterStyle style(shape, pen(rgb, 0.9), p.ours ? QBrush(colour(rgb)) : QBrush(Qt::white), 2.1 * units_per_mm);
      style.applyTo(&painter, pen(rgb, 0.9));
      style.drawShape(&painter, (at + 1.5) * units_per_mm, y * units_per_mm);
    });
    sheet.text(x + 4, y, qt(p.name), Qt::AlignLeft | Qt::AlignVCenter, small_text);
    x += wide + 3;
  };
  for (const std::string& name : std::vector<std::string>(legend.ours)) entry({name, 0, 0, true});
  x = 14, y += 5;
  for (const std::string& name : std::vector<std::string>(legend.peers)) entry({name, 0, 0, false});
  const char* notes[] = {
      "Dashed: the front; nothing is both quicker and more accurate. Coloured: pivnp, over valid "
      "vectors; grey: other programs,",
      "over all vectors they returned. One thread, the same images, 1024 x 1024 px.",
      "Noise and loss rows move evenly: what averages beyond its window gains there, and nowhere else."};
  for (const char* note : notes) sheet.text(14, y += 4.2, note, Qt::AlignLeft | Qt::AlignTop, small_text, false, faint);
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
    const Rows table = read(argv[1]), others = read(argv[2]);
    start_qt();
    Sheet sheet(170, 236);
    Legend legend;
    std::size_t drawn = 0;
    for (const char* panel : panels) {
      std::vector<Point> points = ours(table, panel);
      if (points.empty())
        throw std::runtime_error(std::string(argv[1]) + ": found no row '" + panel + "', expected it");
      for (const Point& p : peers(others, panel)) points.push_back(p);
      draw_panel(sheet, panel, drawn++, points, legend);
    }
    draw_legend(sheet, legend, 208);
    write(std::string(argv[3]) + ".svg", sheet.svg());
    write(std::string(argv[3]) + ".png", sheet.png(150));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "piv_chart: %s\n", e.what());
    return 2;
  }
  return 0;
}
