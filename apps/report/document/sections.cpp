#include "apps/report/document/sections.hpp"

#include "apps/plot/numbers.hpp"

#include <algorithm>
#include <ctime>
#include <utility>

#include "apps/report/content/analysis.hpp"
#include "apps/report/document/versions.hpp"
#include "apps/report/figures/figures.hpp"
#include "apps/report/words/data_sets.hpp"
#include "apps/report/words/summary.hpp"
#include "apps/report/words/words.hpp"
#include "compare/metrics/words.hpp"

namespace pivnp::report {

namespace {

class Builder {
 public:
  Document document;
  void heading(int level, std::string text) { document.blocks.push_back(Heading{level, std::move(text)}); }
  void paragraph(std::string text, bool lead = false) { document.blocks.push_back(Paragraph{std::move(text), lead}); }
  bool figure(std::optional<Figure> figure) {
    if (figure) document.blocks.push_back(std::move(*figure));
    return figure.has_value();
  }
  void add(Block block) { document.blocks.push_back(std::move(block)); }
};

// The metrics a reader asks for first; those with a limit are always among them.
bool leading(const Metric& m) {
  return compare::leads(m.name) || m.verdict == Verdict::met || m.verdict == Verdict::exceeded;
}

Table leading_table(const Content& content) {
  Table t;
  t.caption = in_sides(content,
                       "Metrics, simulated minus measured; \u00b1: standard uncertainty of the value. All "
                       "metrics and their definitions stand at the end of the report.");
  t.head = {"Metric", "Value", "Unit", "Verdict"};
  t.width = {0.44, 0.22, 0.06, 0.28};
  t.align = {'l', 'r', 'l', 'l'};
  for (const Metric& m : content.comparison->metrics)
    if (leading(m))
      t.rows.push_back({in_sides(content, metric_words(m.name)), value_with_uncertainty(m.value, m.uncertainty),
                        m.unit == "1" ? "" : m.unit, std::string(name_of(m.verdict))});
  return t;
}

Table metrics_table(const Content& content) {
  Table t;
  t.caption = "Metrics of the comparison with their definitions, under the names of the record" +
              std::string(like_with_like(content) ? "" : "; first: measured, second: simulated") +
              ". \u00b1: standard uncertainty of the value.";
  t.head = {"Metric", "Value", "Unit", "Verdict"};
  t.width = {0.44, 0.22, 0.06, 0.28};
  t.align = {'l', 'r', 'l', 'l'};
  for (const Metric& m : content.comparison->metrics) {
    t.rows.push_back({in_sides(content, metric_words(m.name)), value_with_uncertainty(m.value, m.uncertainty),
                      m.unit == "1" ? "" : m.unit, std::string(name_of(m.verdict))});
    t.notes.push_back(m.name + ": " + m.definition);
  }
  return t;
}

std::optional<Table> ends_table(const Content& content) {
  Table t;
  t.caption = "Particles that ended before the last frame, by reason.";
  t.head = {"Side", "Reason", "Particles", "Share", "First", "Median", "Last (" + content.time_unit + ")"};
  t.width = {0.12, 0.38, 0.12, 0.1, 0.09, 0.09, 0.1};
  t.align = {'l', 'l', 'r', 'r', 'r', 'r', 'r'};
  for (const auto& [motion, side] : {std::pair{content.measured.get(), in_sides(content, "measured")},
                                     {content.simulated.get(), in_sides(content, "simulated")}}) {
    if (motion == nullptr) continue;
    for (const Ends& e : ends_by_reason(motion->particles()))
      t.rows.push_back({side, words(e.reason), std::to_string(e.particles),
                        percent(double(e.particles) / double(motion->particles().size())), plain(e.first),
                        plain(e.median), plain(e.last)});
  }
  if (t.rows.empty()) return std::nullopt;
  return t;
}

std::string measurement_text(const Content& content, const std::vector<PairQuality>& pairs) {
  std::size_t nodes = 0, valid = 0, replaced = 0, rejected = 0, failed = 0;
  std::vector<double> sigma;
  for (const PairQuality& q : pairs) {
    nodes += q.nodes;
    valid += q.valid;
    replaced += q.replaced;
    rejected += q.rejected;
    failed += q.failed;
    sigma.push_back(q.sigma);
  }
  if (nodes == 0) return "No node was measured: all are masked.";
  auto share = [&](std::size_t n) { return percent(double(n) / double(nodes)); };
  std::string text = count(pairs.size(), "pair of frames was", "pairs of frames were") + " correlated, " +
                     count(nodes, "vector") + " in all: " + share(valid) + " valid, " + share(replaced) +
                     " rejected and replaced from valid neighbours, " + share(rejected) + " rejected, " +
                     share(failed) + " failed.";
  const double typical = quantile(sigma, 0.5);
  if (typical > 0)
    text += " Standard uncertainty of a valid vector, one component: " + number(typical, 2) +
            unit_suffix(content.length_unit) + " (random error; median over the pairs).";
  if (content.camera_residual > 0)
    text += " The camera\u2019s targets are met with a residual of " + number(content.camera_residual, 2) +
            unit_suffix(content.length_unit) + " (RMS).";
  return text;
}

void comparison_section(Builder& b, const ReportOptions& options, const Content& content, bool central,
                        const DifferenceHistory& differences) {
  if (!content.measured && !content.simulated) {
    auto curves = compared_curves_figure(content);
    if (!curves) return;
    b.heading(1, "Comparison");
    b.figure(std::move(curves));
    return;
  }
  b.heading(1, content.comparison ? "Comparison" : "Motion");
  if (content.comparison && !content.comparison->metrics.empty()) b.add(leading_table(content));
  const std::vector<double> times = chosen_times(options, content);
  // In this order tall and low figures share pages.
  for (std::size_t k = 0; k < std::max<std::size_t>(2, options.fields_drawn.size()); ++k) {
    if (k < options.fields_drawn.size()) b.figure(field_figure(content, options.fields_drawn[k], times, central));
    if (k == 0) b.figure(history_figure(content, chosen_points(options, content)));
    if (k == 1) b.figure(difference_figure(content, differences));
  }
  b.figure(outline_figure(content));
  b.figure(decomposition_figure(content));
}

void flags_section(Builder& b, const Content& content, const std::vector<PairQuality>& pairs) {
  b.heading(1, "What was flagged");
  const std::vector<std::string> list = flags(content, pairs);
  if (list.empty())
    b.paragraph("Nothing was flagged: no step, no shortage of valid vectors, no particle that ended early.");
  else b.add(List{list});
  if (auto table = ends_table(content)) b.add(std::move(*table));
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  char text[64];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &parts);
  return text;
}

void appendix(Builder& b, const Content& content) {
  b.heading(1, "How this was made");
  if (!content.command.empty()) {
    b.paragraph("Command:");
    b.add(Code{content.command});
  }
  b.paragraph(versions() + " Written " + utc_now() + ".");
  b.heading(2, "How to cite");
  b.add(List{{"pivnp " + program_version() +
                  ": from lab video to verdict by PIV, numerical particles, MPM and comparison. Free software, "
                  "GPL-3.0-or-later.",
              "N. M. Pinyol and M. Alvarado (2017). Novel analysis for large strains based on particle image "
              "velocimetry. Canadian "
              "Geotechnical Journal 54(7), 933\u2013944.",
              "M. Alvarado (2018). Landslide motion assessment including thermal interaction: an MPM approach. PhD "
              "thesis, Universitat "
              "Polit\u00e8cnica de Catalunya."}});
  if (content.case_text.empty()) return;
  b.heading(1, "Settings");
  b.paragraph("The case as run, with every default filled in.");
  b.add(Code{content.case_text});
}

}  // namespace

