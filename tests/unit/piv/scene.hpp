// Short names for the unit tests: synthetic pairs, lattices, errors, and one call that measures.
#pragma once

#include <utility>

#include "pivnp/image/synthetic/synthetic_pair.hpp"
#include "pivnp/piv/piv.hpp"
#include "tests/support/piv_score.hpp"

namespace pivnp::piv {

using image::band, image::Motion, image::plain_shear, image::rotation, image::sine, image::triangle_shear,
    image::uniform;

struct Scene : image::SyntheticPair {
  Vec2 truth(const Vec2& place, bool central) const {
    return image::displacement_at(motion, place, central ? Anchor::central : Anchor::forward);
  }
};

inline Scene make_scene(Motion motion, int width, int height, const image::TextureOptions& texture) {
  return {image::synthetic_pair(std::move(motion), width, height, texture)};
}

inline PixelVectors measure(const Scene& scene, const NodeLattice& nodes, const PivOptions& options = {},
                            int threads = 1, const MaskView& mask = {}) {
  PairCorrelator correlator(options, nodes, scene.width, scene.height, threads);
  return correlator.correlate(scene.first.view(), scene.second.view(), mask);
}

}  // namespace pivnp::piv
