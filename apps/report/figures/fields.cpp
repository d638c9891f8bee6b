// Fields on particles, side by side at chosen times.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/content/fields.hpp"
#include "apps/report/content/selection.hpp"
#include "apps/report/figures/rows.hpp"
#include "apps/report/words/summary.hpp"
#include "apps/report/words/words.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/derived.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

// The two fields that every report draws have files of shorter names; all others bear the field's own.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> file_names = {
    {{"displacement_magnitude", "displacement"}, {"strain_dev", "deviatoric_strain"}}};

std::string file_name(const std::string& field) {
  for (const auto& [name, file] : file_names)
    if (name == field) return std::string(file);
  return field;
}

bool owns_fields(std::string_view figure) {
  const std::vector<DerivedField> fields = derived_fields();
  return std::any_of(fields.begin(), fields.end(),
                     [&](const DerivedField& f) { return f.name == figure || file_name(f.name) == figure; });
}

enum class Shown { measured, simulated, difference };

struct Cell {
  Shown shown;
  const FieldAtTime* at;  // where the particles are
  const std::vector<double>* value;
};

// Everything that a figure of one field shows, before it is laid out.
struct FieldFigure {
  std::string field, label;
  std::vector<FieldAtTime> measured, simulated;
  std::vector<std::vector<double>> difference;  // one a time, at the measured particles
  Scale scale, difference_scale;
  Box box;
  std::size_t ended = 0, flagged = 0, outside = 0;
};

Raster draw_cell(const Cell& cell, const Scale& scale, const Box& box, double width_mm) {
  const FieldAtTime& s = *cell.at;
  // Where a difference is shown, an ended particle is one of those without a partner.
  const Rgb ended_rgb = cell.shown == Shown::difference ? no_value : ended_colour;
  std::vector<Tile> tiles;
  tiles.reserve(s.position.size());
  for (const bool ended : {true, false})  // those no longer followed lie below
    for (std::size_t p = 0; p < s.position.size(); ++p) {
      if (s.status[p] == ParticleStatus::unborn || (s.status[p] == ParticleStatus::ended) != ended) continue;
      const double v = p < cell.value->size() ? (*cell.value)[p] : std::nan("");
      tiles.push_back({s.position[p], s.half_x[p], s.half_y[p], ended ? ended_rgb : scale.at(v)});
    }
  return draw_tiles(tiles, box, int(width_mm / 25.4 * 400));
}

FieldFigure gather(const FigureInput& input, const std::string& field) {
  const Content& content = input.content;
  FieldFigure f;
  f.field = field;
  f.label = derived_field(field).label;
  std::vector<double> values, differences;
  std::vector<const std::vector<Vec2>*> positions;
  const auto add = [&](const MotionSource& motion, std::vector<FieldAtTime>& list) {
    list = fields_at(motion, field, input.central, input.times);
    for (const FieldAtTime& s : list) {
      values.insert(values.end(), s.value.begin(), s.value.end());
      positions.push_back(&s.position);
      f.ended += std::size_t(std::count(s.status.begin(), s.status.end(), ParticleStatus::ended));
      f.flagged += std::size_t(std::count(s.status.begin(), s.status.end(), ParticleStatus::flagged));
    }
    positions.push_back(&motion.particles().x0);
  };
  if (content.measured) add(*content.measured, f.measured);
  if (content.simulated) add(*content.simulated, f.simulated);
  if (content.measured)
    for (std::size_t k = 0; k < input.times.size(); ++k) {
      f.difference.push_back(field_difference(content, field, input.times[k], f.measured[k]));
      differences.insert(differences.end(), f.difference.back().begin(), f.difference.back().end());
    }
  if (content.gauge && derived_field(field).strain) {
    differences.clear();  // that of the comparison is over the record's gauge, not over this one
    f.difference.clear();
  }
  if (!std::any_of(differences.begin(), differences.end(), [](double d) { return std::isfinite(d); }))
    f.difference.clear();
  f.scale = std::string_view(field).ends_with("_magnitude") ? scale_of_magnitude(values) : scale_for(values, false);
  f.difference_scale = scale_for(differences, true);
  // A simulation that reaches far beyond what was measured is shown where the two can be compared.
  const Metric* shared = content.comparison ? find(content.comparison->metrics, "coverage_second") : nullptr;
  if (shared != nullptr && shared->value < 0.7 && content.measured && content.simulated)
    positions.resize(f.measured.size() + 1);
  f.box = box_around(positions, 0.001);
  for (const auto* list : positions)
    f.outside += std::size_t(std::count_if(list->begin(), list->end(), [&](const Vec2& x) {
      return (x.array() < f.box.lower.array()).any() || (x.array() > f.box.upper.array()).any();
    }));
  return f;
}

