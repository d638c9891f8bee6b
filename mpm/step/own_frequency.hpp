// How stiffly points hang on their own nodes: what bounds the step where points are sparse.
#pragma once

#include "mpm/grid/grid_state.hpp"
#include "mpm/state/particles.hpp"

namespace pivnp::mpm {

/// The greatest sum over a point's nodes of h^2 |grad w|^2 m_p/m_i among the awake points, h the smaller cell side: the square of
/// the frequency, in c/h, with which a point by itself swings against the masses that its nodes have. A lone point of B-splines
/// has 8 to 12, one among four in its cell 1 to 4, one of them at a surface 2 to 4. Call it between mapping and moving the
/// points. The same bits for any number of threads. docs/theory/mpm.md#time-step-and-end-of-a-run.
double own_frequency2(const Particles& p, const GridState& g, int threads);
/// The same before the first step: maps the masses, which the nodes then keep.
double own_frequency2_at_start(const Particles& p, GridState& g);

/// What steps go by after another look. It rises at once, and falls by at most half a percent: steps whose lengths differ leave an
/// error of first order in their difference.
double held_frequency2(double before, double now);

}  // namespace pivnp::mpm
