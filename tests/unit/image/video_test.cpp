#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "pivnp/image/frames.hpp"
#include "scratch.hpp"

namespace pivnp::image {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::Scratch;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Video : public Scratch {
 protected:
  static constexpr int width = 160, height = 96;

  // The frame's number as eight blocks, black or white: it survives any codec.
  static cv::Mat numbered(int number) {
    cv::Mat image(height, width, CV_8UC3, cv::Scalar(110, 120, 130));
    for (int bit = 0; bit < 8; ++bit) {
      const int grey = (number >> bit & 1) ? 230 : 20;
      cv::rectangle(image, cv::Rect(bit * 20 + 2, 20, 16, 56), cv::Scalar(grey, grey, grey), cv::FILLED);
    }
    return image;
  }
  static int number_in(const Image& image) {
    int number = 0;
    for (int bit = 0; bit < 8; ++bit) number |= (image.view().row<std::uint8_t>(48)[bit * 20 + 10] > 128) << bit;
    return number;
  }
  // False if this OpenCV cannot write the codec.
  bool write_video(const std::string& name, int frames, double rate, const char (&codec)[5]) const {
    cv::VideoWriter writer;
    const int fourcc = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
    if (!writer.open(at(name).string(), cv::CAP_FFMPEG, fourcc, rate, cv::Size(width, height))) return false;
    for (int k = 0; k < frames; ++k) writer.write(numbered(k));
    return true;
  }
  std::unique_ptr<FrameSource> open(const FrameOptions& options) const { return open_frames(options, folder_); }
};

TEST_F(Video, EveryFrameIsTheOneItsNameSays) {
  // Motion JPEG: every frame by itself; MPEG-4: differences between frames, where seeking is not exact.
  for (const std::string name : {"a b.avi", "c.mp4"}) {
    const bool mpeg4 = name == "c.mp4";
    ASSERT_TRUE(mpeg4 ? write_video(name, 40, 25, "mp4v") : write_video(name, 40, 25, "MJPG")) << name;
    const auto source = open({.path = name});
    ASSERT_EQ(source->frames().size(), 40u) << name;
    EXPECT_EQ(source->width(), width);
    EXPECT_EQ(source->height(), height);
    EXPECT_TRUE(source->has_rate());
    EXPECT_DOUBLE_EQ(source->frames()[17].time, 17 / 25.0);
    EXPECT_EQ(source->frames()[17].name, name + "#17");
    for (int k = 0; k < 40; ++k) ASSERT_EQ(number_in(source->read(k)), k) << name;
    for (int k = 39; k >= 0; k -= 3) ASSERT_EQ(number_in(source->read(k)), k) << name << " backwards";
    for (const int k : {5, 5, 39, 0, 20, 19, 21}) ASSERT_EQ(number_in(source->read(k)), k) << name;
    const auto ahead = prefetched(open({.path = name}));
    for (const int k : {0, 1, 2, 3, 2, 3, 4, 39, 38}) ASSERT_EQ(number_in(ahead->read(k)), k) << name;
  }
}

TEST_F(Video, RereadingGivesTheSameBits) {
  ASSERT_TRUE(write_video("c.mp4", 30, 25, "mp4v"));
  const auto source = open({.path = "c.mp4"});
  const Image first = source->read(23);
  source->read(29);
  const Image again = source->read(23);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      ASSERT_EQ(first.view().row<std::uint8_t>(r)[c], again.view().row<std::uint8_t>(r)[c]) << c << " " << r;
}

TEST_F(Video, FirstLastStrideAndRate) {
  ASSERT_TRUE(write_video("v.avi", 30, 25, "MJPG"));
  const auto source = open({.path = "v.avi", .rate_hz = 240.0, .first = 3, .last = 12, .stride = 4});
  ASSERT_EQ(source->frames().size(), 3u);
  EXPECT_EQ(source->frames()[2].name, "v.avi#11");
  EXPECT_DOUBLE_EQ(source->frames()[2].time, 8 / 240.0);
  for (int k = 2; k >= 0; --k) EXPECT_EQ(number_in(source->read(k)), 3 + 4 * k);
  EXPECT_THAT(error_of([&] { open({.path = "v.avi", .last = 30}); }),
              AllOf(HasSubstr("frames.last: found 30"), HasSubstr("has 30 frames, 0 to 29")));
  EXPECT_EQ(open({.path = "v.avi", .last = 29})->frames().size(), 30u);
  EXPECT_THAT(error_of([&] { open({.path = "v.avi", .first = 30}); }), HasSubstr("frames.first: found 30"));
}

TEST_F(Video, AGlobMayNameOneVideo) {
  ASSERT_TRUE(write_video("only.avi", 3, 25, "MJPG"));
  EXPECT_EQ(open({.path = "*.avi"})->frames().size(), 3u);
}

TEST_F(Video, TruncationIsNamedAndTheRestUsableOnDemand) {
  ASSERT_TRUE(write_video("v.avi", 40, 25, "MJPG"));
  truncate("v.avi", 0.6);
  ::testing::internal::CaptureStderr();
  const std::string message = error_of([&] { open({.path = "v.avi"}); });
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_THAT(message, AllOf(HasSubstr("v.avi' is truncated"), HasSubstr("promises 40 frames")));
  const auto source = open({.path = "v.avi", .last = 10});
  EXPECT_EQ(source->frames().size(), 11u);
  EXPECT_EQ(number_in(source->read(10)), 10);
}

TEST_F(Video, UnreadableFilesAreNamedInOneLine) {
  ASSERT_TRUE(write_video("v.mp4", 40, 25, "mp4v"));
  truncate("v.mp4", 0.6);  // an MP4 without its index, which comes last
  put(at("notes.avi"), "FFmpeg would draw this text as a terminal does.\n");
  put(at("empty.avi"), "");
  put(at("noise.avi"), std::string(5000, '\x07') + std::string(100, '\0'));
  ::testing::internal::CaptureStderr();
  for (const char* name : {"v.mp4", "notes.avi", "noise.avi"})
    EXPECT_THAT(error_of([&] { open({.path = name}); }), AllOf(HasSubstr(name), HasSubstr("cannot be opened"))) << name;
  EXPECT_THAT(error_of([&] { open({.path = "empty.avi"}); }), HasSubstr("is empty"));
  EXPECT_THAT(error_of([&] { open({.path = "gone.avi"}); }), HasSubstr("gone.avi"));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace pivnp::image
