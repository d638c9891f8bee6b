#include "compare/reference.hpp"

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::compare {

Reference::Reference(const Points& polygon, const Side& first, const Side& second) : given_(!polygon.empty()) {
  if (!given_) return;
  std::vector<Vec2> vertices;
  for (const Pair& p : polygon) vertices.emplace_back(p[0], p[1]);
  const Polygon inside(std::move(vertices), "compare.reference_m");
  const std::array<const Side*, 2> sides{&first, &second};
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t p = 0; p < sides[s]->size(); ++p)
      if (sides[s]->state().followed[p] && inside.contains(sides[s]->material_position()[p])) members_[s].push_back(p);
    if (members_[s].empty())
      throw InputError("compare.reference_m: the polygon holds no particle of motion '" + sides[s]->motion().name() +
                       "', expected at least one");
  }
}

std::optional<std::array<Vec2, 2>> Reference::shift(const SideState& first, const SideState& second) const {
  std::array<Vec2, 2> mean{Vec2::Zero(), Vec2::Zero()};
  if (!given_) return mean;
  const std::array<const SideState*, 2> states{&first, &second};
  for (std::size_t s = 0; s < 2; ++s) {
    std::size_t count = 0;
    for (std::size_t p : members_[s]) {
      if (!states[s]->followed[p]) continue;
      mean[s] += states[s]->u[p];
      ++count;
    }
    if (count == 0) return std::nullopt;
    mean[s] /= double(count);
  }
  return mean;
}

}  // namespace pivnp::compare
