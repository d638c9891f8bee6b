#include "apps/study/stress/mpm/trial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "apps/study/methods/simulation/doubts.hpp"
#include "mpm/solver/solver.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

struct Moved {
  std::vector<Vec2> x0, u;
};

Moved moved(const Trial& trial, Progress& progress) {
  if (progress.stop_requested()) throw Interrupted();
  mpm::Solver solver(trial.options, trial.scene, 1);
  solver.advance_to(trial.end_s, progress);
  const MotionFrame frame = solver.frame();
  Moved m;
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    if (!alive(frame.status[k])) continue;
    m.x0.push_back(solver.particles().x0[k]);
    m.u.push_back({double(frame.u[k][0]), double(frame.u[k][1])});
  }
  return m;
}

// Mean displacements over the squares of a lattice that all runs share.
std::map<std::pair<int, int>, Vec2> on_lattice(const Moved& m, double side) {
  std::map<std::pair<int, int>, std::pair<Vec2, double>> sums;
  for (std::size_t k = 0; k < m.x0.size(); ++k) {
    auto& [sum, n] = sums.try_emplace({int(std::floor(m.x0[k].x() / side)), int(std::floor(m.x0[k].y() / side))}, Vec2(0, 0), 0.0).first->second;
    sum += m.u[k];
    ++n;
  }
  std::map<std::pair<int, int>, Vec2> means;
  for (const auto& [at, s] : sums) means[at] = s.first / s.second;
  return means;
}

// RMS difference over the greatest displacement of the reference.
double difference_of(const Moved& run, const Moved& reference, double side) {
  const auto a = on_lattice(run, side), b = on_lattice(reference, side);
  double square = 0, most = 0;
  for (const auto& [at, u] : b) {
    const auto found = a.find(at);
    square += found == a.end() ? u.squaredNorm() : (found->second - u).squaredNorm();
    most = std::max(most, u.norm());
  }
  return std::sqrt(square / double(b.size())) / most;
}

// References, each simulated by whoever needs it first.
class References {
 public:
  const Moved& at(const std::pair<std::size_t, std::size_t>& key, const std::function<Moved()>& make) {
    std::unique_lock lock(mutex_);
    Entry& entry = entries_[key];
    lock.unlock();
    const std::lock_guard own(entry.mutex);
    if (!entry.moved) entry.moved = make();
    return *entry.moved;
  }

 private:
  struct Entry {
    std::mutex mutex;
    std::optional<Moved> moved;
  };
  std::mutex mutex_;
  std::map<std::pair<std::size_t, std::size_t>, Entry> entries_;
};

Moved known_motion(const std::vector<Vec2>& x0, const std::function<Vec2(const Vec2&)>& truth) {
  Moved m{x0, {}};
  for (const Vec2& x : x0) m.u.push_back(truth(x));
  return m;
}

}  // namespace

MapPlan plan_of(TrialMap map) {
  MapPlan plan;
  plan.map = {map.name, map.title,
              map.scene_words + ". A run a combination. Right: within " + number(100 * motion_bounds.right) + " % of the greatest displacement, rms, of " +
                  (map.truth ? "what is known" : "the default scheme on finer cells") + "; wrong: more than " + number(100 * motion_bounds.wrong) +
                  " % without a warning. A run that stops with its reason, or is doubted beforehand, is flagged.",
              map.x, map.y, {}, map.theory};
  const auto references = std::make_shared<References>();
  plan.result = [map = std::move(map), references](std::size_t i, std::size_t j, Progress& progress) {
    const double x = map.x.names.empty() ? map.x.levels[i] : double(i);
    const Trial trial = map.trial(x, j);
    const Moved reference = map.truth ? known_motion(trial.scene.particles.x0, [&](const Vec2& x0) { return map.truth(x, x0); })
                                      : references->at({map.reference_by_x ? i : 0, map.reference_by_row ? j : 0}, [&] { return moved(map.reference(x, j), progress); });
    const bool doubted = !doubts(trial.options, trial.scene).empty();
    Survival s;
    try {
      s.count(difference_of(moved(trial, progress), reference, map.square_m), motion_bounds, !doubted);
    } catch (const RunError& e) {
      s.count(std::numeric_limits<double>::infinity(), motion_bounds, false);
    } catch (const InputError&) {  // refused
      s.count_none();
    }
    return s;
  };
  return plan;
}

mpm::MpmOptions bare_options() {
  mpm::MpmOptions options;
  options.initial_equilibrium = false;
  options.end_at_rest = false;
  return options;
}

mpm::MaterialOptions elastic_soil(double young_pa, double poisson, double density_kg_m3) {
  mpm::MaterialOptions m;
  m.model = "linear_elastic";
  m.young_pa = young_pa;
  m.poisson = poisson;
  m.density_kg_m3 = density_kg_m3;
  return m;
}

mpm::BoundaryOptions line_boundary(Pair from, Pair to, mpm::BoundaryType type) {
  mpm::BoundaryOptions b;
  b.line_m = {from, to};
  b.type = type;
  return b;
}

Region box_region(const std::string& name, double x0, double y0, double x1, double y1) {
  return {name, Polygon({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, name)};
}

Grid cells_to(const Vec2& corner, double cell) {
  return {{0, 0}, {cell, cell}, int(std::ceil(corner.x() / cell - 1e-9)) + 1, int(std::ceil(corner.y() / cell - 1e-9)) + 1};
}

namespace {

struct NamedScheme {
  const char* name;
  mpm::ShapeKind shape;
  mpm::TransferKind transfer;
};
constexpr NamedScheme schemes[] = {{"bilinear, flip", mpm::ShapeKind::bilinear, mpm::TransferKind::flip},
                                   {"gimp, flip", mpm::ShapeKind::gimp, mpm::TransferKind::flip},
                                   {"bspline, flip", mpm::ShapeKind::bspline, mpm::TransferKind::flip},
                                   {"bspline, apic", mpm::ShapeKind::bspline, mpm::TransferKind::apic}};

}  // namespace

MapAxis scheme_rows() {
  MapAxis axis{"shape functions, transfer", {}, {}};
  for (const NamedScheme& s : schemes) axis.names.emplace_back(s.name);
  return axis;
}

void take_scheme(mpm::MpmOptions& options, std::size_t row) {
  options.shape = schemes[row].shape;
  options.transfer = schemes[row].transfer;
}

}  // namespace pivnp::app
