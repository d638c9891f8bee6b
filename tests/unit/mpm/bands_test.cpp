// Embedded bands: the deviation across a zone.
#include <gtest/gtest.h>

#include "mpm/heat/bands.hpp"

namespace pivnp::mpm {
namespace {

TEST(Bands, VolumesFillTheZone) {
  for (const double width : {0.011, 0.02, 0.5, 50.0}) {
    const double growth = growth_of(0.01, width);
    const auto volume = volumes_of(0.01, width, growth);
    double sum = 0;
    for (const double v : volume) sum += v;
    EXPECT_NEAR(sum, 0.5 * width, 1e-12 * width);
    EXPECT_GT(volume.back(), 0);
  }
}

}  // namespace
}  // namespace pivnp::mpm
