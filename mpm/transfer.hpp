// The transfers of a step between points and nodes: bilinear shapes, selective averaging.
//
// Sources: Sulsky, Chen & Schreyer 1994 (Comput. Meth. Appl. Mech. Engng 118:179) and Sulsky, Zhou & Schreyer 1995
// (Comput. Phys. Commun. 87:236); Zabala & Alonso 2011 (Geotechnique 61:795) for the averaging over elements; the
// thesis' appendix A, equations A.1-A.13, with the signs of ma = div sigma + rho b.
//
// Selective averaging: the mean stress acts through the gradient at the element's centre, the deviator through the
// gradient at its own point; the volumetric part of the strain increment is the divergence at the centre, the deviator
// that of the point. Force and strain are therefore conjugate: sum_i f_i . v_i = -sum_p V0_p tau_p : d_p exactly. The
// average over the element weights the Kirchhoff mean stress by initial volume (that is by mass, where the density is
// one), times the sum of the initial volumes; for points of one J this is the thesis' average weighted by mass times
// the sum of their volumes, and it stays conjugate where J differs.
#pragma once

#include "mpm/grid_state.hpp"
#include "mpm/particles.hpp"

namespace pivnp::mpm {

/// What a gather of velocity saw.
struct GatherSums {
  double fastest2 = 0;      // largest squared speed of a point, m^2/s^2
  double transfer_loss = 0; // kinetic energy taken out by the PIC share, J/m
  bool good = true;         // every point finite, none moved more than one cell
};

/// Cell and natural coordinates of every point that is simulated, and the grid's lists (for settling; a step calls
/// locate_points()).
void locate_all(Particles& p, GridState& g);

/// A.1: cell and natural coordinates of every point. True if any point changed its cell; those that left the grid are
/// marked Particles::ended and appended to `left` (storage order).
bool locate_points(Particles& p, GridState& g, std::vector<std::uint32_t>& left, int threads);

/// A.3, A.4: mass, momentum and internal force at the nodes, then the velocity there.
void particles_to_grid(const Particles& p, GridState& g, int threads);

/// A.8-A.11: velocity and position of the points from the nodes (FLIP with the share `pic` of PIC), and the updated
/// momentum back to the nodes as Node::ux, uy (divided by mass, not yet restrained).
GatherSums grid_to_particles(Particles& p, GridState& g, double dt, double pic, int threads);

/// A.12: strain and rotation increments of the points from Node::ux, uy.
void strain_increments(Particles& p, const GridState& g, double dt, int threads);

/// F <- (I + dt L) F and J <- (1 + dt div v) J from the increments.
void update_deformation(Particles& p, int threads);

}  // namespace pivnp::mpm
