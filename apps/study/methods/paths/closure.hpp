// Closure of a sequence: steps in turn against the direct correlation of frames further apart, and what of it the
// uncertainty of paths has to hold.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/core/record/closure_note.hpp"
#include "pivnp/core/record/vectors.hpp"

namespace pivnp::app {

/// Closes up to piv.closure chains, spread over the frames, without a pair in common, of 2 to 8 steps each: as many as
/// the frames allow. Every node is carried through the steps (`pair` k: frames k to k + 1) as a numerical particle, and
/// once by the direct pair, which is measured here: one pair of the method's own a chain. A chain where less than half
/// of the nodes that its first pair has close is tried again with half its steps. Fewer than two chains: not checked.
/// What is found and when: pivnp/piv/validation/closure.hpp.
ClosureNote check_closure(const Case& c, const Setting& setting, image::FrameSource& source,
                          const std::function<VectorField(int)>& pair, int threads, Progress& progress);

/// Adds to the covariance of `field`'s vectors what the repeated error adds to a path in its step number `step` (from
/// 1): (2 m - 1) times its covariance, m = min(step, steps in which the material moves by correlation_length), so that
/// m steps have m^2 times it, and one further on than that the sum of independent pieces.
void add_repeated(const ClosureNote& note, int step, VectorField& field);

/// One sentence if there is a repeated error; else none.
std::vector<std::string> closure_remarks(const ClosureNote& note, const Setting& setting);

}  // namespace pivnp::app
