// What a finished run tells: remarks on what was flagged, and what its camera says of a comparison.
#pragma once

#include <string>
#include <vector>

#include "compare/data/options.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

/// What was flagged in a record and why, one sentence each: flagged steps, ended particles.
std::vector<std::string> remarks_of(const io::RecordReader& record);
/// How many particles of a simulation are outside the equations of heat, at most in one state (the field heat_limit); reads every state
/// that has it.
std::vector<std::string> remarks_on_heat(const MotionSource& motion);

/// A simulation that has lost or gained more than a tenth of the energy supplied to it where no law, wall or damping asked for
/// takes any (`damped`: local damping was).
std::vector<std::string> remarks_on_energy(const std::vector<EnergyRow>& rows, bool damped);

/// The residual of the camera's targets becomes the measurement's systematic uncertainty where none is given.
void add_camera(double residual, compare::CompareOptions& options);

}  // namespace pivnp::app
