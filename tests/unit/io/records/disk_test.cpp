// A disk that fills up: RunError with file and cause, what was closed before stays, no half-written file is left.
#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>
#include <fstream>

#include "gmock/gmock.h"
#include "same_record.hpp"
#include "sample.hpp"

namespace pivnp::io {
namespace {

using sample::message_of;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

// No file of this process may grow beyond `bytes` while this lives.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  void (*handler_)(int);
  rlimit before_;
};

// A file system of `size`, in a mount namespace of this process; gone with the object.
class TinyDisk {
 public:
  TinyDisk(const fs::path& where, const char* options) : where_(where) {
    fs::create_directories(where);
    mounted_ = ::unshare(CLONE_NEWNS) == 0 && ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
               ::mount("tmpfs", where.c_str(), "tmpfs", MS_NOSUID | MS_NODEV, options) == 0;
  }
  ~TinyDisk() {
    if (mounted_) ::umount2(where_.c_str(), MNT_DETACH);
  }
  bool mounted() const { return mounted_; }

 private:
  fs::path where_;
  bool mounted_;
};

std::vector<std::string> temporary_files(const fs::path& directory) {
  std::vector<std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(directory))
    if (entry.path().extension() == ".tmp") out.push_back(entry.path());
  return out;
}

sample::Size large() {
  sample::Size s;
  s.pairs = 60;
  s.nx = 100;
  s.ny = 50;  // 125 kB a pair
  return s;
}

// Writes pairs, a segment every ten, until an error.
std::string fill(RecordWriter& w, const sample::Size& size, std::size_t from) {
  return message_of<RunError>([&] {
    for (std::size_t k = from; k < size.pairs; ++k) {
      w.add_pair(sample::pair(size, k));
      if ((k + 1) % 10 == 0) w.close_segment("piv", {std::byte(k + 1)});
    }
    w.end_stage("piv", nullptr);
    w.finish();
  });
}

void finish_and_check(const fs::path& directory, const sample::Size& size, std::size_t at_least) {
  RecordWriter w(directory, sample::head(size), true);
  const std::size_t items = w.stage("piv").items;
  EXPECT_GE(items, at_least);
  for (std::size_t k = items; k < size.pairs; ++k) w.add_pair(sample::pair(size, k));
  if (!w.stage("piv").complete) w.end_stage("piv", nullptr);
  w.finish();
  const RecordReader r(directory / "record.h5");
  ASSERT_EQ(r.pair_count(), size.pairs);
  for (std::size_t k = 0; k < size.pairs; ++k)
    EXPECT_TRUE(sample::same_bits(r.pair(k).displacement, sample::pair(size, k).displacement)) << k;
}

TEST(DiskTest, AFileThatMayNotGrowStopsTheRunAndNothingElseIsLost) {
  const sample::Size size = large();
  test::Scratch directory;
  {
    RecordWriter w(directory.path, sample::head(size), false);
    for (std::size_t k = 0; k < 20; ++k) {
      w.add_pair(sample::pair(size, k));
      if ((k + 1) % 10 == 0) w.close_segment("piv", {std::byte(k + 1)});
    }
    {
      const FileLimit limit(600'000);  // half a segment
      const std::string message = fill(w, size, 20);
      EXPECT_THAT(message, HasSubstr("parts/piv.00000020.h5.tmp: cannot be written: File too large"));
    }
    EXPECT_TRUE(temporary_files(directory.path).empty());
    EXPECT_THROW(w.add_pair(sample::pair(size, 20)), RunError);  // not on with a hole
    EXPECT_EQ(w.pair(15).pair[0], 15);
  }
  finish_and_check(directory.path, size, 20);
}

TEST(DiskTest, EveryMomentOfFillingUpEndsTheSameWay) {
  sample::Size size = large();
  size.pairs = 15;
  for (const rlim_t bytes : {0, 100, 2'000, 130'000, 900'000}) {
    SCOPED_TRACE(bytes);
    test::Scratch directory;
    {
      const FileLimit limit(bytes);
      const std::string message = message_of<RunError>([&] {
        RecordWriter w(directory.path, sample::head(size), false);
        for (std::size_t k = 0; k < size.pairs; ++k) w.add_pair(sample::pair(size, k));
        w.end_stage("piv", nullptr);
        w.finish();
      });
      EXPECT_THAT(message, HasSubstr("cannot be written: File too large"));
    }
    EXPECT_TRUE(temporary_files(directory.path).empty());
    finish_and_check(directory.path, size, 0);
  }
}

TEST(DiskTest, PackingThatFailsKeepsTheSegmentsAndTheOldRecord) {
  const sample::Size size = large();
  test::Scratch directory;
  sample::Size shorter = size;
  shorter.pairs = 3;
  sample::run(directory.path, shorter, false);
  {
    RecordWriter w(directory.path, sample::head(size), false);
    for (std::size_t k = 0; k < size.pairs; ++k) {
      w.add_pair(sample::pair(size, k));
      if ((k + 1) % 10 == 0) w.close_segment("piv", {std::byte(k + 1)});
    }
    w.end_stage("piv", nullptr);
    const FileLimit limit(2'000'000);  // a segment fits, the record does not
    EXPECT_THAT(message_of<RunError>([&] { w.finish(); }),
                HasSubstr("record.h5.tmp: cannot be written: File too large"));
  }
  EXPECT_TRUE(temporary_files(directory.path).empty());
  EXPECT_EQ(RecordReader(directory.path / "record.h5").pair_count(), 3u);
  finish_and_check(directory.path, size, 60);
}

TEST(DiskTest, AFullFileSystemSaysSo) {
  const sample::Size size = large();
  test::Scratch directory;
  const TinyDisk disk(directory.path / "disk", "size=4m");
  if (!disk.mounted()) GTEST_SKIP() << "needs the right to mount a tmpfs: " << std::strerror(errno);
  const fs::path out = directory.path / "disk" / "out";
  {
    RecordWriter w(out, sample::head(size), false);
    EXPECT_THAT(fill(w, size, 0), HasSubstr("parts/piv.00000020.h5.tmp: cannot be written: No space left on device"));
  }
  EXPECT_TRUE(temporary_files(out).empty());
  RecordWriter w(out, sample::head(size), true);
  EXPECT_EQ(w.stage("piv").items, 20u);
  EXPECT_TRUE(sample::same_bits(w.pair(17).score, sample::pair(size, 17).score));
}

TEST(DiskTest, ADirectoryThatCannotBeIsNamed) {
  test::Scratch directory;
  std::ofstream(directory.path / "file") << "x";
  EXPECT_THAT(message_of<InputError>([&] { RecordWriter w(directory.path / "file", sample::head({}), false); }),
              HasSubstr("file: cannot be made"));
  EXPECT_THAT(
      message_of<InputError>([&] { RecordWriter w(directory.path / "file" / "out", sample::head({}), false); }),
      HasSubstr("out: cannot be made"));
}

}  // namespace
}  // namespace pivnp::io
