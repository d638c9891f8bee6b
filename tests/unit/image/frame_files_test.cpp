#include "pivnp/image/files/frame_files.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "scratch.hpp"

namespace pivnp::image {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::Scratch;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> names(const FrameFiles& files) {
  std::vector<std::string> out;
  for (const auto& f : files.files) out.push_back(f.path.filename().string());
  return out;
}

TEST(NaturalOrder, NumbersCountAsNumbers) {
  const std::vector<std::string> ordered = {"IMG_9.png",  "a",        "img_1.png",  "img_01.png", "img_2.png",
                                            "img_2a.png", "img_10.b", "img_10.png", "img_10_1.x", "img_10_11.x",
                                            "img_99999999999999999999999.png", "img_100000000000000000000000.png"};
  std::vector<std::string> shuffled = ordered;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(5));
  std::sort(shuffled.begin(), shuffled.end(), natural_less);
  EXPECT_EQ(shuffled, ordered);
}

TEST(NaturalOrder, IsAStrictWeakOrderOnRandomNames) {
  std::mt19937 random(11);
  RecordProperty("seed", 11);
  std::vector<std::string> all;
  for (int k = 0; k < 60; ++k) {
    std::string name;
    for (unsigned n = random() % 5; n-- > 0;) name += "01a_"[random() % 4];
    all.push_back(name);
  }
  for (const auto& a : all)
    for (const auto& b : all) {
      EXPECT_FALSE(natural_less(a, b) && natural_less(b, a)) << a << " " << b;
      EXPECT_TRUE(a == b || natural_less(a, b) || natural_less(b, a)) << a << " " << b;
      for (const auto& c : all)
        if (natural_less(a, b) && natural_less(b, c)) { EXPECT_TRUE(natural_less(a, c)) << a << " " << b << " " << c; }
    }
}

TEST(NumberedName, GoesBothWays) {
  const auto padded = NumberedName::parse("img_%04d .png", "x");
  ASSERT_TRUE(padded);
  EXPECT_EQ(padded->name(7), "img_0007 .png");
  EXPECT_EQ(padded->name(12345), "img_12345 .png");
  EXPECT_EQ(padded->number("img_0060 .png"), 60);
  EXPECT_EQ(padded->number("img_12345 .png"), 12345);
  EXPECT_EQ(padded->number("img_60 .png"), std::nullopt);
  EXPECT_EQ(padded->number("img_00060 .png"), std::nullopt);
  EXPECT_EQ(padded->number("img_0060.png"), std::nullopt);
  const auto plain = NumberedName::parse("100%% [%d].tif", "x");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->name(0), "100% [0].tif");
  EXPECT_EQ(plain->number("100% [12].tif"), 12);
  EXPECT_EQ(plain->number("100% [012].tif"), std::nullopt);
  EXPECT_FALSE(NumberedName::parse("100%*.tif", "x"));
  EXPECT_THAT(error_of([] { NumberedName::parse("%d_%d.png", "x"); }), HasSubstr("more than one"));
}

using Globs = Scratch;

TEST_F(Globs, NaturalOrderAndSpaces) {
  for (const char* name : {"img 10.png", "img 2.png", "img 1.png", "img 1.txt", ".img 0.png"}) put(at(name), "x");
  fs::create_directories(at("img 5.png"));  // a folder is no frame
  EXPECT_THAT(names(files_of_glob(folder_, "img*.png", "x")), ElementsAre("img 1.png", "img 2.png", "img 10.png"));
  EXPECT_THAT(names(files_of_glob("/", (folder_ / "img ?.png").string(), "x")), ElementsAre("img 1.png", "img 2.png"));
  EXPECT_THAT(names(files_of_glob(folder_, "img [2-9].png", "x")), ElementsAre("img 2.png"));
}

TEST_F(Globs, BracketsThatExistAreNotWildcards) {
  fs::create_directories(at("run [1]"));
  fs::create_directories(at("run 1"));
  put(at("run [1]/a[0].png"), "x");
  put(at("run [1]/a[1].png"), "x");
  put(at("run 1/b.png"), "x");
  EXPECT_THAT(names(files_of_glob(folder_, "run [1]/*.png", "x")), ElementsAre("a[0].png", "a[1].png"));
  EXPECT_THAT(names(files_of_glob(folder_, "run [1]/a[0].png", "x")), ElementsAre("a[0].png"));
  // As a glob "a[?].png" means the file "a?.png"; there is none, so the brackets are taken as they stand.
  EXPECT_THAT(names(files_of_glob(folder_, "run [1]/a[?].png", "x")), ElementsAre("a[0].png", "a[1].png"));
  EXPECT_THAT(names(files_of_glob(at("run [1]"), "*.png", "x")), ElementsAre("a[0].png", "a[1].png"));
}

TEST_F(Globs, WildcardsInFolders) {
  for (const char* run : {"run10", "run2"}) {
    fs::create_directories(at(run));
    put(at(run) / "f.png", "x");
  }
  const FrameFiles files = files_of_glob(folder_, "run*/f.png", "x");
  ASSERT_EQ(files.files.size(), 2u);
  EXPECT_EQ(files.files[0].path, at("run2") / "f.png");
  EXPECT_EQ(files.files[1].path, at("run10") / "f.png");
}

TEST_F(Globs, NothingFoundSaysWhatIsThere) {
  put(at("one.jpg"), "x");
  put(at("two.jpg"), "x");
  const std::string in_folder = error_of([&] { files_of_glob(folder_, "*.png", "frames.path"); });
  EXPECT_THAT(in_folder, HasSubstr("frames.path: nothing matches"));
  EXPECT_THAT(in_folder, HasSubstr("holds 2 entries, the first is 'one.jpg'"));
  EXPECT_THAT(error_of([&] { files_of_glob(at("missing"), "*.png", "x"); }), HasSubstr("there is no folder"));
  fs::create_directories(at("bare"));
  EXPECT_THAT(error_of([&] { files_of_glob(at("bare"), "*.png", "x"); }), HasSubstr("is empty"));
  EXPECT_THAT(error_of([&] { files_in_folder(at("bare"), "x"); }), HasSubstr("no image"));
  EXPECT_THAT(error_of([&] { files_of_pattern(folder_, *NumberedName::parse("f%02d.png", "x"), "x"); }),
              HasSubstr("no file is named like"));
}

}  // namespace
}  // namespace pivnp::image
