// The energy balance of the simulation.
#include <algorithm>
#include <array>
#include <cmath>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/figures/rows.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

struct Term {
  const char* words;
  double EnergyRow::*value;
  Rgb rgb;
  Dash dash;
  Key key;
};
constexpr std::array<Term, 8> terms = {
    {{"kinetic", &EnergyRow::kinetic, blue, Dash::solid, Key::line},
     {"elastic", &EnergyRow::elastic, green, Dash::dashed, Key::dashed},
     {"plastic dissipation", &EnergyRow::plastic, vermilion, Dash::solid, Key::line},
     {"damping", &EnergyRow::damping, purple, Dash::dash_dot, Key::dash_dot},
     {"friction at contacts", &EnergyRow::contact, orange, Dash::dashed, Key::dashed},
     {"water, elastic", &EnergyRow::water, blue, Dash::dotted, Key::dotted},
     {"Darcy dissipation", &EnergyRow::darcy, green, Dash::dash_dot, Key::dash_dot},
     {"external work", &EnergyRow::external, ink, Dash::dotted, Key::dotted}}};

std::vector<double> column(const std::vector<EnergyRow>& rows, double EnergyRow::*value) {
  std::vector<double> out;
  for (const EnergyRow& row : rows) out.push_back(row.*value);
  return out;
}

std::vector<Figure> draw_energy(const FigureInput& input) {
  const std::vector<EnergyRow>& rows = input.content.energy;
  const std::vector<double> time = column(rows, &EnergyRow::time);
  double low = 0, high = 0;
  for (const Term& t : terms)
    for (const double v : column(rows, t.value))
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  const double size = std::max(high, -low), share = size > 0 ? 100 / size : 0;
  const auto stays_zero = [&](const Term& t) {
    const std::vector<double> value = column(rows, t.value);
    return std::all_of(value.begin(), value.end(), [&](double v) { return !(std::abs(v) > 1e-6 * size); });
  };
  const std::string unit = input.content.per_radian ? "J/rad" : "J/m";
  const double keys = std::ceil(double(std::count_if(terms.begin(), terms.end(), [&](const Term& t) { return !stays_zero(t); })) / 2) * 4.5;
  const double x = 17, w = 62, margin = high > low ? 0.04 * (high - low) : 1, top = keys + 3;
  auto canvas = std::make_shared<Canvas>(half_figure_mm, top + 65);
  Panel upper = canvas->panel(x, top, w, 30), lower = canvas->panel(x, top + 35, w, 19);
  upper.pale_grid().axis(Axis::x, time.front(), time.back(), "", 4).numbers(Axis::x, false);
  lower.pale_grid().axis(Axis::x, time.front(), time.back(), axis_label("time", input.content.time_unit), 4);
  upper.axis(Axis::y, low - (low < 0 ? margin : 0), high + margin, "energy (" + unit + ")", 5);
  std::vector<double> residual = column(rows, &EnergyRow::residual);
  double least = 0, most = 0;
  for (double& r : residual) {
    r *= share;
    if (std::isfinite(r)) least = std::min(least, r), most = std::max(most, r);
  }
  const double spread = most > least ? 0.15 * (most - least) : 1;
  lower.axis(Axis::y, least - spread, most + spread, "residual (%)", 3);
  std::size_t key = 0;
  for (const Term& t : terms) {
    if (stays_zero(t)) continue;
    canvas->curve(upper, time, column(rows, t.value), {t.rgb, 1.2, t.dash});
    legend(*canvas, x + (key % 2 == 0 ? 0 : 33), 2.5 + 4.5 * double(key / 2), t.key, t.rgb, t.words);
    ++key;
  }
  canvas->curve(lower, time, residual, {ink, 1.1});
  canvas->text(x - 15, top - 3, "(a)", Align::top_left, {.bold = true});
  canvas->text(x - 15, top + 32, "(b)", Align::top_left, {.bold = true});
  std::vector<ComparisonTable::Column> data{{"time", input.content.time_unit, time}};
  for (const Term& t : terms) data.push_back({t.words, unit, column(rows, t.value)});
  data.push_back({"residual", unit, column(rows, &EnergyRow::residual)});
  const double at_end = residual.back();
  return {{"Energy of the simulation, per " + std::string(input.content.per_radian ? "radian" : "metre of thickness") + ": (a) its terms (those that stay zero are left out); (b) the "
           "residual, what the scheme gained (+) or lost (\u2212), in per cent of the largest term; at the end " +
               (std::isfinite(at_end) ? significant(at_end, 2) + " %." : std::string("not known.")),
           canvas, {}, {}, std::move(data)}};
}

}  // namespace

FigureRow energy_row() {
  return {.name = "energy",
          .shows = "energy balance of the simulation",
          .section = Section::simulation,
          .applies = [](const FigureInput& i) { return i.content.energy.size() >= 2; },
          .draw = draw_energy};
}

}  // namespace pivnp::report
