#include "pivnp/image/frames/frames.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <thread>

#include "scratch.hpp"

namespace pivnp::image {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::Scratch;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Frames : public Scratch {
 protected:
  void write_sequence(int first, int last, const std::string& before = "img_", const std::string& after = ".png") {
    for (int k = first; k <= last; ++k) write(before + std::to_string(k) + after, picture(k));
  }
  std::unique_ptr<FrameSource> open(const FrameOptions& options) const { return open_frames(options, folder_); }
  static std::vector<std::string> names(const FrameSource& source) {
    std::vector<std::string> out;
    for (const Frame& f : source.frames()) out.push_back(f.name);
    return out;
  }
  static std::vector<double> times(const FrameSource& source) {
    std::vector<double> out;
    for (const Frame& f : source.frames()) out.push_back(f.time);
    return out;
  }
  static bool is_picture(const Image& image, int seed) {
    const cv::Mat expected = picture(seed);
    if (image.width() != expected.cols || image.height() != expected.rows) return false;
    for (int r = 0; r < expected.rows; ++r)
      for (int c = 0; c < expected.cols; ++c)
        if (image.view().row<std::uint8_t>(r)[c] != expected.at<std::uint8_t>(r, c)) return false;
    return true;
  }
};

TEST_F(Frames, GlobInNaturalOrder) {
  write_sequence(0, 11);
  const auto source = open({.path = "*.png"});
  ASSERT_EQ(source->frames().size(), 12u);
  EXPECT_EQ(source->frames()[2].name, "img_2.png");
  EXPECT_EQ(source->frames()[10].name, "img_10.png");
  EXPECT_EQ(source->width(), 40);
  EXPECT_EQ(source->height(), 30);
  EXPECT_FALSE(source->has_rate());
  EXPECT_EQ(source->frames()[11].time, 11.0);
  for (int k : {0, 11, 5, 2}) EXPECT_TRUE(is_picture(source->read(k), k)) << k;
}

TEST_F(Frames, FolderHoldsImagesOnly) {
  write_sequence(8, 10, "shot/a ");
  put(at("shot/readme.txt"), "no image");
  EXPECT_THAT(names(*open({.path = "shot"})), ElementsAre("a 8.png", "a 9.png", "a 10.png"));
  EXPECT_THAT(names(*open({.path = "shot/"})), ElementsAre("a 8.png", "a 9.png", "a 10.png"));
  EXPECT_THAT(names(*open({.path = (folder_ / "shot").string()})), ElementsAre("a 8.png", "a 9.png", "a 10.png"));
}

TEST_F(Frames, SameNamesInSeveralFoldersStayApart) {
  write("run2/f.png", picture(2));
  write("run10/f.png", picture(10));
  EXPECT_THAT(names(*open({.path = "run*/f.png"})), ElementsAre("run2/f.png", "run10/f.png"));
}

TEST_F(Frames, FirstLastAndStrideCountOriginalFrames) {
  write_sequence(0, 11);
  const auto source = open({.path = "*.png", .rate_hz = 50.0, .first = 2, .last = 9, .stride = 3});
  EXPECT_THAT(names(*source), ElementsAre("img_2.png", "img_5.png", "img_8.png"));
  EXPECT_TRUE(source->has_rate());
  EXPECT_THAT(times(*source), ElementsAre(0.0, 3 / 50.0, 6 / 50.0));
  EXPECT_TRUE(is_picture(source->read(1), 5));
  EXPECT_THAT(times(*open({.path = "*.png", .first = 2, .stride = 4})), ElementsAre(0.0, 4.0, 8.0));
}

TEST_F(Frames, ChoicesOutsideTheSequenceAreNamed) {
  write_sequence(0, 4);
  EXPECT_THAT(error_of([&] { open({.path = "*.png", .last = 5}); }),
              AllOf(HasSubstr("frames.last: found 5"), HasSubstr("has 5 frames, 0 to 4")));
  EXPECT_THAT(error_of([&] { open({.path = "*.png", .first = 5}); }),
              AllOf(HasSubstr("frames.first: found 5"), HasSubstr("has 5 frames")));
  EXPECT_THAT(error_of([&] { open({.path = "*.png", .first = 3, .last = 2}); }), HasSubstr("frames.last: found 2"));
  EXPECT_THAT(error_of([&] { open({.path = "*.png", .stride = 0}); }), HasSubstr("frames.stride"));
  EXPECT_THAT(error_of([&] { open({.path = "*.png", .rate_hz = 0.0}); }), HasSubstr("frames.rate_hz"));
  EXPECT_THAT(error_of([&] { open({.path = ""}); }), HasSubstr("frames.path: nothing given"));
  EXPECT_THAT(error_of([&] { open({.path = "*.tif"}); }), HasSubstr("nothing matches"));
}

TEST_F(Frames, PatternStartsAtTheFirstNumberThatExists) {
  write_sequence(7, 12);
  const auto source = open({.path = "img_%d.png"});
  EXPECT_EQ(names(*source).front(), "img_7.png");
  EXPECT_EQ(source->frames().size(), 6u);
  EXPECT_THAT(names(*open({.path = "img_%d.png", .first = 4})), ElementsAre("img_11.png", "img_12.png"));
}

TEST_F(Frames, GapInAPatternIsNamed) {
  write_sequence(7, 9);
  write_sequence(11, 12);
  EXPECT_THAT(error_of([&] { open({.path = "img_%d.png"}); }),
              AllOf(HasSubstr("frame 3 is missing"), HasSubstr((folder_ / "img_10.png").string())));
  EXPECT_THAT(names(*open({.path = "img_%d.png", .last = 2})), ElementsAre("img_7.png", "img_8.png", "img_9.png"));
  EXPECT_THAT(names(*open({.path = "img_%d.png", .stride = 2})), ElementsAre("img_7.png", "img_9.png", "img_11.png"));
  EXPECT_EQ(open({.path = "img_*.png"})->frames().size(), 5u);
}

TEST_F(Frames, PaddedPatternTakesOnlyItsOwnNames) {
  for (const char* name : {"f 0009 .png", "f 0010 .png", "f 11 .png"}) write(name, picture(1));
  EXPECT_THAT(names(*open({.path = "f %04d .png"})), ElementsAre("f 0009 .png", "f 0010 .png"));
}

TEST_F(Frames, ANameThatExistsIsNoPattern) {
  write("img_%d.png", picture(1));
  write("img_[1].png", picture(2));
  write("img_1.png", picture(3));
  EXPECT_THAT(names(*open({.path = "img_%d.png"})), ElementsAre("img_%d.png"));
  EXPECT_THAT(names(*open({.path = "img_[1].png"})), ElementsAre("img_[1].png"));
}

TEST_F(Frames, AnotherSizeOrDepthIsNamedWithTheFirst) {
  write("a0.png", picture(0));
  write("a1.png", picture(1, 41, 30));
  write("a2.png", picture(2, 40, 30, CV_16U));
  const auto source = open({.path = "a*.png"});
  EXPECT_THAT(error_of([&] { source->read(1); }),
              AllOf(HasSubstr("a1.png' is 41x30 8-bit"), HasSubstr("a0.png' is 40x30 8-bit")));
  EXPECT_THAT(error_of([&] { source->read(2); }),
              AllOf(HasSubstr("a2.png' is 40x30 16-bit"), HasSubstr("a0.png' is 40x30 8-bit")));
  EXPECT_TRUE(is_picture(source->read(0), 0));
}

TEST_F(Frames, DamagedFramesAreNamedWhenTheyAreRead) {
  write_sequence(0, 4);
  truncate("img_2.png", 0.7);
  put(at("img_3.png"), "");
  const auto source = open({.path = "img_%d.png"});
  fs::remove(at("img_4.png"));
  EXPECT_TRUE(is_picture(source->read(1), 1));
  EXPECT_THAT(error_of([&] { source->read(2); }), AllOf(HasSubstr("img_2.png"), HasSubstr("truncated")));
  EXPECT_THAT(error_of([&] { source->read(3); }), AllOf(HasSubstr("img_3.png"), HasSubstr("empty")));
  EXPECT_THAT(error_of([&] { source->read(4); }), AllOf(HasSubstr("img_4.png"), HasSubstr("no such file")));
  truncate("img_0.png", 0.7);
  EXPECT_THAT(error_of([&] { open({.path = "img_%d.png", .last = 1}); }), HasSubstr("img_0.png"));
}

TEST_F(Frames, OnlyTheFirstFrameUsedIsReadAtOpening) {
  write("b5.png", picture(5));
  for (const char* name : {"b1.png", "b6.png"}) put(at(name), "no image");
  EXPECT_EQ(open({.path = "b*.png", .first = 1})->frames().size(), 2u);
}

// Counts who reads what, and on how many threads at a time.
class Watched final : public FrameSource {
 public:
  explicit Watched(int frames) : frames_(std::size_t(frames)) {}
  ~Watched() override { EXPECT_EQ(inside_, 0) << "dropped while a frame is being read"; }
  const std::vector<Frame>& frames() const override { return frames_; }
  bool has_rate() const override { return false; }
  int width() const override { return 1; }
  int height() const override { return 1; }
  Image read(int index) override {
    EXPECT_EQ(inside_.fetch_add(1), 0) << "two reads at a time";
    if (begins_) begins_(index);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    reads_.push_back(index);
    inside_.fetch_sub(1);
    if (index == failing_) throw InputError("frame " + std::to_string(index));
    Image image(1, 1, PixelDepth::u8, 255);
    image.row<std::uint8_t>(0)[0] = std::uint8_t(index);
    return image;
  }
  std::vector<int> reads_;
  int failing_ = -1;
  std::function<void(int)> begins_;  // is told of every frame whose reading begins

