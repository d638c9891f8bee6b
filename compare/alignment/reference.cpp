#include "compare/alignment/reference.hpp"

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::compare {

namespace {

std::size_t least(bool turn) { return turn ? 3 : 1; }

}  // namespace

Reference::Reference(const Points& polygon, bool turn, const std::string& key, const DataSet& first, const DataSet& second)
    : given_(!polygon.empty()), turn_(turn), sets_{&first, &second} {
  if (!given_) return;
  std::vector<Vec2> vertices = positions_of(polygon);
  const Polygon inside(std::move(vertices), key);
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t p = 0; p < sets_[s]->size(); ++p)
      if (sets_[s]->state().followed[p] && inside.contains(sets_[s]->material_position()[p]))
        members_[s].push_back(p);
    if (members_[s].size() < least(turn))
      throw InputError(key + ": the polygon holds " + (members_[s].empty() ? "no particle" : "too few particles") +
                       " of motion '" + sets_[s]->motion().name() + "', expected at least " +
                       (turn ? "three" : "one"));
  }
}

std::optional<std::array<RigidFit, 2>> Reference::fit(const DataSetState& first, const DataSetState& second) const {
  std::array<RigidFit, 2> fits;
  if (!given_) return fits;
  const std::array<const DataSetState*, 2> states{&first, &second};
  for (std::size_t s = 0; s < 2; ++s) {
    std::vector<Vec2> X, x;
    for (const std::size_t p : members_[s]) {
      if (!states[s]->followed[p]) continue;
      X.push_back(sets_[s]->material_position()[p]);
      x.push_back(X.back() + states[s]->u[p]);
    }
    if (X.size() < least(turn_)) return std::nullopt;
    fits[s] = fit_rigid(X, x, turn_);
  }
  return fits;
}

}  // namespace pivnp::compare
