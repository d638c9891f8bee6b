// What was damaged after it was written never enters a record, and a damaged record is not read.
#include <sys/stat.h>

#include <fstream>
#include <random>

#include "gmock/gmock.h"
#include "pivnp/core/instruction_set.hpp"
#include "pivnp/io/files/seal.hpp"
#include "pivnp/io/hdf5/hdf5.hpp"
#include "pivnp/io/records/record_check.hpp"
#include "same_record.hpp"
#include "sample.hpp"

namespace pivnp::io {
namespace {

using sample::message_of;
using ::testing::HasSubstr;
using ::testing::StartsWith;
namespace fs = std::filesystem;

// Some bytes somewhere in the file become others.
void damage(const fs::path& file, std::mt19937& random) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  const auto size = static_cast<std::size_t>(fs::file_size(file));
  const std::size_t count = std::min<std::size_t>(size, random() % 3 == 0 ? 64 : 1);
  const auto at = static_cast<std::streamoff>(random() % (size - count + 1));
  std::vector<char> bytes(count);
  stream.seekg(at).read(bytes.data(), static_cast<std::streamsize>(count));
  const std::vector<char> before = bytes;
  if (random() % 2 == 0) std::fill(bytes.begin(), bytes.end(), '\0');  // a block that never reached the disk
  if (bytes == before) bytes[random() % count] ^= char(1 << random() % 8);
  stream.seekp(at).write(bytes.data(), static_cast<std::streamsize>(count));
  ASSERT_TRUE(stream.good());
}

struct Stop {};

// A run that is stopped before its item `items`.
void leave(const fs::path& directory, const sample::Size& size, int items) {
  int done = 0;
  try {
    sample::run(directory, size, false, 10, [&] {
      if (done++ == items) throw Stop();
    });
    FAIL() << "the run ended";
  } catch (const Stop&) {
  }
}

class Damage : public ::testing::Test {
 protected:
  Damage() {
    size.pairs = 40;
    sample::run(whole.path, size, false, 10);
    expected = sample::describe(whole.path / "record.h5");
    random.seed(seed);
    std::printf("seed %u\n", seed);
  }
  sample::Size size;
  test::Scratch whole;
  std::vector<std::string> expected;
  const unsigned seed = std::random_device{}();
  std::mt19937 random;
};

TEST_F(Damage, OfPartsIsDoneAgain) {
  ASSERT_GT(expected.size(), 100u);
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", trial " + std::to_string(trial));
    test::Scratch there;
    leave(there.path, size, int(20 + random() % 95));
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(there.path / "parts"))
      if (entry.path().extension() == ".h5" && entry.path().filename() != "head.h5") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    ASSERT_FALSE(files.empty());
    const fs::path file = files[random() % files.size()];
    SCOPED_TRACE(file.filename());
    damage(file, random);
    sample::run(there.path, size, true, 10);
    EXPECT_EQ(sample::describe(there.path / "record.h5"), expected);
  }
}

TEST_F(Damage, OfTheHeadIsRefused) {
  test::Scratch there;
  leave(there.path, size, 30);
  damage(there.path / "parts" / "head.h5", random);
  EXPECT_THAT(message_of<InputError>([&] { RecordWriter w(there.path, sample::head(size), true); }),
              HasSubstr("head.h5: is damaged"));
}

TEST_F(Damage, WhileTheRunIsAtWorkDoesNotEnterTheRecord) {
  test::Scratch there;
  {
    RecordWriter w(there.path, sample::head(size), false);
    for (std::size_t k = 0; k < 20; ++k) {
      w.add_pair(sample::pair(size, k));
      if (k % 10 == 9) w.close_segment("piv", {std::byte(k)});
    }
    w.end_stage("piv", nullptr);
    damage(there.path / "parts" / "piv.00000010.h5", random);
    EXPECT_THAT(message_of<RunError>([&] { w.finish(); }), HasSubstr("piv.00000010.h5"));
    EXPECT_FALSE(fs::exists(there.path / "record.h5"));
  }
  RecordWriter again(there.path, sample::head(size), true);
  EXPECT_EQ(again.stage("piv").items, 10u);
}

