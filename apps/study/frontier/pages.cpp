#include "apps/study/frontier/pages.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>

#include "apps/plot/error_time.hpp"
#include "apps/plot/palette.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "an unknown processor";
}

namespace {

// Whole decades that hold the values.
std::pair<double, double> decades(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return {std::pow(10, std::floor(std::log10(0.9 * *least))), std::pow(10, std::ceil(std::log10(1.1 * *most)))};
}

report::Figure chart_of(const FrontierStage& stage) {
  constexpr double width = 170, height = 112;
  plot::ErrorTimeChart chart{stage.time_label, stage.error_label};
  std::vector<double> times, errors;
  std::vector<const FrontierPoint*> shown;
  for (const FrontierPoint& p : stage.points) {
    if (!(p.seconds > 0) || !(p.error > 0)) continue;
    shown.push_back(&p);
    times.push_back(p.seconds / stage.time_unit);
    errors.push_back(p.error);
  }
  const auto named = [](const FrontierPoint* p) { return p->own || p->standard || p->on_front || p->elsewhere; };
  std::vector<std::size_t> order(shown.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return named(shown[a]) && !named(shown[b]); });  // the first on top
  if (!shown.empty()) {
    std::tie(chart.quickest, chart.slowest) = decades(times);
    std::tie(chart.least, chart.greatest) = decades(errors);
  }
  chart.names = true;
  for (const std::size_t k : order) {
    plot::ErrorTimePoint point;
    point.name = shown[k]->name;
    if (shown[k]->own) point.name += shown[k]->standard ? " (the case's; default)" : " (the case's)";
    else if (shown[k]->standard) point.name += " (default)";
    else if (!shown[k]->on_front && !shown[k]->elsewhere) point.name.clear();  // the table names it
    const plot::Rgb colour = shown[k]->own ? plot::vermilion : shown[k]->standard ? plot::blue : shown[k]->on_front ? plot::ink : plot::faint;
    point.own = shown[k]->own || shown[k]->standard || shown[k]->on_front;
    point.symbol = point.own ? plot::Symbol{plot::Marker::disc, {colour, 0.9}, {colour}, 2.6}
                   : shown[k]->elsewhere ? plot::Symbol{plot::Marker::square, {plot::faint, 0.9}, {0xffffff}, 2.2}
                                         : plot::Symbol{plot::Marker::disc, {plot::faint, 0.8}, {0xffffff}, 2.0};
    point.time = times[k];
    point.error = errors[k];
    chart.points.push_back(point);
  }
  auto canvas = std::make_shared<plot::Canvas>(width, height);
  plot::draw_error_time(*canvas, 20, 4, width - 24, height - 20, chart);
  report::Figure figure;
  figure.name = stage.name;
  figure.canvas = canvas;
  figure.caption = stage.title + ": error against time. Dashed: the front; nothing measured is both quicker and more accurate. Named are the settings on it, "
                   "the default (blue) and the case's (orange). Grey: settings that give less, or are beaten." +
                   std::string(std::any_of(shown.begin(), shown.end(), [](auto p) { return p->elsewhere; }) ? " Squares: other programs, measured on another machine." : "");
  figure.shows = "Error against time of every setting, both on logarithmic scales, with the front.";
  return figure;
}

// "ms", as the axis has it.
std::string time_unit(const FrontierStage& stage) {
  const std::size_t open = stage.time_label.rfind('('), close = stage.time_label.rfind(')');
  return stage.time_label.substr(open + 1, close - open - 1);
}

report::Table settings_table(const FrontierStage& stage) {
  report::Table table;
  table.caption = stage.title + ": all settings, the most accurate first; those on the front are marked (" + stage.error_label + ").";
  table.head = {"Setting", "time (" + time_unit(stage) + ")", "of the repeats", "memory (MB)", "error"};
  table.width = {0.26, 0.07, 0.1, 0.07, 0.07};
  table.align = {'l', 'r', 'r', 'r', 'r'};
  for (const FrontierColumn& column : stage.columns) {
    table.head.push_back(column.head);
    table.width.push_back(0.43 / double(stage.columns.size()));
    table.align.push_back('r');
  }
  std::vector<const FrontierPoint*> sorted;
  for (const FrontierPoint& p : stage.points) sorted.push_back(&p);
  std::stable_sort(sorted.begin(), sorted.end(), [](auto a, auto b) { return a->error < b->error || (std::isnan(b->error) && !std::isnan(a->error)); });
  const auto text = [](double v) {
    return !std::isfinite(v) ? std::string("–") : std::abs(v) >= 1000 ? std::to_string(std::llround(v)) : number(v, 3);
  };
  for (const FrontierPoint* p : sorted) {
    std::vector<std::string> row = {p->name + (p->own ? " (the case's)" : "") + (p->standard ? " (default)" : ""), text(p->seconds / stage.time_unit),
                                    p->quickest < p->slowest ? text(p->quickest / stage.time_unit) + " to " + text(p->slowest / stage.time_unit) : "–",
                                    text(p->bytes / 1e6), text(p->error)};
    for (const double v : p->columns) row.push_back(text(v));
    table.rows.push_back(std::move(row));
    table.notes.emplace_back();
    table.marked.push_back(p->on_front ? std::optional<std::size_t>(0) : std::nullopt);
  }
  return table;
}

}  // namespace

report::Document frontier_document(const std::vector<FrontierStage>& stages, const std::string& subject, int threads) {
  report::Document document;
  document.title = "Speed against accuracy: " + subject;
  document.subtitle = "Measured on " + processor() + ", " + std::to_string(threads) + (threads == 1 ? " thread" : " threads") +
                      ". Times are those of this machine, medians of repeats; only their ratios hold on others. Memory is the high-water mark of the resident set "
                      "(VmHWM) while a setting works, less what was resident before; a dash where the system does not say.";
  for (const FrontierStage& stage : stages) {
    document.blocks.push_back(report::Heading{1, stage.title});
    std::string lead;
    for (const std::string& sentence : what_to_change(stage)) lead += (lead.empty() ? "" : " ") + sentence;
    if (!lead.empty()) document.blocks.push_back(report::Paragraph{lead, true});
    document.blocks.push_back(report::Paragraph{stage.made_of});
    document.blocks.push_back(chart_of(stage));
    for (const std::string& remark : stage.remarks) document.blocks.push_back(report::Paragraph{remark});
    document.blocks.push_back(settings_table(stage));
    report::List columns;
    for (const FrontierColumn& column : stage.columns) columns.items.push_back(column.head + ": " + column.text + ".");
    document.blocks.push_back(columns);
    if (!stage.left_out.empty()) {
      document.blocks.push_back(report::Paragraph{"Not measured:"});
      document.blocks.push_back(report::List{stage.left_out});
    }
  }
  return document;
}

}  // namespace pivnp::app
