#include "pivnp/image/files/image_file.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "pivnp/image/files/image_check.hpp"
#include "scratch.hpp"

namespace pivnp::image {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::Scratch;
using ::testing::HasSubstr;

using ImageFile = Scratch;

template <class T>
void expect_same(const Image& image, const cv::Mat& grey, const std::string& name) {
  ASSERT_EQ(image.width(), grey.cols) << name;
  ASSERT_EQ(image.height(), grey.rows) << name;
  for (int r = 0; r < grey.rows; ++r)
    for (int c = 0; c < grey.cols; ++c)
      ASSERT_EQ(image.view().row<T>(r)[c], grey.at<T>(r, c)) << name << " column " << c << " row " << r;
}

TEST_F(ImageFile, GreyValuesComeAsStored) {
  for (const std::string ending : {"png", "tif", "bmp", "pgm"}) {
    write("g." + ending, picture(3));
    const Image image = read_image_file(at("g." + ending), "t");
    EXPECT_EQ(image.depth(), PixelDepth::u8);
    EXPECT_EQ(image.white(), 255.0f);
    expect_same<std::uint8_t>(image, picture(3), ending);
  }
  for (const std::string ending : {"png", "tif", "pgm"}) {
    const cv::Mat deep = picture(3, 40, 30, CV_16U);
    write("d." + ending, deep);
    const Image image = read_image_file(at("d." + ending), "t");
    EXPECT_EQ(image.depth(), PixelDepth::u16);
    EXPECT_EQ(image.white(), 65535.0f);
    expect_same<std::uint16_t>(image, deep, ending);
  }
}

TEST_F(ImageFile, ColourBecomesBt601Luma) {
  for (const int type : {CV_8UC3, CV_8UC4, CV_16UC3, CV_16UC4})
    for (const std::string ending : {"png", "tif"}) {
      const cv::Mat colour = picture(9, 40, 30, type);
      write("c." + ending, colour);
      const Image image = read_image_file(at("c." + ending), "t");
      const bool deep = colour.depth() == CV_16U;
      ASSERT_EQ(image.depth(), deep ? PixelDepth::u16 : PixelDepth::u8);
      for (int r = 0; r < colour.rows; ++r)
        for (int c = 0; c < colour.cols; ++c) {
          auto channel = [&](int k) {
            const int i = c * colour.channels() + k;
            return deep ? double(colour.ptr<std::uint16_t>(r)[i]) : double(colour.ptr<std::uint8_t>(r)[i]);
          };
          const double luma = 0.114 * channel(0) + 0.587 * channel(1) + 0.299 * channel(2);
          const double found = deep ? image.view().row<std::uint16_t>(r)[c] : image.view().row<std::uint8_t>(r)[c];
          // OpenCV's weights have 14 bits or more: 65535 * 2^-15 for each channel, and half a grey value of rounding.
          ASSERT_NEAR(found, luma, deep ? 4.0 : 0.6) << ending << " " << c << " " << r;
        }
    }
}

TEST_F(ImageFile, JpegIsReadGreyOrColour) {
  cv::Mat smooth(64, 64, CV_8UC3);
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 64; ++c) smooth.at<cv::Vec3b>(r, c) = cv::Vec3b(uchar(2 * c), uchar(100 + r), uchar(220 - c));
  ASSERT_TRUE(cv::imwrite(at("c.jpg").string(), smooth, {cv::IMWRITE_JPEG_QUALITY, 98}));
  const Image image = read_image_file(at("c.jpg"), "t");
  double worst = 0;
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 64; ++c) {
      const double luma = 0.114 * 2 * c + 0.587 * (100 + r) + 0.299 * (220 - c);
      worst = std::max(worst, std::abs(image.view().row<std::uint8_t>(r)[c] - luma));
    }
  EXPECT_LT(worst, 4.0);
}

TEST_F(ImageFile, PgmNamesItsOwnWhite) {
  std::string file = "P5\n# a 12-bit camera\n3 2\n4095\n";
  for (const int v : {0, 1, 4095, 2048, 77, 4094}) file += {char(v >> 8), char(v & 255)};
  put(at("twelve.pgm"), file);
  const Image image = read_image_file(at("twelve.pgm"), "t");
  EXPECT_EQ(image.depth(), PixelDepth::u16);
  EXPECT_EQ(image.white(), 4095.0f);
  EXPECT_EQ(image.view().row<std::uint16_t>(0)[2], 4095);
  EXPECT_EQ(image.view().row<std::uint16_t>(1)[0], 2048);
}

