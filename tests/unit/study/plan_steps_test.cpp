// Which steps tracking takes past dropped frames.
#include <gtest/gtest.h>

#include "apps/study/methods/paths/tracking.hpp"

namespace pivnp::app {
namespace {

std::vector<TrackStep> planned(const std::vector<int>& lost_at, int count) {
  std::vector<Frame> frames(static_cast<std::size_t>(count));
  for (const int k : lost_at) frames[std::size_t(k)].flag = frame_decorrelated;
  return plan_steps(frames);
}

using Steps = std::vector<TrackStep>;

TEST(PlanSteps, OneByOneWhereNothingIsLost) {
  EXPECT_EQ(planned({}, 4), (Steps{{0, 1}, {1, 2}, {2, 3}}));
  std::vector<Frame> frames(3);
  frames[1].flag = frames[2].flag = frame_jump;  // not lost
  EXPECT_EQ(plan_steps(frames), (Steps{{0, 1}, {1, 2}}));
}

TEST(PlanSteps, ABadFrameIsBridged) {
  EXPECT_EQ(planned({2, 3}, 6), (Steps{{0, 1}, {1, 3}, {3, 4}, {4, 5}}));
  EXPECT_EQ(planned({2, 3, 4}, 6), (Steps{{0, 1}, {1, 4}, {4, 5}}));
  EXPECT_EQ(planned({1, 2, 3, 4}, 6), (Steps{{0, 4}, {4, 5}}));  // three bad frames, the most
  EXPECT_EQ(planned({1, 2}, 4), (Steps{{0, 2}, {2, 3}}));
  EXPECT_EQ(planned({2, 3}, 4), (Steps{{0, 1}, {1, 3}}));
}

TEST(PlanSteps, OneLostStepOrTooManyAreNot) {
  EXPECT_EQ(planned({2}, 4), (Steps{{0, 1}, {1, 2}, {2, 3}}));
  EXPECT_EQ(planned({3}, 4), (Steps{{0, 1}, {1, 2}, {2, 3}}));
  EXPECT_EQ(planned({1, 2, 3, 4, 5}, 7), (Steps{{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}}));
  EXPECT_EQ(planned({2, 4, 5}, 7), (Steps{{0, 1}, {1, 2}, {2, 3}, {3, 5}, {5, 6}}));
}

}  // namespace
}  // namespace pivnp::app
