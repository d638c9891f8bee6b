#include "apps/study/sweep/sweep_pages.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/plot/canvas.hpp"
#include "apps/study/sweep/sweep_charts.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr std::size_t most_curves = 8, most_pictures = 24;

std::vector<SweepResponse> asked(const SweepOptions& options) {
  std::vector<SweepResponse> all;
  for (const std::string& name : options.responses) all.push_back(sweep_response(name));
  return all;
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char ch : text) out += ch == '"' ? std::string("\"\"") : std::string(1, ch);
  return out + "\"";
}

std::string shown(double value) { return std::isfinite(value) ? number(value, 4) : "–"; }
std::string shown(double value, double sigma) { return shown(value) + (std::isfinite(sigma) ? " (u = " + number(sigma, 2) + ")" : ""); }

// Those with an uncertainty in some run.
bool is_uncertain(std::size_t response, const std::vector<SweepRun>& runs) {
  return std::any_of(runs.begin(), runs.end(), [&](const SweepRun& r) { return response < r.uncertainties.size() && std::isfinite(r.uncertainties[response]); });
}
double sigma_of(const SweepRun& run, std::size_t response) {
  return response < run.uncertainties.size() ? run.uncertainties[response] : std::numeric_limits<double>::quiet_NaN();
}

report::Table table_of_runs(const std::vector<SweepResponse>& responses, const std::vector<SweepRun>& runs) {
  report::Table table;
  table.caption = "All runs. Each has a folder with its record and its report in runs/.";
  table.head = {"Run"};
  table.width = {0.5};
  table.align = {'l'};
  for (const SweepResponse& r : responses) {
    table.head.push_back(r.name + (r.unit.empty() ? "" : " (" + r.unit + ")"));
    table.width.push_back(0.5 / double(responses.size()));
    table.align.push_back('r');
  }
  for (const SweepRun& run : runs) {
    std::vector<std::string> row = {run.label};
    for (std::size_t k = 0; k < run.responses.size(); ++k) row.push_back(shown(run.responses[k], sigma_of(run, k)));
    table.rows.push_back(std::move(row));
    table.notes.push_back(run.failure.empty() ? "" : "Ended: " + run.failure);
    table.marked.push_back(std::nullopt);
  }
  return table;
}

}  // namespace

SweepPages sweep_pages(const Case& c, const SweepOptions& options, const std::vector<Variation>& variations, const std::vector<SweepRun>& runs) {
  plot::start_qt();  // charts measure their words before there is a canvas
  SweepPages pages;
  report::Document& document = pages.document;
  document.title = "Sweep: " + (c.name.empty() ? short_name(c) : c.name);
  document.subtitle = std::to_string(runs.size()) + " runs, " + (options.grid ? "all combinations of the values." : "one key at a time beside the case's own values.");
  const std::vector<SweepResponse> responses = asked(options);
  std::vector<const SweepRun*> finished;
  for (const SweepRun& run : runs)
    if (run.failure.empty()) finished.push_back(&run);
  if (finished.size() < runs.size())
    pages.sentences.push_back(std::to_string(runs.size() - finished.size()) + " of " + std::to_string(runs.size()) + " runs ended before their time; the table says why.");
  for (std::size_t r = 0; r < responses.size() && !options.grid; ++r) {
    const std::vector<Swing> all = swings(r, variations, runs);
    if (all.empty()) continue;
    const Swing& widest = all.front();
    const std::string own = shown(widest.own, widest.sigma);
    if (!(widest.upper > widest.lower)) {
      pages.sentences.push_back(responses[r].name + " is " + own + " " + responses[r].unit +
                                " with each of the values.");
      continue;
    }
    pages.sentences.push_back(responses[r].name + " is " + own + " " + responses[r].unit + "; it depends most on " + widest.key + ": " + shown(widest.lower) +
                              " at " + widest.least + " to " + shown(widest.upper) + " at " + widest.most + ".");
  }
  std::string lead;
  for (const std::string& sentence : pages.sentences) lead += (lead.empty() ? "" : " ") + sentence;
  if (!lead.empty()) document.blocks.push_back(report::Paragraph{lead, true});
  for (std::size_t r = 0; r < responses.size(); ++r) {
    document.blocks.push_back(report::Heading{1, responses[r].name});
    if (!options.grid) document.blocks.push_back(tornado(responses[r], swings(r, variations, runs)));
    for (std::size_t v = 0; v < variations.size(); ++v)
      if (numeric(variations[v])) document.blocks.push_back(curves(responses[r], r, v, variations, runs));
  }
  if (!finished.empty()) document.blocks.push_back(report::Heading{1, "Motion"});
  for (std::size_t v = 0; v < variations.size() && !options.grid; ++v) {
    std::vector<const SweepRun*> of;
    for (const SweepRun* run : finished)
      if (of.size() < most_curves && (run == &runs.front() || !run->values[v].empty())) of.push_back(run);
    if (of.size() > 1) document.blocks.push_back(histories("histories_" + std::to_string(v + 1), variations[v].name(), of));
  }
  for (std::size_t k = 0; k < finished.size() && options.grid; k += most_curves)
    document.blocks.push_back(histories("histories_" + std::to_string(k / most_curves + 1), "All combinations",
                                        {finished.begin() + std::ptrdiff_t(k), finished.begin() + std::ptrdiff_t(std::min(finished.size(), k + most_curves))}));
  if (finished.size() > most_pictures) finished.resize(most_pictures);
  if (!finished.empty()) document.blocks.push_back(report::Heading{1, "At the end"});
  for (const std::string& field : options.fields)
    if (!finished.empty()) document.blocks.push_back(mosaic(field, finished));
  document.blocks.push_back(report::Heading{1, "Runs"});
  document.blocks.push_back(table_of_runs(responses, runs));
  report::List meanings;
  for (const SweepResponse& r : responses) meanings.items.push_back(r.name + ": " + r.text + ".");
  document.blocks.push_back(meanings);
  return pages;
}

