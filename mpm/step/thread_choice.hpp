// How many threads a step uses. Bits do not depend on it, so it may follow the clock.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>

namespace pivnp::mpm {

/// A step is short (some 0.1 ms) and has a handful of barriers: on a machine that is busy otherwise, waiting for a
/// thread that was put aside costs a hundred times the step. So one thread and `most` are timed now and then, and the
/// faster is used in between; the longer one thread keeps winning, the rarer the trials. Medians are compared: the first
/// steps of a trial find the other processor's caches empty, and a single interruption says nothing about the rest. The
/// first trials follow soon on one another: new threads may share a processor until the system moves them apart.
class ThreadChoice {
 public:
  explicit ThreadChoice(int most) : most_(std::max(1, most)), now_(most_) {}

  int threads() const { return most_ == 1 ? 1 : at_ < trial ? 1 : at_ < 2 * trial ? most_ : now_; }
  void begin_step() { start_ = Clock::now(); }
  void end_step() {
    if (most_ == 1) return;
    if (at_ < 2 * trial)
      spent_[std::size_t(at_ / trial)][std::size_t(at_ % trial)] =
          std::chrono::duration<double>(Clock::now() - start_).count();
    if (++at_ == 2 * trial) {
      now_ = median(spent_[1]) < median(spent_[0]) ? most_ : 1;
      cycle_ = now_ == 1 ? std::min(rarer * cycle_, longest) : shortest;
    } else if (at_ >= cycle_) {
      at_ = 0;
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int trial = 7, first = 32, shortest = 500, longest = 16000;  // steps
  static constexpr int rarer = 4;
  using Times = std::array<double, trial>;                          // seconds

  static double median(Times t) {
    std::nth_element(t.begin(), t.begin() + trial / 2, t.end());
    return t[trial / 2];
  }

  int most_, now_;
  int at_ = 0, cycle_ = first;
  std::array<Times, 2> spent_{};  // with one thread, and with most_
  Clock::time_point start_;
};

}  // namespace pivnp::mpm
