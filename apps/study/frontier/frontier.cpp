#include "apps/study/frontier/frontier.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include "apps/plot/files.hpp"
#include "apps/study/frontier/known_pairs.hpp"
#include "apps/study/frontier/mpm_frontier.hpp"
#include "apps/study/frontier/pages.hpp"
#include "apps/study/frontier/piv_frontier.hpp"
#include "apps/study/frontier/written_pages.hpp"
#include "apps/study/pipeline/scene.hpp"
#include "apps/study/synth/case_frames.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/records/table_file.hpp"

namespace pivnp::app {

namespace {

constexpr int drawn_side = 512, drawn_seed = 901;

// Quoted where a comma or a quotation mark would end the cell.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char ch : text) out += ch == '"' ? std::string("\"\"") : std::string(1, ch);
  return out + "\"";
}

io::NamedTable table_of(const FrontierStage& stage) {
  const auto numbers = [&](const auto& of) {
    std::vector<double> all;
    for (const FrontierPoint& p : stage.points) all.push_back(of(p));
    return all;
  };
  const auto texts = [&](const auto& of) {
    std::vector<std::string> all;
    for (const FrontierPoint& p : stage.points) all.push_back(of(p));
    return all;
  };
  io::NamedTable t{stage.name, {{"made_of", stage.made_of}, {"error", stage.error_label}, {"time", stage.time_label}}, {}};
  t.columns.push_back({.name = "setting", .texts = texts([](const FrontierPoint& p) { return p.name; })});
  t.columns.push_back({.name = "keys", .texts = texts([](const FrontierPoint& p) { return p.keys; })});
  t.columns.push_back({.name = "seconds", .unit = "s", .numbers = numbers([](const FrontierPoint& p) { return p.seconds; })});
  t.columns.push_back({.name = "error", .numbers = numbers([](const FrontierPoint& p) { return p.error; })});
  t.columns.push_back({.name = "worst", .numbers = numbers([](const FrontierPoint& p) { return p.worst; })});
  for (std::size_t k = 0; k < stage.columns.size(); ++k)
    t.columns.push_back({.name = stage.columns[k].name, .numbers = numbers([k](const FrontierPoint& p) { return p.columns[k]; })});
  t.columns.push_back({.name = "on_front", .numbers = numbers([](const FrontierPoint& p) { return double(p.on_front); })});
  t.columns.push_back({.name = "default", .numbers = numbers([](const FrontierPoint& p) { return double(p.standard); })});
  t.columns.push_back({.name = "case", .numbers = numbers([](const FrontierPoint& p) { return double(p.own); })});
  return t;
}

}  // namespace

std::string csv(const FrontierStage& stage) {
  std::string out = "setting,keys,seconds,seconds_least,seconds_most,error,worst";
  for (const FrontierColumn& column : stage.columns) out += "," + column.name;
  out += ",on_front,default,case\n";
  for (const FrontierPoint& p : stage.points) {
    out += cell(p.name) + "," + cell(p.keys);
    for (const double v : {p.seconds, p.quickest, p.slowest, p.error, p.worst}) out += "," + (std::isfinite(v) ? number(v, 6) : "");
    for (const double v : p.columns) out += "," + (std::isfinite(v) ? number(v, 6) : "");
    out += std::string(p.on_front ? ",1" : ",0") + (p.standard ? ",1" : ",0") + (p.own ? ",1\n" : ",0\n");
  }
  return out;
}

FrontierOutcome frontier(const Case* given, const FrontierOptions& options, const RunSettings& settings, Progress& progress) {
  FrontierOutcome outcome;
  const int threads = settings.threads > 0 ? settings.threads : int(std::max(1u, std::thread::hardware_concurrency()));
  std::string subject = "drawn texture";
  plot::make_folder(settings.out);  // before the work
  if (!given && !options.piv) throw InputError("--stages: found mpm without a case, expected CASE");
  if (!given) {
    outcome.stages.push_back(piv_frontier(drawn_pairs(drawn_side, drawn_seed), {}, false, options.repeats, threads, progress));
  } else {
    Case c = *given;
    subject = c.name.empty() ? of_file(c) : c.name;
    const bool wants_frames = options.piv || (c.mpm && !c.mpm->end_s);
    const std::unique_ptr<image::FrameSource> source = wants_frames ? case_frames(c, settings, progress) : nullptr;
    const bool measures = options.piv && source && c.piv, simulates = options.mpm && c.mpm;
    if (!measures && !simulates)
      throw InputError((of_file(c).empty() ? "" : of_file(c) + ": ") + "there is nothing to measure; expected frames ([frames], [synth] or --frames) or [mpm]");
    const Setting setting = make_setting(c, source ? source->width() : 0, source ? source->height() : 0);
    if (measures)
      outcome.stages.push_back(
          piv_frontier(carried_pairs(c, setting, *source, threads, progress), *c.piv, true, options.repeats, threads, progress));
    if (simulates) {
      const double end = c.mpm->end_s ? *c.mpm->end_s : source ? source->frames().back().time : 0;
      if (!(end > 0)) throw InputError(of_file(c) + ": mpm.end_s: missing; expected the simulation's end");
      outcome.stages.push_back(mpm_frontier(c, setting, end, threads, progress));
    }
  }
  std::vector<std::pair<std::string, std::string>> texts;
  std::vector<io::NamedTable> tables;
  for (const FrontierStage& stage : outcome.stages) {
    texts.push_back({stage.name + ".csv", csv(stage)});
    tables.push_back(table_of(stage));
    for (std::string& sentence : what_to_change(stage)) outcome.sentences.push_back(std::move(sentence));
    outcome.remarks.insert(outcome.remarks.end(), stage.remarks.begin(), stage.remarks.end());
    for (const std::string& left : stage.left_out) outcome.remarks.push_back("Not measured: " + left);
  }
  outcome.files = write_pages(frontier_document(outcome.stages, subject, threads), "frontier", texts, tables, settings.out);
  return outcome;
}

}  // namespace pivnp::app
