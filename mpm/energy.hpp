// The energy balance.
#pragma once

#include <cmath>

#include "mpm/material/stress_update.hpp"
#include "mpm/momentum.hpp"
#include "mpm/particles.hpp"
#include "pivnp/core/record/energy.hpp"

namespace pivnp::mpm {

/// What was done since the start of the run, J/m.
struct EnergyBook {
  double damping = 0;   // local damping, and the PIC share of the transfer
  double contact = 0;
  double bodies = 0;    // work of moving bodies
  double gravity = 0;   // work of gravity
  double carried = 0;   // kinetic and elastic energy that left the grid with ended points
  double start = 0;     // kinetic + elastic at the start
  double moved = 0;     // sum of |work of moving bodies| over the steps

  void add(const NodalWork& work, double transfer_loss) {
    damping += work.damping + transfer_loss;
    contact += work.contact;
    bodies += work.bodies;
    moved += std::abs(work.bodies);
  }
};

struct StoredEnergy {
  double kinetic = 0, elastic = 0, plastic = 0;
};

/// Kinetic and elastic energy of the points still simulated, and what all have dissipated.
StoredEnergy stored_energy(const Particles& p, const Materials& materials);
StoredEnergy stored_energy_of(const Particles& p, const Materials& materials, std::size_t k);

EnergyRow energy_row(double time, const StoredEnergy& stored, const EnergyBook& book);

/// What the scheme turned over: the scale against which a residual is large.
double turnover(const EnergyRow& row, const EnergyBook& book);

}  // namespace pivnp::mpm
