#include "apps/study/sweep/sweep_charts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>

#include "apps/plot/canvas.hpp"
#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/plot/raster.hpp"
#include "apps/plot/scale.hpp"
#include "apps/report/words/words.hpp"
#include "apps/study/sweep/responses.hpp"
#include "pivnp/core/particles/derived.hpp"

namespace pivnp::app {

namespace {

using plot::Axis;
using plot::Canvas;
using plot::Panel;

struct Look {
  plot::Rgb rgb;
  plot::Dash dash;
  plot::Key key;
  plot::Marker marker;
};
constexpr std::array<Look, 8> looks = {{{plot::ink, plot::Dash::solid, plot::Key::line, plot::Marker::disc},
                                        {plot::blue, plot::Dash::dashed, plot::Key::dashed, plot::Marker::square},
                                        {plot::vermilion, plot::Dash::solid, plot::Key::line, plot::Marker::triangle},
                                        {plot::green, plot::Dash::dotted, plot::Key::dotted, plot::Marker::diamond},
                                        {plot::purple, plot::Dash::dash_dot, plot::Key::dash_dot, plot::Marker::triangle_down},
                                        {plot::sky, plot::Dash::solid, plot::Key::line, plot::Marker::circle},
                                        {plot::orange, plot::Dash::dashed, plot::Key::dashed, plot::Marker::cross},
                                        {plot::faint, plot::Dash::solid, plot::Key::line, plot::Marker::plus}}};
constexpr double page_mm = 170;

double number_of(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return text.empty() || *end ? std::numeric_limits<double>::quiet_NaN() : value;
}

// In a chart: without quotation marks, and of a long list no more than its end.
std::string shown_value(const std::string& text) {
  constexpr std::size_t most = 16;
  if (text.size() > most && text.front() == '[') return "… " + text.substr(text.size() - most);
  return text.size() > 1 && text.front() == '"' ? text.substr(1, text.size() - 2) : text;
}

// Around the values, from zero where they are near it.
std::pair<double, double> span_of(const std::vector<double>& values) {
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  for (const double v : values)
    if (std::isfinite(v)) lower = std::min(lower, v), upper = std::max(upper, v);
  if (!(upper >= lower)) return {0, 1};
  if (lower > 0 && lower < 0.6 * upper) lower = 0;
  const double room = upper > lower ? 0.06 * (upper - lower) : std::max(1e-12, 0.1 * std::abs(upper));
  return {lower == 0 ? 0 : lower - room, upper + room};
}

// Legends in lines as wide as the page; gives the height that they take.
double legends(Canvas* canvas, double y, const std::vector<std::string>& words, std::size_t looks_from = 0) {
  double x = 16;
  for (std::size_t k = 0; k < words.size(); ++k) {
    const double wide = plot::text_width(words[k], plot::small_text) + 14;
    if (x > 16 && x + wide > page_mm) x = 16, y += 4;
    const Look& look = looks[(k + looks_from) % looks.size()];
    if (canvas) plot::legend(*canvas, x, y, look.key, look.rgb, words[k]);
    x += wide;
  }
  return y + 4;
}

std::string words_of(const SweepResponse& response) {
  std::string words = report::field_words(response.name);
  if (const std::size_t dot = words.find('.'); dot != std::string::npos) words.replace(dot, 1, ": ");
  return words;
}

std::string in_file_name(std::string key) {
  std::replace(key.begin(), key.end(), '.', '_');
  return key;
}

}  // namespace

bool numeric(const Variation& v) {
  return v.values.size() > 1 && std::all_of(v.values.begin(), v.values.end(), [](const std::string& t) { return std::isfinite(number_of(t)); });
}

std::vector<Swing> swings(std::size_t response, const std::vector<Variation>& variations, const std::vector<SweepRun>& runs) {
  std::vector<Swing> all;
  const double own = runs.front().responses[response];
  for (std::size_t v = 0; v < variations.size(); ++v) {
    Swing s{variations[v].name(), shown_value(variations[v].own), shown_value(variations[v].own), own, own, own};
    if (response < runs.front().uncertainties.size()) s.sigma = runs.front().uncertainties[response];
    for (const SweepRun& run : runs) {
      if (run.values[v].empty() || !std::isfinite(run.responses[response])) continue;
      const double value = run.responses[response];
      if (value < s.lower || !std::isfinite(s.lower)) s.lower = value, s.least = shown_value(run.values[v]);
      if (value > s.upper || !std::isfinite(s.upper)) s.upper = value, s.most = shown_value(run.values[v]);
    }
    if (std::isfinite(s.lower)) all.push_back(s);
  }
  std::stable_sort(all.begin(), all.end(), [](const Swing& a, const Swing& b) { return a.upper - a.lower > b.upper - b.lower; });
  return all;
}

std::pair<double, double> tornado_span(const std::vector<Swing>& all, double width_mm) {
  constexpr double beside_mm = 3;  // between a bar's end, its value and the axis
  std::vector<double> values;
  for (const Swing& s : all) values.insert(values.end(), {s.lower, s.upper, s.own - 2 * s.sigma, s.own + 2 * s.sigma});
  const auto [least, most] = span_of(values);
  double lower = least, upper = most;
  for (int pass = 0; pass < 20; ++pass) {  // what the words take grows with the span, by less than they are wide
    const double per_mm = (upper - lower) / width_mm;
    lower = least, upper = most;
    for (const Swing& s : all) {
      const auto room = [&](const std::string& words) {
        return per_mm * (beside_mm + std::min(0.4 * width_mm, plot::text_width(words, plot::small_text)));
      };
      if (!(s.lower >= s.own)) lower = std::min(lower, s.lower - room(s.least));
      if (!(s.upper <= s.own)) upper = std::max(upper, s.upper + room(s.most));
    }
  }
  return {lower, upper};
}

report::Figure tornado(const SweepResponse& response, const std::vector<Swing>& all) {
  constexpr double row_mm = 8, left = 62, top = 4;
  const double height = row_mm * double(all.size());
  auto canvas = std::make_shared<Canvas>(page_mm, top + height + 14);
  Panel panel = canvas->panel(left, top, page_mm - left - 8, height);
  const auto [lower, upper] = tornado_span(all, page_mm - left - 8);
  panel.axis(Axis::x, lower, upper, plot::axis_label(words_of(response), response.unit), 6);
  panel.axis(Axis::y, 0, double(all.size()), "");
  panel.ticks(Axis::y, false).numbers(Axis::y, false);
  for (std::size_t k = 0; k < all.size(); ++k)
    canvas->text(left - 2, top + row_mm * (double(k) + 0.5), all[k].key, plot::Align::right, {.points = plot::small_text});
  canvas->paint_over([=](plot::Painter& p) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Swing& s = all[k];
      const double y = double(all.size()) - double(k) - 0.5;
      const auto bar = [&](double from, double to, plot::Rgb rgb) {
        p.no_pen();
        p.fill({rgb});
        p.rectangle(plot::between(panel.at({from, y - 0.3}), panel.at({to, y + 0.3})));
      };
      const bool known = std::isfinite(s.own);  // reached in the case itself
      bar(s.lower, known ? s.own : s.upper, plot::sky);
      if (known) bar(s.own, s.upper, plot::orange);
      const auto value = [&](double at, const std::string& words, plot::Align align, double dx) {
        const Vec2 place = panel.at({at, y}) + Vec2(dx, 0);
        constexpr double wide = 300, high = 40;
        p.text({align == plot::Align::right ? place.x() - wide : place.x(), place.y() - high / 2, wide, high}, words, align, {.points = plot::small_text});
      };
      if (!(s.lower >= s.own)) value(s.lower, s.least, plot::Align::right, -8);
      if (!(s.upper <= s.own)) value(s.upper, s.most, plot::Align::left, 8);
    }
    if (all.empty() || !std::isfinite(all.front().own)) return;
    p.pen({plot::ink, 0.8});
    p.line(panel.at({all.front().own, 0}), panel.at({all.front().own, double(all.size())}));
    if (!std::isfinite(all.front().sigma)) return;
    p.pen({plot::ink, 0.5, plot::Dash::dashed});
    for (const double side : {-2.0, 2.0}) {
      const double at = all.front().own + side * all.front().sigma;
      p.line(panel.at({at, 0}), panel.at({at, double(all.size())}));
    }
  });
  report::Figure figure;
  figure.name = "tornado_" + in_file_name(response.name);
  figure.canvas = canvas;
  figure.caption = "Tornado chart: " + response.text + ". Each bar is the range over the values of one key, all others being the case's; at its ends the "
                   "value of the key. The line is the case itself" +
                   (all.empty() || !std::isfinite(all.front().sigma) ? std::string(".") : std::string("; broken lines: twice its standard uncertainty to both sides."));
  figure.shows = "How far " + words_of(response) + " goes with each key, the widest first.";
  return figure;
}

