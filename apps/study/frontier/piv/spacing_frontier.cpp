#include "apps/study/frontier/piv/spacing_frontier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "apps/study/frontier/piv/pairs_in_turn.hpp"
#include "apps/study/frontier/piv/piv_choices.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "apps/study/synth/truth.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::app {

namespace {

using piv::PivOptions;

constexpr int least_px = 4;  // of a spacing worth having

// From the first node to the next in its row.
double spacing_px(const piv::NodeLattice& nodes) {
  const auto &a = nodes.pixel[0], &b = nodes.pixel[1];
  return std::hypot(double(b[0] - a[0]), double(b[1] - a[1]));
}

struct Box {
  Vec2 lower, upper;  // (column, row)
};

// About the cells of the nodes scored.
Box scored_box(const KnownPairs& known) {
  constexpr double far = std::numeric_limits<double>::max();
  Box box{{far, far}, {-far, -far}};
  for (std::size_t k = 0; k < known.scored.size(); ++k) {
    if (!known.scored[k]) continue;
    const Vec2 at(double(known.nodes.pixel[k][0]), double(known.nodes.pixel[k][1]));
    box.lower = box.lower.cwiseMin(at), box.upper = box.upper.cwiseMax(at);
  }
  const double half = 0.5 * spacing_px(known.nodes);
  return {box.lower - Vec2(half, half), box.upper + Vec2(half, half)};
}

// Four places about each node scored, somewhere in the quarters of its cell.
std::vector<Vec2> places_of(const KnownPairs& known) {
  const double h = spacing_px(known.nodes);
  std::vector<Vec2> places;
  for (std::size_t k = 0; k < known.scored.size(); ++k) {
    if (!known.scored[k]) continue;
    for (int quarter = 0; quarter < 4; ++quarter) {
      const std::uint64_t n = 2 * (4 * k + std::uint64_t(quarter));
      const Vec2 within(0.5 * (quarter % 2 + uniform(71, n)) - 0.5, 0.5 * (quarter / 2 + uniform(71, n + 1)) - 0.5);
      places.push_back(Vec2(double(known.nodes.pixel[k][0]), double(known.nodes.pixel[k][1])) + h * within);
    }
  }
  return places;
}

// Nodes `spacing` px apart about the box, within the frame, and one more around it for the shape functions where there is room.
Setting setting_of(const KnownPairs& known, const Box& box, double spacing) {
  const auto ends = [&](double lo, double hi, int size) {
    const double most = std::floor((size - 1) / spacing), wanted = std::ceil((hi - lo) / spacing) + 2;
    const double wide = std::min(most, wanted) * spacing;
    const double from = std::clamp(0.5 * (lo + hi - wide), 0.0, double(size - 1) - wide);
    return std::pair(from, from + wide);
  };
  const auto [left, right] = ends(box.lower.x(), box.upper.x(), known.width);
  const auto [top, bottom] = ends(box.lower.y(), box.upper.y(), known.height);
  const auto corner = [](double x, double y) { return "[" + number(x, 12) + ", " + number(y, 12) + "]"; };
  const Case c = parse_case("[frames]\npath = \"\"\n[grid]\nspacing_px = " + number(spacing, 12) + "\narea_px = [" + corner(left, bottom) + ", " +
                                corner(right, top) + "]\n",
                            "the nodes of pivnp frontier", ".");
  return make_setting(c, known.width, known.height);
}

// What measures and reads at one spacing.
class Reader {
 public:
  Reader(const KnownPairs& known, const std::vector<Vec2>& places, const Box& box, double spacing, const np::NpOptions& np)
      : places_(places), setting_(setting_of(known, box, spacing)), nodes_(node_lattice(setting_)), np_(np) {
    np_.reseed = false;
    particles_.label_names = {"material"};
    for (std::size_t k = 0; k < places.size(); ++k) {
      particles_.id.push_back(std::int64_t(k));
      particles_.label.push_back(0);
      particles_.x0.push_back(setting_.camera.to_world(places[k]));
      particles_.area.push_back(1);
      particles_.born.push_back(0);
      particles_.end.push_back(std::nan(""));
      particles_.end_reason.push_back(EndReason{});
    }
  }

  const piv::NodeLattice& nodes() const { return nodes_; }

