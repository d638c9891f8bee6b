// Masks that differ from frame to frame.
//   criterion: a prescribed tool covers what it covers at rest, shifted and turned; one mask image a frame, no more, no less;
//     glare is what is bright in that very frame, grown by the pixels asked for.
#include "pivnp/image/masks/moving_mask.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "pivnp/image/files/write.hpp"
#include "scratch.hpp"

namespace pivnp::image {
namespace moving_mask_tests {

using test::error_of;
using test::Scratch;
using ::testing::HasSubstr;

constexpr int width = 120, height = 80;

class MovingMask : public Scratch {
 protected:
  MovingMasks make(const MaskOptions& o) const { return {{{"tool", o}}, make_camera({}, width, height), width, height, folder_}; }
  static Image grey(int value) {
    Image image(width, height, PixelDepth::u8, 255);
    for (int r = 0; r < height; ++r) std::fill(image.row<std::uint8_t>(r), image.row<std::uint8_t>(r) + width, std::uint8_t(value));
    return image;
  }
  static int covered(const Mask& mask) {
    int n = 0;
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c) n += !mask.view().usable(c, r);
    return n;
  }
};

MaskOptions box() {
  MaskOptions o;
  o.polygon_px = {{20, 20}, {40, 20}, {40, 30}, {20, 30}};  // 21 x 11 pixels
  return o;
}

TEST_F(MovingMask, GoesWhereItIsTold) {
  std::ofstream(folder_ / "tool.csv") << "frame,right_px,down_px,turn_deg\n0,0,0,0\n4,40,20,0\n5,40,20,90\n";
  MaskOptions o = box();
  o.motion = "tool.csv";
  const MovingMasks masks = make(o);
  const Image frame = grey(50);
  Mask start, between, turned;
  masks.apply(0, frame.view(), start);
  masks.apply(2, frame.view(), between);
  masks.apply(9, frame.view(), turned);
  EXPECT_EQ(covered(start), 21 * 11);
  EXPECT_EQ(covered(between), 21 * 11);
  EXPECT_FALSE(between.view().usable(40, 30));  // the corner that was at (20, 20)
  EXPECT_TRUE(between.view().usable(39, 30));
  EXPECT_EQ(covered(turned), 21 * 11);
  EXPECT_FALSE(turned.view().usable(70, 36));  // its middle is at (70, 45), 10 px to each side upward and downward
  EXPECT_TRUE(turned.view().usable(76, 45));
}

TEST_F(MovingMask, TakesOneImageAFrame) {
  for (int k = 0; k < 3; ++k) {
    Image image = grey(255);
    for (int r = 10; r < 20; ++r) std::fill(image.row<std::uint8_t>(r) + 10 * k, image.row<std::uint8_t>(r) + 10 * k + 10, std::uint8_t{0});
    write_image(image.view(), folder_ / ("m" + std::to_string(k) + ".png"));
  }
  MaskOptions o;
  o.images = "m%d.png";
  const MovingMasks masks = make(o);
  EXPECT_NO_THROW(masks.require_frames(3));
  EXPECT_THAT(error_of([&] { masks.require_frames(4); }), HasSubstr("mask.tool.images: found 3 images, expected one for each of the 4 frames"));
  Mask second;
  masks.apply(1, grey(50).view(), second);
  EXPECT_EQ(covered(second), 100);
  EXPECT_FALSE(second.view().usable(15, 15));
  EXPECT_EQ(masks.files().size(), 3u);
}

TEST_F(MovingMask, FindsGlare) {
  MaskOptions o;
  o.glare = 0.98;
  o.grow_px = 2;
  Image frame = grey(100);
  frame.row<std::uint8_t>(40)[60] = 252;
  frame.row<std::uint8_t>(0)[0] = 255;
  frame.row<std::uint8_t>(60)[60] = 249;  // below .98 of white
  Mask mask;
  make(o).apply(0, frame.view(), mask);
  EXPECT_EQ(covered(mask), 25 + 9);
  EXPECT_FALSE(mask.view().usable(62, 42));
  EXPECT_TRUE(mask.view().usable(63, 40));
}

TEST_F(MovingMask, AddsToWhatStandsStill) {
  Mask still(width, height);
  still.row(5)[5] = 0;
  MaskOptions o;
  o.glare = 0.5;
  Image frame = grey(10);
  frame.row<std::uint8_t>(6)[6] = 200;
  make(o).apply(0, frame.view(), still);
  EXPECT_EQ(covered(still), 2);
  Mask other(width, height);
  other.row(7)[7] = 0;
  EXPECT_EQ(covered(both(still, other)), 3);
  EXPECT_EQ(covered(both({}, other)), 1);
}

TEST_F(MovingMask, RefusesWhatCannotMove) {
  MaskOptions o;
  o.follow = true;
  EXPECT_THAT(error_of([&] { make(o); }), HasSubstr("found 0 shapes"));
  o.glare = 0.9;
  EXPECT_THAT(error_of([&] { make(o); }), HasSubstr("no outline that could move"));
  o = box();
  o.motion = "nowhere.csv";
  EXPECT_THAT(error_of([&] { make(o); }), HasSubstr("no such file"));
  std::ofstream(folder_ / "bad.csv") << "time,x,y\n0,0,0\n";
  o.motion = "bad.csv";
  EXPECT_THAT(error_of([&] { make(o); }), HasSubstr("expected 'frame,right_px,down_px,turn_deg'"));
}

}  // namespace moving_mask_tests
}  // namespace pivnp::image