TEST_F(Damage, OfARecordIsOneLine) {
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", trial " + std::to_string(trial));
    test::Scratch there;
    const fs::path file = there.path / "record.h5";
    fs::copy(whole.path / "record.h5", file);
    if (trial % 5 == 4)
      fs::resize_file(file, random() % (fs::file_size(file) - seal_bytes));
    else
      damage(file, random);
    // Where the superblock's word of the file's end is hit, the seal counts for nothing: such a file is read with care.
    if (seal_of(file) == Seal::none) {
      try {
        RecordReader reader(file);
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), StartsWith(file.string()));
      }
      continue;
    }
    EXPECT_THAT(message_of<InputError>([&] { RecordReader reader(file); }), StartsWith(file.string() + ": damaged"));
  }
}

TEST_F(Damage, OfTheChecksumItselfIsDamage) {
  const fs::path file = whole.path / "record.h5";
  const auto bytes = fs::file_size(file);
  for (std::size_t k = 0; k < seal_bytes; ++k) {
    SCOPED_TRACE(k);
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    const auto at = static_cast<std::streamoff>(bytes - seal_bytes + k);
    const char before = char(stream.seekg(at).get());
    stream.seekp(at).put(char(before ^ 1)).flush();
    EXPECT_THAT(message_of<InputError>([&] { RecordReader reader(file); }), StartsWith(file.string() + ": damaged"));
    stream.seekp(at).put(before).flush();
  }
  EXPECT_TRUE(check_record(file).has_checksum);
  for (std::size_t cut = 1; cut < seal_bytes; cut += 5) {
    fs::copy_file(file, whole.path / "cut.h5", fs::copy_options::overwrite_existing);
    fs::resize_file(whole.path / "cut.h5", bytes - cut);
    EXPECT_THROW(RecordReader(whole.path / "cut.h5"), InputError) << cut;
  }
}

