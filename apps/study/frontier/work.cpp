#include "apps/study/frontier/work.hpp"

#include <linux/perf_event.h>
#include <malloc.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <limits>
#include <string>

#include "apps/study/pipeline/measure/statistics.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// "VmHWM:   1234 kB" of this process.
double status_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(name + ":")) return 1024 * std::stod(line.substr(name.size() + 1));
  return unknown;
}

bool reset_high_water() {
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;
  return bool(file);
}

// Instructions of this thread in user mode.
class Instructions {
 public:
  explicit Instructions(bool wanted) {
    if (!wanted) return;
    perf_event_attr asked{};
    asked.type = PERF_TYPE_HARDWARE;
    asked.size = sizeof(asked);
    asked.config = PERF_COUNT_HW_INSTRUCTIONS;
    asked.disabled = 1;
    asked.exclude_kernel = 1;
    asked.exclude_hv = 1;
    file_ = int(syscall(SYS_perf_event_open, &asked, 0, -1, -1, 0));
    if (file_ >= 0) ioctl(file_, PERF_EVENT_IOC_ENABLE, 0);
  }
  ~Instructions() {
    if (file_ >= 0) close(file_);
  }
  Instructions(const Instructions&) = delete;
  Instructions& operator=(const Instructions&) = delete;
  double count() const {
    std::int64_t n = 0;
    return file_ >= 0 && read(file_, &n, sizeof(n)) == sizeof(n) && n > 0 ? double(n) : unknown;
  }

 private:
  int file_ = -1;
};

}  // namespace

double seconds_of(int threads, const std::function<void()>& work) {
  const auto now = [threads] {
    timespec t{};
    clock_gettime(threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
  };
  const double start = now();
  work();
  return now() - start;
}

Effort measured(int threads, const std::function<void()>& work) {
  malloc_trim(0);
  const bool marked = reset_high_water();
  const double before = status_bytes("VmRSS");
  Effort w;
  const Instructions instructions(threads == 1);
  w.seconds = seconds_of(threads, work);
  w.instructions = instructions.count();
  w.bytes = marked ? std::max(0.0, status_bytes("VmHWM") - before) : unknown;
  return w;
}

void set_times(const std::vector<double>& seconds, FrontierPoint& point) {
  point.seconds = median(seconds, unknown);
  const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
  if (least == seconds.end()) return;
  point.quickest = *least;
  point.slowest = *most;
}

void repeat_in_turn(std::vector<Timed>& all, int repeats, Progress& progress) {
  std::int64_t total = 0, done = 0;
  const auto wanted = [&](const Timed& t, int round) { return int(t.seconds.size()) <= round && t.seconds.front() <= long_work_s; };
  for (int round = 1; round < repeats; ++round) total += std::count_if(all.begin(), all.end(), [&](const Timed& t) { return wanted(t, round); });
  for (int round = 1; round < repeats; ++round)
    for (Timed& t : all) {
      if (!wanted(t, round)) continue;
      if (progress.stop_requested()) throw Interrupted();
      progress.update("repeats", done++, total);
      t.seconds.push_back(t.again());
    }
}

}  // namespace pivnp::app
