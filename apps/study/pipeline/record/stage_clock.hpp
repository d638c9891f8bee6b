// Time and memory of a run's stages, measured while they tell how far they are.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "pivnp/core/progress.hpp"
#include "pivnp/core/record/stage_cost.hpp"

namespace pivnp::app {

/// A stage lasts from its begin() to the next one, or to end(). Passes on what the engines say, and looks at it: a stage's
/// peak of memory is exact where it is the highest so far, else the most that was seen between two units of its work.
class StageClock final : public Progress {
 public:
  explicit StageClock(Progress& progress);

  void begin(std::string name);
  /// Of the stage that has begun: how many units of `unit` (a stage of the progress) are to be done, so that its first ones
  /// tell what to expect.
  void expect(std::string_view unit, double count);
  void end();
  const RunCost& cost() const { return cost_; }
  void expect_bytes(double bytes) { cost_.expected_bytes = bytes; }

  void update(std::string_view stage, std::int64_t done, std::int64_t total) override;
  bool stop_requested() const override { return progress_.stop_requested(); }

 private:
  using Clock = std::chrono::steady_clock;
  void look_at_memory();

  Progress& progress_;
  RunCost cost_;
  bool running_ = false;
  Clock::time_point began_, looked_, first_unit_;
  double processor_s_ = 0, highest_bytes_ = 0, seen_bytes_ = 0;  // when the stage began; since
  std::string unit_;
  double units_ = 0, first_done_ = -1;
};

}  // namespace pivnp::app
