// Real laboratory images; found through PIVNP_TEST_DATA.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>

#include "pivnp/image/frames/frames.hpp"
#include "pivnp/image/masks/mask.hpp"
#include "scratch.hpp"

namespace pivnp::image {
namespace {

using test::error_of;
using ::testing::HasSubstr;

class SharedImages : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("PIVNP_TEST_DATA");
    if (!folder) GTEST_SKIP() << "PIVNP_TEST_DATA is not set: the shared images are not read";
    folder_ = folder;
  }
  std::unique_ptr<FrameSource> open(const FrameOptions& options) const { return open_frames(options, folder_); }

  std::filesystem::path folder_;
};

template <class T>
std::pair<T, T> range(const Image& image) {
  const T* begin = image.view().row<T>(0);
  const auto [low, high] = std::minmax_element(begin, begin + std::ptrdiff_t(image.width()) * image.height());
  return {*low, *high};
}

TEST_F(SharedImages, SixteenBitWithSpacesInTheNames) {
  const auto source = open({.path = "fracture_16bit/*.png"});
  ASSERT_EQ(source->frames().size(), 2u);
  EXPECT_EQ(source->frames()[0].name, "img_0000 .png");
  EXPECT_EQ(source->frames()[1].name, "img_0060 .png");
  EXPECT_EQ(source->width(), 800);
  EXPECT_EQ(source->height(), 1228);
  for (int k = 0; k < 2; ++k) {
    const Image image = source->read(k);
    EXPECT_EQ(image.depth(), PixelDepth::u16);
    EXPECT_EQ(image.white(), 65535.0f);
    EXPECT_GT(range<std::uint16_t>(image).second, 60000);
  }
  EXPECT_EQ(open({.path = "fracture_16bit/img_%04d .png", .stride = 60})->frames().size(), 2u);
  EXPECT_THAT(error_of([&] { open({.path = "fracture_16bit/img_%04d .png"}); }), HasSubstr("img_0001 .png"));
}

TEST_F(SharedImages, VideoAtTheRateItWasRecordedAt) {
  const std::string file = "20210804_08g_050g_050_050_005_1.MP4";
  const auto source = open({.path = "column_collapse/" + file, .rate_hz = 240.0});
  ASSERT_EQ(source->frames().size(), 111u);
  EXPECT_EQ(source->width(), 1920);
  EXPECT_EQ(source->height(), 1080);
  EXPECT_DOUBLE_EQ(source->frames()[110].time, 110 / 240.0);
  EXPECT_EQ(source->frames()[110].name, file + "#110");
  const auto claimed = open({.path = "column_collapse/" + file, .last = 5});
  EXPECT_DOUBLE_EQ(claimed->frames()[1].time, 1 / 120.0);

  // Read forward and read again from further on: the same frame, bit by bit.
  const Image early = claimed->read(4);
  source->read(9);
  const Image again = source->read(4);
  EXPECT_TRUE(std::equal(early.view().data, early.view().data + 1920 * 1080, again.view().data));
  EXPECT_NO_THROW(source->read(110));
}

TEST_F(SharedImages, TwelveMegapixelsAndTheirMask) {
  const auto source = prefetched(open({.path = "tbar/*.jpg"}));
  ASSERT_EQ(source->frames().size(), 19u);
  EXPECT_EQ(source->frames()[18].name, "IMG_1080.jpg");
  EXPECT_EQ(source->width(), 4096);
  EXPECT_EQ(source->height(), 3000);
  const Image image = source->read(0);
  EXPECT_EQ(image.depth(), PixelDepth::u8);
  EXPECT_GT(range<std::uint8_t>(image).second - range<std::uint8_t>(image).first, 100);
  const Mask mask = make_mask({{"cylinder", {.circle_px = {1915, 1490, 395}}}}, make_camera({}, 4096, 3000), 4096, 3000,
                              folder_);
  EXPECT_FALSE(mask.view().usable(1915, 1490));
  EXPECT_TRUE(mask.view().usable(1915, 1000));
}

TEST_F(SharedImages, ColourJpegsOfTheSandWedge) {
  const auto source = open({.path = "sand_wedge/pjt_highfric_15deg_glass1cm_071619_crop_%d.jpg"});
  ASSERT_EQ(source->frames().size(), 20u);
  EXPECT_EQ(source->frames()[0].name, "pjt_highfric_15deg_glass1cm_071619_crop_500.jpg");
  EXPECT_EQ(source->width(), 250);
  EXPECT_EQ(source->height(), 150);
  for (int k = 0; k < 20; ++k) EXPECT_NO_THROW(source->read(k));
}

TEST_F(SharedImages, EveryOtherImageIsWhole) {
  for (const char* glob : {"dic_challenge_12/*.tiff", "dic_challenge_14/*.tif", "dice_rigid_shift/def*.tif",
                           "dice_rigid_shift/Sample5*.tif", "speckle_affine/*.bmp", "oseen_uvmat/*.bmp",
                           "oseen_uvmat/*.tif", "openpiv/test14_disp_series/*.bmp"}) {
    const auto source = open({.path = glob});
    EXPECT_GE(source->frames().size(), 2u) << glob;
    for (std::size_t k = 0; k < source->frames().size(); ++k) EXPECT_NO_THROW(source->read(int(k))) << glob;
  }
}

}  // namespace
}  // namespace pivnp::image
