#include "apps/report/figures/figure.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/report/content/selection.hpp"
#include "apps/report/figures/rows.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::report {

Registry<FigureRow>& figures() {
  static Registry<FigureRow> rows = {summary_row(),  quality_row(), camera_motion_row(),  uncertainty_row(),   vectors_row(),  fields_row(),
                                     point_curves_row(), point_strains_row(), point_pressures_row(), differences_row(), outlines_row(), geometry_row(), bands_row(),
                                     lines_row(),    runs_row(), decomposition_row(), histories_row(),  energy_row(),   reactions_row()};
  return rows;
}

std::string csv(const std::vector<ComparisonTable::Column>& data) {
  std::string text;
  std::size_t rows = 0;
  for (std::size_t c = 0; c < data.size(); ++c) {
    std::string head = data[c].name + (data[c].unit.empty() || data[c].unit == "1" ? "" : " (" + data[c].unit + ")");
    std::replace(head.begin(), head.end(), '"', '\'');
    text += (c > 0 ? "," : "") + (head.find(',') == std::string::npos ? head : "\"" + head + "\"");
    rows = std::max(rows, data[c].values.size());
  }
  text += "\n";
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < data.size(); ++c) {
      if (c > 0) text += ",";
      if (r < data[c].values.size() && std::isfinite(data[c].values[r])) text += number(data[c].values[r], 7);
    }
    text += "\n";
  }
  return text;
}

FigureInput figure_input(const ReportOptions& options, const Content& content) {
  return {options,
          content,
          data_set_names(content),
          pair_quality(content),
          difference_curve(content),
          chosen_times(options, content),
          chosen_points(options, content),
          content.pair_count == 0 || content.pair(0).anchor == Anchor::central};
}

const FigureRow* row_of(std::string_view figure) {
  for (const FigureRow& row : figures())
    if (row.owns != nullptr ? row.owns(figure) : row.name == figure) return &row;
  return nullptr;
}

std::vector<Figure> draw_section(Section section, const FigureInput& input) {
  std::vector<Figure> ordered;
  for (const FigureRow& row : figures()) {
    if (row.section != section || !row.applies(input)) continue;
    for (Figure& figure : row.draw(input)) {
      if (figure.name.empty()) figure.name = row.name;
      if (figure.shows.empty()) figure.shows = row.shows;
      ordered.push_back(std::move(figure));
    }
  }
  return ordered;
}

}  // namespace pivnp::report