 private:
  std::vector<Frame> frames_;
  std::atomic<int> inside_ = 0;
};

int value(const Image& image) { return image.view().row<std::uint8_t>(0)[0]; }

TEST(Prefetched, ReadsEachFrameOnceWhenGoingForward) {
  auto watched = std::make_unique<Watched>(20);
  Watched& inner = *watched;
  const auto source = prefetched(std::move(watched));
  for (int k = 0; k < 20; ++k) ASSERT_EQ(value(source->read(k)), k);
  std::vector<int> once(20);
  for (int k = 0; k < 20; ++k) once[std::size_t(k)] = k;
  EXPECT_EQ(inner.reads_, once);
}

TEST(Prefetched, ReadsAheadWhileTheCallerWorks) {
  auto watched = std::make_unique<Watched>(3);
  std::promise<int> ahead;
  watched->begins_ = [&](int index) {
    if (index > 0) ahead.set_value(index);
  };
  const auto source = prefetched(std::move(watched));
  source->read(0);
  auto first_ahead = ahead.get_future();
  ASSERT_EQ(first_ahead.wait_for(std::chrono::minutes(1)), std::future_status::ready) << "nothing is read ahead";
  EXPECT_EQ(first_ahead.get(), 1);
}

TEST(Prefetched, GivesTheRightFrameInAnyOrder) {
  const auto source = prefetched(std::make_unique<Watched>(20));
  for (const int k : {0, 1, 1, 2, 1, 2, 19, 18, 3, 4, 5, 0, 19, 19, 0, 1, 2})
    ASSERT_EQ(value(source->read(k)), k);
}

TEST(Prefetched, ErrorsComeWithTheFrameThatIsAskedFor) {
  auto watched = std::make_unique<Watched>(6);
  watched->failing_ = 2;
  const auto source = prefetched(std::move(watched));
  EXPECT_EQ(value(source->read(0)), 0);
  EXPECT_EQ(value(source->read(1)), 1);
  EXPECT_EQ(error_of([&] { source->read(2); }), "frame 2");
  EXPECT_EQ(error_of([&] { source->read(2); }), "frame 2");
  EXPECT_EQ(value(source->read(1)), 1);
  EXPECT_EQ(value(source->read(3)), 3);  // what the background read of 2 threw is not this frame's
}

TEST(Prefetched, MayBeDroppedWithAReadUnderWay) {
  for (int k = 0; k < 20; ++k) {
    auto watched = std::make_unique<Watched>(6);
    watched->failing_ = 1;
    std::promise<void> under_way;
    watched->begins_ = [&](int index) {
      if (index == 1) under_way.set_value();
    };
    auto source = prefetched(std::move(watched));
    EXPECT_EQ(value(source->read(0)), 0);
    auto begun = under_way.get_future();
    ASSERT_EQ(begun.wait_for(std::chrono::minutes(1)), std::future_status::ready) << "round " << k;
    source.reset();  // Watched looks whether the read has ended
  }
}

}  // namespace
}  // namespace pivnp::image
