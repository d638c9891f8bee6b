#include "apps/study/pipeline/record/stage_clock.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <thread>
#include <utility>

namespace pivnp::app {

namespace {

constexpr auto look_every = std::chrono::milliseconds(20), enough_to_tell = std::chrono::milliseconds(100);

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_utime.tv_sec) + 1e-6 * double(usage.ru_utime.tv_usec);
}

// The most that the process has ever held.
double highest_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * double(usage.ru_maxrss);
}

double held_bytes() {
  std::ifstream stream("/proc/self/statm");
  double all = 0, resident = 0;
  return stream >> all >> resident ? resident * double(sysconf(_SC_PAGESIZE)) : 0;
}

std::string machine() {
  const unsigned count = std::max(1u, std::thread::hardware_concurrency());
  std::string text = std::to_string(count) + (count == 1 ? " processor" : " processors");
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("model name"))
      if (const std::size_t at = line.find(": "); at != std::string::npos) return text + ", " + line.substr(at + 2);
  return text;
}

}  // namespace

StageClock::StageClock(Progress& progress) : progress_(progress) {
  cost_.before_bytes = held_bytes();
  cost_.machine = machine();
}

void StageClock::begin(std::string name) {
  end();
  cost_.stages.push_back({.name = std::move(name)});
  running_ = true;
  began_ = looked_ = Clock::now();
  processor_s_ = processor_seconds();
  highest_bytes_ = highest_bytes();
  seen_bytes_ = held_bytes();
  unit_.clear();
}

void StageClock::expect(std::string_view unit, double count) {
  unit_ = unit;
  units_ = count;
  first_done_ = -1;
}

void StageClock::end() {
  if (!std::exchange(running_, false)) return;
  look_at_memory();
  StageCost& stage = cost_.stages.back();
  stage.wall_s = seconds(Clock::now() - began_);
  stage.processor_s = processor_seconds() - processor_s_;
  const double highest = highest_bytes();
  stage.peak_bytes = highest > highest_bytes_ ? highest : seen_bytes_;
}

void StageClock::look_at_memory() {
  looked_ = Clock::now();
  seen_bytes_ = std::max(seen_bytes_, held_bytes());
}

void StageClock::update(std::string_view stage, std::int64_t done, std::int64_t total) {
  progress_.update(stage, done, total);
  if (!running_) return;
  const Clock::time_point now = Clock::now();
  if (now - looked_ > look_every) look_at_memory();
  if (unit_.empty() || stage != unit_) return;
  if (first_done_ < 0) {
    first_done_ = double(done);
    first_unit_ = now;
  } else if (now - first_unit_ > enough_to_tell && double(done) > first_done_) {
    cost_.stages.back().expected_s = seconds(now - first_unit_) / (double(done) - first_done_) * units_;
    unit_.clear();
  }
}

}  // namespace pivnp::app
