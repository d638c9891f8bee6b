// How particles are laid out in an element (seeding.hpp).
#pragma once

#include "pivnp/core/choice.hpp"

namespace pivnp {

enum class SeedPattern { even, gauss };  // sub-cell centres, or Gauss-Legendre points
inline constexpr std::array seed_pattern_names{NamedValue{"even", SeedPattern::even},
                                               NamedValue{"gauss", SeedPattern::gauss}};
constexpr const auto& names_of(SeedPattern) { return seed_pattern_names; }

}  // namespace pivnp