report::Figure curves(const SweepResponse& response, std::size_t index, std::size_t x, const std::vector<Variation>& variations, const std::vector<SweepRun>& runs) {
  // A curve for each combination of the other values, in the order of the runs.
  std::vector<std::string> names;
  std::map<std::string, std::vector<std::pair<double, double>>> points;
  std::vector<double> all_x, all_y;
  const bool single = std::none_of(runs.begin(), runs.end(), [](const SweepRun& r) { return r.label == "the case"; });
  for (const SweepRun& run : runs) {
    std::string name;
    bool others = false;
    for (std::size_t v = 0; v < variations.size(); ++v) {
      if (v == x || run.values[v].empty()) continue;
      others = true;
      name += (name.empty() ? "" : ", ") + variations[v].name().substr(variations[v].name().rfind('.') + 1) + " " + shown_value(run.values[v]);
    }
    if (!single && others) continue;  // one at a time: of this key alone
    const double at = number_of(run.values[x].empty() ? variations[x].own : run.values[x]), value = run.responses[index];
    if (!std::isfinite(at) || !std::isfinite(value)) continue;
    if (!points.contains(name)) names.push_back(name);
    points[name].emplace_back(at, value);
    all_x.push_back(at);
    all_y.push_back(value);
  }
  const double least = all_x.empty() ? 0 : *std::min_element(all_x.begin(), all_x.end()), most = all_x.empty() ? 1 : *std::max_element(all_x.begin(), all_x.end());
  const bool logarithmic = least > 0 && most >= 20 * least;
  const bool named = names.size() > 1 || (names.size() == 1 && !names[0].empty());
  const double top = 3 + (named ? legends(nullptr, 2, names) : 0);
  auto canvas = std::make_shared<Canvas>(page_mm, top + 68);
  if (named) legends(canvas.get(), 3, names);
  Panel panel = canvas->panel(16, top, page_mm - 20, 54);
  panel.pale_grid();
  const auto [lower, upper] = span_of(all_y);
  panel.axis(Axis::y, lower, upper, plot::axis_label(words_of(response), response.unit), 5);
  if (logarithmic) {
    panel.axis(Axis::x, least / 1.6, most * 1.6, variations[x].name());
    panel.logarithmic(Axis::x, least / 1.6, most * 1.6, 1).small_ticks(Axis::x);
  } else {
    const double room = 0.04 * std::max(most - least, 1e-12);
    panel.axis(Axis::x, least - room, most + room, variations[x].name(), 7);
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    auto& of = points[names[k]];
    std::sort(of.begin(), of.end());
    std::vector<double> xs, ys;
    for (const auto& [a, b] : of) xs.push_back(a), ys.push_back(b);
    const Look& look = looks[k % looks.size()];
    canvas->curve(panel, xs, ys, {look.rgb, 1.1, look.dash}, plot::Symbol{look.marker, {look.rgb, 0.9}, {look.rgb}, 1.6});
  }
  report::Figure figure;
  figure.name = in_file_name(response.name) + "_over_" + in_file_name(variations[x].name());
  figure.canvas = canvas;
  figure.caption = words_of(response) + ": " + response.text + ", over " + variations[x].name() + ".";
  figure.shows = words_of(response) + " over the values of a key.";
  return figure;
}

