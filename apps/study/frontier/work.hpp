// What a piece of work takes: time, memory, instructions.
#pragma once

#include <functional>
#include <vector>

#include "apps/study/frontier/front.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

struct Effort {
  double seconds = 0;
  double bytes = 0;         // peak of what it held beyond what was held before; NaN: the system does not say
  double instructions = 0;  // in user mode; NaN: not allowed, or several threads
};

/// Does `work` and says what it took. Bytes: the system's high-water mark of the resident set (VmHWM), reset before, less the
/// resident set then, after the allocator gave back what it could; buffers made before are not in it. Instructions are counted
/// (perf_event_open) where `threads` is 1: those of other threads cannot be told apart.
Effort measured(int threads, const std::function<void()>& work);

/// Time alone, s: with one thread the processor's, which what else the machine does hardly changes; with more the clock's.
double seconds_of(int threads, const std::function<void()>& work);

/// Median, least and most into a point.
void set_times(const std::vector<double>& seconds, FrontierPoint& point);

/// Work whose time is taken again.
struct Timed {
  std::vector<double> seconds;    // so far
  std::function<double()> again;  // does it once more and says what it took
};

/// Times each until it has `repeats`, in turn, so that what else the machine does meets all alike. What took longer than
/// long_work_s at first averages over that by itself, and is not done again.
void repeat_in_turn(std::vector<Timed>& all, int repeats, Progress& progress);
inline constexpr double long_work_s = 5;

/// Work that is one unit of a larger one: reports nothing, stops when that is asked to.
class WithinProgress final : public Progress {
 public:
  explicit WithinProgress(Progress& whole) : whole_(whole) {}
  void update(std::string_view, std::int64_t, std::int64_t) override {}
  bool stop_requested() const override { return whole_.stop_requested(); }

 private:
  Progress& whole_;
};

}  // namespace pivnp::app
