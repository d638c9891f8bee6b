// Which steps of a sequence are flagged: a missing frame, a repeated exposure, lost correlation; and which are not.
#include <gtest/gtest.h>

#include "apps/study/pipeline/measure.hpp"

namespace pivnp::app {
namespace {

std::vector<StepQuality> moving(const std::vector<double>& shifts) {
  std::vector<StepQuality> pairs;
  for (const double shift : shifts) pairs.push_back({0.99, 0.95, shift});
  return pairs;
}

using Flags = std::vector<std::uint8_t>;

TEST(StepFlags, SteadyAndAcceleratingMotionIsNotFlagged) {
  EXPECT_EQ(step_flags(moving({0.5, 0.5, 0.51, 0.49})), Flags(4, frame_ok));
  EXPECT_EQ(step_flags(moving({0, 0, 0.1, 0.3, 0.6, 1.0, 1.2, 1.0, 0.5, 0.1, 0})), Flags(11, frame_ok));
}

TEST(StepFlags, AMissingFrameIsAJump) {
  EXPECT_EQ(step_flags(moving({0.5, 0.5, 1.0, 0.5, 0.5})), (Flags{0, 0, frame_jump, 0, 0}));
}

TEST(StepFlags, ARepeatedExposureStandsStill) {
  EXPECT_EQ(step_flags(moving({0.5, 0.5, 0.001, 0.5, 0.5})), (Flags{0, 0, frame_repeated, 0, 0}));
}

TEST(StepFlags, LostCorrelation) {
  std::vector<StepQuality> pairs = moving({0.5, 0.5, 0.5, 0.5});
  pairs[0].valid = 0.4;
  pairs[2].median_score = 0.3;
  EXPECT_EQ(step_flags(pairs), (Flags{frame_decorrelated, 0, frame_decorrelated, 0}));
}

}  // namespace
}  // namespace pivnp::app
