// Which steps of a sequence are flagged: a missing frame, a repeated exposure, lost correlation; and which are not.
#include <gtest/gtest.h>

#include "apps/study/pipeline/measure/measure.hpp"

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
  std::vector<StepQuality> pairs = moving({0.5, 0.5, 0.001, 0.5, 0.5});
  pairs[2].median_score = 0.99;  // one exposure: its noise is in both
  EXPECT_EQ(step_flags(pairs), (Flags{0, 0, frame_repeated, 0, 0}));
  pairs[2].median_score = 0.95;  // two exposures: the motion paused
  EXPECT_EQ(step_flags(pairs), (Flags{0, 0, frame_jump, 0, 0}));
}

TEST(StepFlags, LostCorrelation) {
  std::vector<StepQuality> pairs = moving({0.5, 0.5, 0.5, 0.5});
  pairs[0].valid = 0.4;
  pairs[2].median_score = 0.3;
  EXPECT_EQ(step_flags(pairs), (Flags{frame_decorrelated, 0, frame_decorrelated, 0}));
}

TEST(StepFlags, EveryPairMayBeLost) {
  std::vector<StepQuality> pairs(5, {0.03, 0.35, 0.7});
  pairs[1] = {0, 0.2, 0};
  EXPECT_EQ(step_flags(pairs), Flags(5, frame_decorrelated));
  for (StepQuality& q : pairs) q = {0.03, 0.9, 0.7};  // a small body before much air
  EXPECT_EQ(step_flags(pairs), Flags(5, frame_ok));
}

// Where most of the picture is air, its scores are of chance and change from pair to pair; those of the material count.
TEST(StepFlags, AirIsNotWhatLosesCorrelation) {
  std::vector<StepQuality> pairs;
  for (const float of_air : {0.1f, 0.3f, 0.35f, 0.12f, 0.3f}) {
    VectorField field;
    field.grid = {{0, 0}, {8, 8}, 10, 10};
    field.status.assign(100, VectorStatus::rejected);
    field.score.assign(100, of_air);
    field.displacement.assign(100, {4, 0});
    for (std::size_t k = 0; k < 40; ++k) field.status[k] = VectorStatus::valid, field.score[k] = 0.95f;
    pairs.push_back(quality_of(field));
    EXPECT_FLOAT_EQ(float(pairs.back().median_score), 0.95f);
    EXPECT_DOUBLE_EQ(pairs.back().valid, 0.4);
  }
  EXPECT_EQ(step_flags(pairs), Flags(5, frame_ok));
  VectorField lost;
  lost.grid = {{0, 0}, {8, 8}, 2, 1};
  lost.status.assign(2, VectorStatus::rejected);
  lost.score = {0.2f, 0.2f};
  lost.displacement.assign(2, {0, 0});
  EXPECT_FLOAT_EQ(float(quality_of(lost).median_score), 0.2f);
}

}  // namespace
}  // namespace pivnp::app
