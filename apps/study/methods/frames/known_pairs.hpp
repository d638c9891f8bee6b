// Pairs of frames whose displacement is known: what settings of [piv] are judged by.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/study/methods/frames/texture.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/image/frames/frames.hpp"
#include "pivnp/image/synthetic/synthetic_pair.hpp"
#include "pivnp/piv/piv.hpp"

namespace pivnp::app {

struct KnownPair {
  std::string name;  // "shear 5 %"
  Image first, second;
  std::function<Vec2(const Vec2& place, Anchor)> truth;  // displacement at a place (column, row), px
  double wavelength = 0;                                 // of a wave, px; 0: no wave
  std::vector<std::uint8_t> scored;                      // of each node; empty: those of KnownPairs
};

/// Pairs, and where they are measured.
struct KnownPairs {
  std::string made_of;  // one sentence, for readers
  int width = 0, height = 0;
  image::Mask mask;
  piv::NodeLattice nodes;
  std::vector<std::uint8_t> scored;  // of each node
  double shift = 2, slope = 0.1;     // of a case: what the frames show, px and px/px from one to the next
  double sigma = 0;                  // of a case: median stated standard deviation of a vector's component, px
  std::vector<KnownPair> pairs;      // the first is an even shift; waves follow, from long to short
};

/// Of a displacement that is a function of the mid-point's place: where a pixel of the first (side -1) or second (+1)
/// frame is in the middle.
Vec2 middle_of(const image::Motion& motion, const Vec2& px, int side);

/// Nodes `spacing` apart over a square frame but for a rim, px; j upward in the world.
piv::NodeLattice even_nodes(int side, double spacing, double rim);

/// Drawn texture of the usual kind (3 px blobs, .05 a pixel), frames of `side` x `side` px, nodes 8 px apart.
KnownPairs drawn_pairs(int side, int seed);

/// A frame of a case that can be carried by any field, and what the frames show of their own motion.
struct CarriedFrame {
  KnownPairs known;  // without pairs
  std::string from;  // "Frame 3 of 20"
  CarriedTexture texture;
  double noise = 0;             // variance, grey values squared
  NoiseShape noise_shape = {};
  double shift = 0, slope = 0;  // 95th percentiles of displacement (px) and of its gradient from one frame to the next
  Vec2 middle = Vec2::Zero();   // of what is scored, px
  int frame = 0;                // its number, and where in it the part that is carried begins, px
  int left = 0, top = 0;
  std::vector<double> step_px =
      {};  // of each node: mean motion from one frame to the next, over the pairs looked at; NaN where none is valid

  /// The frame carried half a step back and half a step on, with noise of its own (by `number`) in both images.
  KnownPair pair(const std::string& name, const image::Motion& motion, std::uint64_t number) const;
};

/// One frame, freed of its noise; scored are the nodes that are valid between the frames themselves. Throws InputError
/// where there are fewer than two frames, or hardly a vector between them is valid.
CarriedFrame carried_frame(const Case& c, const Setting& setting, image::FrameSource& source, int threads,
                           Progress& progress);

/// Pairs of that frame, carried by fields like those that the frames show. Throws InputError as carried_frame().
KnownPairs carried_pairs(const Case& c, const Setting& setting, image::FrameSource& source, int threads,
                         Progress& progress);

}  // namespace pivnp::app
