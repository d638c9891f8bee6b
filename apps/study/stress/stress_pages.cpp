#include "apps/study/stress/stress_pages.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "apps/plot/canvas.hpp"
#include "apps/plot/palette.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr plot::Rgb good_colour = plot::sky, fair_colour = 0xcfe6f5, flagged_colour = 0xd6d6d6, wrong_colour = plot::vermilion;

std::string level_text(const MapAxis& axis, std::size_t k) { return axis.names.empty() ? number(axis.levels[k], 3) : axis.names[k]; }

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

// A map with the shares of each combination one over the other, and theory's lines.
class MapDrawing {
 public:
  MapDrawing(const SurvivalMap& map, double width, double height)
      : map_(map), left_(map.y.names.empty() ? 18 : 30), width_(width - left_ - 3), top_(3), height_(height - top_ - (map.theory.empty() ? 17 : 21)) {}

  void draw(plot::Canvas& canvas) const {
    canvas.paint_over([self = *this](plot::Painter& p) { self.cells(p); });
    for (std::size_t i = 0; i < map_.x.size(); ++i)
      canvas.text(x(double(i) + 0.5), top_ + height_ + 1, level_text(map_.x, i), plot::Align::top, {.points = plot::small_text});
    for (std::size_t j = 0; j < map_.y.size(); ++j)
      canvas.text(left_ - 1.2, y(double(j) + 0.5), level_text(map_.y, j), plot::Align::right, {.points = plot::small_text});
    canvas.text(left_ + width_ / 2, top_ + height_ + 5, map_.x.label, plot::Align::top);
    canvas.text(2.5, top_ + height_ / 2, map_.y.label, plot::Align::centre, {.angle_deg = -90});
    legend(canvas);
  }

 private:
  double x(double level) const { return left_ + width_ * level / double(map_.x.size()); }
  double y(double level) const { return top_ + height_ * (1 - level / double(map_.y.size())); }

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
    for (std::size_t k = 0; k < map_.theory.size(); ++k) {
      p.pen({plot::ink, 0.9, k == 0 ? plot::Dash::dashed : plot::Dash::dotted});
      std::vector<Vec2> path;
      for (const Vec2& at : map_.theory[k].points) {
        const double across = place_on(map_.x, at.x()), up = place_on(map_.y, at.y());
        if (across < 0 || across > double(map_.x.size())) continue;
        path.push_back({x(across) * mm, y(std::clamp(up, 0.0, double(map_.y.size()))) * mm});
      }
      if (path.size() > 1) p.polyline(path);
    }
  }

  void legend(plot::Canvas& canvas) const {
    double at = left_;
    double y_mm = top_ + height_ + 12.5;
    const auto words = [&](const std::string& text) {
      canvas.text(at + 4, y_mm, text, plot::Align::left, {.points = plot::small_text});
      at += 4 + plot::text_width(text, plot::small_text) + 5;
    };
    for (const auto& [text, colour] : {std::pair("right", good_colour), std::pair("between", fair_colour), std::pair("flagged", flagged_colour),
                                       std::pair("wrong, not flagged", wrong_colour)}) {
      canvas.paint_over([at, y_mm, colour = colour](plot::Painter& p) {
        p.no_pen();
        p.fill({colour});
        p.rectangle({at * plot::units_per_mm, (y_mm - 1.3) * plot::units_per_mm, 2.6 * plot::units_per_mm, 2.6 * plot::units_per_mm});
      });
      words(text);
    }
    at = left_ + 1;
    y_mm += 4;
    for (std::size_t k = 0; k < map_.theory.size(); ++k) {
      canvas.paint_over([at, y_mm, k](plot::Painter& p) {
        p.pen({plot::ink, 0.9, k == 0 ? plot::Dash::dashed : plot::Dash::dotted});
        p.line({(at - 1) * plot::units_per_mm, y_mm * plot::units_per_mm}, {(at + 3) * plot::units_per_mm, y_mm * plot::units_per_mm});
      });
      words(map_.theory[k].name);
    }
  }

  const SurvivalMap& map_;
  double left_, width_, top_, height_;
};

std::string percent(double part, double all) { return number(all > 0 ? 100 * part / all : 0, 3) + " %"; }

double wrong_share(const Survival& s) { return s.all() > 0 ? s.wrong / s.all() : 0; }

std::string map_sentence(const SurvivalMap& map) {
  const Survival s = map.total();
  std::string text = map.title + ": " + percent(s.good, s.all()) + " right, " + percent(s.fair, s.all()) + " between, " + percent(s.flagged, s.all()) + " flagged, " +
                     percent(s.wrong, s.all()) + " wrong and not flagged";
  std::size_t worst = 0;
  for (std::size_t k = 1; k < map.cells.size(); ++k)
    if (wrong_share(map.cells[k]) > wrong_share(map.cells[worst])) worst = k;
  if (map.cells[worst].wrong > 0)
    text += "; most of that at " + map.x.label + " " + level_text(map.x, worst % map.x.size()) + ", " + map.y.label + " " + level_text(map.y, worst / map.x.size()) + " (" +
            percent(map.cells[worst].wrong, map.cells[worst].all()) + ")";
  return text + ".";
}

}  // namespace

std::string flags_sentence(const Survival& s) {
  const std::string wrong = s.wrong_values > 0 ? "of what is wrong, " + percent(s.wrong_flagged, s.wrong_values) + " is flagged" : "nothing has a wrong value";
  const std::string right = s.right_values > 0 ? "of what is right, " + percent(s.right_flagged, s.right_values) + " is flagged" : "nothing has a right value";
  return wrong + "; " + right + ".";
}

Survival total_of(const std::vector<SurvivalMap>& maps, const std::string& stage) {
  Survival sum;
  for (const SurvivalMap& map : maps)
    if (map.name.starts_with(stage + "_")) sum.add(map.total());
  return sum;
}

report::Document stress_document(const std::vector<SurvivalMap>& maps, const std::string& subject) {
  constexpr double width = 170;
  report::Document document;
  document.title = "Where it holds, and where it fails: " + subject;
  document.subtitle = "A result that is wrong and not flagged is the defect to look for.";
  std::string lead;
  for (const auto& [stage, words] : {std::pair("piv", "Image correlation"), std::pair("np", "Particles"), std::pair("mpm", "Simulation")}) {
    const Survival s = total_of(maps, stage);
    if (s.all() > 0) lead += (lead.empty() ? "" : " ") + std::string(words) + ", over all maps: " + flags_sentence(s);
  }
  if (const Survival s = total_of(maps, "compare"); s.all() > 0)
    lead += (lead.empty() ? "" : " ") + ("Comparison, over all maps: " + percent(s.wrong, s.all())) + " of its verdicts are wrong, and " + percent(s.flagged, s.all()) + " are withheld or doubted.";
  document.blocks.push_back(report::Paragraph{lead, true});
  for (const SurvivalMap& map : maps) {
    document.blocks.push_back(report::Heading{1, map.title});
    const double height = (map.theory.empty() ? 20 : 24) + 7.5 * double(map.y.size());
    auto canvas = std::make_shared<plot::Canvas>(width, height);
    MapDrawing(map, width, height).draw(*canvas);
    report::Figure figure;
    figure.name = map.name;
    figure.canvas = canvas;
    figure.caption = map_sentence(map) + " " + map.made_of + (map.theory.empty() ? "" : " Lines: what theory expects.");
    figure.shows = "Shares of right, doubtful, flagged and silently wrong results over " + map.x.label + " and " + map.y.label + ".";
    document.blocks.push_back(std::move(figure));
  }
  return document;
}

}  // namespace pivnp::app
