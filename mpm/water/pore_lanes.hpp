// The kernels of the flow, in lanes (transfer/lanes.hpp): over points, and over nodes. Nothing here may include Eigen.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mpm/state/pore_node.hpp"
#include "mpm/state/views.hpp"

namespace pivnp::mpm {

/// Of a material that holds no water of its own, in the place of its mobility.
inline constexpr double drained_mobility = -1, no_pores_mobility = -2;
inline constexpr double least_pores = 1e-6;  // of the initial volume: grains would touch everywhere

/// The water of the points, and what it knows.
struct PoreView {
  double *pressure, *content, *J_flow;
  const double *mobility, *solid;   // K/gamma, and the grains' share of the initial volume; null: as the next two everywhere
  double mobility_all, solid_all;
  double bulk;                      // Pa
  double head_x, head_y, head_0;    // e = p - (head_x x + head_y y + head_0), but see `imposed`
  double outside, level;            // weight of the water outside, N/m^3, and its height; 0: none
  bool projected = false;
  const double* swelling = nullptr;  // adds to the volume of the water (heat); null: none
  bool smooths_flow = false;  // the next flow smooths what flows as it smooths strain (heat)
  // The groundwater is that of a level: e is the pressure over that of the water outside, and water bears no tension:
  // where it does not fill the pores, its pressure is zero.
  bool imposed = false;
};

/// Adds to the nodes and elements. `centred`: cells are squares around nodes (three-node shapes).
void map_pores_lanes(bool centred, const PointView& p, const PoreView& w, const CellView& c, const PoreSumsView& sums, Range range);
/// From PoreFields::change and `even` to the points: content, pressure and what follows. `rate`: by which a cell's own
/// water evens out, over the mobility, times the step.
struct PoreChange {
  double lost = 0;    // potential energy of the water, J/m
  double lifted = 0;  // of its weight, by what imposes a level, J/m
};
PoreChange change_points_lanes(bool centred, double rate, const PointView& p, const PoreView& w, const CellView& c,
                               const PoreFields& f, Range range);

/// What points lost of the work that the skeleton did on their water and of its potential energy, J/m: all, and by flow.
struct PoreLosses {
  double all = 0, by_flow = 0;
};
/// Projected: pressures from `even` (what they gain, with what they are brought to) and `share` (by how much), contents from `change`.
PoreLosses project_points_lanes(bool centred, const PointView& p, const PoreView& w, const CellView& c, const PoreFields& f,
                                const double* share, Range range);

/// Of one soil without water, and of water, kg/m^3; and the cells' sides. `empty_too`: pores that hold none may get
/// some.
struct PoreMasses {
  double dry, water, hx, hy;
  bool empty_too;
};
/// Masses of points that are simulated (`cell`) and hold water, as many together as there are lanes, from
/// `points.begin` on, which is moved on to the first that is left. Returns the kinetic energy that the water brought,
/// J/m.
double carry_water_lanes(const PointView& p, const PoreView& w, const std::int32_t* cell, const PoreMasses& of,
                         Range& points);

/// Of a step: what the edges' exchange follows from.
struct PoreEdges {
  double rate;            // of change_points_lanes()
  double through_x, through_y;  // the step over hx^2, hy^2
  double mobility_all;    // where PoreFields::rate is null
  double least_volume;    // of a node, inside the material
  double inert_x = 0, inert_y = 0;  // projected: the step's square over the density, over hx^2, hy^2
};
/// From the sums of some nodes to their means and edges. Those that have an empty element beside them, or little around
/// them, in their order to `special`; how many.
std::size_t take_means_lanes(const PoreSumsView& sums, const PoreFields& f, const PoreEdges& edges, const std::uint32_t* nodes,
                             std::size_t size, std::uint32_t* special);
/// Of elements up and to the right of some nodes, PoreFields::weight, from their volume there and the nodes' shares.
void weigh_elements_lanes(const PoreFields& f, const std::uint32_t* nodes, std::size_t size);
/// Of some nodes: the mean over the elements around each of what their four nodes have, (1, 2, 1)/4 along both axes.
void smooth_pores_lanes(const PoreFields& f, const double* from, double* to, const std::uint32_t* nodes, std::size_t size);
/// 2 m - M' s of the mean m and the smooth s, M' what points pass from node to node, in the place of m; and the change, with the
/// rate of a cell where potentials are not given.
void exchange_pores_lanes(const PoreFields& f, double rate, double mobility_all, const std::uint32_t* nodes, std::size_t size);

}  // namespace pivnp::mpm