TEST_F(ImageFile, FloatingPointMustLieWithinZeroAndOne) {
  cv::Mat values(5, 7, CV_32F, cv::Scalar(0.25f));
  write("f.tif", values);
  const Image image = read_image_file(at("f.tif"), "t");
  EXPECT_EQ(image.depth(), PixelDepth::f32);
  EXPECT_EQ(image.white(), 1.0f);
  EXPECT_EQ(image.view().row<float>(4)[6], 0.25f);
  values.at<float>(2, 3) = 1.5f;
  write("f.tif", values);
  EXPECT_THAT(error_of([&] { read_image_file(at("f.tif"), "t"); }), HasSubstr("outside 0..1"));
  values.at<float>(2, 3) = std::nanf("");
  write("f.tif", values);
  EXPECT_THAT(error_of([&] { read_image_file(at("f.tif"), "t"); }), HasSubstr("outside 0..1"));
}

// A file cut anywhere must never come out as a picture, and only one line may be said about it.
TEST_F(ImageFile, EveryTruncationIsNamed) {
  for (const std::string ending : {"png", "jpg", "bmp", "tif", "pgm"}) {
    for (const int type : {CV_8UC1, CV_8UC3}) {
      if (ending == "pgm" && type == CV_8UC3) continue;
      const std::string name = "whole." + ending;
      write(name, picture(4, 61, 47, type));
      const std::string whole = bytes(at(name));
      ASSERT_NO_THROW(read_image_file(at(name), "frames"));
      const fs::path cut = at("cut." + ending);
      ::testing::internal::CaptureStderr();
      for (std::size_t size = 0; size < whole.size(); size += size < 64 || size + 64 > whole.size() ? 1 : 37) {
        put(cut, whole.substr(0, size));
        const std::string message = error_of([&] { read_image_file(cut, "frames"); });
        EXPECT_THAT(message, HasSubstr("frames: '" + cut.string() + "' ")) << size << " of " << whole.size();
        if (size == 0) { EXPECT_THAT(message, HasSubstr("empty")); }
        if (size > 64) { EXPECT_THAT(message, HasSubstr("truncated")) << ending << " " << size; }
      }
      EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << ending;
    }
  }
}

// A disk that filled up, or a copy that was stopped, leaves files of full length whose end is zero.
TEST_F(ImageFile, ZeroedEndIsNamed) {
  for (const std::string ending : {"png", "jpg"}) {
    const fs::path file = at("zero." + ending);
    write("zero." + ending, picture(4, 61, 47));
    std::string content = bytes(file);
    std::fill(content.begin() + std::ptrdiff_t(content.size() / 2), content.end(), '\0');
    put(file, content);
    EXPECT_THAT(error_of([&] { read_image_file(file, "frames"); }), HasSubstr(file.string())) << ending;
  }
}

TEST_F(ImageFile, FlippedByteInPngIsNamed) {
  write("f.png", picture(4, 61, 47));
  std::string content = bytes(at("f.png"));
  content[content.size() / 2] = char(content[content.size() / 2] ^ 0x10);
  put(at("f.png"), content);
  EXPECT_THAT(error_of([&] { read_image_file(at("f.png"), "frames"); }), HasSubstr("damaged"));
}

// libpng would say something of a chunk that no grey value depends on.
TEST_F(ImageFile, WhatPngSaysToViewersIsNotRead) {
  write("plain.png", picture(4, 61, 47));
  std::string file = bytes(at("plain.png"));
  file.insert(33, std::string("\0\0\0\0gAMA\xb2\xe1\xb7\x1f", 12));  // behind IHDR; empty, with its checksum
  put(at("odd.png"), file);
  ::testing::internal::CaptureStderr();
  const Image plain = read_image_file(at("plain.png"), "t"), odd = read_image_file(at("odd.png"), "t");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  for (int r = 0; r < 47; ++r)
    for (int c = 0; c < 61; ++c) ASSERT_EQ(odd.view().row<std::uint8_t>(r)[c], plain.view().row<std::uint8_t>(r)[c]);
}

