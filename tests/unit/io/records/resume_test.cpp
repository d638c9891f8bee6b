// Killed at any moment, a run goes on from its closed segments, and its record equals an uninterrupted one.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <random>
#include <set>
#include <thread>

#include "gmock/gmock.h"
#include "pivnp/io/hdf5/hdf5.hpp"
#include "same_record.hpp"
#include "sample.hpp"

namespace pivnp::io {
namespace {

using sample::message_of;
using ::testing::HasSubstr;
using ::testing::StartsWith;
namespace fs = std::filesystem;

// The closed segments that a run can go on from; every closed file must be whole.
std::set<std::string> closed_segments(const fs::path& directory) {
  std::set<std::string> out;
  if (!fs::exists(directory / "parts")) return out;
  for (const auto& entry : fs::directory_iterator(directory / "parts")) {
    if (entry.path().extension() != ".h5") continue;
    const h5::Source source(entry.path());  // throws if it is not
    if (source.has("/checkpoint")) out.insert(entry.path().filename());
  }
  return out;
}

void expect_equal_records(const fs::path& a, const fs::path& b) {
  const auto x = sample::describe(a / "record.h5"), y = sample::describe(b / "record.h5");
  ASSERT_GT(x.size(), 100u);
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_EQ(x[k], y[k]);
  std::ifstream f(a / "record.xdmf"), g(b / "record.xdmf");
  const std::string s((std::istreambuf_iterator<char>(f)), {}), t((std::istreambuf_iterator<char>(g)), {});
  EXPECT_GT(s.size(), 1000u);
  EXPECT_EQ(s, t);
}

// Leaves no trace in the test's own process: HDF5 in the child is never shut down.
pid_t start(const fs::path& directory, const sample::Size& size, std::size_t close_every, int pace_us) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  int code = 0;
  try {
    sample::run(directory, size, true, close_every, [&] { ::usleep(static_cast<useconds_t>(pace_us)); });
  } catch (const std::exception& e) {
    std::fprintf(stderr, "child: %s\n", e.what());
    code = 1;
  }
  ::_exit(code);
}

TEST(ResumeTest, KilledAtRandomMomentsTheRecordEqualsAnUninterruptedOne) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  RecordProperty("seed", std::to_string(seed));
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  sample::Size size;
  size.pairs = 90;
  test::Scratch whole;
  // Kills are spread over the time a whole run takes here, and come later with every attempt, so that it ends.
  const auto began = std::chrono::steady_clock::now();
  sample::run(whole.path, size, false, 10, [] { ::usleep(300); });
  const std::chrono::duration<double, std::micro> whole_us = std::chrono::steady_clock::now() - began;
  int kills = 0, resumed = 0;
  for (int round = 0; round < 3; ++round) {
    test::Scratch directory;
    const std::size_t close_every = std::uniform_int_distribution<std::size_t>(5, 40)(random);
    std::set<std::string> before;
    for (int attempt = 0; attempt < 200; ++attempt) {
      const pid_t child = start(directory.path, size, close_every, 300);
      const double latest = whole_us.count() * (0.4 + 0.2 * attempt);
      std::this_thread::sleep_for(
          std::chrono::duration<double, std::micro>(std::uniform_real_distribution<double>(0, latest)(random)));
      ::kill(child, SIGKILL);
      int status = 0;
      ASSERT_EQ(::waitpid(child, &status, 0), child);
      if (WIFEXITED(status)) {
        ASSERT_EQ(WEXITSTATUS(status), 0);
        break;
      }
      ++kills;
      const auto now = closed_segments(directory.path);
      resumed += !now.empty();
      // What was closed stays, until the record has taken its place.
      const bool packed = fs::exists(directory.path / "record.h5");
      for (const std::string& name : before) EXPECT_TRUE(now.contains(name) || packed) << name;
      before = now;
    }
    expect_equal_records(whole.path, directory.path);
    for (const auto& entry : fs::directory_iterator(directory.path))
      EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
    EXPECT_FALSE(fs::exists(directory.path / "parts"));
    EXPECT_FALSE(fs::exists(directory.path / "parts.old"));
  }
  std::printf("%d kills, %d of them with closed segments\n", kills, resumed);
  EXPECT_GT(kills, 0);
  EXPECT_GT(resumed, 0);
}

class PartialRun : public ::testing::Test {
 protected:
  PartialRun() { size.pairs = 100; }
  // Writes `pairs` pairs and stops as if interrupted, with checkpoints of k after each `every`.
  void leave(std::size_t pairs, std::size_t every) {
    RecordWriter w(directory.path, sample::head(size), false);
    for (std::size_t k = 0; k < pairs; ++k) {
      w.add_pair(sample::pair(size, k));
      if ((k + 1) % every == 0) w.close_segment("piv", {std::byte(k + 1)});
    }
  }
  sample::Size size;
  test::Scratch directory;
  fs::path parts = directory.path / "parts";
};

TEST_F(PartialRun, GoesOnFromTheLastClosedSegment) {
  leave(25, 10);
  std::ofstream(parts / "piv.00000020.h5.tmp") << "half a segment";  // as kill -9 leaves it
  RecordWriter w(directory.path, sample::head(size), true);
  EXPECT_FALSE(fs::exists(parts / "piv.00000020.h5.tmp"));
  const StageState s = w.stage("piv");
  EXPECT_EQ(s.items, 20u);
  EXPECT_FALSE(s.complete);
  EXPECT_EQ(s.checkpoint, std::vector<std::byte>{std::byte(20)});
  EXPECT_EQ(w.pair(13).pair[0], 13);
  EXPECT_EQ(w.stage("motion/np").items, 0u);
}

