// What a comparison is given beside the two motions.
#pragma once

#include <optional>
#include <vector>

#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/record/comparison.hpp"
#include "pivnp/core/record/strain_note.hpp"

namespace pivnp::compare {

/// The simulation on coarser grids than the second data set, for the numerical part of its uncertainty.
struct Refinement {
  std::vector<const MotionSource*> coarser;  // one or two: ratio, ratio^2 times the second's cell size
  double ratio = 2;
};

/// What the records state with their strains, first and second data set; nothing where they state nothing. A noise floor
/// stated there is the data set's; otherwise it is what the zone shows that the comparison declares, if it does.
using StrainNotes = PerDataSet<std::optional<StrainNote>>;

}  // namespace pivnp::compare
