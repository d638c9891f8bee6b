// A motion read at points and in rectangles: exact where the motion is affine, with the uncertainty of its particles.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <span>

#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/places.hpp"

namespace pivnp {
namespace {

constexpr int side = 8;

// x = X + k (G X + (0.5, -0.25)), k = 0 and 1; spacing 0.5; variance 0.01 and 0.04 of u, 0.0025 of a component of F.
std::shared_ptr<MotionMemory> affine(const Mat2& G) {
  ParticleSet set;
  for (int p = 0; p < side * side; ++p) {
    set.id.push_back(p);
    set.label.push_back(0);
    set.x0.emplace_back(0.25 + 0.5 * (p % side), 0.25 + 0.5 * (p / side));
    set.area.push_back(0.25);
    set.born.push_back(0);
    set.end.push_back(nan_value);
    set.end_reason.push_back(EndReason::none);
  }
  auto motion = std::make_shared<MotionMemory>("np", "m", "s", set);
  for (int k = 0; k < 2; ++k) {
    MotionFrame f;
    f.time = 2.0 * k;
    const std::span<float> cov_F = f.add("cov_F", set.size()), stress = f.add("stress", set.size());
    for (std::size_t p = 0; p < set.size(); ++p) {
      const Vec2 u = k * (G * set.x0[p] + Vec2(0.5, -0.25));
      const Mat2 F = Mat2::Identity() + k * G;
      f.u.push_back({float(u.x()), float(u.y())});
      f.F.push_back({float(F(0, 0)), float(F(0, 1)), float(F(1, 0)), float(F(1, 1))});
      f.status.push_back(ParticleStatus::active);
      f.cov_u.push_back({0.01f, 0.04f, 0});
      cov_F[3 * p] = cov_F[3 * p + 1] = 0.0025f;
      stress[4 * p + 1] = float(-10 * set.x0[p].y());
    }
    motion->add(f);
  }
  return motion;
}

Mat2 some() {
  Mat2 G;
  G << 0.2, 0.1, -0.05, -0.1;
  return G;
}

TEST(Places, PointsOfAnAffineMotion) {
  const auto motion = affine(some());
  const Vec2 x(1.37, 2.11);
  const auto places = at_points(motion, {x, Vec2(30, 30)});
  DerivedReader reader(*places, true);
  const Vec2 u = some() * x + Vec2(0.5, -0.25);
  EXPECT_NEAR(reader.values("displacement_x", 1)[0], u.x(), 1e-6);
  EXPECT_NEAR(reader.values("displacement_y", 1)[0], u.y(), 1e-6);
  EXPECT_NEAR(reader.values("velocity_x", 1)[0], u.x() / 2, 1e-6);
  EXPECT_NEAR(reader.values("J", 1)[0], (Mat2::Identity() + some()).determinant(), 1e-6);
  EXPECT_NEAR(reader.values("stress_yy", 1)[0], -10 * x.y(), 1e-4);
  EXPECT_NEAR(reader.values("sigma_displacement_x", 1)[0], 0.1, 1e-7);
  EXPECT_NEAR(reader.values("sigma_displacement_y", 1)[0], 0.2, 1e-7);
  EXPECT_NEAR(reader.values("sigma_displacement_magnitude", 0)[0], std::sqrt(0.025), 1e-7);  // at rest: of a component
  EXPECT_GT(reader.values("sigma_strain_dev", 1)[0], 0.01);
  EXPECT_EQ(places->frame(1).status[1], ParticleStatus::unborn);  // no particle starts there
  EXPECT_TRUE(std::isnan(reader.values("displacement_x", 1)[1]));
}

TEST(Places, APointEndsWithAParticleBesideIt) {
  const auto motion = affine(some());
  MotionMemory ending("np", "m", "s", motion->particles());
  for (std::size_t k = 0; k < 2; ++k) {
    MotionFrame f = motion->frame(k);
    if (k == 1) f.status[0] = ParticleStatus::ended;
    ending.add(f);
  }
  const auto places = at_points({std::shared_ptr<void>(), &ending}, {Vec2(0.3, 0.3), Vec2(3.1, 3.1)});
  EXPECT_EQ(places->frame(0).status[0], ParticleStatus::active);
  EXPECT_EQ(places->frame(1).status[0], ParticleStatus::ended);
  EXPECT_TRUE(std::isnan(places->frame(1).u[0][0]));
  EXPECT_EQ(places->frame(1).status[1], ParticleStatus::active);
}

// 4 x 2 particles: errors that are one in cells of 1 x 1 (four particles each, two cells) halve the variance of errors that are
// one everywhere; cells of less than the spacing make it an eighth.
TEST(Places, TheMeanOfARectangleAndItsUncertainty) {
  const auto motion = affine(some());
  const Vec2 lower(1, 1), upper(3, 2), middle(2, 1.5), u = some() * middle + Vec2(0.5, -0.25);
  for (const auto& [length, share] : {std::pair{0.0, 1.0}, {1.0, 0.5}, {0.4, 0.125}}) {
    const auto place = in_rectangle(motion, lower, upper, length);
    DerivedReader reader(*place, true);
    EXPECT_NEAR((place->particles().x0[0] - middle).norm(), 0, 1e-12);
    EXPECT_NEAR(place->particles().area[0], 2, 1e-12);
    EXPECT_NEAR(reader.values("displacement_x", 1)[0], u.x(), 1e-6);
    EXPECT_NEAR(reader.values("strain_vol", 1)[0], std::log((Mat2::Identity() + some()).determinant()), 1e-6);
    EXPECT_NEAR(reader.values("sigma_displacement_x", 1)[0], 0.1 * std::sqrt(share), 1e-7) << length;
    EXPECT_NEAR(place->frame(1).field("cov_F")(0, 0), 0.0025 * share, 1e-8) << length;
  }
  EXPECT_EQ(in_rectangle(motion, Vec2(9, 9), Vec2(10, 10), 0)->frame(0).status[0], ParticleStatus::unborn);
}

// The mean is over those that are followed.
TEST(Places, ARectangleGoesOnWithoutThoseThatEnded) {
  const auto motion = affine(some());
  MotionMemory ending("np", "m", "s", motion->particles());
  for (std::size_t k = 0; k < 2; ++k) {
    MotionFrame f = motion->frame(k);
    for (std::size_t p = 0; k == 1 && p < f.status.size(); ++p)
      if (motion->particles().x0[p].x() < 2) f.status[p] = ParticleStatus::ended;
    ending.add(f);
  }
  const auto place = in_rectangle({std::shared_ptr<void>(), &ending}, Vec2(1, 1), Vec2(3, 2), 1.0);
  EXPECT_EQ(place->frame(1).status[0], ParticleStatus::active);
  EXPECT_NEAR(place->frame(1).u[0][0], (some() * Vec2(2.5, 1.5) + Vec2(0.5, -0.25)).x(), 1e-6);
  EXPECT_NEAR(place->frame(1).cov_u[0][0], 0.01, 1e-8);  // one cell is left
}

TEST(Places, OfASectionTheDisplacementHasItsUncertaintyToo) {
  const auto motion = affine(Mat2::Zero());
  const SectionCurve curve = section(*motion, "displacement_y", true, 1, Vec2(1, 1), Vec2(3, 1));
  ASSERT_EQ(curve.sigma.size(), curve.value.size());
  EXPECT_NEAR(curve.value[60], -0.25, 1e-7);
  EXPECT_NEAR(curve.sigma[60], 0.2, 1e-7);
  EXPECT_EQ(sigma_field("velocity_x"), "");
}

}  // namespace
}  // namespace pivnp