report::Figure histories(const std::string& name, const std::string& what, const std::vector<const SweepRun*>& shown) {
  std::vector<std::string> names;
  std::vector<double> times, distances, speeds, pressures;
  for (const SweepRun* run : shown) {
    names.push_back(run->label);
    times.insert(times.end(), run->times.begin(), run->times.end());
    distances.insert(distances.end(), run->distance.begin(), run->distance.end());
    speeds.insert(speeds.end(), run->speed.begin(), run->speed.end());
    for (const double p : run->pressure) pressures.push_back(p / 1e3);
  }
  const double top = 3 + legends(nullptr, 2, names);
  const bool wet = std::any_of(pressures.begin(), pressures.end(), [](double p) { return std::isfinite(p); });
  auto canvas = std::make_shared<Canvas>(page_mm, top + 66);
  legends(canvas.get(), 3, names);
  const double wide = wet ? 38 : 64;  // and half a number beside the last panel
  const auto draw = [&](double left, const std::vector<double> SweepRun::*of, double factor, const std::vector<double>& all, const std::string& label) {
    Panel panel = canvas->panel(left, top, wide, 52);
    panel.pale_grid();
    const auto [from, to] = span_of(times);
    const auto [lower, upper] = span_of(all);
    panel.axis(Axis::x, from, to, "time (s)", 6);
    panel.axis(Axis::y, lower, upper, label, 5);
    for (std::size_t k = 0; k < shown.size(); ++k) {
      const Look& look = looks[k % looks.size()];
      std::vector<double> values = shown[k]->*of;
      for (double& value : values) value *= factor;
      canvas->curve(panel, shown[k]->times, values, {look.rgb, 1.0, look.dash});
    }
  };
  draw(14, &SweepRun::distance, 1, distances, "displacement (m)");
  draw(wet ? 71 : 97, &SweepRun::speed, 1, speeds, "speed (m/s)");
  if (wet) draw(128, &SweepRun::pressure, 1e-3, pressures, "pore pressure (kPa)");
  report::Figure figure;
  figure.name = name;
  figure.canvas = canvas;
  figure.caption = what + ": mean displacement and speed of the zone" + (wet ? ", and its pore pressure (in bands, where there are any; else, with a level, over the hydrostatic one)," : "") + " against time.";
  figure.shows = wet ? "Displacement, speed and pore pressure of the zone against time." : "Displacement and speed of the zone against time.";
  return figure;
}

