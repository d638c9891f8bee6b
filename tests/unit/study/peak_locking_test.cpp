// Peak locking is remarked on from vectors of the world as from pixels, through an oblique camera, for both anchors.
#include "apps/study/methods/frames/peak_locking.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pivnp/image/synthetic/synthetic_pair.hpp"

namespace pivnp::app {
namespace {

Setting setting_of(int nx, int ny) {
  Setting setting;
  setting.width = 12 * (nx + 3), setting.height = 12 * (ny + 3);
  Mat3 world_from_pixel;
  world_from_pixel << 1e-3, 2e-5, -0.02, 1e-5, -1e-3, 0.6, 1e-5, 2e-5, 1;
  setting.camera = image::Camera(world_from_pixel, 0, "m");
  const Vec2 corner = setting.camera.to_world(Vec2(24, setting.height - 24));
  setting.grid = Grid{corner, {0.0118, 0.0118}, nx, ny};
  return setting;
}

VectorField rotated(const Setting& setting, Anchor anchor, double locking, unsigned seed) {
  const piv::NodeLattice lattice = node_lattice(setting);
  const image::Motion motion = image::rotation(2, 0.5 * setting.width, 0.5 * setting.height);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 0.01);
  piv::PixelVectors pixels;
  pixels.anchor = anchor;
  pixels.status.assign(lattice.pixel.size(), VectorStatus::valid);
  pixels.cov.assign(lattice.pixel.size(), {1e-4f, 1e-4f, 0});
  pixels.score.assign(lattice.pixel.size(), 1);
  for (const auto& p : lattice.pixel) {
    std::array<float, 2> found{};
    const Vec2 d = image::displacement_at(motion, Vec2(double(p[0]), double(p[1])), anchor);
    for (int c = 0; c < 2; ++c)
      found[std::size_t(c)] = float(d[c] - locking * std::sin(2 * M_PI * d[c]) + normal(random));
    pixels.displacement.push_back(found);
  }
  return world_vectors(pixels, lattice, setting, {0, 1});
}

TEST(PeakLockingRemarks, FollowTheFractionsOfThePixelsNotOfTheWorld) {
  const Setting setting = setting_of(40, 32);
  for (const Anchor anchor : {Anchor::central, Anchor::forward})
    for (const double locking : {0.0, 0.08}) {
      const auto remarks = fraction_remarks(
          setting, 3, [&](std::size_t k) { return rotated(setting, anchor, locking, 7 + static_cast<unsigned>(k)); });
      ASSERT_EQ(remarks.size(), locking > 0 ? 1u : 0u) << static_cast<int>(anchor);
      for (const std::string& remark : remarks)
        EXPECT_NE(remark.find("towards whole pixels"), std::string::npos) << remark;
    }
  EXPECT_TRUE(fraction_remarks(setting, 0, [](std::size_t) { return VectorField{}; }).empty());
}

TEST(PeakLockingRemarks, TextureTooFineForThePixels) {
  Setting setting;
  for (const double diameter : {1.0, 3.0}) {
    image::TextureOptions texture;
    texture.blob_diameter_px = diameter;
    const image::SyntheticPair pair = image::synthetic_pair(image::uniform(0, 0), 256, 256, texture);
    EXPECT_EQ(texture_remarks(setting, pair.first).size(), diameter < 2 ? 1u : 0u);
  }
}

}  // namespace
}  // namespace pivnp::app
