// An unknown offset between two data sets' coordinates, found on the outlines they begin with.
#pragma once

#include <vector>

#include "compare/data/data_set.hpp"
#include "compare/data/rigid.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::compare {

using Rings = std::vector<std::vector<Vec2>>;

/// The rigid motion that lays the outline `second` on `first`, by least squares of the distances, across the outline, of
/// points `step` apart on the first (point-to-line matching: Chen & Medioni 1992, Image Vis. Comput. 10). Only points
/// inside `zone` count (all without one). `start`: where the search begins. Points further off than three medians of the
/// distance are left out. sigma: jackknife over up to 16 pieces of the outline. Throws InputError if the outline's part
/// does not hold a shift or the turn (a straight edge, a circle), or the search does not come to rest.
RigidFit match_outlines(const Rings& first, const Rings& second, double step, const Points& zone,
                        const Vec2& start);

/// The same for two data sets as read at the common start; the search begins with the centres of their areas on each other,
/// with a zone where the second stands.
RigidFit match_data_sets(const DataSet& first, const DataSet& second, const Points& zone);

}  // namespace pivnp::compare
