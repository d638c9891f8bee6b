// Two motions as a comparison sees them, for drawing what was compared.
#pragma once

#include <memory>

#include "compare/data/options.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::compare {

struct ComparedMotions {
  std::shared_ptr<const MotionSource> first, second;
};

/// The motions in the frame of their comparison: the second on the first's clock and in its coordinates, both without
/// the motion of the declared zone, counted from the common start (a particle's x0 is where it is then), and the second
/// at the times of the first where both are known (linear between its frames); beyond the first's last time it keeps
/// its own. Velocities are left out: they are differences of these displacements. Other fields are those of the nearest
/// frame. A motion that the comparison takes as it is comes back itself. Throws InputError as compare() does.
ComparedMotions as_compared(const std::shared_ptr<const MotionSource>& first,
                            const std::shared_ptr<const MotionSource>& second, const CompareOptions& options);

}  // namespace pivnp::compare
