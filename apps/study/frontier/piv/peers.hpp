// Image correlation beside other programs, on pairs of the kind that they were measured on.
#pragma once

#include <string>

#include "apps/study/frontier/front.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

/// peers.csv: program, vectors a second of one thread, rms error by row (px). The rows are frames of 1024 x 1024 px, 8 bit, 3 px blobs, .05 a pixel;
/// each program by its own convention of place, all vectors that it returned. Measured with OpenPIV 38ebc6b, PIVlab 6986f2d (in Octave),
/// OpenCorr 44532cc, ncorr d645565 and OpenCV 4.6.0 on two cores of an AMD EPYC with AVX-512.
std::string peers_table();

/// Some of our settings on the rows of peers.csv that nearly every program has, one thread, and those programs. Their times are
/// those of their own machine times (our default here over our default there), and they are on no front.
/// `side` of the frames, px.
FrontierStage peers_frontier(int side, int repeats, Progress& progress);

}  // namespace pivnp::app
