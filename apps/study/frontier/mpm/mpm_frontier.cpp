#include "apps/study/frontier/mpm/mpm_frontier.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "apps/study/frontier/work.hpp"
#include "apps/study/methods/simulation/simulation.hpp"
#include "apps/study/pipeline/scene/simulation_scene.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr double finer_cells = 0.5, coarser_cells = 2;  // whole factors: meshes fit the same outlines

struct Result {
  ParticleSet particles;
  MotionFrame last;
  Effort work;
  double steps = 0;
};

Result run(const Case& c, const Setting& setting, double factor, double end, int threads, Progress& progress) {
  Setting coarse = setting;
  coarse.grid = coarsened(setting.grid, factor);
  WithinProgress unseen(progress);
  Result r;
  r.work = measured(threads, [&] {
    mpm::Solver solver = make_solver(c, coarse, threads);
    if (c.mpm->initial_equilibrium) solver.find_initial_equilibrium(unseen);
    solver.advance_to(end, unseen);
    r.particles = solver.particles();
    r.last = solver.frame();
    r.steps = double(solver.steps());
  });
  return r;
}

// The truth's points by their place at the start.
class Truth {
 public:
  explicit Truth(const Result& r) : r_(r) {
    for (std::uint32_t k = 0; k < r.particles.size(); ++k)
      if (alive(r.last.status[k])) order_.push_back(k);
    std::sort(order_.begin(), order_.end(), [&](auto a, auto b) { return r.particles.x0[a].x() < r.particles.x0[b].x(); });
  }
  /// Mean displacement of the points of one label in a square about x; none where there is none.
  std::optional<Vec2> displacement(const Vec2& x, double half, std::int32_t label) const {
    const std::vector<Vec2>& x0 = r_.particles.x0;
    auto at = std::lower_bound(order_.begin(), order_.end(), x.x() - half, [&](auto k, double left) { return x0[k].x() < left; });
    Vec2 sum(0, 0);
    double n = 0;
    for (; at != order_.end() && x0[*at].x() <= x.x() + half; ++at) {
      if (std::abs(x0[*at].y() - x.y()) > half || r_.particles.label[*at] != label) continue;
      sum += Vec2(double(r_.last.u[*at][0]), double(r_.last.u[*at][1]));
      ++n;
    }
    return n > 0 ? std::optional<Vec2>(sum / n) : std::nullopt;
  }

 private:
  const Result& r_;
  std::vector<std::uint32_t> order_;
};

struct Difference {
  double rms = 0, greatest = 0, alike = 0;  // m, m, share of points that have a partner
};

Difference difference(const Result& r, const Truth& truth) {
  Difference d;
  double n = 0, square = 0;
  for (std::size_t k = 0; k < r.particles.size(); ++k) {
    if (!alive(r.last.status[k])) continue;
    const auto u = truth.displacement(r.particles.x0[k], 0.5 * std::sqrt(double(r.particles.area[k])), r.particles.label[k]);
    if (!u) continue;
    const double away = (Vec2(double(r.last.u[k][0]), double(r.last.u[k][1])) - *u).norm();
    square += away * away, ++n;
    d.greatest = std::max(d.greatest, away);
  }
  d.rms = std::sqrt(square / n);
  d.alike = n / double(r.particles.size());
  return d;
}

struct Variant {
  std::string name, keys;
  mpm::MpmOptions options;
  bool own = false, standard = false;
  bool coarser = true;  // on cells twice as large too
};

// The case's own with other numbers of points, and other steps.
void add_points_and_steps(const mpm::MpmOptions& given, std::vector<Variant>& all) {
  const Variant own = all.front();
  const auto add = [&](const std::string& more, const std::string& keys, const auto& change) {
    Variant v = own;
    v.name += more, v.keys = keys;
    v.own = v.standard = v.coarser = false;
    change(v.options);
    all.push_back(std::move(v));
  };
  for (const int points : {1, 4, 9, 16})
    if (points != given.per_element)
      add(", " + std::to_string(points) + (points == 1 ? " point a cell" : " points a cell"), "mpm.per_element=" + std::to_string(points),
          [&](mpm::MpmOptions& o) { o.per_element = points; });
  for (const double courant : {0.2, 0.4, 0.8})
    if (courant != given.courant)
      add(", step " + number(courant, 2) + " of the critical", "mpm.courant=" + number(courant, 2), [&](mpm::MpmOptions& o) { o.courant = courant; });
}

std::vector<Variant> variants(const mpm::MpmOptions& given) {
  const mpm::Scheme mine = mpm::scheme_of(given), standard = mpm::scheme_of([&] {
    mpm::MpmOptions o;
    o.gravity_m_s2 = given.gravity_m_s2;
    return o;
  }());
  std::vector<Variant> all = {{"the case's", "the case as it is", given, true, false, true}};
  for (const mpm::ShapeRow& shape : mpm::shapes())
    for (const mpm::TransferRow& transfer : mpm::transfers()) {
      if (transfer.value != transfer.runs() || shape.value != shape.runs()) continue;  // another one's kernel
      Variant v;
      v.name = std::string(shape.name) + ", " + std::string(transfer.name);
      v.keys = "mpm.shape=" + std::string(shape.name) + " mpm.transfer=" + std::string(transfer.name);
      v.options = given;
      v.options.shape = shape.value;
      v.options.transfer = transfer.value;
      if (!transfer.blends) v.options.pic_per_s.reset();
      try {
        const mpm::Scheme scheme = mpm::scheme_of(v.options);
        const auto same = [&](const mpm::Scheme& o) { return scheme.shape == o.shape && scheme.transfer == o.transfer; };
        if (same(mine)) {
          all.front().name = v.name;
          all.front().standard = same(standard) && given.scheme == mpm::SchemeName::standard && !given.stress_update && !given.locking;
          continue;
        }
        v.standard = same(standard) && given.scheme == mpm::SchemeName::standard;
      } catch (const InputError&) {
        continue;  // what the case says beside does not go with it
      }
      all.push_back(std::move(v));
    }
  add_points_and_steps(given, all);
  return all;
}

