#include "apps/study/frontier/piv/piv_frontier.hpp"

#include <algorithm>

#include "apps/study/frontier/piv/pairs_in_turn.hpp"

namespace pivnp::app {

using piv::PivOptions;

namespace {

Scored at_nodes(const KnownPairs& known, const KnownPair& pair, const piv::PixelVectors& found) {
  Scores scores;
  for (std::size_t k = 0; k < known.nodes.pixel.size(); ++k) {
    if (!(pair.scored.empty() ? known.scored[k] : pair.scored[k])) continue;
    if (found.status[k] == VectorStatus::valid)
      scores.add(Vec2(double(found.displacement[k][0]), double(found.displacement[k][1])),
                 pair.truth({double(known.nodes.pixel[k][0]), double(known.nodes.pixel[k][1])}, found.anchor));
    else scores.add_none();
  }
  return scores.result();
}

}  // namespace

FrontierStage piv_frontier(const KnownPairs& known, const PivOptions& given, bool own, int repeats, int threads, Progress& progress,
                           const std::vector<PivChoice>& only, std::size_t first_compared) {
  const PivOptions base = plainly(given);
  FrontierStage stage;
  stage.name = "piv";
  stage.title = "Image correlation";
  stage.made_of = known.made_of;
  stage.error_label = "error, rms over all pairs (px)";
  stage.time_label = "time per pair of frames (ms)";
  stage.time_unit = 1e-3;
  stage.columns = pair_columns();

  std::vector<PivChoice> all = only.empty() ? piv_choices(base) : only;
  const PivOptions standard = with_defaults(base);
  if (own && std::none_of(all.begin(), all.end(), [&](const PivChoice& c) { return same(c.options, base); })) all.push_back({plain_name(base), base});
  std::vector<PivRun> runs;
  for (const PivChoice& c : all) {
    PivRun run{{}, c.options, known.nodes, [&](const KnownPair& pair, const piv::PixelVectors& found) { return at_nodes(known, pair, found); }};
    run.point.name = c.name;
    run.point.keys = keys_of(c.options, base);
    run.point.standard = same(c.options, standard);
    run.point.own = own && same(c.options, base);
    if (run.point.own && run.point.keys == "as it is") run.point.keys = "the case as it is";
    runs.push_back(std::move(run));
  }
  measure_in_turn(std::move(runs), known, first_compared, repeats, threads, progress, stage);
  const auto reference = std::find_if(stage.points.begin(), stage.points.end(), [&](const FrontierPoint& p) { return own ? p.own : p.standard; });
  compare_alike(reference == stage.points.end() ? nullptr : &*reference, stage.points);
  return stage;
}

}  // namespace pivnp::app