constexpr double least_flow = 1e-3;  // over the greatest of all panels: less is drawn as rest

struct MeanFlow {
  Vec2 place = Vec2::Zero(), flow = Vec2::Zero();
};

// A motion's flow of water at a time, where the particles are: means over squares of that side.
std::vector<MeanFlow> mean_flow(const MotionSource& motion, const FieldAtTime& at, const Box& box, double side) {
  const std::optional<std::size_t> frame = frame_at(motion, at.time);
  const MotionFrame state = frame ? motion.frame(*frame) : MotionFrame{};
  const FieldValues* flow = state.find("water_flow");
  if (!flow || at.position.size() * 2 != flow->values.size()) return {};
  std::map<std::pair<int, int>, std::pair<MeanFlow, double>> squares;
  for (std::size_t p = 0; p < at.position.size(); ++p) {
    const Vec2 q(double(flow->values[2 * p]), double(flow->values[2 * p + 1]));
    if (at.status[p] != ParticleStatus::active || !q.allFinite() || !at.position[p].allFinite()) continue;
    const Vec2 from = (at.position[p] - box.lower) / side;
    auto& [sum, n] = squares[{int(std::floor(from.x())), int(std::floor(from.y()))}];
    sum.place += at.position[p];
    sum.flow += q;
    ++n;
  }
  std::vector<MeanFlow> means;
  for (const auto& [square, sum] : squares) means.push_back({sum.first.place / sum.second, sum.first.flow / sum.second});
  return means;
}

double greatest(const std::vector<MeanFlow>& means) {
  double most = 0;
  for (const MeanFlow& mean : means) most = std::max(most, mean.flow.norm());
  return most;
}

// Arrows, the longest as long as a square.
void draw_flow(Canvas& canvas, const Panel& panel, const std::vector<MeanFlow>& means, double side) {
  canvas.paint(panel, [panel, means, per = side / greatest(means)](Painter& p) {
    for (const MeanFlow& mean : means) {
      const Vec2 half = 0.5 * per * mean.flow;
      arrow(p, panel.at(mean.place - half), panel.at(mean.place + half), ink);
    }
  });
}

std::string heading(Shown shown, const DataSetNames& names) {
  if (shown == Shown::difference) return capitalised(names.second) + " \u2212 " + names.first;
  return capitalised(shown == Shown::measured ? names.first : names.second);
}

// `again`: a figure before says how they are drawn.
std::string caption(const FieldFigure& f, const std::vector<Shown>& columns, const FigureInput& input, bool again) {
  const DataSetNames& names = input.names;
  const bool compared = columns.size() == 3;
  std::string text = capitalised(f.label);
  if (columns.size() == 1) {
    text += " of the " + (columns[0] == Shown::measured ? names.first : names.second) + " motion.";
  } else {
    text += ", " + names.first + " and " + names.second + ", on one colour scale";
    text += compared ? "; right: " + names.difference() + ", at the " + names.first + " particles (blue: " +
                           names.the_second + " has less, red: more)."
                     : ".";
  }
  if (again) {
    text += " Otherwise as in the figure before.";
  } else {
    text += " Particles are drawn where they are at each time, as their deformed squares.";
    if (!input.content.alignment.empty()) text += " " + input.content.alignment;
    if (f.ended > 0) text += " Pale grey: particles no longer followed, at their last place.";
    if (compared) text += " Darker grey in the right column: no partner to compare with.";
    if (f.flagged > 0) text += " Flagged particles are shown like all others.";
  }
  if (f.scale.above || f.scale.below || (compared && (f.difference_scale.above || f.difference_scale.below)))
    text += " A pointed colour bar: the outermost 0.5 % of the values lie beyond its end.";
  if (f.outside > 0)
    text += " Outside the panels: " + count(f.outside, "place of a particle", "places of particles") + ".";
  if (input.content.gauge && derived_field(f.field).strain) {
    const DisplayUnit unit = display_unit(input.content.length_unit, *input.content.gauge);
    text += " Strains over circles of " + significant(*input.content.gauge * unit.factor, 3) + unit_suffix(unit.name) +
            ", fitted to the particles\u2019 displacements.";
  } else if (input.content.strain_note && input.content.measured && derived_field(f.field).strain) {
    text += " " + strain_statement(input.content);
  }
  return text;
}

