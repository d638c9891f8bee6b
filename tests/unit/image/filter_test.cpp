// Filters of frames before correlation, and what a JPEG leaves in grey values.
//   criterion: backgrounds are the mean, minimum and median by hand, in one piece or in bands; each filter does what it
//   is for: a slope of
//     light goes, spots are capped, contrasts become even; depth and size stay. A JPEG's quality of 20 to 60 is found
//     within 5.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "pivnp/image/files/write.hpp"
#include "pivnp/image/frames/compression.hpp"
#include "pivnp/image/frames/filter.hpp"
#include "pivnp/image/synthetic/synthetic_pair.hpp"
#include "scratch.hpp"

namespace pivnp::image {
namespace filter_tests {

template <class T = std::uint8_t>
Image made(int width, int height, PixelDepth depth, float white, const std::function<double(int, int)>& grey) {
  Image out(width, height, depth, white);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) out.row<T>(r)[c] = T(std::lround(grey(c, r)));
  return out;
}

Image bytes(int width, int height, const std::function<double(int, int)>& grey) {
  return made(width, height, PixelDepth::u8, 255, grey);
}

int at(const Image& image, int c, int r) { return image.view().row<std::uint8_t>(r)[c]; }

double deviation(const Image& image, int c0, int c1, int r0, int r1) {
  double sum = 0, square = 0, n = 0;
  for (int r = r0; r < r1; ++r)
    for (int c = c0; c < c1; ++c) sum += at(image, c, r), square += at(image, c, r) * at(image, c, r), ++n;
  return std::sqrt(square / n - sum * sum / (n * n));
}

double chequered(int c, int r) { return (c / 3 + r / 3) % 2 ? 1 : -1; }

class Compression : public test::Scratch {};

TEST(Filter, BackgroundsAreThoseByHand) {
  const auto read = [](int k) {
    return bytes(5, 4, [k](int c, int r) { return (c + r) * 10 + std::vector<int>{7, 1, 40, 4}[std::size_t(k)]; });
  };
  const Image mean = background_of(4, read, Background::mean), least = background_of(4, read, Background::minimum);
  const Image middle = background_of(4, read, Background::median),
              bands = background_of(4, read, Background::median, 1);
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 5; ++c) {
      EXPECT_EQ(at(mean, c, r), (c + r) * 10 + 13);
      EXPECT_EQ(at(least, c, r), (c + r) * 10 + 1);
      EXPECT_EQ(at(middle, c, r), (c + r) * 10 + 4);
      EXPECT_EQ(at(bands, c, r), at(middle, c, r));
    }
}

TEST(Filter, ABackgroundIsSubtractedAndItsMeanAdded) {
  FilterOptions options;
  options.background = Background::median;
  const FrameFilter filter(options, bytes(4, 1, [](int c, int) { return 10 * c; }));
  const Image out = filter(bytes(4, 1, [](int c, int) { return 10 * c + 50 + c; }));
  for (int c = 0; c < 4; ++c) EXPECT_EQ(at(out, c, 0), 50 + c + 15);
}

TEST(Filter, TheHighPassTakesASlopeOfLight) {
  FilterOptions options;
  options.high_pass_px = 12;
  const Image frame = bytes(128, 64, [](int c, int r) { return 40 + c + 10 * chequered(c, r); });
  const Image out = FrameFilter(options)(bytes(128, 64, [&](int c, int r) { return at(frame, c, r); }));
  EXPECT_GT(deviation(frame, 40, 88, 10, 54), 15);
  EXPECT_NEAR(deviation(out, 40, 88, 10, 54), 10, 1);  // the texture's
}

TEST(Filter, ACapHoldsSpotsDown) {
  FilterOptions options;
  options.cap_std = 2;
  const Image out = FrameFilter(options)(
      bytes(64, 64, [](int c, int r) { return c == 9 && r == 9 ? 255 : 100 + 10 * chequered(c, r); }));
  EXPECT_LE(at(out, 9, 9), 135);
  EXPECT_EQ(at(out, 20, 20), 100 + 10 * int(chequered(20, 20)));
}

TEST(Filter, ContrastsBecomeEven) {
  const auto halves = [] {
    return bytes(192, 96, [](int c, int r) { return 100 + (c < 96 ? 8 : 40) * chequered(c, r); });
  };
  FilterOptions local, clahe;
  local.local_px = 10;
  clahe.clahe_px = 32;
  clahe.clahe_limit = 40;
  for (const FilterOptions& options : {local, clahe}) {
    const Image out = FrameFilter(options)(halves());
    const double weak = deviation(out, 30, 60, 20, 76), strong = deviation(out, 130, 160, 20, 76);
    EXPECT_LT(strong / weak, options.local_px > 0 ? 1.1 : 2.0);  // 5 before
  }
}

TEST(Filter, DepthAndSizeStay) {
  FilterOptions all;
  all.high_pass_px = 5, all.clahe_px = 16, all.cap_std = 2, all.local_px = 5;
  const Image deep = FrameFilter(all)(
      made<std::uint16_t>(40, 30, PixelDepth::u16, 4095, [](int c, int r) { return 2000 + 400 * chequered(c, r); }));
  EXPECT_EQ(deep.depth(), PixelDepth::u16);
  EXPECT_EQ(deep.white(), 4095);
  EXPECT_EQ(deep.width(), 40);
  const Image plain = FrameFilter({})(bytes(3, 3, [](int c, int) { return c; }));
  EXPECT_EQ(at(plain, 2, 1), 2);
}

TEST(Filter, FramesOfABackgroundAreSpreadOverTheSequence) {
  EXPECT_EQ(background_frames(3, 25), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(background_frames(101, 5), (std::vector<int>{0, 25, 50, 75, 100}));
  EXPECT_EQ(background_frames(1, 5), (std::vector<int>{0}));
}

TEST_F(Compression, TheQualityOfAJpegShows) {
  TextureOptions texture;
  texture.noise = 0.02;
  texture.background = 0.3;
  const SyntheticPair pair = synthetic_pair(uniform(0, 0), 256, 192, texture);
  EXPECT_FALSE(jpeg_quality(pair.first.view()));
  for (const int quality : {20, 30, 45, 60}) {
    const auto found = jpeg_quality(through_jpeg(pair.first.view(), quality).view());
    ASSERT_TRUE(found) << quality;
    EXPECT_NEAR(*found, quality, 5);
  }
  const std::filesystem::path file = folder_ / "quality.jpg";
  write_image(pair.first.view(), file);  // at OpenCV's own quality
  ASSERT_TRUE(jpeg_quality(file));
  EXPECT_EQ(*jpeg_quality(file), 95);
  std::filesystem::rename(file, folder_ / "quality.png");
  EXPECT_TRUE(jpeg_quality(folder_ / "quality.png"));  // its content says what it is
  EXPECT_THROW(jpeg_quality(folder_ / "none.jpg"), InputError);
  const auto fine = jpeg_quality(through_jpeg(pair.first.view(), 92).view());
  EXPECT_TRUE(!fine || *fine > least_jpeg_quality);
}

}  // namespace filter_tests
}  // namespace pivnp::image
