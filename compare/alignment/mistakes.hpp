// Mistakes of units, origin and axes, which the outlines show before anything moves.
#pragma once

#include <string>

#include "compare/data/triangulation.hpp"

namespace pivnp::compare {

/// Where both outlines at the common start lie more than 0.75 of the greater spacing apart (their symmetric difference over the
/// length of the first) and one change of the second's coordinates (a shift, axes exchanged, a mirror, a scale, a turn) leaves
/// less than 0.6 of a spacing and of that: a sentence that names it, the simplest that is within a quarter and a fifth of a spacing of the best. Else empty, so
/// also where one data set covers only a part of the other. Symmetric bodies hide some changes.
std::string likely_mistake(const MaterialMesh& first, double spacing_first, const MaterialMesh& second, double spacing_second,
                           const std::string& unit);

}  // namespace pivnp::compare