Figure draw_field(const FigureInput& input, const std::string& field, bool again = false) {
  const Content& content = input.content;
  const FieldFigure f = gather(input, field);
  std::vector<Shown> columns;
  if (content.measured) columns.push_back(Shown::measured);
  if (content.simulated) columns.push_back(Shown::simulated);
  if (!f.difference.empty() && columns.size() == 2) columns.push_back(Shown::difference);

  // Cells in rows, a row a time; a single data set is laid out along the times instead.
  const bool along = columns.size() == 1;
  const std::size_t per_row = along ? std::min<std::size_t>(3, input.times.size()) : columns.size();
  std::vector<Cell> cells;
  for (std::size_t k = 0; k < input.times.size(); ++k)
    for (const Shown c : columns) {
      const FieldAtTime& s = c == Shown::simulated || f.measured.empty() ? f.simulated[k] : f.measured[k];
      cells.push_back({c, &s, c == Shown::difference ? &f.difference[k] : &s.value});
    }
  const std::size_t rows = (cells.size() + per_row - 1) / per_row;

  const double left = 14, right = 3, gap = 5, head = along ? 5 : 10, row_gap = 5.5, foot = 24;
  const double aspect = f.box.height() / f.box.width();
  double w = (figure_width_mm - left - right - gap * double(per_row - 1)) / double(per_row);
  w = std::min(w, 80.0);
  // Two such figures fit a page, where the panels do not become too small to read.
  const double between_rows = head + foot + row_gap * double(rows - 1), room = figure_height_mm - between_rows;
  w = std::min(w, room / double(rows) / aspect);
  w = std::min(w, std::max(36.0, (104 - between_rows) / double(rows) / aspect));
  const double h = w * aspect;
  const double used = left + double(per_row) * w + double(per_row - 1) * gap + right;
  const double x0 = left + std::max(0.0, (figure_width_mm - used) / 2);
  const double height = head + double(rows) * h + double(rows - 1) * row_gap + foot;
  auto canvas = std::make_shared<Canvas>(figure_width_mm, height);

  const auto x_at = [&](std::size_t column) { return x0 + double(column) * (w + gap); };
  const double side = f.box.width() * std::max(0.07, 5 / w);  // of squares, some 5 mm
  std::vector<std::vector<MeanFlow>> flows(cells.size());
  double flow = 0;
  for (std::size_t n = 0; n < cells.size(); ++n) {
    if (field == "pressure" && cells[n].shown != Shown::difference)
      flows[n] = mean_flow(cells[n].shown == Shown::measured ? *content.measured : *content.simulated, *cells[n].at, f.box, side);
    flow = std::max(flow, greatest(flows[n]));
  }
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const std::size_t row = n / per_row, column = n % per_row;
    const double x = x_at(column), y = head + double(row) * (h + row_gap);
    const bool last_row = n + per_row >= cells.size();
    const Panel panel = world_panel(*canvas, x, y, w, h, f.box, content.length_unit, last_row, column == 0);
    const Scale& scale = cells[n].shown == Shown::difference ? f.difference_scale : f.scale;
    const std::vector<Vec2>& places = cells[n].at->position;
    if (std::none_of(places.begin(), places.end(), [](const Vec2& place) { return place.allFinite(); }))
      canvas->text(x + w / 2, y + h / 2, "no data at this time", Align::centre, {.points = small_text, .rgb = faint});
    else {
      canvas->raster(panel, draw_cell(cells[n], scale, f.box, w));
      if (greatest(flows[n]) > least_flow * flow) draw_flow(*canvas, panel, flows[n], side);
    }
    const std::string letter(1, char('a' + int(n % 26)));
    canvas->text(x, y - 0.8, "(" + letter + ")", Align::bottom_left, {.bold = true});
    if (along || column == 0)
      canvas->text(x + 6, y - 0.8, "t = " + plain(cells[n].at->time) + unit_suffix(content.time_unit),
                   Align::bottom_left);
    if (row == 0 && !along)
      canvas->text(x + w / 2, 0.8, heading(cells[n].shown, input.names), Align::top,
                   {.points = normal_text + 0.5, .bold = true});
  }

  const std::string unit = field_unit(derived_field(field), content);
  const DisplayUnit shown = display_unit(unit, std::max(std::abs(f.scale.lower), std::abs(f.scale.upper)));
  const double y_bar = height - foot + 12;
  const std::size_t shared = along ? per_row : std::min<std::size_t>(2, columns.size());
  const double span = double(shared) * w + double(shared - 1) * gap, bar = std::min(span * 0.6, 80.0);
  colour_bar(*canvas, x0 + (span - bar) / 2, y_bar, bar, f.scale, shown.factor, axis_label(f.label, shown.name));
  if (columns.size() == 3) {
    const DisplayUnit other = display_unit(unit, f.difference_scale.upper);
    colour_bar(*canvas, x_at(2) + 0.1 * w, y_bar, 0.8 * w, f.difference_scale, other.factor,
               axis_label("difference", other.name));
  }
  std::string words = caption(f, columns, input, again);
  if (flow > 0)
    words += " Arrows: Darcy's flow of the water, means over squares, the longest of each panel as long as a square (none where it is "
             "less than a thousandth of the greatest); the greatest is " + significant(flow, 2) + unit_suffix(content.length_unit + "/" + content.time_unit) + ".";
  std::vector<ComparisonTable::Column> data;
  for (const Cell& cell : cells) {
    const std::string which = heading(cell.shown, input.names) + " at " + plain(cell.at->time) + unit_suffix(content.time_unit);
    std::array<std::vector<double>, 2> place;
    for (const Vec2& at : cell.at->position)
      for (const int a : {0, 1}) place[std::size_t(a)].push_back(at[a]);
    data.push_back({which + ", x", content.length_unit, std::move(place[0])});
    data.push_back({which + ", y", content.length_unit, std::move(place[1])});
    data.push_back({which + ", " + f.label, unit, *cell.value});
  }
  return {words, canvas, file_name(field), f.label + " on the particles at chosen times", std::move(data)};
}

