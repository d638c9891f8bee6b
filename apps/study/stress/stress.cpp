#include "apps/study/stress/stress.hpp"

#include <algorithm>
#include <thread>

#include "apps/plot/files.hpp"
#include "apps/study/frontier/written_pages.hpp"
#include "apps/study/pipeline/scene.hpp"
#include "apps/study/stress/mpm_stress.hpp"
#include "apps/study/stress/piv_stress.hpp"
#include "apps/study/stress/stress_pages.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/records/table_file.hpp"

namespace pivnp::app {

namespace {

constexpr int stress_side = 512;

using Column = double (*)(const Survival&);
constexpr std::pair<const char*, Column> columns[] = {{"good", [](const Survival& s) { return s.good; }},
                                                      {"fair", [](const Survival& s) { return s.fair; }},
                                                      {"flagged", [](const Survival& s) { return s.flagged; }},
                                                      {"wrong", [](const Survival& s) { return s.wrong; }},
                                                      {"wrong_values", [](const Survival& s) { return s.wrong_values; }},
                                                      {"wrong_flagged", [](const Survival& s) { return s.wrong_flagged; }},
                                                      {"right_values", [](const Survival& s) { return s.right_values; }},
                                                      {"right_flagged", [](const Survival& s) { return s.right_flagged; }}};

std::string level_of(const MapAxis& axis, std::size_t k) { return axis.names.empty() ? number(axis.levels[k], 6) : "\"" + axis.names[k] + "\""; }

io::NamedTable table_of_map(const SurvivalMap& map) {
  io::NamedTable table{map.name, {{"made_of", map.made_of}, {"x", map.x.label}, {"y", map.y.label}}, {}};
  const auto axis = [&](const std::string& name, const MapAxis& a) {
    io::TableColumn column{.name = name};
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (a.names.empty()) column.numbers.push_back(a.levels[k]);
      else column.texts.push_back(a.names[k]);
    }
    table.columns.push_back(std::move(column));
  };
  axis("x", map.x);
  axis("y", map.y);
  for (const auto& [name, of] : columns) {  // [y][x], row after row
    io::TableColumn column{.name = name};
    for (const Survival& s : map.cells) column.numbers.push_back(of(s));
    table.columns.push_back(std::move(column));
  }
  return table;
}

}  // namespace

std::string csv(const SurvivalMap& map) {
  std::string out = "\"" + map.x.label + "\",\"" + map.y.label + "\"";
  for (const auto& [name, of] : columns) out += std::string(",") + name;
  out += "\n";
  for (std::size_t j = 0; j < map.y.size(); ++j)
    for (std::size_t i = 0; i < map.x.size(); ++i) {
      out += level_of(map.x, i) + "," + level_of(map.y, j);
      for (const auto& [name, of] : columns) out += "," + number(of(map.at(i, j)), 9);
      out += "\n";
    }
  return out;
}

StressOutcome stress(const Case* c, const StressOptions& options, const RunSettings& settings, Progress& progress) {
  const int threads = settings.threads > 0 ? settings.threads : int(std::max(1u, std::thread::hardware_concurrency()));
  StressOutcome outcome;
  plot::make_folder(settings.out);  // before the work
  if (options.piv) outcome.maps = piv_stress(c && c->piv ? *c->piv : piv::PivOptions{}, stress_side, options.seeds, threads, progress);
  if (options.mpm)
    for (SurvivalMap& map : mpm_stress(threads, progress)) outcome.maps.push_back(std::move(map));
  const report::Document document = stress_document(outcome.maps, c ? (c->name.empty() ? of_file(*c) : c->name) + ", [piv] as it says" : "the default");
  std::vector<std::pair<std::string, std::string>> tables;
  std::vector<io::NamedTable> numbers;
  for (const SurvivalMap& map : outcome.maps) {
    tables.push_back({map.name + ".csv", csv(map)});
    numbers.push_back(table_of_map(map));
  }
  outcome.files = write_pages(document, "stress", tables, numbers, settings.out);
  for (const report::Block& block : document.blocks) {
    if (const auto* lead = std::get_if<report::Paragraph>(&block); lead && lead->lead) outcome.sentences.push_back(lead->text);
    if (const auto* figure = std::get_if<report::Figure>(&block)) outcome.sentences.push_back(figure->caption.substr(0, figure->caption.find(". ") + 1));
  }
  return outcome;
}

}  // namespace pivnp::app
