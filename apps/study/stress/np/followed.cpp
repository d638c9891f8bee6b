#include "apps/study/stress/np/followed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "apps/study/methods/paths/closure.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/seeding.hpp"
#include "pivnp/np/reseed.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::app {

namespace {

// Vectors of the known motion with their errors.
class Vectors {
 public:
  Vectors(const KnownPaths& paths, std::uint64_t seed) : paths_(paths), random_(seed) {
    const std::size_t nodes = paths.grid.node_count();
    const double repeated = paths.error_px * std::sqrt(paths.repeated_share);
    for (std::size_t k = 0; k < nodes; ++k) repeated_.push_back(repeated * gauss());
    if (repeated > 0) note_.repeated.assign(nodes, {float(repeated * repeated), float(repeated * repeated), 0});
  }

  VectorField pair(int number) {
    const Grid& grid = paths_.grid;
    VectorField field;
    field.pair = {number, number + 1};
    field.anchor = paths_.anchor;
    field.grid = grid;
    field.correlation_length = float(element_px);
    const double own = paths_.error_px * std::sqrt(1 - paths_.repeated_share);
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const Vec2 at(grid.origin.x() + i * grid.spacing.x(), grid.origin.y() + j * grid.spacing.y());
        const Vec2 d = paths_.increment(at, number) + repeated_[grid.node(i, j)] + own * gauss();
        const VectorStatus status = paths_.status ? paths_.status(at, number) : VectorStatus::valid;
        const bool known = status != VectorStatus::masked && status != VectorStatus::failed;
        constexpr float none = std::numeric_limits<float>::quiet_NaN();
        field.displacement.push_back(known ? std::array<float, 2>{float(d.x()), float(d.y())} : std::array<float, 2>{none, none});
        field.status.push_back(status);
        field.cov.push_back({float(own * own), float(own * own), 0});
        field.score.push_back(known ? 1 : none);
      }
    if (!note_.repeated.empty()) add_repeated(note_, number + 1, field);
    return field;
  }

 private:
  Vec2 gauss() {
    const double x = normal_(random_), y = normal_(random_);
    return {x, y};
  }

  const KnownPaths& paths_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::vector<Vec2> repeated_;
  ClosureNote note_;
};

}  // namespace

Survival followed(const KnownPaths& paths, std::uint64_t seed, const Progress& progress) {
  Vectors vectors(paths, seed);
  np::Tracker tracker(paths.options, pivnp::seed(paths.grid, {paths.region}, paths.options.per_element, paths.options.seeding, 0, "np.per_element"), 0);
  const std::size_t first = tracker.particles().size();
  std::optional<np::Reseeder> reseeder;
  if (paths.births_alone) reseeder.emplace(paths.grid, paths.options.per_element, paths.options.seeding, tracker);
  for (int k = 0; k < paths.frames; ++k) {
    if (progress.stop_requested()) throw Interrupted();
    const VectorField field = vectors.pair(k);
    tracker.step(field, k + 1);
    if (!reseeder) continue;
    if (const ParticleSet born = reseeder->births(tracker, field); born.size() > 0) tracker.add(born);
  }
  Survival s;
  const ParticleSet& set = tracker.particles();
  const auto states = tracker.state();
  for (std::size_t p = paths.births_alone ? first : 0; p < set.size(); ++p) {
    const np::Tracker::Particle state = states[p];
    if (!alive(state.status)) {
      s.count_none();
      continue;
    }
    const double error = (state.x - paths.position(set.x0[p], paths.frames - set.born[p])).norm();
    const double stated = std::sqrt(std::max(state.cov[0], state.cov[1]));
    s.count(error, path_bounds, state.status == ParticleStatus::active && stated <= most_stated_px);
  }
  return s;
}

}  // namespace pivnp::app