std::vector<Figure> draw_fields(const FigureInput& input) {
  std::vector<Figure> all;
  for (const std::string& field : input.options.fields_drawn) {
    derived_field(field);  // an unknown one is told of even where nothing is drawn
    if (!input.times.empty()) all.push_back(draw_field(input, field, !all.empty()));
  }
  // Water in the pores, temperature and embedded bands belong to what every report draws.
  if (!input.times.empty() && input.options.fields_drawn == ReportOptions{}.fields_drawn && input.content.simulated &&
      !input.content.simulated->times().empty()) {
    const MotionFrame first = input.content.simulated->frame(0);
    for (const char* field : {"pressure", "excess_pressure", "temperature", "band_pressure", "band_temperature", "band_width"})
      if (first.find(field)) all.push_back(draw_field(input, field, !all.empty()));
  }
  return all;
}

constexpr std::string_view motion_figure = "motion";  // page one where nothing is compared

// The last time at which half of the particles that are followed longest are still there.
double last_shown(const Content& content) {
  const MotionSource& motion = content.measured ? *content.measured : *content.simulated;
  const std::vector<double>& times = motion.times();
  std::size_t most = 0, k = times.size();
  const auto followed = [&](std::size_t frame) {
    const std::vector<ParticleStatus> status = motion.frame(frame).status;
    return std::size_t(std::count_if(status.begin(), status.end(), [](ParticleStatus s) { return alive(s); }));
  };
  for (std::size_t step = std::max<std::size_t>(1, times.size() / 20), frame = 0; frame < times.size(); frame += step) most = std::max(most, followed(frame));
  while (k > 1 && 2 * followed(k - 1) < most) --k;
  return times[k - 1];
}

Figure draw_motion(const FigureInput& input) {
  FigureInput one = input;
  one.times = {last_shown(input.content)};
  Figure figure = draw_field(one, "displacement_magnitude");
  figure.name = motion_figure;
  figure.shows = "displacement on the particles";
  figure.caption = "Displacement at " + plain(one.times[0]) + unit_suffix(input.content.time_unit) + " on the particles where they are then" +
                   (input.content.measured && input.content.simulated ? ", " + input.names.first + " and " + input.names.second : std::string()) +
                   "; pale grey: no longer followed, at their last place.";
  return figure;
}

}  // namespace

// The picture that carries the verdict: displacement of both and their difference, where that is greatest; else the motion.
FigureRow summary_row() {
  return {.name = "verdict",
          .shows = "displacement of both data sets and their difference, at the time of the greatest difference",
          .section = Section::summary,
          .applies = [](const FigureInput& i) {
            if (!i.content.comparison)
              return (i.content.measured && !i.content.measured->times().empty()) ||
                     (!i.content.measured && i.content.simulated && !i.content.simulated->times().empty());
            return i.content.measured && i.content.simulated && std::isfinite(worst_of(i.content, i.differences).rms);
          },
          .draw = [](const FigureInput& i) -> std::vector<Figure> {
            if (!i.content.comparison) return {draw_motion(i)};
            FigureInput one = i;
            one.times = {worst_of(i.content, i.differences).time};
            Figure figure = draw_field(one, "displacement_magnitude");
            figure.name.clear();
            figure.shows.clear();
            figure.caption = "Displacement at " + plain(one.times[0]) + unit_suffix(i.content.time_unit) +
                             ", when the difference is largest: " + i.names.first + ", " + i.names.second + " and " +
                             i.names.difference() + " (blue: less, red: more). " + i.content.alignment;
            return {figure};
          },
          .owns = [](std::string_view figure) { return figure == "verdict" || figure == motion_figure; }};
}

FigureRow fields_row() {
  return {.name = "fields",
          .shows = "a field on the particles at chosen times",
          .section = Section::comparison,
          .applies = [](const FigureInput& i) { return i.content.measured || i.content.simulated; },
          .draw = draw_fields,
          .owns = owns_fields};
}

}  // namespace pivnp::report
