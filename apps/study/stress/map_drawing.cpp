#include "apps/study/stress/map_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "apps/plot/palette.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr plot::Rgb good_colour = plot::sky, fair_colour = 0xcfe6f5, flagged_colour = 0xd6d6d6, wrong_colour = plot::vermilion;
constexpr double row_mm = 7.5, line_mm = 4, below_mm = 10;

// Where a value lies between the levels, counted in levels: the middle of the first is .5. Linear where levels hold 0, else logarithmic.
double place_on(const MapAxis& axis, double value) {
  if (axis.levels.empty()) return value + 0.5;
  const std::vector<double>& v = axis.levels;
  const bool logarithmic = v.front() > 0;
  std::size_t k = std::size_t(std::upper_bound(v.begin(), v.end(), value) - v.begin());
  k = std::clamp<std::size_t>(k, 1, v.size() - 1);
  const auto scale = [&](double x) { return logarithmic ? std::log(x) : x; };
  return double(k) - 0.5 + (scale(value) - scale(v[k - 1])) / (scale(v[k]) - scale(v[k - 1]));
}

bool ours(const Survival& s) { return s.all() > 0 && s.good >= ours_share * s.all(); }

// The cells, in millimetres of a canvas.
class MapDrawing {
 public:
  MapDrawing(const SurvivalMap& map, double left, double top, double width)
      : map_(map), label_(left + 2.5), left_(left + (map.y.names.empty() ? 18 : 30)), top_(top), width_(left + width - left_ - 3), height_(row_mm * double(map.y.size())) {}

  void draw(plot::Canvas& canvas) const {
    canvas.paint_over([self = *this](plot::Painter& p) {
      self.cells(p);
      self.theory(p);
      self.own_limit(p);
    });
    for (std::size_t i = 0; i < map_.x.size(); ++i)
      canvas.text(x(double(i) + 0.5), top_ + height_ + 1, level_text(map_.x, i), plot::Align::top, {.points = plot::small_text});
    for (std::size_t j = 0; j < map_.y.size(); ++j)
      canvas.text(left_ - 1.2, y(double(j) + 0.5), level_text(map_.y, j), plot::Align::right, {.points = plot::small_text});
    canvas.text(left_ + width_ / 2, top_ + height_ + 5, map_.x.label, plot::Align::top);
    canvas.text(label_, top_ + height_ / 2, map_.y.label, plot::Align::centre, {.angle_deg = -90});
    for (std::size_t k = 0; k < map_.theory.size(); ++k) {
      const double at = left_ + 1, y_mm = top_ + height_ + below_mm + 2 + line_mm * double(k);
      canvas.paint_over([at, y_mm, k](plot::Painter& p) {
        p.pen(theory_pen(k));
        p.line({(at - 1) * plot::units_per_mm, y_mm * plot::units_per_mm}, {(at + 5) * plot::units_per_mm, y_mm * plot::units_per_mm});
      });
      canvas.text(at + 7, y_mm, map_.theory[k].name, plot::Align::left, {.points = plot::small_text});
    }
  }

 private:
  double x(double level) const { return left_ + width_ * level / double(map_.x.size()); }
  double y(double level) const { return top_ + height_ * (1 - level / double(map_.y.size())); }
  Vec2 at(double across, double up) const { return {x(across) * plot::units_per_mm, y(up) * plot::units_per_mm}; }
  static plot::Pen theory_pen(std::size_t k) { return {plot::ink, 0.9, k == 0 ? plot::Dash::dashed : plot::Dash::dotted}; }

