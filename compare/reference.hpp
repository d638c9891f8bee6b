// The frame both sides are seen in: the mean motion of declared reference material, taken off each side.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "compare/side.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::compare {

class Reference {
 public:
  /// Without a polygon nothing is taken off. Throws InputError if the polygon is not simple, or holds no particle of a
  /// side at the common start, naming which.
  Reference(const Points& polygon, const Side& first, const Side& second);

  bool given() const { return given_; }
  std::size_t count(int side) const { return members_[std::size_t(side)].size(); }

  /// Mean displacement of the reference particles still followed, first and second side; zero without a polygon;
  /// nothing once a side has lost them all.
  std::optional<std::array<Vec2, 2>> shift(const SideState& first, const SideState& second) const;

 private:
  bool given_ = false;
  std::array<std::vector<std::size_t>, 2> members_;  // by material position at the common start
};

}  // namespace pivnp::compare
