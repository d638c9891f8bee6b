#include <gmock/gmock.h>

#include <bit>
#include <fstream>
#include <iterator>

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "pivnp/image/frames/frames.hpp"
#include "pivnp/image/frames/sources.hpp"
#include "scratch.hpp"

namespace pivnp::image {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::Scratch;
using ::testing::AllOf;
using ::testing::Field;
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
  bool write_video(const std::string& name, int frames, double rate, const std::string& codec) const {
    cv::VideoWriter writer;
    const int fourcc = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
    if (!writer.open(at(name).string(), cv::CAP_FFMPEG, fourcc, rate, cv::Size(width, height))) return false;
    for (int k = 0; k < frames; ++k) writer.write(numbered(k));
    return true;
  }
  static std::uint32_t word(const std::string& file, std::size_t at) {
    std::uint32_t v = 0;
    for (std::size_t k = 0; k < 4; ++k) v = v << 8 | static_cast<unsigned char>(file.at(at + k));
    return v;
  }
  static std::string word(std::uint32_t v) { return {char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; }
  // Where the box of this name begins: its length, then its name. The index ("moov") comes last in these files.
  static std::size_t box(const std::string& file, const std::string& name) { return file.rfind(name) - 4; }

  std::unique_ptr<FrameSource> open(const FrameOptions& options) const { return open_frames(options, folder_); }
};

TEST_F(Video, ReadsBackwards) {
  if (!write_video("back.avi", 40, 25, "MJPG")) GTEST_SKIP() << "no encoder";
  FrameOptions options;
  options.path = "back.avi";
  options.first = 3;
  options.stride = 2;
  const auto source = open(options);
  const int count = int(source->frames().size());
  for (int k = count - 1; k >= 0; --k) EXPECT_EQ(number_in(source->read(k)), 3 + 2 * k);
  for (int k = 0; k < count; ++k) EXPECT_EQ(number_in(source->read(k)), 3 + 2 * k);
}

// Deep frames come out of the decoder with 8 bits: how many grey values are left is said.
TEST_F(Video, GreyValuesThatTheDecoderCutsAreSaid) {
  std::string file = "YUV4MPEG2 W" + std::to_string(width) + " H" + std::to_string(height) + " F25:1 Ip A1:1 Cmono16\n";
  for (int k = 0; k < 3; ++k) {
    file += "FRAME\n";
    for (int n = 0; n < width * height; ++n) {
      const int grey = (n * 37 + k * 11) % 1500;  // of 65535
      file += {char(grey & 0xFF), char(grey >> 8)};
    }
  }
  put(at("deep.y4m"), file);
  FrameOptions options;
  options.path = "deep.y4m";
  EXPECT_THAT(open(options)->remarks(), ::testing::ElementsAre(Field(&Remark::text, AllOf(HasSubstr("16 bits"), HasSubstr(" different ones are left")))));
}

// The matrix in the track's head: a turn by a quarter, as of a telephone that was held upright.
TEST_F(Video, ATurnThatThePlayerIsAskedForIsSaid) {
  if (!write_video("upright.mp4", 5, 25, "mp4v")) GTEST_SKIP() << "no encoder";
  std::string file = bytes(at("upright.mp4"));
  const std::size_t matrix = box(file, "tkhd") + 8 + 40;
  for (const auto& [k, value] : {std::pair{0, 0u}, {1, 0x10000u}, {3, 0xFFFF0000u}, {4, 0u}})
    file.replace(matrix + 4 * std::size_t(k), 4, word(value));
  put(at("turned.mp4"), file);
  FrameOptions options;
  options.path = "upright.mp4";
  EXPECT_TRUE(open(options)->remarks().empty());
  options.path = "turned.mp4";
  const auto source = open(options);
  EXPECT_EQ(source->width(), width);
  EXPECT_THAT(source->remarks(), ::testing::ElementsAre(Field(&Remark::text, HasSubstr("turn it by"))));
}

TEST_F(Video, TimesAreThoseOfTheStampsWhereTheyAreAsked) {
  if (!write_video("stamped.avi", 6, 20, "MJPG")) GTEST_SKIP() << "no encoder";
  FrameOptions options;
  options.path = "stamped.avi";
  options.times = FrameTimes::stamps;
  options.first = 1;
  const auto source = open(options);
  ASSERT_TRUE(source->has_rate());
  for (std::size_t k = 0; k < source->frames().size(); ++k) EXPECT_NEAR(source->frames()[k].time, double(k) / 20, 1e-6);
  options.rate_hz = 20.0;
  EXPECT_THAT(error_of([&] { open(options); }), HasSubstr("given together with frames.times"));
}

// Matroska promises a duration times a rate, which is more frames than it holds where the rate varies.
TEST_F(Video, AVariableRateInMatroskaIsNoTruncation) {
  {
    cv::VideoWriter writer;
    if (!writer.open(at("even.mkv").string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25, cv::Size(width, height)))
      GTEST_SKIP() << "no encoder";
    // (Plain frames, so that all lie in one cluster, whose times are relative to its own.)
    for (int k = 0; k < 12; ++k) writer.write(cv::Mat(height, width, CV_8UC3, cv::Scalar(20 * k, 20 * k, 20 * k)));
  }
  std::string file;
  {
    std::ifstream in(at("even.mkv"), std::ios::binary);
    file.assign(std::istreambuf_iterator<char>(in), {});
  }
  const int ms[] = {0, 40, 80, 160, 200, 320, 360, 400, 480, 560, 600, 640};
  // Blocks: track 1, time in two bytes, key frame; then a JPEG.
  std::size_t from = 0;
  for (int k = 0; k < 12; ++k) {
    const auto block = [](int time) { return std::string{char(0x81), char(time >> 8), char(time & 255), char(0x80), char(0xff), char(0xd8)}; };
    const std::size_t found = file.find(block(40 * k), from);
    ASSERT_NE(found, std::string::npos) << k;
    file.replace(found, 6, block(ms[k]));
    from = found + 6;
  }
  const std::size_t duration = file.find(std::string{0x44, char(0x89), char(0x88)});
  ASSERT_NE(duration, std::string::npos);
  const auto bits = std::bit_cast<std::uint64_t>(680.0);
  for (std::size_t b = 0; b < 8; ++b) file[duration + 3 + b] = char(bits >> (56 - 8 * b) & 255);
  std::ofstream(at("varies.mkv"), std::ios::binary) << file;
  FrameOptions options;
  options.path = "varies.mkv";
  EXPECT_THAT(error_of([&] { open(options); }), HasSubstr("frames.times = \"stamps\""));
  options.times = FrameTimes::stamps;
  const auto source = open(options);
  ASSERT_EQ(source->frames().size(), 12u);
  for (std::size_t k = 0; k < 12; ++k) EXPECT_NEAR(source->frames()[k].time, ms[k] / 1000.0, 1e-6);
  // Cut short, it is known to be.
  std::ofstream(at("cut.mkv"), std::ios::binary) << file.substr(0, file.size() * 6 / 10);
  options.path = "cut.mkv";
  EXPECT_NE(error_of([&] { open(options); }), "");
}

// H.264 with frames that depend on later ones: at the file's end the decoder still holds some, and knows no stamps of them.
TEST_F(Video, FramesWithoutAStampAreNamed) {
  if (!write_video("late.mp4", 40, 25, "avc1")) GTEST_SKIP() << "no encoder";
  FrameOptions options;
  options.path = "late.mp4";
  ASSERT_EQ(open(options)->frames().size(), 40u);
  options.times = FrameTimes::stamps;
  const std::string error = error_of([&] { open(options); });
  const std::string remedy = "frames.last = ";
  const std::size_t at = error.find(remedy);
  ASSERT_NE(at, std::string::npos) << error;
  EXPECT_THAT(error, HasSubstr("without a stamp"));
  options.last = std::stoi(error.substr(at + remedy.size()));
  const auto source = open(options);
  EXPECT_GE(source->frames().size(), 30u);
  for (std::size_t k = 0; k < source->frames().size(); ++k) EXPECT_NEAR(source->frames()[k].time, double(k) / 25, 1e-3);
}

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
  EXPECT_THAT(message, AllOf(HasSubstr("v.avi' ends too early"), HasSubstr("promises 40 frames")));
  const auto source = open({.path = "v.avi", .last = 10});
  EXPECT_EQ(source->frames().size(), 11u);
  EXPECT_EQ(number_in(source->read(10)), 10);
}

