// Contact between deformable bodies: a velocity field for each, coupled where they meet by Coulomb's law.
//
// Source: Bardenhagen, Brackbill & Sulsky 2000 (Comput. Meth. Appl. Mech. Engng 187:529) and Bardenhagen et al. 2001
// (CMES 2:509): at a node that two fields share, the relative velocity loses its normal part where the fields approach,
// and of its tangential part what friction can take; impulses are equal and opposite, so momentum is conserved to
// round-off. Departures:
//   Normal. Nodal masses, by central differences, give three: that of either body and that of both together (each over
//   its density; what lies behind a wall as a mirror's). The one counts along which the points that the node sees are
//   furthest apart: so a block's edge on a flat bed has the bed's normal and does not plough. (Nairn, Hammerquist & Smith
//   2020, CMAME 362:112859, have logistic regression find the plane between the points.)
//   When bodies touch. Nodes are shared up to three cells away from contact, as Nairn 2013 criticises; so the gap is
//   measured, by the points' places as he asks: along lines parallel to the normal, a quarter of a cell apart, between
//   the outermost points of both bodies, points as squares of their present area; the mean over the lines that meet both,
//   weighted by the splines' weights. Velocities may close a gap within the step, no more.
//   Walls. Directions in which a wall holds a node take no part (Restraints::mobility).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mpm/constraint/reaction.hpp"
#include "mpm/constraint/restraints.hpp"
#include "mpm/grid/grid_state.hpp"
#include "mpm/constraint/options.hpp"

namespace pivnp::mpm {

class Contacts {
 public:
  /// Every list of regions makes a body with a velocity field (GridGeometry) of its own; what no list names is one body.
  /// Throws InputError naming contact.<name>.<key>: unknown or missing region, lists that share some regions and not
  /// all, a pair of bodies with no law or with two.
  Contacts(const std::vector<std::pair<std::string, ContactOptions>>& contacts, const std::vector<std::string>& labels);

  bool empty() const { return laws_.empty(); }
  int velocity_fields() const { return velocity_fields_; }
  int field_of(std::size_t label) const { return field_of_label_[label]; }

  /// The nodes at which bodies may touch, from Node::mass and the points' places; before a step of `dt`. `density`: of
  /// each label now, kg/m^3. With dt = 0 (initial equilibrium, where points stay) bodies up to a quarter of a cell apart touch.
  void find(const Particles& p, const GridState& g, const std::vector<double>& density, double dt, int threads);
  /// What excess pressure in the pores presses the faces of both bodies apart with at each of nodes(), N s/m in a step: friction in
  /// apply() follows what the skeletons bear of the normal impulse. Empty: nothing presses.
  void press(std::span<const double> impulses);
  /// Corrects Node::nx, ny after the restraints; the impulses are appended to `reactions`, and those on the material that
  /// [contact.NAME] lists in `regions` added to its place in `of_contacts` (empty: not wanted).
  void apply(GridState& g, const Restraints& restraints, std::vector<Reaction>& reactions, std::span<Impulse> of_contacts = {});
  /// Corrects the strain-rate velocity where apply() found a normal impulse: the same relative motion
  /// along the normal, and none along the face where they stick.
  void apply_to_strain_velocity(GridState& g) const;
  /// Of what find() found and apply() did, for tests and figures.
  struct ContactNode {
    std::uint32_t node[2] = {0, 0};  // of the two bodies, at the same place
    Vec2 normal = Vec2::Zero();      // from the first to the second
    double gap = 0;                  // m
    double normal_impulse = 0, tangential_impulse = 0;  // on the second, along the normal and across it, N s/m
    double pressed = 0;              // of the normal impulse, by the water in the pores
    double friction = 0;             // Coulomb coefficient; infinite: rough
    double closing = 0;              // relative velocity along the normal that is left
    bool sticks = false;
    int law = 0;
    Mat2 mobility[2] = {Mat2::Identity(), Mat2::Identity()};  // velocity for a unit impulse
  };
  const std::vector<ContactNode>& nodes() const { return nodes_; }

 private:
  struct Law {
    int field[2];
    double friction;
    std::size_t option;  // its place among the case's
    int side;            // which of the two bodies its `regions` are
  };
  void enforce(ContactNode& m, GridState& g) const;

  std::vector<Law> laws_;
  std::vector<int> field_of_label_;
  int velocity_fields_ = 1;
  double dt_ = 0;
  std::vector<ContactNode> nodes_;
};

}  // namespace pivnp::mpm