// The observed order p: differences from the truth's cells are C (h^p - 2^-p), so those of cells 2 and 1 are as 2^p + 1.
struct Convergence {
  std::optional<double> order;
  double left = 0;   // error that the case's own cells leave
  double truth = 0;  // error of the truth
};

Convergence convergence(const std::vector<std::pair<double, double>>& own) {
  if (own.size() != 2 || !(own[0].second > 0)) return {};
  const double ratio = own[1].second / own[0].second;
  constexpr double least = 0.2, most = 4;
  if (!(ratio > std::pow(2, least) + 1) || ratio > std::pow(2, most) + 1) return {};
  Convergence c;
  c.order = std::log2(ratio - 1);
  c.left = own[0].second / (1 - std::pow(2, -*c.order));
  c.truth = c.left * std::pow(2, -*c.order);
  return c;
}

std::string cells(double factor) { return factor == 1 ? "" : ", cells " + number(factor, 3) + " times"; }

}  // namespace

FrontierStage mpm_frontier(const Case& c, const Setting& setting, double end, int repeats, int threads, Progress& progress) {
  FrontierStage stage;
  stage.name = "mpm";
  stage.title = "Simulation";
  const std::string unit = setting.camera.length_unit();
  stage.error_label = "displacement, rms difference from finer cells (" + unit + ")";
  stage.time_label = "time of a run (s)";
  stage.columns = {{"cell_" + unit, "cell (" + unit + ")", "side of a cell"},
                   {"greatest_" + unit, "greatest (" + unit + ")", "greatest difference of any material point"},
                   {"points", "points", "material points"},
                   {"steps", "steps", "time steps"},
                   {"partners", "partners", "share of the material points that have a partner among the truth's"}};
  const std::vector<Variant> all = variants(*c.mpm);
  const double factors[] = {1, coarser_cells};
  std::int64_t total = 1;
  for (const Variant& v : all) total += v.coarser ? 2 : 1;
  std::int64_t done = 0;
  progress.update("runs", done, total);
  const Result finest = run(c, setting, finer_cells, end, threads, progress);
  const Truth truth(finest);
  stage.made_of = "The case's own setting on cells " + number(finer_cells, 2) + " times as large (" + std::to_string(finest.particles.size()) +
                  " material points, " + number(finest.work.seconds, 3) + " s) stands for the truth at t = " + number(end, 4) +
                  " s; each setting ran on cells of the case's size and twice that.";
  std::vector<std::pair<double, double>> own;  // cells and errors of the case's setting
  std::vector<Timed> timed;                    // as stage.points
  for (const Variant& v : all)
    for (const double factor : factors) {
      if (factor != 1 && !v.coarser) continue;
      progress.update("runs", ++done, total);
      Case changed = c;
      changed.mpm = v.options;
      FrontierPoint p;
      p.name = v.name + cells(factor);
      p.keys = v.keys + (factor == 1 ? "" : ", grid spacing times " + number(factor, 3));
      p.own = v.own && factor == 1;
      p.standard = v.standard && factor == 1;
      try {
        const Result r = run(changed, setting, factor, end, threads, progress);
        const Difference d = difference(r, truth);
        timed.push_back({{r.work.seconds}, [=, &setting, &progress] { return run(changed, setting, factor, end, threads, progress).work.seconds; }});
        p.bytes = r.work.bytes, p.instructions = r.work.instructions;
        p.error = d.rms;
        p.columns = {setting.grid.spacing.x() * factor / c.mpm->refine, d.greatest, double(r.particles.size()), r.steps, d.alike};
        if (v.own) own.push_back({factor, d.rms});
        stage.points.push_back(std::move(p));
      } catch (const RunError& error) {
        stage.left_out.push_back(p.name + ": " + error.what());
      } catch (const InputError& error) {
        stage.left_out.push_back(p.name + ": " + error.what());
      }
    }
  repeat_in_turn(timed, repeats, progress);
  for (std::size_t k = 0; k < timed.size(); ++k) set_times(timed[k].seconds, stage.points[k]);
  find_front(stage.points);
  const Convergence found = convergence(own);
  if (found.order) {
    stage.floor = found.truth;
    stage.remarks.push_back("Observed order in the cell of the case's setting: " + number(*found.order, 2) + "; by it the case's cells leave an error of " +
                            number(found.left, 2) + " " + unit + " rms (grid convergence index of three meshes, factor of safety 1.25: " + number(1.25 * found.left, 2) + " " + unit + "), and the truth's " + number(found.truth, 2) + ": smaller differences than that say nothing.");
  } else if (own.size() == 1) {
    stage.floor = own.front().second;
    stage.remarks.push_back("On cells twice as large the case's setting does not run: the error of the reference itself is not known.");
  } else if (!own.empty()) {
    stage.floor = own.front().second;
    stage.remarks.push_back("With the case's setting the difference does not fall with the cell as an error of any order would: the error of the reference "
                            "itself is not known, and settings that differ by less are alike.");
  }
  return stage;
}

}  // namespace pivnp::app
