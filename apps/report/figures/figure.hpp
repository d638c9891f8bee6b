// The figures of a report: one list, one row a figure. The sections, the files in figures/ and the removal of those of
// an earlier report walk it; nothing else names a figure.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/report/content/content.hpp"
#include "apps/report/content/differences.hpp"
#include "apps/report/content/options.hpp"
#include "apps/report/content/quality.hpp"
#include "apps/report/words/data_sets.hpp"
#include "pivnp/core/registry.hpp"

namespace pivnp::plot {
class Canvas;
}

namespace pivnp::report {

constexpr double figure_width_mm = 170;   // the measure of an A4 page
constexpr double half_figure_mm = 82;     // two of them stand side by side
constexpr double figure_height_mm = 205;  // at most, so that a caption fits below

/// What figures are drawn from: the content, and what is computed of it once.
struct FigureInput {
  const ReportOptions& options;
  const Content& content;
  DataSetNames names;
  std::vector<PairQuality> pairs;
  DifferenceCurve differences;
  std::vector<double> times;  // at which fields are drawn
  std::vector<Vec2> points;   // whose displacement is drawn against time
  bool central = true;        // the anchor of the vectors
};
FigureInput figure_input(const ReportOptions& options, const Content& content);

struct Figure {
  std::string caption;
  std::shared_ptr<const plot::Canvas> canvas;
  std::string name = {};   // of its files; left out: the row's
  std::string shows = {};  // for readers who cannot see it; left out: the row's
  std::vector<ComparisonTable::Column> data = {};  // what it draws, in the content's units; NaN: not known
};

/// The data as CSV, a column each with "name (unit)" at its head; shorter columns end in empty cells.
std::string csv(const std::vector<ComparisonTable::Column>& data);

enum class Section { summary, measurement, comparison, simulation };

struct FigureRow {
  std::string name;  // of the figure's files, as long as it is one
  std::string shows;
  Section section = Section::comparison;
  bool (*applies)(const FigureInput& input) = nullptr;
  /// Draws and captions: one figure, several, or none where the content has nothing to show after all.
  std::vector<Figure> (*draw)(const FigureInput& input) = nullptr;
  /// For a row of several: whether a figure of that name is one of its own.
  bool (*owns)(std::string_view figure) = nullptr;
};

Registry<FigureRow>& figures();

/// The row whose figure bears the name; nullptr: no figure of a report does.
const FigureRow* row_of(std::string_view figure);

/// The figures of a section that apply, drawn, in their order on the page. Throws InputError for an unknown name in
/// `options.fields_drawn`.
std::vector<Figure> draw_section(Section section, const FigureInput& input);

}  // namespace pivnp::report
