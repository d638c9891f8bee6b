// Particles that ended, by reason.
#pragma once

#include <cstddef>
#include <vector>

#include "pivnp/core/particles/end_reason.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::report {

struct Ends {
  EndReason reason;
  std::size_t particles = 0;
  double first = 0, median = 0, last = 0;  // times
};
std::vector<Ends> ends_by_reason(const ParticleSet& particles);

}  // namespace pivnp::report