TEST_F(Video, TheLastBytesCount) {
  for (const auto& [name, code] : {std::pair{"v.avi", "MJPG"}, {"v.mp4", "mp4v"}, {"v.mov", "mp4v"}, {"v.mpg", "PIM1"}}) {
    ASSERT_TRUE(write_video(name, 40, 25, code)) << name;
    EXPECT_EQ(open({.path = name})->frames().size(), 40u) << name;
    truncate(name, 0.999);
    EXPECT_THAT(error_of([&] { open({.path = name}); }), HasSubstr("truncated")) << name;
  }
}

// A program stream tells unless it is cut between two of its packets.
TEST_F(Video, ProgramStreamsTellByTheirLastPacket) {
  ASSERT_TRUE(write_video("v.mpg", 40, 25, "PIM1"));
  const std::string whole = bytes(at("v.mpg"));
  int silent = 0;
  for (std::size_t cut = 1; cut < 4096; cut += 5) {
    put(at("cut.mpg"), whole.substr(0, whole.size() - cut));
    silent += !video_defect(at("cut.mpg"));
  }
  EXPECT_LE(silent, 8);
  put(at("padded.mpg"), whole + std::string(3000, '\0'));
  EXPECT_FALSE(video_defect(at("padded.mpg")));
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

// A list of files passes for a video: what it names would be opened and shown.
TEST_F(Video, ListsOfFilesAreNoVideos) {
  ASSERT_TRUE(write_video("other.avi", 12, 25, "MJPG"));
  ASSERT_EQ(open({.path = "other.avi"})->frames().size(), 12u);
  const std::string no_text(1, '\0');
  put(at("list.avi"), "ffconcat version 1.0\nfile other.avi\n#" + no_text);
  put(at("list.mp4"), "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\nother.avi\n#EXT-X-ENDLIST\n#" + no_text);
  for (const char* name : {"list.avi", "list.mp4"})
    EXPECT_THAT(error_of([&] { open({.path = name}); }), AllOf(HasSubstr(name), HasSubstr("cannot be opened"))) << name;
}

// An MP4 made for the web has its index in front, so that a download that stopped still opens and still counts.
TEST_F(Video, AnIndexInFrontDoesNotHideATruncation) {
  ASSERT_TRUE(write_video("v.mp4", 40, 25, "mp4v"));
  std::string file = bytes(at("v.mp4"));
  const std::size_t index_at = box(file, "moov"), data_at = box(file, "mdat");
  ASSERT_LT(data_at, index_at);
  std::string index = file.substr(index_at);
  const std::size_t offsets = box(index, "stco");
  for (std::uint32_t k = 0; k < word(index, offsets + 12); ++k) {
    const std::size_t entry = offsets + 16 + 4 * k;
    index.replace(entry, 4, word(word(index, entry) + std::uint32_t(index.size())));
  }
  file = file.substr(0, data_at) + index + file.substr(data_at, index_at - data_at);
  put(at("front.mp4"), file);
  ASSERT_EQ(number_in(open({.path = "front.mp4"})->read(39)), 39);

  put(at("front.mp4"), file.substr(0, data_at + index.size() + (index_at - data_at) / 2));
  const std::string message = error_of([&] { open({.path = "front.mp4"}); });
  EXPECT_THAT(message, AllOf(HasSubstr("ends too early"), HasSubstr("promises 40 frames")));
  const std::string key = "frames.last = ";  // what the message proposes must work
  ASSERT_NE(message.find(key), std::string::npos) << message;
  const int last = std::stoi(message.substr(message.find(key) + key.size()));
  EXPECT_GT(last, 5);
  EXPECT_EQ(number_in(open({.path = "front.mp4", .last = last})->read(last)), last);
  EXPECT_THAT(error_of([&] { open({.path = "front.mp4", .last = last + 1}); }), HasSubstr("ends too early"));
}

TEST_F(Video, AVaryingRateAsksForOne) {
  ASSERT_TRUE(write_video("v.mp4", 40, 25, "mp4v"));
  std::string file = bytes(at("v.mp4"));
  // The table of durations says "40 frames of d each"; make it 20 of d and 20 of 3 d, eight bytes longer.
  const std::size_t table = box(file, "stts");
  ASSERT_EQ(word(file, table + 12), 1u);
  const std::uint32_t d = word(file, table + 20);
  file.replace(table + 12, 12, word(2) + word(20) + word(d) + word(20) + word(3 * d));
  for (const char* name : {"moov", "trak", "mdia", "minf", "stbl", "stts"}) {
    const std::size_t at = box(file, name);
    file.replace(at, 4, word(word(file, at) + 8));
  }
  file.replace(box(file, "edts") + 4, 4, "free");  // the edit list would cut the film at its old length
  put(at("varying.mp4"), file);
  EXPECT_THAT(error_of([&] { open({.path = "varying.mp4"}); }),
              AllOf(HasSubstr("varying.mp4"), HasSubstr("frames.rate_hz")));
  const auto source = open({.path = "varying.mp4", .rate_hz = 10.0});
  ASSERT_EQ(source->frames().size(), 40u);
  EXPECT_DOUBLE_EQ(source->frames()[39].time, 3.9);
  EXPECT_EQ(number_in(source->read(39)), 39);
}

}  // namespace
}  // namespace pivnp::image