std::string big_endian(std::uint32_t v) { return {char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; }

// A chunk's checksum made anew, as who damages a file on purpose would.
void seal_chunk(std::string& png, std::size_t at) {
  const std::size_t length = std::size_t(static_cast<unsigned char>(png[at + 2])) << 8 | static_cast<unsigned char>(png[at + 3]);
  std::uint32_t c = 0xFFFFFFFFu;
  for (std::size_t k = at + 4; k < at + 8 + length; ++k) {
    c ^= static_cast<unsigned char>(png[k]);
    for (int bit = 0; bit < 8; ++bit) c = c >> 1 ^ (c & 1 ? 0xEDB88320u : 0u);
  }
  png.replace(at + 8 + length, 4, big_endian(~c));
}

TEST_F(ImageFile, LibrariesPrintNothing) {
  write("f.png", picture(4, 61, 47));
  std::string file = bytes(at("f.png"));
  const std::size_t data = file.find("IDAT") - 4;
  for (std::size_t k = data + 40; k < data + 60; ++k) file[k] = char(0xA7 * k);
  seal_chunk(file, data);
  put(at("f.png"), file);
  ::testing::internal::CaptureStderr();
  EXPECT_THAT(error_of([&] { read_image_file(at("f.png"), "frames"); }), HasSubstr("cannot be decoded"));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

// A file of some hundred bytes that asks for gigabytes.
TEST_F(ImageFile, PicturesOfMorePixelsThanAnyCameraHasAreRefused) {
  write("f.png", picture(4, 61, 47));
  std::string file = bytes(at("f.png"));
  file.replace(16, 8, big_endian(1u << 20) + big_endian(3000));
  seal_chunk(file, 8);
  put(at("f.png"), file);
  put(at("f.pgm"), "P5\n70000 60000\n255\n");
  write("f.tif", picture(4, 61, 47));
  file = bytes(at("f.tif"));
  for (const auto& [size, larger] : {std::pair{61, 50000}, {47, 40000}})  // both as little-endian shorts of their tags
    for (const int tag : {256, 257})
      if (const std::size_t at = file.find(std::string{char(tag & 255), 1, 3, 0, 1, 0, 0, 0, char(size), 0}); at != file.npos)
        file.replace(at + 8, 2, std::string{char(larger & 255), char(larger >> 8)});
  put(at("f.tif"), file);
  for (const char* name : {"f.png", "f.pgm", "f.tif"})
    EXPECT_THAT(error_of([&] { read_image_file(at(name), "frames"); }), HasSubstr("more than 268 million")) << name;
}

// The JPEG with one more segment, of the kind that holds a camera's notes and its thumbnail.
std::string with_app1(const std::string& jpeg, const std::string& payload) {
  const std::size_t length = payload.size() + 2;
  EXPECT_LT(length, 65536u);
  return jpeg.substr(0, 2) + "\xFF\xE1" + char(length >> 8) + char(length & 255) + payload + jpeg.substr(2);
}

// The thumbnail inside a camera's file has an end-of-image marker of its own.
TEST_F(ImageFile, ThumbnailDoesNotHideATruncation) {
  write("whole.jpg", picture(4, 61, 47));
  write("thumb.jpg", picture(4, 8, 8));
  const std::string whole = bytes(at("whole.jpg")), thumb = bytes(at("thumb.jpg"));
  const std::string with = with_app1(whole, thumb);
  put(at("with.jpg"), with);
  EXPECT_NO_THROW(read_image_file(at("with.jpg"), "t"));
  put(at("with.jpg"), with.substr(0, with.size() - 40));
  EXPECT_THAT(error_of([&] { read_image_file(at("with.jpg"), "t"); }), HasSubstr("truncated"));
  put(at("with.jpg"), with + std::string(100, '\0'));  // some cameras pad
  EXPECT_NO_THROW(read_image_file(at("with.jpg"), "t"));
}

TEST_F(ImageFile, OrientationTagsAreNotObeyed) {
  write("plain.jpg", picture(4, 61, 47));
  const std::string whole = bytes(at("plain.jpg"));
  // Exif with one entry: orientation (0x0112) = 6, a quarter turn.
  const std::string tiff("MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0", 26);
  const std::string exif = std::string("Exif\0\0", 6) + tiff;
  put(at("turned.jpg"), with_app1(whole, exif));
  const cv::Mat obeyed = cv::imread(at("turned.jpg").string(), cv::IMREAD_GRAYSCALE);
  ASSERT_EQ(obeyed.cols, 47) << "the test's file has no orientation tag that OpenCV sees";
  const Image plain = read_image_file(at("plain.jpg"), "t"), turned = read_image_file(at("turned.jpg"), "t");
  ASSERT_EQ(turned.width(), 61);
  for (int r = 0; r < 47; ++r)
    for (int c = 0; c < 61; ++c) ASSERT_EQ(turned.view().row<std::uint8_t>(r)[c], plain.view().row<std::uint8_t>(r)[c]);
}

// An uncompressed 8-bit grey TIFF, little-endian, with an orientation and, if asked for, a second page.
std::string tiff_file(int width, int height, int orientation, bool two_pages) {
  std::string pixels;
  for (int k = 0; k < width * height; ++k) pixels += char(k % 251);
  auto word = [](std::uint32_t v, int n) {
    std::string s;
    for (int k = 0; k < n; ++k) s += char(v >> 8 * k);
    return s;
  };
  const std::uint32_t entries[][3] = {{256, 3, std::uint32_t(width)}, {257, 3, std::uint32_t(height)}, {258, 3, 8},
                                      {259, 3, 1}, {262, 3, 1}, {273, 4, 8}, {274, 3, std::uint32_t(orientation)},
                                      {277, 3, 1}, {278, 3, std::uint32_t(height)},
                                      {279, 4, std::uint32_t(pixels.size())}};
  std::string directory = word(10, 2);
  for (const auto& e : entries) directory += word(e[0], 2) + word(e[1], 2) + word(1, 4) + word(e[2], 4);
  if (pixels.size() % 2) pixels += '\0';
  const std::uint32_t at = std::uint32_t(8 + pixels.size());
  const std::uint32_t next = two_pages ? at + std::uint32_t(directory.size()) + 4 : 0;
  std::string file = std::string("II*\0", 4) + word(at, 4) + pixels + directory + word(next, 4);
  if (two_pages) file += directory + word(0, 4);
  return file;
}

TEST_F(ImageFile, TiffOrientationAndPages) {
  put(at("flipped.tif"), tiff_file(13, 9, 3, false));
  const Image image = read_image_file(at("flipped.tif"), "t");
  ASSERT_EQ(image.width(), 13);
  for (int r = 0; r < 9; ++r)
    for (int c = 0; c < 13; ++c) ASSERT_EQ(image.view().row<std::uint8_t>(r)[c], (r * 13 + c) % 251);
  put(at("stack.tif"), tiff_file(13, 9, 1, true));
  EXPECT_THAT(error_of([&] { read_image_file(at("stack.tif"), "t"); }), HasSubstr("several pages"));
}

TEST_F(ImageFile, WhatTheDecoderLacksIsNoBlackImage) {
  write("odd.tif", picture(1));
  std::string file = bytes(at("odd.tif"));
  const std::size_t tag =
      file.find(std::string("\x03\x01\x03\0\x01\0\0\0", 8));  // compression, one short, little-endian
  ASSERT_NE(tag, std::string::npos);
  file[tag + 8] = '\x52';  // JPEG XL
  file[tag + 9] = '\xC3';
  put(at("odd.tif"), file);
  EXPECT_NE(error_of([&] { read_image_file(at("odd.tif"), "t"); }), "");
}

TEST_F(ImageFile, WebPIsHeldAgainstItsLength) {
  put(at("cut.webp"), std::string("RIFF\0\x10\0\0WEBPVP8 ", 16) + std::string(100, 'x'));
  EXPECT_THAT(error_of([&] { read_image_file(at("cut.webp"), "t"); }), HasSubstr("truncated"));
}

TEST_F(ImageFile, OtherFilesAreNotImages) {
  put(at("notes.png"), "these are notes, whatever the name says");
  EXPECT_THAT(error_of([&] { read_image_file(at("notes.png"), "t"); }), HasSubstr("cannot be decoded"));
  EXPECT_FALSE(looks_like_image(at("notes.png")));
  EXPECT_THAT(error_of([&] { read_image_file(at("gone.png"), "t"); }), HasSubstr("no such file"));
  EXPECT_THAT(error_of([&] { read_image_file(folder_, "t"); }), HasSubstr("is a folder"));
}

}  // namespace
}  // namespace pivnp::image