report::Figure mosaic(const std::string& field, const std::vector<const SweepRun*>& shown) {
  std::vector<LastField> fields;
  std::vector<double> all;
  plot::Box box{{1e300, 1e300}, {-1e300, -1e300}};
  for (const SweepRun* run : shown) {
    fields.push_back(last_field(run->folder / "record.h5", field));
    const LastField& f = fields.back();
    for (std::size_t k = 0; k < f.x.size(); ++k) {
      if (!std::isfinite(f.values[k])) continue;
      all.push_back(f.values[k]);
      box.lower = box.lower.cwiseMin(f.x[k]);
      box.upper = box.upper.cwiseMax(f.x[k]);
    }
  }
  const std::size_t columns =
      shown.size() > 1 || box.height() > 0.6 * box.width() ? 2 : 1;  // a flat one alone has the page's width
  const DerivedField meaning = derived_field(field);
  const std::string unit = meaning.unit == "L" ? "m" : meaning.unit == "L/T" ? "m/s" : meaning.unit;
  const plot::Scale scale = plot::scale_for(all, false);
  const plot::DisplayUnit display =
      plot::display_unit(unit, all.empty() ? 1.0 : std::max(std::abs(scale.lower), std::abs(scale.upper)));
  const double width = (page_mm - 6 * double(columns - 1)) / double(columns),
               height = box.width() > 0 ? width * box.height() / box.width() : width;
  const std::size_t rows = (shown.size() + columns - 1) / columns;
  auto canvas = std::make_shared<Canvas>(page_mm, double(rows) * (height + 6) + 15);
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const double x = double(k % columns) * (width + 6), y = double(k / columns) * (height + 6);
    std::vector<plot::Tile> tiles;
    for (std::size_t i = 0; i < fields[k].x.size(); ++i)
      if (std::isfinite(fields[k].values[i]))
        tiles.push_back({fields[k].x[i], {fields[k].half[i], 0}, {0, fields[k].half[i]}, scale.at(fields[k].values[i])});
    Panel panel = canvas->panel(x, y + 5, width, height);
    panel.axis(Axis::x, box.lower.x(), box.upper.x(), "").axis(Axis::y, box.lower.y(), box.upper.y(), "");
    panel.visible(Axis::x, false).visible(Axis::y, false);
    canvas->raster(panel, plot::draw_tiles(tiles, box, 1800 / int(columns)));
    canvas->text(x, y + 3.5, shown[k]->label, plot::Align::left, {.points = plot::small_text});
  }
  plot::colour_bar(*canvas, page_mm / 2 - 40, double(rows) * (height + 6) + 3, 80, scale, display.factor,
                   plot::axis_label(meaning.label.empty() ? meaning.name : meaning.label, display.name));
  report::Figure figure;
  figure.name = "final_" + field;
  figure.canvas = canvas;
  figure.caption = (meaning.label.empty() ? meaning.name : meaning.label) + " at the end of each run, on one scale.";
  figure.shows = "A field of all runs at their end.";
  return figure;
}

}  // namespace pivnp::app
