// Where particles start: n per occupied element of the grid, inside a region.
#pragma once

#include <vector>

#include "pivnp/core/grid/grid.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/particles/seed_pattern.hpp"

namespace pivnp {

/// Seeds `per_element` = k*k particles in every element of `grid` that a region occupies: the particle counts if its
/// own point lies inside the region. Each stands for 1/per_element of its element. Ids are element * per_element + k,
/// so that two seedings on the same grid and regions pair by id. Labels are indices into `regions`; where two regions
/// overlap, the first wins. Throws InputError if per_element is not a square, naming `what`, or if a region holds no
/// particle at all.
ParticleSet seed(const Grid& grid, const std::vector<Region>& regions, int per_element, SeedPattern pattern,
                 double birth_time, const std::string& what);

}  // namespace pivnp