  void cells(plot::Painter& p) const {
    constexpr double mm = plot::units_per_mm, gap = 0.25;
    p.no_pen();
    for (std::size_t j = 0; j < map_.y.size(); ++j)
      for (std::size_t i = 0; i < map_.x.size(); ++i) {
        const Survival& s = map_.at(i, j);
        const double high = y(double(j)) - y(double(j) + 1) - 2 * gap;
        double bottom = y(double(j)) - gap;
        for (const auto& [count, colour] : {std::pair(s.wrong, wrong_colour), std::pair(s.flagged, flagged_colour), std::pair(s.fair, fair_colour),
                                            std::pair(s.good, good_colour)}) {
          const double part = s.all() > 0 ? high * count / s.all() : 0;
          p.fill({colour});
          p.rectangle({(x(double(i)) + gap) * mm, (bottom - part) * mm, (x(double(i) + 1) - x(double(i)) - 2 * gap) * mm, part * mm});
          bottom -= part;
        }
      }
  }

  void theory(plot::Painter& p) const {
    for (std::size_t k = 0; k < map_.theory.size(); ++k) {
      p.pen(theory_pen(k));
      std::vector<Vec2> path;
      for (const Vec2& point : map_.theory[k].points) {
        const double across = place_on(map_.x, point.x()), up = place_on(map_.y, point.y());
        if (across < 0 || across > double(map_.x.size())) continue;
        path.push_back(at(across, std::clamp(up, 0.0, double(map_.y.size()))));
      }
      if (path.size() == 2 && path[0].x() == path[1].x()) {  // a level of x: through the whole map
        path[0].y() = y(0) * plot::units_per_mm;
        path[1].y() = y(double(map_.y.size())) * plot::units_per_mm;
      }
      if (path.size() > 1) p.polyline(path);
    }
  }

  // Between combinations that are ours and their neighbours that are not.
  void own_limit(plot::Painter& p) const {
    p.pen({plot::ink, 1.6});
    for (std::size_t j = 0; j < map_.y.size(); ++j)
      for (std::size_t i = 0; i < map_.x.size(); ++i) {
        const bool here = ours(map_.at(i, j));
        const double across = double(i), up = double(j);
        if (i + 1 < map_.x.size() && here != ours(map_.at(i + 1, j))) p.line(at(across + 1, up), at(across + 1, up + 1));
        if (j + 1 < map_.y.size() && here != ours(map_.at(i, j + 1))) p.line(at(across, up + 1), at(across + 1, up + 1));
      }
  }

  const SurvivalMap& map_;
  double label_, left_, top_, width_, height_;
};

}  // namespace

std::string level_text(const MapAxis& axis, std::size_t k) { return axis.names.empty() ? number(axis.levels[k], 3) : axis.names[k]; }

double drawn_height_mm(const SurvivalMap& map) { return row_mm * double(map.y.size()) + below_mm + (map.theory.empty() ? 0 : 2 + line_mm * double(map.theory.size())); }

void draw_map(plot::Canvas& canvas, const SurvivalMap& map, double left_mm, double top_mm, double width_mm) {
  MapDrawing(map, left_mm, top_mm, width_mm).draw(canvas);
}

double draw_legend(plot::Canvas& canvas, double left_mm, double top_mm) {
  constexpr double mm = plot::units_per_mm;
  double at = left_mm;
  const double y_mm = top_mm + 2;
  const auto words = [&](const std::string& text, double after) {
    canvas.text(at + after, y_mm, text, plot::Align::left, {.points = plot::small_text});
    at += after + plot::text_width(text, plot::small_text) + 5;
  };
  for (const auto& [text, colour] : {std::pair("right", good_colour), std::pair("between", fair_colour), std::pair("flagged", flagged_colour),
                                     std::pair("wrong, not flagged", wrong_colour)}) {
    canvas.paint_over([at, y_mm, colour = colour](plot::Painter& p) {
      p.no_pen();
      p.fill({colour});
      p.rectangle({at * mm, (y_mm - 1.3) * mm, 2.6 * mm, 2.6 * mm});
    });
    words(text, 4);
  }
  canvas.paint_over([at, y_mm](plot::Painter& p) {
    p.pen({plot::ink, 1.6});
    p.line({at * mm, y_mm * mm}, {(at + 5) * mm, y_mm * mm});
  });
  words("our limit: nine tenths right", 6.5);
  return 5;
}

}  // namespace pivnp::app
