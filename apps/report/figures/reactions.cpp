// What boundaries, loads and bodies do to the material of the simulation, against time; and of bodies against their own path.
#include <algorithm>
#include <array>
#include <cmath>

#include "apps/plot/marks.hpp"
#include "apps/report/figures/rows.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

struct Style {
  Rgb rgb;
  Dash dash;
  Key key;
};
constexpr std::array<Style, 8> styles = {{{blue, Dash::solid, Key::line},
                                          {vermilion, Dash::solid, Key::line},
                                          {green, Dash::dashed, Key::dashed},
                                          {purple, Dash::dash_dot, Key::dash_dot},
                                          {orange, Dash::dashed, Key::dashed},
                                          {ink, Dash::dotted, Key::dotted},
                                          {blue, Dash::dotted, Key::dotted},
                                          {green, Dash::dash_dot, Key::dash_dot}}};

struct Curve {
  std::string words;
  std::vector<double> force;  // N/m
  std::vector<double> path;   // of a body, along which it went; empty for a boundary
};

double greatest(const std::vector<double>& values) {
  double most = 0;
  for (const double v : values)
    if (std::isfinite(v)) most = std::max(most, std::abs(v));
  return most;
}

std::vector<double> component(const std::vector<Vec2>& all, int axis) {
  std::vector<double> out;
  for (const Vec2& v : all) out.push_back(v[axis]);
  return out;
}

// The component that is the greater over the run.
Curve curve_of(const ReactionSeries& s) {
  const std::vector<double> x = component(s.force, 0), y = component(s.force, 1);
  const int axis = greatest(x) > greatest(y) ? 0 : 1;
  Curve out{s.name.substr(s.name.find('.') + 1) + (axis == 0 ? ", x" : ", y"), axis == 0 ? x : y, {}};
  if (s.displacement.empty()) return out;
  const std::vector<double> along = component(s.displacement, axis);
  if (greatest(along) > 0) out.path = along;
  return out;
}

std::vector<double> times(const std::vector<double>& values, double factor) {
  std::vector<double> out;
  for (const double v : values) out.push_back(factor * v);
  return out;
}

std::vector<Figure> draw_reactions(const FigureInput& input) {
  const Reactions& reactions = input.content.reactions;
  std::vector<Curve> curves;
  for (const ReactionSeries& s : reactions.series) curves.push_back(curve_of(s));
  std::stable_sort(curves.begin(), curves.end(), [](const Curve& a, const Curve& b) { return greatest(a.force) > greatest(b.force); });
  const std::size_t all = curves.size();
  curves.resize(std::min(all, styles.size()));
  double low = 0, high = 0;
  for (const Curve& c : curves)
    for (const double f : c.force)
      if (std::isfinite(f)) low = std::min(low, f), high = std::max(high, f);
  const double size = std::max(high, -low), unit = size >= 2000 ? 1e-3 : 1, margin = high > low ? 0.05 * (high - low) : 1;
  const bool per_radian = input.content.per_radian;
  const std::string force_unit = per_radian ? "N/rad" : "N/m", label = std::string(unit < 1 ? "force (k" : "force (") + force_unit + ")";
  const bool paths = std::any_of(curves.begin(), curves.end(), [](const Curve& c) { return !c.path.empty(); });

  // Half a page wide where there is no second panel; the keys then stand above.
  const double keys = paths ? 0 : std::ceil(double(curves.size()) / 2) * 4.5;
  const double height = paths ? 46 : 44, x = 17, w = paths ? 52 : 62, top = paths ? 5 : keys + 3;
  auto canvas = std::make_shared<Canvas>(paths ? figure_width_mm : half_figure_mm, top + height + 12);
  Panel left = canvas->panel(x, top, w, height);
  left.pale_grid().axis(Axis::x, reactions.time.front(), reactions.time.back(), axis_label("time", input.content.time_unit), 4);
  left.axis(Axis::y, unit * (low - (low < 0 ? margin : 0)), unit * (high + (high > 0 ? margin : 0)), label, 5);
  for (std::size_t k = 0; k < curves.size(); ++k) {
    canvas->curve(left, reactions.time, times(curves[k].force, unit), {styles[k].rgb, 1.2, styles[k].dash});
    const double column = k % 2 == 0 ? 0 : 33;
    if (paths) legend(*canvas, x + 2 * w + 17, 9 + 5 * double(k), styles[k].key, styles[k].rgb, curves[k].words);
    else legend(*canvas, x + column, 2.5 + 4.5 * double(k / 2), styles[k].key, styles[k].rgb, curves[k].words);
  }
  std::string caption = "Forces on the material, per " + std::string(per_radian ? "radian" : "metre of thickness") +
                        ", mean between output times: of each boundary and body the component that is the greater";
  if (paths) {
    double from = 0, to = 0;
    for (const Curve& c : curves)
      for (const double d : c.path) from = std::min(from, d), to = std::max(to, d);
    Panel right = canvas->panel(x + w + 12, 5, w, height);
    right.pale_grid().axis(Axis::x, from, to, axis_label("displacement", input.content.length_unit), 4);
    right.axis(Axis::y, left.lower(Axis::y), unit * (high + (high > 0 ? margin : 0)), "", 5).numbers(Axis::y, false);
    for (std::size_t k = 0; k < curves.size(); ++k)
      if (!curves[k].path.empty()) canvas->curve(right, curves[k].path, times(curves[k].force, unit), {styles[k].rgb, 1.2, styles[k].dash});
    canvas->text(x - 15, 2, "(a)", Align::top_left, {.bold = true});
    canvas->text(x + w + 5, 2, "(b)", Align::top_left, {.bold = true});
    caption += ", (a) against time, (b) of bodies that move against their displacement along it";
  }
  if (all > curves.size()) caption += "; the " + std::to_string(curves.size()) + " greatest of " + std::to_string(all);
  const std::string& length = input.content.length_unit;
  std::vector<ComparisonTable::Column> data{{"time", input.content.time_unit, reactions.time}};
  for (const ReactionSeries& s : reactions.series) {
    data.push_back({s.name + " force x", force_unit, component(s.force, 0)});
    data.push_back({s.name + " force y", force_unit, component(s.force, 1)});
    data.push_back({s.name + " moment", per_radian ? "N m/rad" : "N", s.moment});
    if (s.displacement.empty()) continue;
    data.push_back({s.name + " displacement x", length, component(s.displacement, 0)});
    data.push_back({s.name + " displacement y", length, component(s.displacement, 1)});
    data.push_back({s.name + " turn", "rad", s.turn});
  }
  return {{caption + ".", canvas, {}, {}, std::move(data)}};
}

}  // namespace

FigureRow reactions_row() {
  return {.name = "reactions",
          .shows = "forces of boundaries, loads and bodies on the simulated material",
          .section = Section::simulation,
          .applies =
              [](const FigureInput& i) {
                const auto& all = i.content.reactions.series;
                return i.content.reactions.time.size() >= 3 &&
                       std::any_of(all.begin(), all.end(), [](const ReactionSeries& s) { return greatest(curve_of(s).force) > 0; });
              },
          .draw = draw_reactions};
}

}  // namespace pivnp::report
