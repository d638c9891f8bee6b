// The energy balance of a simulation, one row an output time.
#pragma once

namespace pivnp {

/// Joules per metre of thickness. residual = (kinetic + elastic + plastic + damping + contact + water + darcy) - external -
/// (their sum at the start): what the scheme gained (+) or lost (-).
struct EnergyRow {
  double time = 0;
  double kinetic = 0;
  double elastic = 0;
  double plastic = 0;   // dissipated by plastic flow
  double damping = 0;   // dissipated by damping, and by the transfer where it dissipates
  double contact = 0;   // dissipated by friction at walls and bodies
  double external = 0;  // work of gravity and of moving bodies
  double residual = 0;
  double hourglass = 0;  // part of kinetic: in the hourglass modes of bilinear elements, else 0
  // Where there is water in the pores, else 0; the first two count in the residual.
  double water = 0;         // elastic, in the water
  double darcy = 0;         // dissipated by its flow
  double water_mass = 0;    // of the water that flows, kg per metre of thickness
  double water_inflow = 0;  // what came in through boundaries since the start, less what points that ended took, likewise
  // Where there is heat, else 0; not in the residual. heat less that of the start is heat_made + heat_inflow.
  double heat = 0;          // from the reference temperature
  double heat_made = 0;     // of plastic work and Darcy's, since the start
  double heat_inflow = 0;   // through boundaries and carried by the water's flow since the start, less what points that ended took
};

}  // namespace pivnp
