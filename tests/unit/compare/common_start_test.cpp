// Which time both data sets are counted from, and what is refused because nothing is left to compare.
#include <gtest/gtest.h>

#include <cmath>

#include "pivnp/core/error.hpp"
#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

std::string refusal(const MotionSource& a, const MotionSource& b) {
  try {
    compared(a, b);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

bool remarked(const Comparison& c, const std::string& text) {
  for (const std::string& r : c.remarks)
    if (r.find(text) != std::string::npos) return true;
  return false;
}

// Another program's files that begin with a later step hold displacements since its own beginning.
TEST(CommonStart, ASideThatIsUnderWayAtItsFirstTimeIsCountedFromThere) {
  const MotionMemory whole = motion_of("whole", block(), {0, 1, 2, 3}, shear, shear_F);
  const MotionMemory part = motion_of("part", block(), {1, 2, 3}, shear, shear_F);
  for (const auto& [first, second] : {std::pair{&whole, &part}, std::pair{&part, &whole}}) {
    const Comparison c = compared(*first, *second);
    EXPECT_EQ(c.times(), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(metric(c, "coverage_first").value, 1);
    EXPECT_LT(metric(c, "displacement_max").value, 1e-6);
    EXPECT_LT(metric(c, "strain_dev_max").value, 1e-6);
    EXPECT_NEAR(metric(c, "displacement_peak_first").value, 2 * Vec2(0.4 * 4.5 + 0.1, -0.2).norm(), 1e-6);
    EXPECT_TRUE(remarked(c, "'whole' is under way") && remarked(c, "'part' is under way"));
  }
}

TEST(CommonStart, SidesThatBeginTogetherAreTakenAsTheyAre) {
  const MotionMemory one = motion_of("one", block(), {5}, shear, shear_F);
  const MotionMemory two = motion_of("two", block(), {5}, [](const Vec2& x, double t) -> Vec2 {
    return shear(x, t) + Vec2(0.25, 0);
  }, shear_F);
  const Comparison c = compared(one, two);  // two final states
  EXPECT_NEAR(metric(c, "displacement_bias_x").value, 0.25, 1e-6);
  EXPECT_FALSE(remarked(c, "under way"));
}

// Zero by definition there: a simulation that failed at once must not pass for one without a difference.
TEST(CommonStart, AloneIsNoComparison) {
  const MotionMemory a = motion_of("lab", block(), {0, 1, 2}, shear), b = motion_of("sim", block(), {0}, shear),
                     late = motion_of("sim", block(), {2, 3}, shear);
  for (const MotionMemory* m : {&b, &late})
    for (const std::string& said : {refusal(a, *m), refusal(*m, a)}) {
      EXPECT_NE(said.find("only the start is in common"), std::string::npos) << said;
      EXPECT_NE(said.find("'lab'"), std::string::npos) << said;
      EXPECT_NE(said.find("'sim'"), std::string::npos) << said;
    }
}

TEST(CommonStart, NobodyLeftRightAfterItIsNoComparison) {
  MotionMemory lost("sim", "m", "s", block());
  for (double t : {0.0, 1.0, 2.0}) {
    MotionFrame f = frame_of(block(), t, shear, shear_F);
    if (t > 0) f.status.assign(f.status.size(), ParticleStatus::ended);
    lost.add(f);
  }
  const MotionMemory a = motion_of("lab", block(), {0, 1, 2}, shear, shear_F);
  EXPECT_NE(refusal(a, lost).find("no particle has a partner any more at 1 s"), std::string::npos) << refusal(a, lost);
}

TEST(CommonStart, TheShareOfTimesComparedIsStated) {
  const MotionMemory a = motion_of("lab", block(), {0, 1, 2, 3}, shear), b = motion_of("sim", block(), {0, 1.5}, shear);
  EXPECT_EQ(metric(compared(a, b), "coverage_time").value, 0.5);
  EXPECT_EQ(metric(compared(a, a), "coverage_time").value, 1);
}

// Two seedings of one body: partners are interpolated, values are taken at the first's particles, so that swapping the
// data sets keeps sizes and turns signs up to what the other points sample.
TEST(Swap, BetweenTwoSeedings) {
  const auto u = [](double more) {
    return DisplacementLaw([=](const Vec2& x, double t) -> Vec2 {
      return t * Vec2(0.02 * x.x() + more * (0.3 + 0.02 * x.y()), -0.01 * x.y() - more * 0.2);
    });
  };
  const auto F = [](double more) {
    return GradientLaw([=](const Vec2&, double t) -> Mat2 {
      Mat2 f;
      f << 1 + 0.02 * t, more * 0.02 * t, 0, 1 - 0.01 * t;
      return f;
    });
  };
  const MotionMemory a = motion_of("a", particles_at(square_lattice(30, 20, 1), 1), {0, 1, 2}, u(0), F(0));
  const MotionMemory b = motion_of("b", particles_at(square_lattice(40, 25, 0.8, Vec2(-1, 0)), 0.8), {0, 1, 2}, u(1), F(1));
  const Comparison ab = compared(a, b), ba = compared(b, a);
  EXPECT_EQ(metric(ab, "coverage_first").value, metric(ba, "coverage_second").value);
  EXPECT_EQ(metric(ab, "coverage_second").value, metric(ba, "coverage_first").value);
  EXPECT_LT(metric(ab, "coverage_second").value, 1);  // one column of the second's lies beyond
  for (const char* name : {"displacement_bias_x", "displacement_bias_y", "strain_dev_bias", "strain_vol_bias"}) {
    const double one = metric(ab, name).value, other = metric(ba, name).value;
    EXPECT_NEAR(one, -other, 0.02 * std::abs(one) + 1e-6) << name;
  }
  for (const char* name : {"displacement_rms", "displacement_p95", "velocity_rms", "strain_dev_rms", "outline_iou",
                           "outline_hausdorff_95"}) {
    const double one = metric(ab, name).value, other = metric(ba, name).value;
    EXPECT_NEAR(one, other, 0.03 * one + 1e-6) << name;
  }
  EXPECT_LT(metric(ab, "displacement_bias_y").value, -0.1);
}

TEST(Units, ThatLengthsAreTheMotionsOwnIsSaidWhereverOneIsGiven) {
  MotionMemory px("px", "px", "frame", block());
  for (double t : {0.0, 1.0}) px.add(frame_of(block(), t, shear, shear_F));
  EXPECT_FALSE(remarked(compared(px, px), "own unit, px"));
  CompareOptions points;
  points.points_m = {{3, 3}};
  EXPECT_TRUE(remarked(compared(px, px, points), "own unit, px"));
  LimitOptions limits;
  limits["hausdorff_m"] = 1;
  EXPECT_TRUE(remarked(compared(px, px, {}, limits), "own unit, px"));
  limits = {};
  limits["strain_rms"] = 1;
  EXPECT_FALSE(remarked(compared(px, px, {}, limits), "own unit, px"));
}

}  // namespace
}  // namespace pivnp::compare
