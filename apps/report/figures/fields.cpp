// Fields on particles, side by side at chosen times.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "apps/plot/numbers.hpp"
#include "apps/plot/parts.hpp"
#include "apps/report/figures/figures.hpp"
#include "apps/report/words/data_sets.hpp"
#include "apps/report/words/words.hpp"
#include "pivnp/core/particles/derived.hpp"

namespace pivnp::report {

namespace {

enum class Column { measured, simulated, difference };

struct Cell {
  Column column;
  const Snapshot* snapshot;  // where the particles are
  const std::vector<double>* value;
  double time;
};

// Everything a field figure shows, before it is laid out.
struct Fields {
  std::vector<Snapshot> measured, simulated;
  std::vector<std::vector<double>> difference;  // one a time, at the measured particles
  Scale scale, difference_scale;
  Box box;
  std::size_t ended = 0, doubtful = 0, outside = 0;
};

QImage draw_cell(const Cell& cell, const Scale& scale, const Box& box, double width_mm) {
  const Snapshot& s = *cell.snapshot;
  // Where a difference is shown, an ended particle is one of those without a partner.
  const Rgb ended_rgb = cell.column == Column::difference ? no_value : ended_colour;
  std::vector<Tile> tiles;
  tiles.reserve(s.position.size());
  for (const bool ended : {true, false})  // those no longer followed lie below
    for (std::size_t p = 0; p < s.position.size(); ++p) {
      if (s.status[p] == ParticleStatus::unborn || (s.status[p] == ParticleStatus::ended) != ended) continue;
      const double v = p < cell.value->size() ? (*cell.value)[p] : std::nan("");
      tiles.push_back({s.position[p], s.half_x[p], s.half_y[p], ended ? ended_rgb : scale.at(v)});
    }
  return to_image(draw_tiles(tiles, box, int(width_mm / 25.4 * 400)));
}

Fields gather(const Content& content, const std::string& field, const std::vector<double>& times, bool central) {
  Fields f;
  std::vector<double> values, differences;
  std::vector<const std::vector<Vec2>*> positions;
  auto add = [&](const MotionSource& motion, std::vector<Snapshot>& list) {
    list = snapshots(motion, field, central, times);
    for (const Snapshot& s : list) {
      values.insert(values.end(), s.value.begin(), s.value.end());
      positions.push_back(&s.position);
      f.ended += std::size_t(std::count(s.status.begin(), s.status.end(), ParticleStatus::ended));
      f.doubtful += std::size_t(std::count(s.status.begin(), s.status.end(), ParticleStatus::flagged));
    }
    positions.push_back(&motion.particles().x0);
  };
  if (content.measured) add(*content.measured, f.measured);
  if (content.simulated) add(*content.simulated, f.simulated);
  if (content.measured)
    for (std::size_t k = 0; k < times.size(); ++k) {
      f.difference.push_back(field_difference(content, field, times[k], f.measured[k]));
      differences.insert(differences.end(), f.difference.back().begin(), f.difference.back().end());
    }
  if (!std::any_of(differences.begin(), differences.end(), [](double d) { return std::isfinite(d); }))
    f.difference.clear();
  f.scale = scale_for(values, false);
  f.difference_scale = scale_for(differences, true);
  f.box = box_around(positions, 0.001);
  for (const auto* list : positions)
    f.outside += std::size_t(std::count_if(list->begin(), list->end(), [&](const Vec2& x) {
      return (x.array() < f.box.lower.array()).any() || (x.array() > f.box.upper.array()).any();
    }));
  return f;
}

std::string column_words(Column c) {
  return c == Column::measured ? "Measured" : c == Column::simulated ? "Simulated" : "Simulated \u2212 measured";
}

std::string figure_name(const std::string& field) {
  return field == "displacement_magnitude" ? "displacement" : field == "strain_dev" ? "deviatoric_strain" : field;
}

std::string unit_of(const std::string& field, const Content& content) {
  const std::string unit = derived_field(field).unit;
  std::string out;
  for (char c : unit) out += c == 'L' ? content.length_unit : c == 'T' ? content.time_unit : std::string(1, c);
  if (out.ends_with("^2")) out.replace(out.size() - 2, 2, "\u00b2");
  return out == "1" ? "" : out;
}

std::string caption(const Fields& f, const std::string& field, std::size_t columns, const Content& content) {
  std::string what = field_words(field);
  what[0] = char(std::toupper(static_cast<unsigned char>(what[0])));
  std::string text;
  if (columns == 1) text = what + " of the " + (content.measured ? "measured" : "simulated") + " motion.";
  else
    text =
        what + ", measured and simulated, on one colour scale" +
        (columns == 3 ? "; right: simulated minus measured, at the measured particles (blue: the simulation has less, "
                        "red: more)."
                      : ".");
  text += " Particles are drawn where they are at each time, as their deformed squares.";
  text = in_sides(content, text);
  if (f.ended > 0) text += " Pale grey: particles no longer followed, at their last place.";
  if (columns == 3) text += " Darker grey in the right column: no partner to compare with.";
  if (f.doubtful > 0) text += " Doubtful particles are shown like all others.";
  if (f.scale.above || f.scale.below || (columns == 3 && (f.difference_scale.above || f.difference_scale.below)))
    text += " A pointed colour bar: the outermost 0.5 % of the values lie beyond its end.";
  if (f.outside > 0)
    text += " Outside the panels: " + count(f.outside, "place of a particle", "places of particles") + ".";
  return text;
}

}  // namespace

std::optional<Figure> field_figure(const Content& content, const std::string& field, const std::vector<double>& times,
                                   bool central) {
  derived_field(field);
  if (times.empty() || (!content.measured && !content.simulated)) return std::nullopt;
  const Fields f = gather(content, field, times, central);
  std::vector<Column> columns;
  if (content.measured) columns.push_back(Column::measured);
  if (content.simulated) columns.push_back(Column::simulated);
  if (!f.difference.empty() && columns.size() == 2) columns.push_back(Column::difference);

  // Cells in rows; a single side is laid out along the times instead.
  const bool along = columns.size() == 1;
  const std::size_t per_row = along ? std::min<std::size_t>(3, times.size()) : columns.size();
  std::vector<Cell> cells;
  for (std::size_t k = 0; k < times.size(); ++k)
    for (const Column c : columns) {
      const Snapshot& s = c == Column::simulated ? f.simulated[k] : f.measured.empty() ? f.simulated[k] : f.measured[k];
      cells.push_back({c, &s, c == Column::difference ? &f.difference[k] : &s.value, times[k]});
    }
  const std::size_t rows = (cells.size() + per_row - 1) / per_row;

  const double left = 14, right = 3, gap = 5, head = along ? 5 : 10, row_gap = 5.5, foot = 24;
  const double aspect = f.box.height() / f.box.width();
  double w = (figure_width_mm - left - right - gap * double(per_row - 1)) / double(per_row);
  w = std::min(w, 80.0);
  const double room = figure_height_mm - head - foot - row_gap * double(rows - 1);
  w = std::min(w, room / double(rows) / aspect);
  const double h = w * aspect;
  const double used = left + double(per_row) * w + double(per_row - 1) * gap + right;
  const double x0 = left + std::max(0.0, (figure_width_mm - used) / 2);
  const double height = head + double(rows) * h + double(rows - 1) * row_gap + foot;
  auto sheet = std::make_shared<Sheet>(figure_width_mm, height);

  auto x_at = [&](std::size_t column) { return x0 + double(column) * (w + gap); };
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const std::size_t row = n / per_row, column = n % per_row;
    const double x = x_at(column), y = head + double(row) * (h + row_gap);
    const bool last_row = n + per_row >= cells.size();
    QCPAxisRect* panel = world_panel(*sheet, x, y, w, h, f.box, content.length_unit, last_row, column == 0);
    const Scale& scale = cells[n].column == Column::difference ? f.difference_scale : f.scale;
    const std::vector<Vec2>& places = cells[n].snapshot->position;
    if (std::none_of(places.begin(), places.end(), [](const Vec2& place) { return place.allFinite(); }))
      sheet->text(x + w / 2, y + h / 2, "no data at this time", Qt::AlignCenter, small_text, false, faint);
    else raster_in(*sheet, panel, draw_cell(cells[n], scale, f.box, w));
    QString letter = QString("(%1)").arg(QChar('a' + int(n % 26)));
    sheet->text(x, y - 0.8, letter, Qt::AlignLeft | Qt::AlignBottom, normal_text, true);
    if (along || column == 0)
      sheet->text(x + 6, y - 0.8, "t = " + qt(plain(cells[n].time) + unit_suffix(content.time_unit)),
                  Qt::AlignLeft | Qt::AlignBottom, normal_text);
    if (row == 0 && !along)
      sheet->text(x + w / 2, 0.8, qt(in_sides(content, column_words(cells[n].column))), Qt::AlignHCenter | Qt::AlignTop,
                  normal_text + 0.5, true);
  }

  const std::string unit = unit_of(field, content);
  const DisplayUnit shown = display_unit(unit, std::max(std::abs(f.scale.lower), std::abs(f.scale.upper)));
  const double y_bar = height - foot + 12;
  const std::size_t shared = along ? per_row : std::min<std::size_t>(2, columns.size());
  const double span = double(shared) * w + double(shared - 1) * gap, bar = std::min(span * 0.6, 80.0);
  colour_bar(*sheet, x0 + (span - bar) / 2, y_bar, bar, f.scale, shown.factor,
             axis_label(qt(field_words(field)), shown.name));
  if (columns.size() == 3) {
    const DisplayUnit other = display_unit(unit, f.difference_scale.upper);
    colour_bar(*sheet, x_at(2) + 0.1 * w, y_bar, 0.8 * w, f.difference_scale, other.factor,
               axis_label("difference", other.name));
  }
  std::string words = caption(f, field, columns.size(), content);
  if (content.strain_note && content.measured && (field.starts_with("strain_") || field == "J"))
    words += " " + strain_statement(*content.strain_note, content.length_unit);
  return Figure{figure_name(field), words, sheet};
}

}  // namespace pivnp::report
