// Peak locking of vectors measured on drawn images: blobs of .7 px show it, blobs of 3 px do not.
#include <gtest/gtest.h>

#include <cstdio>

#include "pivnp/piv/validation/peak_locking.hpp"
#include "tests/unit/piv/scene.hpp"

namespace pivnp::piv {
namespace {

TEST(MeasuredLocking, TinyBlobsAreAccusedAndOthersNot) {
  for (const double diameter : {0.7, 3.0}) {
    FractionStatistics s;
    double seen = 0;
    for (const int seed : {1, 2}) {
      image::TextureOptions texture;
      texture.blob_diameter_px = diameter, texture.density_per_px = 0.1, texture.seed = seed;
      const Scene scene = make_scene(rotation(1, 192, 192), 384, 384, texture);  // .4 px across a window
      const NodeLattice nodes = even_nodes(384, 384, 12, 24);
      PivOptions options;
      options.method = "fft", options.window_px = 24;
      const PixelVectors found = measure(scene, nodes, options);
      s.add(nodes.nx, found.displacement, found.status);
      seen = blob_diameter(scene.first.view(), {});
    }
    std::printf("blobs of %.1f px: amplitude %.4f +- %.4f px, diameter %.2f px\n", diameter, s.amplitude(),
                s.amplitude_error(), seen);
    EXPECT_EQ(seen < least_blob_px, diameter < 1);
    EXPECT_EQ(s.locked(), diameter < 1);
  }
}

}  // namespace
}  // namespace pivnp::piv
