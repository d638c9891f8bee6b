// Which particles count at a time.
#pragma once

#include "pivnp/core/particles/motion.hpp"

namespace pivnp {

/// Born and not ended, flagged or not.
inline bool alive(ParticleStatus s) { return s == ParticleStatus::active || s == ParticleStatus::flagged; }

}  // namespace pivnp