Document make_document(const ReportOptions& options, const Content& content) {
  const std::vector<PairQuality> pairs = pair_quality(content);
  const DifferenceHistory differences = difference_history(content);
  const bool central = content.pair_count == 0 || content.pair(0).anchor == Anchor::central;

  Builder b;
  b.document.title = options.title.empty() ? content.name : options.title;
  if (b.document.title.empty()) b.document.title = "Report";
  b.document.subtitle = content.comparison && !content.measured && !content.simulated ? "Two histories compared"
                        : content.comparison ? in_sides(content, "Measurement and simulation compared")
                        : content.measured && content.simulated ? "Measurement and simulation"
                        : content.simulated                     ? "Simulation"
                                                                : "Measurement";
  b.paragraph(verdict(content, pairs, differences), true);
  comparison_section(b, options, content, central, differences);
  if (!pairs.empty()) {
    b.heading(1, "Measurement");
    b.paragraph(measurement_text(content, pairs));
    if (content.strain_note) b.paragraph(strain_statement(*content.strain_note, content.length_unit));
    b.figure(quality_figure(content, pairs));
    for (Figure& figure : vector_figures(content, pairs)) b.add(std::move(figure));
  }
  if (content.energy.size() >= 2) {
    b.heading(1, "Simulation");
    b.figure(energy_figure(content));
  }
  flags_section(b, content, pairs);
  if (content.comparison && !content.comparison->metrics.empty()) {
    b.heading(1, "All metrics");
    b.add(metrics_table(content));
  }
  appendix(b, content);
  return std::move(b.document);
}

}  // namespace pivnp::report
