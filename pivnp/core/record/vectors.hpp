// Measured displacement increments of one pair of frames at the nodes of the grid.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/grid/grid.hpp"

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
};

/// One pair. Lengths in the record's unit, y upward. Arrays are [ny][nx] in the grid's node order.
struct VectorField {
  std::array<int, 2> pair{0, 1};  // frame indices
  Anchor anchor = Anchor::central;
  Grid grid;
  std::vector<std::array<float, 2>> displacement;
  std::vector<VectorStatus> status;
  std::vector<std::array<float, 3>> cov;  // random error (uu, vv, uv), length^2
  float correlation_length = 0;           // distance within which the errors of vectors are alike
  std::vector<float> score;               // correlation coefficient of the matched subset, -1 .. 1; NaN if failed
};

/// True where the value may be used (valid or replaced).
inline bool usable(VectorStatus s) { return s == VectorStatus::valid || s == VectorStatus::replaced; }

}  // namespace pivnp
