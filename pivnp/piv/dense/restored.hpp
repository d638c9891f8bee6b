// What cells show of a field, depending on the field about which they were measured.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/piv/dense/spline_field.hpp"

namespace pivnp::piv {

/// One component. A pair's cells are measured about a smooth field: of what that one lacks, they show the mean with their hat weights
/// (a wave of wavenumber k loses (k step)^2/12 along each axis), and less, as noise and unequal texture lower the step of
/// Gauss-Newton. Adds to `measured`, which is about the field `about`, what it would hold besides, had it been measured about
/// `instead`. Nothing where not `known`. No noise is added but that of the two smooth fields.
void restore_measured(const CellLattice& lattice, const std::vector<float>& instead, const std::vector<float>& about,
                      const std::vector<std::uint8_t>& known, int threads, std::vector<float>& measured);

}  // namespace pivnp::piv