TEST_F(PartialRun, SegmentsWithoutACheckpointAreNotGoneOnFrom) {
  leave(100, 1000);  // the writer closed the first 64 itself
  ASSERT_TRUE(fs::exists(parts / "piv.00000000.h5"));
  RecordWriter w(directory.path, sample::head(size), true);
  EXPECT_EQ(w.stage("piv").items, 0u);
  EXPECT_FALSE(fs::exists(parts / "piv.00000000.h5"));
}

TEST_F(PartialRun, ADamagedSegmentAndThoseAfterItAreDoneAgain) {
  leave(40, 10);
  fs::resize_file(parts / "piv.00000020.h5", 1000);
  RecordWriter w(directory.path, sample::head(size), true);
  EXPECT_EQ(w.stage("piv").items, 20u);
  EXPECT_FALSE(fs::exists(parts / "piv.00000030.h5"));
}

TEST_F(PartialRun, AnotherCaseIsRefusedWithItsFirstLine) {
  leave(10, 10);
  RecordHead other = sample::head(size);
  other.case_text = "name = \"sample, 1 g\"\n[piv]\nwindow_px = 24\n";
  const std::string message = message_of<InputError>([&] { RecordWriter w(directory.path, other, true); });
  EXPECT_THAT(message, HasSubstr("first in line 3: 'window_px = 32' there, 'window_px = 24' now"));
  EXPECT_THAT(message, StartsWith(parts.string()));
  other.case_text = "name = \"sample, 1 g\"\n[piv]\n";
  EXPECT_THAT(message_of<InputError>([&] { RecordWriter w(directory.path, other, true); }), HasSubstr("nothing now"));
  other = sample::head(size);
  other.grid.nx += 1;
  EXPECT_THAT(message_of<InputError>([&] { RecordWriter w(directory.path, other, true); }),
              HasSubstr("the grid differs"));
  EXPECT_TRUE(fs::exists(parts / "piv.00000000.h5"));  // nothing lost by being refused
}

TEST_F(PartialRun, WithoutResumeOldPartsGoAndTheOldRecordStaysUntilTheEnd) {
  sample::run(directory.path, size, false);
  leave(20, 10);
  EXPECT_EQ(RecordReader(directory.path / "record.h5").pair_count(), 100u);
  RecordWriter w(directory.path, sample::head(size), false);
  EXPECT_FALSE(fs::exists(parts / "piv.00000000.h5"));
  EXPECT_EQ(w.stage("piv").items, 0u);
  for (std::size_t k = 0; k < 3; ++k) w.add_pair(sample::pair(size, k));
  w.end_stage("piv", nullptr);
  EXPECT_EQ(RecordReader(directory.path / "record.h5").pair_count(), 100u);
  w.finish();
  EXPECT_EQ(RecordReader(directory.path / "record.h5").pair_count(), 3u);
}

TEST_F(PartialRun, AFinishedRunHasNothingLeftToDo) {
  sample::run(directory.path, size, false);
  const auto written = fs::last_write_time(directory.path / "record.h5");
  {
    RecordWriter w(directory.path, sample::head(size), true);
    EXPECT_TRUE(w.stage("piv").complete);
    EXPECT_EQ(w.stage("piv").items, 100u);
    EXPECT_TRUE(w.stage("motion/mpm").complete);
    EXPECT_EQ(w.stage("motion/mpm").items, 101u);
    EXPECT_EQ(w.pair(99).pair[0], 99);
    EXPECT_THROW(w.add_pair(sample::pair(size, 0)), std::logic_error);
    w.finish();
  }
  EXPECT_EQ(fs::last_write_time(directory.path / "record.h5"), written);
  RecordHead other = sample::head(size);
  other.case_text += "# more\n";
  EXPECT_THAT(message_of<InputError>([&] { RecordWriter w(directory.path, other, true); }),
              HasSubstr("first in line 4"));
}

TEST_F(PartialRun, OtherParticlesAreRefused) {
  {
    RecordWriter w(directory.path, sample::head(size), false);
    w.begin_motion("np", sample::particles(size));
    w.add_frame("np", sample::frame(size, 0, false));
    w.close_segment("motion/np", {std::byte(1)});
  }
  RecordWriter w(directory.path, sample::head(size), true);
  w.begin_motion("np", sample::particles(size));
  ParticleSet other = sample::particles(size);
  other.x0[1].x() += 1e-12;
  EXPECT_THAT(message_of<InputError>([&] { w.begin_motion("np", other); }),
              HasSubstr("particles of motion 'np' differ"));
}

TEST_F(PartialRun, OnlyOneWriterHoldsADirectory) {
  auto first = std::make_unique<RecordWriter>(directory.path, sample::head(size), false);
  const std::string message =
      message_of<InputError>([&] { RecordWriter w(directory.path, sample::head(size), true); });
  EXPECT_THAT(message, StartsWith(directory.path.string()));
  EXPECT_THAT(message, HasSubstr("another run is writing here"));
  first.reset();
  EXPECT_TRUE(fs::exists(directory.path / ".lock"));  // left behind, and no obstacle
  RecordWriter again(directory.path, sample::head(size), false);
}

TEST_F(PartialRun, ALockDiesWithItsProcess) {
  const pid_t child = ::fork();
  if (child == 0) {
    RecordWriter w(directory.path, sample::head(size), false);
    std::ofstream(directory.path / "ready") << "x";
    ::pause();
    ::_exit(0);
  }
  for (int k = 0; k < 2000 && !fs::exists(directory.path / "ready"); ++k) ::usleep(5000);
  EXPECT_THROW(RecordWriter(directory.path, sample::head(size), false), InputError);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_NO_THROW(RecordWriter(directory.path, sample::head(size), false));
}

}  // namespace
}  // namespace pivnp::io