  Scored score(const KnownPair& pair, const piv::PixelVectors& found) const {
    np::Tracker tracker(np_, particles_, 0);
    tracker.step(world_vectors(found, nodes_, setting_, {0, 1}), 1);
    const auto state = tracker.state();
    Scores scores;
    for (std::size_t k = 0; k < places_.size(); ++k) {
      if (alive(state[k].status)) scores.add(setting_.camera.to_pixel(state[k].x) - places_[k], pair.truth(places_[k], Anchor::forward));
      else scores.add_none();
    }
    return scores.result();
  }

 private:
  const std::vector<Vec2>& places_;
  Setting setting_;
  piv::NodeLattice nodes_;
  np::NpOptions np_;
  ParticleSet particles_;
};

struct Choice {
  std::string name;
  PivOptions options;
  double spacing = 0;
};

std::vector<Choice> choices(const PivOptions& base) {
  std::vector<Choice> all;
  for (const PivChoice& c : piv_choices(base)) {
    const int window = c.options.window_px;
    if (c.name != plain_name(c.options) || c.options.smoothing != piv::Smoothing::adaptive) continue;  // passes, orders, subsets
    if (window != 16 && window != 32 && window != 64) continue;
    for (const int part : {8, 4, 2, 1})
      if (window / part >= least_px) all.push_back({c.name, c.options, double(window) / part});
  }
  return all;
}

}  // namespace

FrontierStage spacing_frontier(const KnownPairs& known, const PivOptions& base_options, const np::NpOptions& np, const SpacingKey& given, bool own,
                               int repeats, int threads, Progress& progress) {
  const PivOptions base = plainly(base_options), standard = with_defaults(base);
  const std::vector<Vec2> places = places_of(known);
  const Box box = scored_box(known);
  constexpr double equal = 1e-6;  // px
  const double own_px = given.px > 0 ? given.px : base.window_px / 4.0;

  FrontierStage stage;
  stage.name = "piv_spacing";
  stage.title = "Image correlation: distance between nodes";
  stage.made_of = "The same pairs of frames. Errors are those of " + std::to_string(places.size()) + " numerical particles (" + std::string(name_of(np.shape)) +
                  ") between the nodes, one step each.";
  stage.error_label = "error between the nodes, rms over all pairs (px)";
  stage.time_label = "time per pair of frames (ms)";
  stage.time_unit = 1e-3;
  stage.columns = pair_columns();
  stage.columns[valid_column] = {"followed", "followed", "least share of the particles that can be followed in any pair"};
  stage.columns[2].text = "share of the particles, in the worst pair, that are followed and more than 0.5 px off";

  std::vector<Choice> all = choices(base);
  const auto is_own = [&](const Choice& c) { return same(c.options, base) && std::abs(c.spacing - own_px) < equal; };
  if (own && std::none_of(all.begin(), all.end(), is_own)) all.push_back({plain_name(base), base, own_px});
  std::vector<PivRun> runs;
  for (const Choice& c : all) {
    if ((box.upper - box.lower).minCoeff() < 3 * c.spacing && !is_own(c)) continue;  // hardly a field
    const auto reader = std::make_shared<const Reader>(known, places, box, c.spacing, np);
    PivRun run{{}, c.options, reader->nodes(), [reader](const KnownPair& pair, const piv::PixelVectors& found) { return reader->score(pair, found); }};
    run.point.name = c.name + ", nodes " + number(c.spacing, 3) + " px";
    run.point.own = own && is_own(c);
    run.point.standard = same(c.options, standard) && std::abs(c.spacing - standard.window_px / 4.0) < equal;
    const std::string keys = keys_of(c.options, base), key = given.key ? given.key(c.spacing) : "grid.spacing_px=" + number(c.spacing, 6);
    run.point.keys = run.point.own ? "the case as it is" : keys == "as it is" ? key : keys + " " + key;
    runs.push_back(std::move(run));
  }
  measure_in_turn(std::move(runs), known, 0, repeats, threads, progress, stage);
  const auto reference = std::find_if(stage.points.begin(), stage.points.end(), [&](const FrontierPoint& p) { return own ? p.own : p.standard; });
  compare_alike(reference == stage.points.end() ? nullptr : &*reference, stage.points);
  return stage;
}

}  // namespace pivnp::app
