// What the flow of water in the pores did in a step.
#pragma once

namespace pivnp::mpm {

/// What a step's flow did, per metre of thickness.
struct PoreFlow {
  double inflow = 0;     // volume of water without pressure through the boundaries, m^2
  double external = 0;   // work at the boundaries, by the potentials, J
  double darcy = 0;      // dissipated, J
  double yielded = 0;    // projected: taken by the strain that pressures foresee, J
  double collapsed = 0;  // work of the skeleton's stress on what it collapsed by, J

  void add(const PoreFlow& more) {
    inflow += more.inflow;
    external += more.external;
    darcy += more.darcy;
    yielded += more.yielded;
    collapsed += more.collapsed;
  }
};

}  // namespace pivnp::mpm
