// The transfers of a step between points and nodes, for every shape (shape.hpp) and scheme (scheme.hpp).
//
// Sources: Sulsky, Chen & Schreyer 1994 (Comput. Meth. Appl. Mech. Engng 118:179) and Sulsky, Zhou & Schreyer 1995
// (Comput. Phys. Commun. 87:236); Brackbill & Ruppel 1986 (FLIP); Jiang et al. 2015 (ACM Trans. Graph. 34:51, APIC);
// Hammerquist & Nairn 2017 (Comput. Meth. Appl. Mech. Engng 318:724, XPIC); Zabala & Alonso 2011 (Geotechnique 61:795)
// for the averaging over elements; Elguedj et al. 2008 (Comput. Meth. Appl. Mech. Engng 197:2732) for B-bar with
// splines; the thesis' appendix A, equations A.1-A.13, with the signs of ma = div sigma + rho b.
//
// Against locking, with m the mean Kirchhoff stress and theta = ln det f the volumetric increment of a point:
//   none       as it is.
//   selective  bilinear: the element's mean of m (weights V0) acts through the gradient at the element's centre, the
//              deviator through that of its point; theta is that of the centre.
//   full       bilinear: the whole stress, averaged, through the centre's gradient (one-point integration); every point
//              is strained by the centre's gradient. Hourglass modes carry no force.
//   fbar       m and theta are replaced by P m and P theta. Bilinear: P averages over the element. Three-node shapes:
//              P maps to the nodes by hat functions, divides by the volume there, and interpolates back.
// Force and strain are conjugate in each: P is self-adjoint with weights V0, so sum_i f_i . v_i = -sum_p V0 tau : d.
#pragma once

#include <functional>
#include <vector>

#include "mpm/grid/grid_state.hpp"
#include "mpm/material/material.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/state/scheme.hpp"
#include "mpm/transfer/lanes.hpp"

namespace pivnp::mpm {

/// Cell of every point that is simulated, and the grid's lists (for the initial equilibrium; a step calls
/// locate_points()).
void locate_all(Particles& p, GridState& g);

/// A.1: cell of every point; where the last sweep over the points has looked for it (GridState::relocation), what it
/// found. True if any point changed its cell: their places in CellList::order are in GridState::relocation.moves, for
/// GridState::follow(). Those that left the grid are marked Particles::ended and appended to `left`.
bool locate_points(Particles& p, GridState& g, std::vector<std::uint32_t>& left, int threads);

/// Where no point has weight but that of rounding, momentum and force are the rounding of a whole cell's
/// (moments-inl.hpp): over such a mass they would be any number. kg/m.
inline double mass_of_rounding(const Particles& p) { return p.size() > 0 ? 1e-21 * p.mass_of(0) : 0; }
inline void forget_sums(Node& node) { node.mass = node.vx = node.vy = node.fx = node.fy = 0; }

/// A.3 but for the quotient: mass and, as Node::v, momentum at the nodes. `force`: A.4 too, in the same sweep (else the
/// force is zero). Calls finished() as soon as the sums of some nodes (places in ActiveCells::nodes) are complete, on
/// any thread.
void map_sums(const Particles& p, GridState& g, const Scheme& scheme, bool force, int threads,
              const std::function<void(Range nodes, std::size_t band)>& finished);
/// The same with the velocity.
void map_momentum(const Particles& p, GridState& g, const Scheme& scheme, bool force, int threads);
/// A.4: internal force at the nodes.
void map_force(const Particles& p, GridState& g, const Scheme& scheme, int threads);
/// F-bar of cells around nodes averages at their corners (averages.hpp); elements' averages are formed where they are
/// used.
inline bool averages_at_corners(const GridState& g, const Scheme& scheme) {
  return g.centred && scheme.locking == Locking::fbar;
}
/// Those of the mean stress, where there are any; call before the force is mapped.
void average_mean_stress(const Particles& p, GridState& g, const Scheme& scheme, int threads);

/// Adds the points' mass times an acceleration to NodeArrays::loads.
void map_acceleration(const Particles& p, GridState& g, const std::vector<double>& ax, const std::vector<double>& ay,
                      int threads);

/// XPIC of order k: the points' velocity, filtered, at the nodes: sum over l < k of (I - P)^l v, P from nodes to points
/// and back, into NodeArrays::filtered.
void filtered_velocity(const Particles& p, GridState& g, int order, int threads);

/// A.8-A.11: velocity, affine field and position of the points from Node::v and Node::n (and, for XPIC,
/// NodeArrays::filtered). Under musl the strain-rate velocity becomes, not yet restrained, the points' new velocity
/// mapped back.
GatherSums gather_velocity(Particles& p, GridState& g, const Scheme& scheme, double dt, int threads);

/// What a sweep that moves the points is told, and what its parts saw together.
MoveJob move_job(const GridState& g, const Scheme& scheme, double dt);
GatherSums sum_of(const std::vector<GatherSums>& parts);

/// A.12: log strain and rotation increments of the points, and F and J, from the strain-rate velocity. With `record`
/// false (initial equilibrium)/// F and J stay.
void strain_points(Particles& p, GridState& g, const Scheme& scheme, double dt, bool record, int threads);

/// The same in runs of a few cells, each followed by its stress update while it is in the cache: update(body, places,
/// increments) is called for points that belong to one of Particles::bodies, with their places in storage;
/// the increments' pointers and size are set, the rest of the batch is the caller's. The arrays of increments in
/// Particles are not used. Returns the work that F-bar's averages pass to the rim of what sleeps, J/m. With `moved`,
/// where moves_with_strain(), does A.8-A.11 in the same sweep.
using UpdateRun =
    std::function<void(const Particles::Body& body, const std::uint32_t* places, const StressBatch& increments)>;
double strain_and_update(Particles& p, GridState& g, const Scheme& scheme, double dt, bool record,
                         const UpdateRun& update, int threads, GatherSums* moved = nullptr);
/// The updated velocity strains the material, and one sweep can do both.
bool moves_with_strain(const GridState& g, const Scheme& scheme);

/// Sum over the active cells of 1/2 mass of the cell times the squared hourglass part of the mapped velocity, J/m
/// (bilinear).
double hourglass_energy(const Particles& p, const GridState& g);

/// Gershgorin's bound for the initial equilibrium: at every node sum_p 1/2 V0 M |grad N_i| sum_j |grad N_j|; `modulus`
/// of the points.
std::vector<double> stiffness_bound(const Particles& p, const GridState& g, const std::vector<double>& modulus);

}  // namespace pivnp::mpm
