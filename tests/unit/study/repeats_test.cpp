// Frames that repeat the one before, in tests too slow for their motion to tell.
//   criterion: a doubled exposure is flagged in a test that hardly moves; frames without noise, which all agree, are not.
#include <gtest/gtest.h>

#include "apps/study/pipeline/measure.hpp"

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

}  // namespace repeats_tests
}  // namespace pivnp::app
