#include "pivnp/core/particles/motion.hpp"

#include <cassert>
#include <utility>

namespace pivnp {

MotionMemory::MotionMemory(std::string name, std::string length_unit, std::string time_unit, ParticleSet particles)
    : name_(std::move(name)), length_unit_(std::move(length_unit)), time_unit_(std::move(time_unit)),
      particles_(std::move(particles)) {}

void MotionMemory::add(MotionFrame frame) {
  assert(frame.u.size() == particles_.size() && frame.F.size() == particles_.size());
  times_.push_back(frame.time);
  frames_.push_back(std::move(frame));
}

}  // namespace pivnp
