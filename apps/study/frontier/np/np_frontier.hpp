// Settings of [np] on motions known in closed form: errors of paths and strains against time and memory.
#pragma once

#include <vector>

#include "apps/study/frontier/front.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/np/options.hpp"

namespace pivnp::app {

/// What is to be followed, in pixels: of a case, what its frames show.
struct Followed {
  double spacing = 16;   // of the nodes
  double shift = 2;      // displacement from frame to frame
  double slope = 0.05;   // its gradient
  double noise = 0.01;   // standard deviation of a vector's component
  double alike = 0;      // distance within which errors of vectors are alike: half the width that a vector averages over; 0: independent
  int steps = 20;
  bool central = true;   // anchor of the vectors
  bool of_case = false;
};

/// Every shape function, gradient and number of particles an element, through nodal vectors of a vortex that winds up, a shear band
/// (half width: a spacing and a half) and a rotation with these gradients from frame to frame, with noise that is new in every pair. Two stages with the
/// same points, "np" for paths and "np_strain" for strains: rms over places of the material, 25 an element, for each of which the
/// nearest particle of its element stands (its displacement carried on by its F, its logarithmic strain as it is). `base`: the
/// case's, marked where `followed.of_case`. Time is the median of `repeats`, settings in turn.
std::vector<FrontierStage> np_frontier(const np::NpOptions& base, const Followed& followed, int repeats, int threads, Progress& progress);

}  // namespace pivnp::app
