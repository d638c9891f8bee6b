#include "apps/study/stress/stress_pages.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "apps/plot/canvas.hpp"
#include "apps/study/stress/map_drawing.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

std::string percent(double part, double all) { return number(all > 0 ? 100 * part / all : 0, 3) + " %"; }

double wrong_share(const Survival& s) { return s.all() > 0 ? s.wrong / s.all() : 0; }

std::string map_sentence(const SurvivalMap& map) {
  const Survival s = map.total();
  std::string text = map.title + ": " + percent(s.good, s.all()) + " right, " + percent(s.fair, s.all()) + " between, " + percent(s.flagged, s.all()) + " flagged, " +
                     percent(s.wrong, s.all()) + " wrong and not flagged";
  std::size_t worst = 0;
  for (std::size_t k = 1; k < map.cells.size(); ++k)
    if (wrong_share(map.cells[k]) > wrong_share(map.cells[worst])) worst = k;
  if (map.cells[worst].wrong > 0)
    text += "; most of that at " + map.x.label + " " + level_text(map.x, worst % map.x.size()) + ", " + map.y.label + " " + level_text(map.y, worst / map.x.size()) + " (" +
            percent(map.cells[worst].wrong, map.cells[worst].all()) + ")";
  return text + ".";
}

struct Stage {
  const char *name, *words;
};
constexpr Stage stage_words[] = {{"piv", "Image correlation"}, {"np", "Particles"}, {"mpm", "Simulation"}, {"compare", "Comparison"}};
constexpr double page_mm = 170;

// All maps of a stage in two columns.
report::Figure glance(const std::vector<SurvivalMap>& maps, const Stage& stage) {
  constexpr double title_mm = 6, gap_mm = 5;
  std::vector<const SurvivalMap*> own;
  for (const SurvivalMap& map : maps)
    if (map.name.starts_with(std::string(stage.name) + "_")) own.push_back(&map);
  double bottom = gap_mm + 5;
  std::vector<double> tops;
  for (std::size_t k = 0; k < own.size(); k += 2) {
    tops.push_back(bottom);
    bottom += title_mm + gap_mm + std::max(drawn_height_mm(*own[k]), k + 1 < own.size() ? drawn_height_mm(*own[k + 1]) : 0.0);
  }
  auto canvas = std::make_shared<plot::Canvas>(page_mm, bottom);
  draw_legend(*canvas, 18, 1);
  for (std::size_t k = 0; k < own.size(); ++k) {
    const double left = k % 2 ? page_mm / 2 : 0, top = tops[k / 2];
    canvas->text(left + page_mm / 4 + 5, top, own[k]->title, plot::Align::top, {.bold = true});
    draw_map(*canvas, *own[k], left, top + title_mm, page_mm / 2);
  }
  report::Figure figure;
  figure.name = std::string("stress_") + stage.name;
  figure.canvas = canvas;
  figure.caption = std::string(stage.words) + " at a glance. Broken lines: what theory expects; what each map is made of stands below it further down.";
  figure.shows = "All survival maps of the stage, small.";
  return figure;
}

}  // namespace

std::string flags_sentence(const Survival& s) {
  const std::string wrong = s.wrong_values > 0 ? "of what is wrong, " + percent(s.wrong_flagged, s.wrong_values) + " is flagged" : "nothing has a wrong value";
  const std::string right = s.right_values > 0 ? "of what is right, " + percent(s.right_flagged, s.right_values) + " is flagged" : "nothing has a right value";
  return wrong + "; " + right + ".";
}

Survival total_of(const std::vector<SurvivalMap>& maps, const std::string& stage) {
  Survival sum;
  for (const SurvivalMap& map : maps)
    if (map.name.starts_with(stage + "_")) sum.add(map.total());
  return sum;
}

report::Document stress_document(const std::vector<SurvivalMap>& maps, const std::string& subject) {
  report::Document document;
  document.title = "Where it holds, and where it fails: " + subject;
  document.subtitle = "A result that is wrong and not flagged is the defect to look for.";
  std::string lead;
  for (const Stage& stage : stage_words) {
    const Survival s = total_of(maps, stage.name);
    if (s.all() == 0) continue;
    lead += (lead.empty() ? "" : " ") + std::string(stage.words) + ", over all maps: ";
    // A verdict has no error of its own that could be held against its flag.
    if (s.wrong_values + s.right_values > 0) lead += flags_sentence(s);
    else lead += percent(s.wrong, s.all()) + " of its verdicts are wrong, and " + percent(s.flagged, s.all()) + " are withheld or doubted.";
  }
  document.blocks.push_back(report::Paragraph{lead, true});
  for (const Stage& stage : stage_words)
    if (total_of(maps, stage.name).all() > 0) document.blocks.push_back(glance(maps, stage));
  for (const SurvivalMap& map : maps) {
    document.blocks.push_back(report::Heading{1, map.title});
    const double height = 3 + drawn_height_mm(map);
    auto canvas = std::make_shared<plot::Canvas>(page_mm, height + 6);
    draw_map(*canvas, map, 0, 3, page_mm);
    draw_legend(*canvas, 18, height + 1);
    report::Figure figure;
    figure.name = map.name;
    figure.canvas = canvas;
    figure.caption = map_sentence(map) + " " + map.made_of + (map.theory.empty() ? "" : " Broken lines: what theory expects.");
    figure.shows = "Shares of right, doubtful, flagged and silently wrong results over " + map.x.label + " and " + map.y.label + ".";
    document.blocks.push_back(std::move(figure));
  }
  return document;
}

}  // namespace pivnp::app
