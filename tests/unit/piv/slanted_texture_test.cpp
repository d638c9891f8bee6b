// Texture drawn out along a diagonal: a vector is known worse along it than across, which is the sign of uv. (Not so of
// `fft`: docs/limits.md.)
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "pivnp/image/synthetic/synthetic.hpp"
#include "tests/unit/piv/scene.hpp"

namespace pivnp::piv {
namespace {

constexpr int side = 192;
const Vec2 moved(0.4, -0.3);

// Chains of blobs along (1, sign): column and row.
Scene slanted(int sign, int seed) {
  image::TextureOptions texture;
  texture.seed = seed;
  texture.noise = 0.05;
  const image::BlobRenderer renderer(texture, side, side);
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> place(0, side);
  std::vector<Vec2> at;
  for (int n = 0; n < 700; ++n) {
    const double column = place(random), row = place(random);
    const Vec2 middle(column, row);
    for (int k = -2; k <= 2; ++k) at.push_back(middle + 1.3 * k * Vec2(1, sign));
  }
  Image first = renderer.draw(at, 0, 2);
  for (Vec2& x : at) x += moved;
  return {{uniform(moved.x(), moved.y()), side, side, std::move(first), renderer.draw(at, 1, 2)}};
}

TEST(SlantedTexture, TheCovarianceLeansAsErrorsDo) {
  const NodeLattice nodes = even_nodes(side, side, 16, 40);
  for (const Smoothing smoothing : {Smoothing::adaptive, Smoothing::window})
    for (const int sign : {1, -1}) {
      SCOPED_TRACE(std::string(name_of(smoothing)));
      SCOPED_TRACE(sign);
      PivOptions options;
      options.smoothing = smoothing;
      double stated = 0, uv = 0, uu = 0, vv = 0;
      std::size_t count = 0;
      for (const int seed : {1, 2, 3}) {
        const PixelVectors found = measure(slanted(sign, seed), nodes, options);
        for (std::size_t k = 0; k < nodes.pixel.size(); ++k) {
          if (found.status[k] != VectorStatus::valid) continue;
          const auto& c = found.cov[k];
          stated += double(c[2]) / std::sqrt(double(c[0]) * double(c[1]));
          const double u = double(found.displacement[k][0]) - moved.x(), v = double(found.displacement[k][1]) - moved.y();
          uv += u * v, uu += u * u, vv += v * v;
          ++count;
        }
      }
      ASSERT_GT(count, 100u);
      EXPECT_GT(sign * stated / double(count), 0.2);
      EXPECT_LT(sign * stated / double(count), 1.0);
      // Adaptive smoothing averages so widely that three frames hold a handful of independent errors.
      if (smoothing == Smoothing::window) {
        EXPECT_GT(sign * uv / std::sqrt(uu * vv), 0.2);
      }
    }
}

}  // namespace
}  // namespace pivnp::piv