std::string csv_of(const SweepOptions& options, const std::vector<Variation>& variations, const std::vector<SweepRun>& runs) {
  std::string out = "run";
  for (const Variation& v : variations) out += "," + quoted(v.name());
  const std::vector<SweepResponse> responses = asked(options);
  for (std::size_t k = 0; k < responses.size(); ++k) {
    const std::string unit = responses[k].unit.empty() ? "" : " (" + responses[k].unit + ")";
    out += "," + responses[k].name + unit;
    if (is_uncertain(k, runs)) out += ",sigma_" + responses[k].name + unit;
  }
  out += ",folder,failure\n";
  for (const SweepRun& run : runs) {
    out += quoted(run.label);
    for (std::size_t v = 0; v < variations.size(); ++v) out += "," + quoted(run.values[v].empty() ? variations[v].own : run.values[v]);
    const auto add = [&](double value) { out += "," + (std::isfinite(value) ? number(value, 9) : ""); };
    for (std::size_t k = 0; k < run.responses.size(); ++k) {
      add(run.responses[k]);
      if (is_uncertain(k, runs)) add(sigma_of(run, k));
    }
    out += "," + quoted(run.folder.filename().string()) + "," + quoted(run.failure) + "\n";
  }
  return out;
}

io::NamedTable table_of(const SweepOptions& options, const std::vector<Variation>& variations, const std::vector<SweepRun>& runs) {
  io::NamedTable t{"sweep", {{"way", options.grid ? "all combinations" : "one at a time"}}, {}};
  const auto texts = [&](const std::string& name, auto&& of) {
    io::TableColumn column{.name = name};
    for (const SweepRun& run : runs) column.texts.push_back(of(run));
    t.columns.push_back(std::move(column));
  };
  texts("run", [](const SweepRun& r) { return r.label; });
  for (std::size_t v = 0; v < variations.size(); ++v)
    texts(variations[v].name(), [&](const SweepRun& r) { return r.values[v].empty() ? variations[v].own : r.values[v]; });
  const std::vector<SweepResponse> responses = asked(options);
  for (std::size_t k = 0; k < responses.size(); ++k) {
    io::TableColumn column{.name = responses[k].name, .unit = responses[k].unit};
    io::TableColumn sigma{.name = "sigma_" + responses[k].name, .unit = responses[k].unit};
    for (const SweepRun& run : runs) {
      column.numbers.push_back(run.responses[k]);
      sigma.numbers.push_back(sigma_of(run, k));
    }
    t.columns.push_back(std::move(column));
    if (is_uncertain(k, runs)) t.columns.push_back(std::move(sigma));
  }
  texts("folder", [](const SweepRun& r) { return r.folder.filename().string(); });
  texts("failure", [](const SweepRun& r) { return r.failure; });
  return t;
}

}  // namespace pivnp::app
