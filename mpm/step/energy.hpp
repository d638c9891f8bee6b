// The energy balance.
#pragma once

#include <array>
#include <cmath>

#include "mpm/transfer/stress_update.hpp"
#include "mpm/step/momentum.hpp"
#include "mpm/state/particles.hpp"
#include "pivnp/core/record/energy.hpp"

namespace pivnp::mpm {

/// What was done since the start of the run, J/m.
struct EnergyBalance {
  double damping = 0;   // local damping, and the transfer between points and nodes
  double contact = 0;
  double bodies = 0;    // work of moving bodies and of loads
  double gravity = 0;   // work of gravity
  double carried = 0;   // kinetic and elastic energy that left the grid with ended points
  double start = 0;     // kinetic + elastic at the start
  double loads = 0;     // that of tractions and forces by place and time, which is part of it
  double moved = 0;     // sum of |work of moving bodies, and what projected pressures foresee| over the steps
  double turned_over = 0;  // greatest turnover() so far
  std::array<double, 4> dissipated{};  // greatest so far of what only grows: plastic, damping, contact, darcy
  double darcy = 0;     // taken out by the flow of water
  double potential = 0; // with water: energy in gravity and in the water outside at the start, less that of ended points
  double heat_made = 0, heat_inflow = 0;  // heat (EnergyRow)
  double inflow = 0;    // water that came in through boundaries, less what ended points took, kg/m

  /// What the nodes gained and the points did not is the transfer's loss, exactly.
  void add(const NodalWork& work, double kinetic_loss_of_points) {
    damping += work.damping + work.kinetic + kinetic_loss_of_points;
    contact += work.contact;
    bodies += work.bodies;
    moved += std::abs(work.bodies);
  }
};

struct StoredEnergy {
  double kinetic = 0, elastic = 0, plastic = 0, water = 0;
  double sum() const { return kinetic + elastic + water; }
};

/// Kinetic and elastic energy of the points still simulated, and what all have dissipated.
/// (`p` is not changed.) The kinetic energy holds that of the affine field (APIC).
StoredEnergy stored_energy(Particles& p, const GridState& g, const Materials& materials);
/// Kinetic energy of a point, with its affine field.
double stored_kinetic(const Particles& p, const GridState& g, std::size_t k);
StoredEnergy stored_energy_of(Particles& p, const GridState& g, const Materials& materials, std::size_t k);

EnergyRow energy_row(double time, const StoredEnergy& stored, const EnergyBalance& balance);

/// What has been turned over, as it stands now: the energy there was at the start, the net work of gravity (less what
/// left with points that ended), that of loads, and all work of bodies, either way. It is counted once, where it comes
/// in: what a load gives comes back in every swing under it, as that of gravity does. It may fall again (a block that
/// swings back, one that falls out of the domain), so a residual is held against the greatest so far, and against
/// least_turnover().
double turnover(const EnergyRow& row, const EnergyBalance& balance);
/// What dissipates never gives back: by how much its terms have fallen below their greatest so far (which is kept in
/// `balance`), J/m. Energy that was gained, whatever the residual says.
double gained(const EnergyRow& row, EnergyBalance& balance);
/// A scale of the scene below which no residual is large: the weight through a millionth of a cell, and strains of 1e-8
/// everywhere. Round-off is far below it. `gravity`: the greatest, m/s^2.
double least_turnover(const Particles& p, const Materials& materials, double gravity, double cell_m);

}  // namespace pivnp::mpm
