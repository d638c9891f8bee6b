// What a comparison gives to the second's clock and coordinates before anything is subtracted.
#pragma once

#include <optional>

#include "compare/alignment/onset.hpp"
#include "compare/data/options.hpp"
#include "compare/data/rigid.hpp"
#include "compare/data/transformed.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::compare {

struct Together {
  Transform second;               // what was declared and what was found
  std::optional<Onset> time;      // found: added to the second's times
  std::optional<RigidFit> place;  // found: given to the second's coordinates
};

/// Throws InputError where an onset or an outline is asked for and is not found.
Together bring_together(const MotionSource& first, const MotionSource& second, const CompareOptions& options);

}  // namespace pivnp::compare
