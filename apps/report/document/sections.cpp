#include "apps/report/document/sections.hpp"

#include <algorithm>
#include <ctime>
#include <string>
#include <utility>

#include "apps/plot/canvas.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/content/ends.hpp"
#include "apps/report/document/player.hpp"
#include "apps/report/document/tables.hpp"
#include "apps/report/document/versions.hpp"
#include "apps/report/words/flags.hpp"
#include "apps/report/words/verdict.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

class Builder {
 public:
  Document document;
  void heading(int level, std::string text) { document.blocks.push_back(Heading{level, std::move(text)}); }
  void paragraph(std::string text, bool lead = false) { document.blocks.push_back(Paragraph{std::move(text), lead}); }
  void add(Block block) { document.blocks.push_back(std::move(block)); }
  /// A figure of half the width that would stand alone is followed by the next such one.
  void add(std::vector<Figure> figures) {
    const auto half = [&](std::size_t k) { return figures[k].canvas->width_mm() <= half_figure_mm; };
    for (std::size_t k = 0; k + 1 < figures.size(); ++k) {
      if (!half(k)) continue;
      std::size_t next = k + 1;
      while (next < figures.size() && !half(next)) ++next;
      if (next == figures.size()) break;
      std::rotate(figures.begin() + std::ptrdiff_t(k) + 1, figures.begin() + std::ptrdiff_t(next), figures.begin() + std::ptrdiff_t(next) + 1);
      ++k;
    }
    for (Figure& figure : figures) document.blocks.push_back(std::move(figure));
  }
};

void comparison_section(Builder& b, const FigureInput& input) {
  const Content& content = input.content;
  std::vector<Figure> figures = draw_section(Section::comparison, input);
  if (figures.empty()) return;
  b.heading(1, content.comparison ? "Comparison" : "Motion");
  if (const auto player = player_of(input.options, content, input.names, input.central)) b.add(OnScreen{html_of(*player)});
  b.add(std::move(figures));
  if (auto table = runs_table(content)) b.add(std::move(*table));
}

void measurement_section(Builder& b, const FigureInput& input) {
  if (input.pairs.empty()) return;
  b.heading(1, "Measurement");
  b.add(measurement_table(input.content, input.pairs));
  b.add(draw_section(Section::measurement, input));
}

void simulation_section(Builder& b, const FigureInput& input) {
  std::vector<Figure> figures = draw_section(Section::simulation, input);
  auto table = simulation_table(input.content);
  if (figures.empty() && !table) return;
  b.heading(1, "Simulation");
  if (table) b.add(std::move(*table));
  b.add(std::move(figures));
}

void flags_section(Builder& b, const FigureInput& input) {
  b.heading(1, "What was flagged");
  const std::vector<std::string> list = flags(input.content);
  if (list.empty())
    b.paragraph("Nothing was flagged: no limit exceeded, no step, no shortage of valid vectors, no particle that ended early.");
  else b.add(List{list});
  if (auto table = ends_table(input.content, input.names)) b.add(std::move(*table));
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  char text[64];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &parts);
  return text;
}

// Keys that are not given are comments of the case: they tell what could be given, not what was run.
std::string without_comments(const std::string& text) {
  std::string out;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::string line = text.substr(from, end - from);
    const bool empty = line.find_first_not_of(" \t") == std::string::npos;
    if (!line.starts_with("#") && !(empty && (out.empty() || out.ends_with("\n\n")))) out += line + "\n";
    from = end + 1;
  }
  while (out.ends_with("\n")) out.pop_back();
  return out;
}

void appendix(Builder& b, const Content& content) {
  b.heading(1, "How this was made");
  if (!content.command.empty()) b.add(Code{content.command});
  Definitions more;
  more.items.emplace_back("Programs", versions(content.written_by) + " The report is of " + utc_now() + ".");
  for (const Remark& remark : content.remarks)
    if (remark.weight == RemarkWeight::note) more.items.emplace_back("Run", remark.text);
  for (const std::string& note : content.notes) more.items.emplace_back("Comparison", note);
  more.items.emplace_back("How to cite", "pivnp " + program_version() +
                                             ": from lab video to verdict by PIV, numerical particles, MPM and comparison. Free "
                                             "software, GPL-3.0-or-later.");
  more.items.emplace_back("Numerical particles", "N. M. Pinyol and M. Alvarado (2017). Novel analysis for large strains based on particle "
                                                 "image velocimetry. Canadian Geotechnical Journal 54(7), 933\u2013944.");
  more.items.emplace_back("Both methods", "M. Alvarado (2018). Landslide motion assessment including thermal interaction: an MPM approach. "
                                          "PhD thesis, Universitat Polit\u00e8cnica de Catalunya.");
  b.add(more);
  if (auto table = cost_table(content)) b.add(std::move(*table));
  if (content.case_text.empty()) return;
  b.heading(1, "Settings");
  b.paragraph("The case as run, with every default filled in. Keys that were left out and have no default stand in the record.");
  b.add(CaseText{without_comments(content.case_text)});
}

std::string subtitle(const Content& content, const DataSetNames& names) {
  if (content.comparison && !content.measured && !content.simulated) return "Two histories compared";
  if (content.comparison) return names.alike ? "Two motions compared" : "Measurement and simulation compared";
  if (content.measured && content.simulated) return "Measurement and simulation";
  return content.simulated ? "Simulation" : "Measurement";
}

}  // namespace

Document make_document(const ReportOptions& options, const Content& content) {
  const FigureInput input = figure_input(options, content);
  Builder b;
  b.document.title = options.title.empty() ? content.name : options.title;
  if (b.document.title.empty()) b.document.title = "Report";
  b.document.subtitle = subtitle(content, input.names);
  for (const Remark& remark : content.remarks)
    if (remark.weight == RemarkWeight::unusable) b.paragraph(remark.text, true);
  b.paragraph(verdict(content, input.names, input.pairs, input.differences), true);
  b.add(draw_section(Section::summary, input));
  if (auto table = summary_table(content, input.names)) b.add(std::move(*table));
  if (const std::string text = basis(content, input.names); !text.empty()) b.paragraph(text);
  flags_section(b, input);
  measurement_section(b, input);
  comparison_section(b, input);
  simulation_section(b, input);
  if (content.comparison && !content.comparison->metrics.empty()) {
    b.heading(1, "All metrics");
    for (Table& table : metrics_tables(content, input.names)) b.add(std::move(table));
    b.heading(2, "Definitions");
    b.add(metric_definitions(content));
  }
  appendix(b, content);
  return std::move(b.document);
}

}  // namespace pivnp::report
