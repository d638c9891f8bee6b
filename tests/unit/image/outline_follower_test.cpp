// A tool without texture, followed by its outline.
//   criterion: shift within .25 px and turn within .7 px at the rim on drawn frames whose surroundings are textured and move on
//     their own, for an outline that is given 2 px off; a circle is given no turn; a body that is covered is lost, and a body
//     without an edge, or a straight edge, is refused.
#include "pivnp/image/masks/outline_follower.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "pivnp/image/synthetic/synthetic.hpp"
#include "scratch.hpp"

namespace pivnp::image {
namespace outline_follower_tests {

using test::error_of;
using ::testing::HasSubstr;

// splitmix64 of both numbers, in 0..1.
double uniform(std::uint64_t seed, std::uint64_t n) {
  std::uint64_t z = (seed * 0x9e3779b97f4a7c15ULL) + n * 0xbf58476d1ce4e5b9ULL + 0x94d049bb133111ebULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return double((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

constexpr int width = 220, height = 180;
using Inside = std::function<bool(const Vec2&)>;

// Grains that flow past; over them the body, grey throughout, its edge averaged over 6 x 6 points a pixel. `light`: of all.
Image drawn(const Inside& inside, double body, int frame, double light = 1, TextureOptions o = soil_texture()) {
  o.noise = 0.01;
  const BlobRenderer renderer(o, width, height);
  std::vector<Vec2> grains;
  for (std::uint64_t n = 0; n < std::uint64_t(o.density_per_px * (width + 60) * (height + 60)); ++n)
    grains.emplace_back(uniform(11, 2 * n) * (width + 60) - 30 + 2.3 * frame, uniform(11, 2 * n + 1) * (height + 60) - 30 - 1.1 * frame);
  Image out = renderer.draw(grains, frame, 10);
  constexpr int fine = 6;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      int in = 0;
      for (int k = 0; k < fine * fine; ++k) {
        const int i = k % fine, j = k / fine;  // no two of the points in one row or column
        in += inside({c + (i + (j + 0.5) / fine) / fine - 0.5, r + (j + (i + 0.5) / fine) / fine - 0.5});
      }
      const double share = in / double(fine * fine), noise = 2 * (uniform(99, std::uint64_t((frame * height + r) * width + c)) - 0.5);
      std::uint8_t& grey = out.row<std::uint8_t>(r)[c];
      grey = std::uint8_t(std::clamp(std::lround(light * ((1 - share) * grey + share * (body + noise))), 0L, 255L));
    }
  return out;
}

const Vec2 middle(100, 90);

// A plate of 60 x 36 px, shifted and turned about its middle.
Inside plate(const Vec2& shift, double turn) {
  return [=](const Vec2& p) {
    const Vec2 d = p - middle - shift;
    const double c = std::cos(turn), s = std::sin(turn);
    return std::abs(c * d.x() + s * d.y()) < 30 && std::abs(-s * d.x() + c * d.y()) < 18;
  };
}
std::vector<Vec2> plate_outline(const Vec2& off) {
  return {middle + off + Vec2(-30, -18), middle + off + Vec2(30, -18), middle + off + Vec2(30, 18), middle + off + Vec2(-30, 18)};
}
std::vector<Vec2> circle_outline(double radius) {
  std::vector<Vec2> out;
  for (int k = 0; k < 90; ++k) out.emplace_back(middle + radius * Vec2(std::cos(2 * std::numbers::pi * k / 90), std::sin(2 * std::numbers::pi * k / 90)));
  return out;
}

TEST(OutlineFollower, FollowsAPlateThatTurns) {
  const Image first = drawn(plate({0, 0}, 0), 200, 0);
  const OutlineFollower follower(first.view(), plate_outline({1.5, -1}), 10, "mask.plate.follow");
  EXPECT_TRUE(follower.turns());
  CameraPlace place;
  for (int k = 1; k < 6; ++k) {
    const Vec2 shift(3.37 * k, -1.21 * k + 0.3 * k * k);
    const double turn = 0.041 * k;
    place = follower.place(drawn(plate(shift, turn), 200, k, 1 - 0.03 * k).view(), place);
    ASSERT_GT(place.points, 0) << k;
    // The middle of the outline, about which the turn is, is 1.5 and -1 px off the plate's.
    const Vec2 off = follower.centre() - middle, moved(std::cos(turn) * off.x() - std::sin(turn) * off.y(), std::sin(turn) * off.x() + std::cos(turn) * off.y());
    EXPECT_LT((place.shift - (shift + moved - off)).norm(), 0.25) << k;
    EXPECT_LT(std::abs(place.turn - turn) * 35, 0.7) << k;
    EXPECT_GT(place.agree, 0.7 * place.points) << k;
  }
}

TEST(OutlineFollower, GivesACircleNoTurn) {
  const auto disc = [](const Vec2& shift) { return [=](const Vec2& p) { return (p - middle - shift).norm() < 24; }; };
  const OutlineFollower follower(drawn(disc({0, 0}), 30, 0).view(), circle_outline(25), 10, "mask.disc.follow");
  EXPECT_FALSE(follower.turns());
  CameraPlace place;
  for (int k = 1; k < 4; ++k) {
    const Vec2 shift(-4.6 * k, 2.13 * k);
    place = follower.place(drawn(disc(shift), 30, k).view(), place);
    ASSERT_GT(place.points, 0) << k;
    EXPECT_LT((place.shift - shift).norm(), 0.25) << k;
    EXPECT_EQ(place.turn, 0);
  }
}

TEST(OutlineFollower, SaysThatItIsLost) {
  const OutlineFollower follower(drawn(plate({0, 0}, 0), 200, 0).view(), plate_outline({0, 0}), 8, "mask.plate.follow");
  const Inside nowhere = [](const Vec2&) { return false; };
  EXPECT_EQ(follower.place(drawn(nowhere, 200, 1).view(), {}).points, 0);             // covered
  EXPECT_EQ(follower.place(drawn(plate({40, 0}, 0), 200, 1).view(), {}).points, 0);   // farther than was searched
}

// Between sparse bright specks on black, a dark disc has hardly an edge: what looks like it elsewhere is not taken for it.
TEST(OutlineFollower, TakesNothingElseForIt) {
  const auto disc = [](const Vec2& shift) { return [=](const Vec2& p) { return (p - middle - shift).norm() < 24; }; };
  const OutlineFollower follower(drawn(disc({0, 0}), 30, 0, 1, {}).view(), circle_outline(25), 10, "mask.disc.follow");
  CameraPlace place;
  for (int k = 1; k < 4; ++k) {
    const Vec2 shift(-4.6 * k, 2.13 * k);
    place = follower.place(drawn(disc(shift), 30, k, 1, {}).view(), place);
    if (place.points == 0) break;
    EXPECT_LT((place.shift - shift).norm(), 0.5) << k;
  }
}

TEST(OutlineFollower, RefusesWhatShowsNoMotion) {
  Image flat(width, height, PixelDepth::u8, 255);
  for (int r = 0; r < height; ++r) std::fill(flat.row<std::uint8_t>(r), flat.row<std::uint8_t>(r) + width, std::uint8_t{90});
  EXPECT_THAT(error_of([&] { OutlineFollower(flat.view(), plate_outline({0, 0}), 8, "mask.plate.follow"); }), HasSubstr("no edge is seen along it"));
  for (int r = 0; r < height; ++r) std::fill(flat.row<std::uint8_t>(r), flat.row<std::uint8_t>(r) + 100, std::uint8_t{190});
  const std::vector<Vec2> side{{100, -200}, {100, 400}, {-200, 400}, {-200, -200}};
  EXPECT_THAT(error_of([&] { OutlineFollower(flat.view(), side, 8, "mask.plate.follow"); }), HasSubstr("motion in one direction alone"));
}

}  // namespace outline_follower_tests
}  // namespace pivnp::image
