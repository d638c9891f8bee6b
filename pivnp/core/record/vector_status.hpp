// What is said of a vector beside its value: the instant that its place belongs to, and whether it may be used.
#pragma once

#include <array>
#include <cstdint>

#include "pivnp/core/choice.hpp"

namespace pivnp {

/// Which instant a vector's place belongs to: the first frame (the node's material moves from the node), or the middle
/// of the pair (symmetric windows).
enum class Anchor : std::uint8_t { forward = 0, central = 1 };
inline constexpr std::array anchor_names{NamedValue{"central", Anchor::central}, NamedValue{"forward", Anchor::forward}};
constexpr const auto& names_of(Anchor) { return anchor_names; }

enum class VectorStatus : std::uint8_t {
  masked = 0,    // no measurement asked for here
  valid = 1,
  replaced = 2,  // measurement rejected; value rebuilt from valid neighbours
  rejected = 3,  // measurement rejected; its value is kept for inspection, not to be used
  failed = 4,    // nothing could be measured (no texture, outside the image): value is NaN
  outside = 5,   // in front of no material (known once particles were followed): what the window shows there is not used
};

/// True where the value may be used (valid or replaced).
inline bool usable(VectorStatus s) { return s == VectorStatus::valid || s == VectorStatus::replaced; }

}  // namespace pivnp
