// Vectors of a pair as arrows on a panel of the world.
#pragma once

#include "apps/plot/canvas.hpp"
#include "apps/report/content/content.hpp"

namespace pivnp::report {

/// Arrows of the usable vectors in material, spaced to be read, and marks where none was measured. `units_per_length`:
/// canvas units to one length unit.
void lay_vectors(plot::Canvas& canvas, const plot::Panel& panel, const Content& content, const VectorField& field, double units_per_length);

}  // namespace pivnp::report