// Read with care; but it is not as it was written, unless it is older than checksums.
TEST_F(Damage, ARecordWithoutAChecksumIsRead) {
  const fs::path file = whole.path / "record.h5";
  fs::resize_file(file, fs::file_size(file) - seal_bytes);
  EXPECT_EQ(RecordReader(file).pair_count(), size.pairs);
  EXPECT_THAT(message_of<InputError>([&] { check_record(file); }), StartsWith(file.string()));
  {
    const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    ASSERT_GE(H5Adelete(id.get(), "schema_version"), 0);
    const h5::Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
    H5Tset_size(type.get(), 3);
    const h5::Handle a(H5Acreate2(id.get(), "schema_version", type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    ASSERT_GE(H5Awrite(a.get(), type.get(), "1.2"), 0);
  }
  EXPECT_FALSE(check_record(file).has_checksum);
}

// Changed by a program that may, not by damage: as h5py does, in place or with more.
TEST_F(Damage, ARecordThatHdf5ChangedIsRead) {
  const fs::path file = whole.path / "record.h5";
  ASSERT_EQ(seal_of(file), Seal::intact);
  for (const char* name : {"remark", "another"}) {
    {
      const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
      const h5::Handle space(H5Screate(H5S_SCALAR), H5Sclose);
      const h5::Handle a(H5Acreate2(id.get(), name, H5T_STD_I64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
      const std::int64_t value = 7;
      ASSERT_GE(H5Awrite(a.get(), H5T_NATIVE_INT64, &value), 0);
    }
    EXPECT_EQ(seal_of(file), Seal::none);
    EXPECT_EQ(RecordReader(file).pair_count(), size.pairs);
  }
}

class Identity : public ::testing::Test {
 protected:
  Identity() {
    size.pairs = 40;
    head = sample::head(size);
    head.sources = {{"a.png", 10, "00000000000000aa"}, {"b.png", 10, "00000000000000bb"}, {"c.png", 12, "cc"}};
  }
  void leave_pairs(std::size_t count) {
    RecordWriter w(there.path, head, false);
    for (std::size_t k = 0; k < count; ++k) w.add_pair(sample::pair(size, k));
    w.close_segment("piv", {std::byte(1)});
  }
  std::string refused(const RecordHead& other) {
    return message_of<InputError>([&] { RecordWriter w(there.path, other, true); });
  }
  void expect_others_refused() {
    RecordHead other = head;
    other.sources[1].hash = "00000000000000bc";
    EXPECT_THAT(refused(other), HasSubstr("'b.png'"));
    other = head;
    other.sources[2].size = 13;
    EXPECT_THAT(refused(other), ::testing::AllOf(HasSubstr("'c.png'"), HasSubstr("12"), HasSubstr("13")));
    other = head;
    other.sources.erase(other.sources.begin() + 1);
    EXPECT_THAT(refused(other), ::testing::AllOf(HasSubstr("'b.png'"), HasSubstr("'c.png'")));
    other = head;
    other.sources.pop_back();
    EXPECT_THAT(refused(other), HasSubstr("'c.png'"));
    other = head;
    other.sources.push_back({"d.png", 1, "dd"});
    EXPECT_THAT(refused(other), HasSubstr("'d.png'"));
  }
  sample::Size size;
  RecordHead head;
  test::Scratch there;
};

TEST_F(Identity, OfFramesIsThatOfTheRunToResume) {
  leave_pairs(10);
  expect_others_refused();
  EXPECT_EQ(RecordWriter(there.path, head, true).stage("piv").items, 10u);
}

// A long video is not read to its end first.
TEST(FileIdentityStop, IsAskedBetweenBlocks) {
  struct Stopped final : Progress {
    void update(std::string_view, std::int64_t, std::int64_t) override {}
    bool stop_requested() const override { return ++asked == 3; }
    mutable int asked = 0;
  } progress;
  const test::Scratch there;
  std::ofstream(there.path / "video.mp4") << std::string(5 << 20, 'v');
  EXPECT_THROW(identity_of(there.path / "video.mp4", "video.mp4", progress), Interrupted);
  EXPECT_EQ(progress.asked, 3);
}

TEST(FileIdentity, OfAPipeIsRefusedAtOnce) {
  SilentProgress progress;
  const test::Scratch there;
  ASSERT_EQ(mkfifo((there.path / "f7.png").c_str(), 0600), 0);
  EXPECT_THROW(identity_of(there.path / "f7.png", "f7.png", progress), InputError);
  EXPECT_THROW(identity_of("/dev/zero", "zero", progress), InputError);
}

TEST_F(Identity, OfFramesIsInTheRecordToo) {
  {
    RecordWriter w(there.path, head, false);
    w.add_pair(sample::pair(size, 0));
    w.end_stage("piv", nullptr);
    w.set_frames({{"a.png", 0, frame_ok}, {"b.png", 1, frame_ok}});
    w.finish();
  }
  EXPECT_EQ(RecordReader(there.path / "record.h5").head().sources, head.sources);
  expect_others_refused();
  EXPECT_TRUE(RecordWriter(there.path, head, true).stage("piv").complete);
}

TEST_F(Identity, OfTheProgramIsThatOfTheRunToResume) {
  leave_pairs(10);
  const fs::path file = there.path / "parts" / "head.h5";
  {
    const h5::Handle id(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const h5::Handle attribute(H5Aopen_by_name(id.get(), "/", "version", H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    const h5::Handle type(H5Aget_type(attribute.get()), H5Tclose);
    const char* other = "0.0.7";
    ASSERT_GE(H5Awrite(attribute.get(), type.get(), &other), 0);
  }
  ASSERT_EQ(append_seal(file), 0);
  EXPECT_THAT(refused(head), ::testing::AllOf(HasSubstr("version 0.0.7"), HasSubstr(build_info().version)));
}

TEST_F(Identity, OfTheInstructionSetIsThatOfTheRunToResume) {
  const std::vector<std::string> sets = instruction_sets();
  if (sets.size() < 2) GTEST_SKIP() << "this processor has one set only";
  use_instruction_set(sets.back(), "test");
  leave_pairs(10);
  use_instruction_set("", "test");
  EXPECT_THAT(refused(head), ::testing::AllOf(HasSubstr(sets.back()), HasSubstr("has " + sets.front()), HasSubstr("--simd")));
  use_instruction_set(sets.back(), "test");
  EXPECT_NO_THROW(RecordWriter(there.path, head, true));
  const h5::Source begun(there.path / "parts" / "head.h5");
  EXPECT_EQ(begun.attribute_text("/", "instruction_set"), sets.back());
  use_instruction_set("", "test");
}

}  // namespace
}  // namespace pivnp::io
