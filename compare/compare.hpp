// How far two motions are apart. Sees motions only, and cannot tell measured from simulated.
#pragma once

#include "compare/data/options.hpp"
#include "compare/data/sources.hpp"
#include "compare/metrics/limits.hpp"
#include "pivnp/core/particles/motion.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::compare {

/// second minus first, at the first's particles and times. Displacement and strain count from the common start, the
/// later of the two first times. Material positions are aligned there; the second motion is interpolated between its
/// particles (natural neighbours among material positions, no triangle that bridges a gap; within half a spacing of the
/// material's edge from the nearest point of the edge) unless ids and positions agree, and linearly in time. A
/// particle that ends in either data set has no partner from then on. Options and limits named _m and _s are in the
/// motions' own units. Frames are read one by one, in order (twice where an onset is looked for); memory grows with the
/// particles, not with the frames: of each field at most 2^23 values are kept. Throws InputError if a motion is empty,
/// the units differ, no time is common, no particle finds a partner, or a limit cannot be evaluated for want of an option;
/// Interrupted if asked to stop. Every metric carries its definition; docs/theory/compare.md has the equations.
Comparison compare(const MotionSource& first, const MotionSource& second, const CompareOptions& options,
                   const LimitOptions& limits, Progress& progress, const Refinement& refinement = {},
                   const StrainNotes& notes = {});

}  // namespace pivnp::compare
