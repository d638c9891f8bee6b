// The order of files by the numbers in their names, and the clock that the numbers keep.
#include "pivnp/image/files/frame_order.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "pivnp/image/frames/frames.hpp"
#include "scratch.hpp"

namespace pivnp::image {
namespace frame_order_tests {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Of names given in their right order and shuffled.
TimeOrder ordered(std::vector<std::string> names, int seed = 3) {
  const std::vector<std::string> right = names;
  std::shuffle(names.begin(), names.end(), std::mt19937(unsigned(seed)));
  TimeOrder order = in_time_order({names.begin(), names.end()});
  std::vector<std::string> found;
  for (const fs::path& p : order.files) found.push_back(p.string());
  EXPECT_EQ(found, right);
  return order;
}

TEST(FrameOrder, NegativeNumbersComeBeforeZero) {
  const TimeOrder order = ordered({"shot-012.tif", "shot-011.tif", "shot-002.tif", "shot-001.tif", "shot000.tif", "shot001.tif"});
  EXPECT_THAT(order.remarks, Contains(Field(&Remark::text, HasSubstr("signs and decimals: shot-012.tif, shot-011.tif ... shot001.tif"))));
  ordered({"a/p_-30.png", "a/p_-20.png", "a/p_-10.png"});  // all before the trigger
  ordered({"-3.png", "-2.png", "-1.png", "0.png", "1.png"});
  ordered({"T-1.5C_-02.png", "T-1.5C_-01.png", "T-1.5C_00.png"});
}

TEST(FrameOrder, AHyphenBetweenWordAndNumberIsNoSign) {
  EXPECT_THAT(ordered({"img-8.png", "img-9.png", "img-10.png"}).remarks, IsEmpty());
  EXPECT_THAT(ordered({"2024-01-05-1.png", "2024-01-05-2.png", "2024-01-05-3.png"}).remarks, IsEmpty());
}

TEST(FrameOrder, DecimalNumbersAreThoseOfTheirValue) {
  const TimeOrder order = ordered({"p0.5kPa.png", "p0.75kPa.png", "p0.8kPa.png", "p1kPa.png", "p1.25kPa.png", "p10.5kPa.png"});
  EXPECT_THAT(order.remarks, Contains(Field(&Remark::text, HasSubstr("signs and decimals"))));
  ordered({"t0,025.png", "t0,05.png", "t0,1.png", "t0,125.png"});
  ordered({"t-0.5.png", "t-0.25.png", "t0.png", "t0.25.png"});
}

TEST(FrameOrder, APointBeforeACountIsNone) {
  EXPECT_THAT(ordered({"cam1.8.png", "cam1.9.png", "cam1.10.png", "cam1.11.png"}).remarks, IsEmpty());
  EXPECT_THAT(ordered({"run1.5.png", "run1.10.png", "run1.15.png", "run1.20.png"}).remarks, IsEmpty());
  ordered({"12.9.2024.png", "12.10.2024.png"});
}

TEST(FrameOrder, GapsAreKept) {
  const TimeOrder order = ordered({"f_003.png", "f_005.png", "f_007.png", "f_013.png", "f_015.png", "f_017.png"});
  EXPECT_THAT(order.clock, ElementsAre(0, 1, 2, 5, 6, 7));
  EXPECT_THAT(order.remarks, ElementsAre(Field(&Remark::text, HasSubstr("skip once between f_007.png and f_013.png"))));
  EXPECT_THAT(ordered({"t1.png", "t1.05.png", "t1.1.png", "t1.2.png", "t1.25.png"}).clock, ElementsAre(0, 1, 2, 4, 5));
  EXPECT_THAT(ordered({"f1.png", "f5.png", "f9.png"}).clock, ElementsAre(0, 1, 2));  // every fourth
}

TEST(FrameOrder, WhatTheNumbersLeaveOpenIsSaid) {
  const TimeOrder uneven = ordered({"f10.png", "f11.png", "f17.png", "f40.png", "f99.png"});
  EXPECT_THAT(uneven.clock, ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(uneven.remarks, ElementsAre(Field(&Remark::text, HasSubstr("do not step evenly"))));
  const TimeOrder day = ordered({"c_101557.png", "c_101558.png", "c_101559.png", "c_101600.png", "c_101601.png"});
  EXPECT_THAT(day.clock, ElementsAre(0, 1, 2, 3, 4));  // 16 minutes and no second
  EXPECT_THAT(ordered({"a_1.png", "a_2.png", "b_1.png"}).remarks, ElementsAre(Field(&Remark::text, HasSubstr("2 patterns ('a_#.png' and 'b_#.png'"))));
}

TEST(FrameOrder, IsAStrictWeakOrderOnRandomNames) {
  std::mt19937 random(23);
  RecordProperty("seed", 23);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<fs::path> names;
    for (int k = 0; k < 7; ++k) {
      std::string name;
      for (unsigned n = random() % 6; n-- > 0;) name += "01.-a,"[random() % 6];
      names.emplace_back(name + "x");
    }
    std::vector<fs::path> again = names;
    std::shuffle(again.begin(), again.end(), random);
    const auto one = in_time_order(names).files, two = in_time_order(again).files;
    std::vector<std::string> a, b;
    for (const auto& p : one) a.push_back(p.string());
    for (const auto& p : two) b.push_back(p.string());
    EXPECT_EQ(a, b);
  }
}

class FrameOrderOnDisk : public test::Scratch {};

TEST_F(FrameOrderOnDisk, EndingsInCapitalsAndGapsReachTheFrames) {
  for (const char* name : {"s_01.png", "s_02.PNG", "s_04.PNG", "s_05.png"}) write(name, picture(1));
  const auto source = open_frames({.path = "*.png", .rate_hz = 20}, folder_);
  ASSERT_EQ(source->frames().size(), 4u);
  EXPECT_DOUBLE_EQ(source->frames()[2].time, 0.15);
  EXPECT_DOUBLE_EQ(source->frames()[3].time, 0.2);
  EXPECT_THAT(source->remarks(), Contains(Field(&Remark::text, HasSubstr("2 of 4 names end in other letters"))));
  EXPECT_THAT(prefetched(open_frames({.path = "*.png", .rate_hz = 20}, folder_))->remarks(), Contains(Field(&Remark::text, HasSubstr("skip once"))));
}

TEST_F(FrameOrderOnDisk, PatternsTakeNegativeNumbers) {
  for (const char* name : {"q-0002.png", "q-0001.png", "q0000.png", "q0001.png"}) write(name, picture(1));
  const auto source = open_frames({.path = "q%04d.png"}, folder_);
  ASSERT_EQ(source->frames().size(), 4u);
  EXPECT_EQ(source->frames()[0].name, "q-0002.png");
  EXPECT_EQ(source->frames()[3].name, "q0001.png");
}

}  // namespace frame_order_tests
}  // namespace pivnp::image
