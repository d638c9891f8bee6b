// Air, found in each frame.
//   criterion: of drawn sand below a sloping surface, at most 2 % of the air is left and at most 2 % of the sand taken, and the
//     surface is met within 4 px, with a sky that is even, shaded or noisy; a frame of sand alone loses nothing; of a still
//     background with texture, what sand has come to is given back, and what it has left is not.
#include "pivnp/image/masks/air_mask.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "pivnp/image/masks/mask.hpp"
#include "pivnp/image/masks/moving_mask.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"

namespace pivnp::image {
namespace air_mask_tests {

// splitmix64 of both numbers, in 0..1.
double uniform(std::uint64_t seed, std::uint64_t n) {
  std::uint64_t z = (seed * 0x9e3779b97f4a7c15ULL) + n * 0xbf58476d1ce4e5b9ULL + 0x94d049bb133111ebULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return double((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

constexpr int width = 320, height = 240;
using Sand = std::function<bool(int c, int r)>;

Image texture(std::uint64_t seed, int frame, double noise, const Vec2& shift, int grains = 4200) {
  TextureOptions o;
  o.noise = noise;
  const BlobRenderer renderer(o, width, height);
  std::vector<Vec2> at;
  for (std::uint64_t n = 0; n < std::uint64_t(grains); ++n)
    at.emplace_back(Vec2(uniform(seed, 2 * n) * (width + 60) - 30, uniform(seed, 2 * n + 1) * (height + 60) - 30) + shift);
  return renderer.draw(at, frame, 10);
}

Image over(const Image& behind, const Image& sand, const Sand& is_sand) {
  Image out(width, height, PixelDepth::u8, 255);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) out.row<std::uint8_t>(r)[c] = (is_sand(c, r) ? sand : behind).view().row<std::uint8_t>(r)[c];
  return out;
}

Image sky(double level, double slope, double noise, int frame) {
  Image out(width, height, PixelDepth::u8, 255);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      out.row<std::uint8_t>(r)[c] = std::uint8_t(std::clamp(
          std::lround(level + slope * c + noise * 255 * 3.46 * (uniform(5, std::uint64_t((frame * height + r) * width + c)) - 0.5)), 0L, 255L));
  return out;
}

struct Shares {
  double air_left = 0, sand_taken = 0, farthest = 0;  // px from the surface, of what is wrong
};
Shares compare(const std::vector<std::uint8_t>& air, const Sand& is_sand, const std::function<double(int, int)>& off) {
  Shares out;
  double airs = 0, sands = 0;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      const bool sand = is_sand(c, r), found = air[std::size_t(r * width + c)] != 0;
      (sand ? sands : airs) += 1;
      if (sand == !found) continue;
      (sand ? out.sand_taken : out.air_left) += 1;
      out.farthest = std::max(out.farthest, std::abs(off(c, r)));
    }
  out.air_left /= std::max(airs, 1.0), out.sand_taken /= std::max(sands, 1.0);
  return out;
}

// Rows below the surface, along its normal.
double below(int c, int r) { return (r - 90 - 0.4 * c + 12 * std::sin(c / 40.0)) / std::hypot(1, 0.4); }

TEST(AirMask, EndsWhereTextureBegins) {
  const Sand sand = [](int c, int r) { return below(c, r) > 0; };
  const Image grains = texture(3, 0, 0.01, {0, 0});
  for (const auto& [level, slope, noise] : {std::array{40.0, 0.0, 0.004}, {230.0, 0.0, 0.004}, {60.0, 0.4, 0.004}, {120.0, 0.0, 0.015}}) {
    const Shares s = compare(air_without_texture(over(sky(level, slope, noise, 0), grains, sand).view()), sand, below);
    EXPECT_LT(s.air_left, 0.02) << level << " " << slope << " " << noise;
    EXPECT_LT(s.sand_taken, 0.02) << level << " " << slope << " " << noise;
    EXPECT_LT(s.farthest, 5) << level << " " << slope << " " << noise;
  }
}

TEST(AirMask, LeavesAFrameOfSandAlone) {
  const auto air = air_without_texture(texture(4, 0, 0.01, {0, 0}).view());
  EXPECT_EQ(std::count(air.begin(), air.end(), 1), 0);
  const auto blank = air_without_texture(sky(100, 0.1, 0.01, 0).view());  // one class too
  EXPECT_EQ(std::count(blank.begin(), blank.end(), 1), 0);
}

TEST(AirMask, GivesBackWhatMaterialHasComeTo) {
  // A heap that falls: sand left of column 120 at first, below row 170 to column 240 later.
  const Sand before = [](int c, int) { return c < 120; }, after = [](int c, int r) { return r > 170 && c < 240; };
  const auto frame = [&](int k, const Sand& sand) { return over(texture(8, k, 0.01, {0, 0}, 2500), texture(9, k, 0.01, Vec2(3.0 * k, 2.0 * k)), sand); };
  std::vector<std::uint8_t> material;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) material.push_back(before(c, r));
  const StillBackground background(frame(0, before).view(), frame(1, before).view(), material);
  const auto start = background.find(frame(1, before).view()), later = background.find(frame(6, after).view());
  const auto share = [&](const std::vector<std::uint8_t>& air, int c0, int c1, int r0, int r1) {
    double n = 0;
    for (int r = r0; r < r1; ++r)
      for (int c = c0; c < c1; ++c) n += air[std::size_t(r * width + c)];
    return n / ((c1 - c0) * (r1 - r0));
  };
  EXPECT_EQ(share(start, 0, 120, 0, height), 0);
  EXPECT_GT(share(start, 122, width, 0, height), 0.99);
  EXPECT_GT(share(later, 122, width, 0, 168), 0.97);       // still the background
  EXPECT_GT(share(later, 243, width, 168, height), 0.97);
  EXPECT_LT(share(later, 122, 237, 174, height), 0.01);    // sand by now
  EXPECT_EQ(share(later, 0, 120, 0, height), 0);           // uncovered: what is behind was never seen
}

TEST(AirMask, IsAMaskOfEachFrame) {
  MaskOptions o;
  o.air = AirKind::texture;
  o.grow_px = 2;
  EXPECT_TRUE(o.moves());
  const MovingMasks masks({{"air", o}}, make_camera({}, width, height), width, height, ".");
  const Sand sand = [](int c, int r) { return below(c, r) > 0; };
  Mask mask;
  masks.apply(0, over(sky(40, 0, 0.004, 0), texture(3, 0, 0.01, {0, 0}), sand).view(), mask);
  EXPECT_FALSE(mask.view().usable(60, 40));
  EXPECT_TRUE(mask.view().usable(60, 200));
}

}  // namespace air_mask_tests
}  // namespace pivnp::image
