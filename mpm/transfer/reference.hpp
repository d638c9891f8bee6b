// The transfers of appendix A as plain loops, for every shape, transfer and average: what the kernels in lanes, and whatever
// else runs them, are held against. No speed is asked of them. Sources and formulas: transfer.hpp, averages.hpp.
#pragma once

#include <vector>

#include "mpm/grid/averages.hpp"
#include "mpm/grid/grid_state.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/state/scheme.hpp"

namespace pivnp::mpm::reference {

/// A.3, A.4 of a node: sums of the points' mass and momentum, and the force of their stress.
struct NodeSums {
  double mass = 0;
  Vec2 momentum = Vec2::Zero(), force = Vec2::Zero();
};
/// Of every node of the grid.
std::vector<NodeSums> map_points(const Particles& p, const GridState& g, const Scheme& scheme);

/// A.8-A.11 of a point: velocity, place and affine field after the step.
struct MovedPoint {
  Vec2 velocity = Vec2::Zero(), place = Vec2::Zero();
  Mat2 affine = Mat2::Zero();  // APIC's C, 1/s; else zero
};
/// Of every point, from Node::vx, vy, nx, ny.
std::vector<MovedPoint> move_points(const Particles& p, const GridState& g, const Scheme& scheme, double dt);
/// musl: their momentum mapped again, over the nodes' mass; the points still where they were.
std::vector<Vec2> map_again(const Particles& p, const GridState& g, const std::vector<MovedPoint>& moved);
/// XPIC: sum over l < order of (I - P)^l v at every node.
std::vector<Vec2> filtered_velocity(const Particles& p, const GridState& g, int order);

/// A.12 of a point: log strain and rotation (2 tan(angle/2)) of the step.
struct StrainIncrement {
  double xx = 0, yy = 0, zz = 0, xy = 0, spin = 0;
};
/// Of every point, from the strain-rate velocity.
std::vector<StrainIncrement> strain_points(const Particles& p, const GridState& g, const Scheme& scheme, double dt);

/// What F-bar puts in the place of a number that each point carries: P of transfer.hpp, with Q or Q^* of averages.hpp.
std::vector<double> average(const Particles& p, const GridState& g, Averaging which, const std::vector<double>& of_point);

}  // namespace pivnp::mpm::reference
