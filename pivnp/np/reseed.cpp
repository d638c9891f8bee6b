#include "pivnp/np/reseed.hpp"

#include <algorithm>
#include <limits>

#include "pivnp/core/particles/alive.hpp"

namespace pivnp::np {

Reseeder::Reseeder(const Grid& grid, int per_element, SeedPattern pattern, const Tracker& tracker) : grid_(grid) {
  // The pattern of one element, as the seeding at the start has it.
  const Grid one{{0, 0}, {1, 1}, 2, 2};
  const Polygon all({{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}, "element");
  pattern_ = seed(one, {{"element", all}}, per_element, pattern, 0, "np.per_element").x0;
  before_ = labels(tracker);
  for (const std::int64_t id : tracker.particles().id) next_id_ = std::max(next_id_, id + 1);
}

std::vector<std::int32_t> Reseeder::labels(const Tracker& tracker) const {
  std::vector<std::int32_t> out(grid_.element_count(), -1);
  const auto state = tracker.state();
  ElementPoint at;
  for (std::size_t p = 0; p < state.size(); ++p) {
    const auto now = state[p];
    if (!alive(now.status)) continue;
    if (locate(grid_, now.x, at)) out[grid_.element(at.i, at.j)] = tracker.particles().label[p];
  }
  return out;
}

ParticleSet Reseeder::births(const Tracker& tracker, const VectorField& field) {
  std::vector<std::int32_t> now = labels(tracker);
  ParticleSet born;
  const double area = grid_.spacing.prod() / double(pattern_.size());
  for (int j = 0; j + 1 < grid_.ny; ++j)
    for (int i = 0; i + 1 < grid_.nx; ++i) {
      const std::size_t element = grid_.element(i, j);
      if (now[element] >= 0 || before_[element] < 0) continue;
      bool valid = true;
      for (const std::size_t n :
           {grid_.node(i, j), grid_.node(i + 1, j), grid_.node(i, j + 1), grid_.node(i + 1, j + 1)})
        valid = valid && field.status[n] == VectorStatus::valid;
      if (!valid) continue;
      now[element] = before_[element];
      for (const Vec2& xi : pattern_) {
        born.id.push_back(next_id_++);
        born.label.push_back(now[element]);
        born.x0.push_back(grid_.position(i, j) + grid_.spacing.cwiseProduct(xi));
        born.area.push_back(area);
      }
    }
  born.born.assign(born.size(), tracker.time());
  born.end.assign(born.size(), std::numeric_limits<double>::quiet_NaN());
  born.end_reason.assign(born.size(), EndReason::none);
  before_ = std::move(now);
  return born;
}

}  // namespace pivnp::np
