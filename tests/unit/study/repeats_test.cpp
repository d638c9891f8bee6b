// Frames that repeat the one before, in tests too slow for their motion to tell.
//   criterion: a doubled exposure is flagged in a test that hardly moves; frames without noise, which all agree, are not.
#include <gtest/gtest.h>

#include <cmath>

#include "apps/study/pipeline/measure/measure.hpp"

namespace pivnp::app {
namespace repeats_tests {

TEST(StepFlags, FindARepeatInASlowTest) {
  std::vector<StepQuality> pairs(8, StepQuality{1.0, 0.97, 0.0008});
  pairs[3] = {1.0, 1.0, 0.0};
  const std::vector<std::uint8_t> flags = step_flags(pairs);
  for (std::size_t k = 0; k < pairs.size(); ++k) EXPECT_EQ(flags[k], k == 3 ? frame_repeated : frame_ok) << k;
}

TEST(StepFlags, DoNotTakeFramesWithoutNoiseForRepeats) {
  std::vector<StepQuality> pairs(8, StepQuality{1.0, 0.99999, 0.0008});
  pairs[3] = {1.0, 1.0, 0.0};
  for (const std::uint8_t flag : step_flags(pairs)) EXPECT_EQ(flag, frame_ok);
}

TEST(StepFlags, FindARepeatThatWasCompressedAnew) {
  std::vector<StepQuality> pairs;
  for (const double shift : {0.01, 0.03, 0.02, 0.05, 0.001, 0.03, 0.06, 0.02}) pairs.push_back({1.0, 0.95, shift});
  pairs[4].median_score = 0.99;  // the compression's noise alone
  const std::vector<std::uint8_t> flags = step_flags(pairs);
  for (std::size_t k = 0; k < pairs.size(); ++k) EXPECT_EQ(flags[k], k == 4 ? frame_repeated : frame_ok) << k;
  pairs[4].median_score = 0.95;  // a step that stands still, of two exposures
  EXPECT_EQ(step_flags(pairs)[4], frame_ok);
}

TEST(StepFlags, FramesThatAreEqualRepeatHoweverMany) {
  std::vector<StepQuality> pairs(12, StepQuality{1.0, 0.93, 0.4});
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (k % 4 != 3) pairs[k] = {1.0, 1.0, 0.0}, pairs[k].same = true;
  const std::vector<std::uint8_t> flags = step_flags(pairs);
  for (std::size_t k = 0; k < pairs.size(); ++k) EXPECT_EQ(flags[k], k % 4 != 3 ? frame_repeated : frame_ok) << k;
}

// Each frame held two to five times and compressed anew each time: what the compression leaves differs little.
TEST(StepFlags, FindFramesThatAreHeldAndCompressedAnew) {
  for (const std::size_t times : {2u, 3u, 5u}) {
    std::vector<StepQuality> pairs;
    for (std::size_t k = 0; k < 8 * times; ++k)
      pairs.push_back(k % times == times - 1 ? StepQuality{1.0, 0.95, 0.3 + 0.02 * double(k)} : StepQuality{1.0, 0.99, 0.002});
    std::vector<std::uint8_t> flags = step_flags(pairs);
    for (std::size_t k = 0; k < pairs.size(); ++k)
      EXPECT_EQ(flags[k], k % times != times - 1 ? frame_repeated : frame_ok) << times << " " << k;
    for (StepQuality& q : pairs) q.median_score = 0.95;  // a motor that steps: each frame has noise of its own
    flags = step_flags(pairs);
    for (std::size_t k = 0; k < pairs.size(); ++k) EXPECT_FALSE(flags[k] & frame_repeated) << times << " " << k;
  }
}

// What stands still for a while, between motion, has noise of its own too; its frames differ less than those that move.
TEST(StepFlags, DoNotTakeRestForHeldFrames) {
  std::vector<StepQuality> pairs;
  for (std::size_t k = 0; k < 60; ++k)
    pairs.push_back(k < 20 || k >= 40 ? StepQuality{1.0, 0.99, 0.001} : StepQuality{1.0, 0.9, 0.5});
  for (const std::uint8_t flag : step_flags(pairs)) EXPECT_FALSE(flag & frame_repeated);
}

// Where motion turns round, the steps on both sides say that it stands still in between.
TEST(StepFlags, DoNotTakeTurningPointsForRepeats) {
  std::vector<StepQuality> pairs;
  std::vector<double> steps;
  for (int k = 0; k < 44; ++k) steps.push_back(5 * (std::sin(0.3 * (k + 1) - 0.15) - std::sin(0.3 * k - 0.15)));
  for (std::size_t k = 0; k < steps.size(); ++k) {
    pairs.push_back({1.0, 1 - 0.01 - 0.05 * std::abs(steps[k]), std::abs(steps[k]) / 8});
    if (k > 0 && k + 1 < steps.size()) pairs[k].along = steps[k - 1] * steps[k + 1] > 0 ? 1 : -1;
  }
  for (const std::uint8_t flag : step_flags(pairs)) EXPECT_EQ(flag, frame_ok);
}

TEST(StepFlags, FindAMissingFrameInAnAcceleratingTest) {
  std::vector<StepQuality> pairs;
  for (int k = 0; k < 16; ++k) pairs.push_back({1.0, 0.95, 0.05 * std::pow(1.3, k < 9 ? k : k + 1)});
  pairs[9].median_shift = 0.05 * (std::pow(1.3, 9) + std::pow(1.3, 10));  // over the missing frame
  const std::vector<std::uint8_t> flags = step_flags(pairs);
  for (std::size_t k = 0; k < pairs.size(); ++k) EXPECT_EQ(flags[k], k == 9 ? frame_jump : frame_ok) << k;
}

}  // namespace repeats_tests
}  // namespace pivnp::app
