// What record.xdmf points at. Private to this folder's sources.
#pragma once

#include "pivnp/io/hdf5/hdf5.hpp"
#include "pivnp/io/records/schema.hpp"

namespace pivnp::io {

/// Writes /xdmf: one dataset a time and quantity, because viewers follow whole datasets only (the XDMF 3 readers fail
/// on hyperslabs, and all of them on sums). Positions, strains and
/// their standard uncertainties are stored; all else is a virtual dataset on what is there.
void pack_views(h5::OutputFile& out, const Grid& grid, const Units& units);

}  // namespace pivnp::io
