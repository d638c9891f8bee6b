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

TEST(StepFlags, FindAMissingFrameInAnAcceleratingTest) {
  std::vector<StepQuality> pairs;
  for (int k = 0; k < 16; ++k) pairs.push_back({1.0, 0.95, 0.05 * std::pow(1.3, k < 9 ? k : k + 1)});
  pairs[9].median_shift = 0.05 * (std::pow(1.3, 9) + std::pow(1.3, 10));  // over the missing frame
  const std::vector<std::uint8_t> flags = step_flags(pairs);
  for (std::size_t k = 0; k < pairs.size(); ++k) EXPECT_EQ(flags[k], k == 9 ? frame_jump : frame_ok) << k;
}

}  // namespace repeats_tests
}  // namespace pivnp::app
