#include "apps/study/stress/stress.hpp"

#include <algorithm>
#include <memory>
#include <string_view>
#include <system_error>
#include <thread>

#include "apps/plot/files.hpp"
#include "apps/study/frontier/written_pages.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "apps/study/stress/cells.hpp"
#include "apps/study/stress/compare/compare_maps.hpp"
#include "apps/study/stress/mpm/mpm_maps.hpp"
#include "apps/study/stress/np/np_maps.hpp"
#include "apps/study/stress/piv/piv_maps.hpp"
#include "apps/study/stress/stress_pages.hpp"
#include "apps/study/synth/case_frames.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/records/table_file.hpp"

namespace pivnp::app {

namespace {

constexpr int stress_side = 512, short_side = 320;  // px

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

namespace {

std::vector<MapPlan> plans_of(const Case* given, const StressOptions& options, const RunSettings& settings, int threads, Progress& progress) {
  const auto asked = [&](std::string_view stage) { return options.stages.empty() || std::find(options.stages.begin(), options.stages.end(), stage) != options.stages.end(); };
  std::vector<MapPlan> all;
  const auto take = [&](std::vector<MapPlan> plans) {
    for (MapPlan& plan : plans) all.push_back(options.in_short ? thinned(plan) : std::move(plan));
  };
  if (asked("piv")) {
    const piv::PivOptions piv = given && given->piv ? *given->piv : piv::PivOptions{};
    take(piv_maps(piv, options.in_short ? short_side : stress_side, options.seeds));
    take(piv_edge_maps(piv, options.seeds));
    if (given && given->piv && (given->synth || settings.frames || (given->frames && !given->frames->path.empty()))) {
      Case c = *given;
      if (const std::unique_ptr<image::FrameSource> source = case_frames(c, settings, progress))
        take(piv_own_maps(c, make_setting(c, source->width(), source->height()), *source, threads, progress));
    }
  }
  if (asked("np")) take(np_maps(given && given->np ? *given->np : np::NpOptions{}));
  if (asked("mpm")) take(mpm_maps());
  if (asked("compare")) take(compare_maps());
  if (options.maps.empty()) return all;
  std::vector<std::string> names;
  for (const MapPlan& plan : all) names.push_back(plan.map.name);
  for (const std::string& name : options.maps)
    if (std::find(names.begin(), names.end(), name) == names.end()) throw InputError("--maps: found '" + name + "'" + did_you_mean(name, names));
  std::erase_if(all, [&](const MapPlan& plan) { return std::find(options.maps.begin(), options.maps.end(), plan.map.name) == options.maps.end(); });
  return all;
}

}  // namespace

StressOutcome stress(const Case* c, const StressOptions& options, const RunSettings& settings, Progress& progress) {
  const int threads = settings.threads > 0 ? settings.threads : int(std::max(1u, std::thread::hardware_concurrency()));
  for (const std::string& stage : options.stages)
    if (std::find(stress_stages.begin(), stress_stages.end(), stage) == stress_stages.end())
      throw InputError("--stages: found '" + stage + "', expected " + one_of({stress_stages.begin(), stress_stages.end()}));
  StressOutcome outcome;
  plot::make_folder(settings.out);  // before the work
  const std::filesystem::path part = settings.out / "stress.part";
  FilledMaps made = filled(plans_of(c, options, settings, threads, progress), part, threads, progress);
  outcome.maps = std::move(made.maps);
  outcome.combinations = made.combinations;
  outcome.kept = made.kept;
  const report::Document document = stress_document(outcome.maps, c ? (c->name.empty() ? of_file(*c) : c->name) + ", with its [piv] and [np]" : "the default");
  std::vector<std::pair<std::string, std::string>> tables;
  std::vector<io::NamedTable> numbers;
  for (const SurvivalMap& map : outcome.maps) {
    tables.push_back({map.name + ".csv", csv(map)});
    numbers.push_back(table_of_map(map));
  }
  outcome.files = write_pages(document, "stress", tables, numbers, settings.out);
  std::error_code ignored;
  std::filesystem::remove(part, ignored);  // all of it is in the files now
  for (const report::Block& block : document.blocks) {
    if (const auto* lead = std::get_if<report::Paragraph>(&block); lead && lead->lead) outcome.sentences.push_back(lead->text);
    if (const auto* figure = std::get_if<report::Figure>(&block); figure && !figure->name.starts_with("stress_")) outcome.sentences.push_back(figure->caption.substr(0, figure->caption.find(". ") + 1));
  }
  return outcome;
}

}  // namespace pivnp::app
