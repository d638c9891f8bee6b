// How many threads a step uses. Bits do not depend on it, so it may follow the clock.
#pragma once

#include <algorithm>
#include <chrono>

namespace pivnp::mpm {

/// A step is short (some 0.1 ms) and has a handful of barriers: on a machine that is busy otherwise, waiting for a
/// thread that was put aside costs a hundred times the step. So one thread and `most` are timed now and then, and the
/// faster is used in between; the longer one thread keeps winning, the rarer the trials.
class ThreadChoice {
 public:
  explicit ThreadChoice(int most) : most_(std::max(1, most)), now_(most_) {}

  int threads() const { return most_ == 1 ? 1 : at_ < trial ? 1 : at_ < 2 * trial ? most_ : now_; }
  void begin_step() { start_ = Clock::now(); }
  void end_step() {
    if (most_ == 1) return;
    if (at_ < 2 * trial) spent_[at_ / trial] += std::chrono::duration<double>(Clock::now() - start_).count();
    if (++at_ == 2 * trial) {
      now_ = spent_[1] < spent_[0] ? most_ : 1;
      cycle_ = now_ == 1 ? std::min(2 * cycle_, longest) : shortest;
    } else if (at_ >= cycle_) {
      at_ = 0;
      spent_[0] = spent_[1] = 0;
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int trial = 4, shortest = 500, longest = 16000;  // steps
  int most_, now_;
  int at_ = 0, cycle_ = shortest;
  double spent_[2] = {0, 0};  // seconds with one thread, and with most_
  Clock::time_point start_;
};

}  // namespace pivnp::mpm
