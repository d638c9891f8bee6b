// Strain measures against closed forms: stretch, simple shear, rotation.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "pivnp/core/particles/strain.hpp"

namespace pivnp {
namespace {

Mat2 rotation(double a) {
  Mat2 R;
  R << std::cos(a), -std::sin(a), std::sin(a), std::cos(a);
  return R;
}

TEST(LogStrain, RotationHasNone) {
  for (double a = -3; a < 3; a += 0.37) {
    const Strain e = log_strain(rotation(a));
    EXPECT_NEAR(e.xx, 0, 1e-15);
    EXPECT_NEAR(e.yy, 0, 1e-15);
    EXPECT_NEAR(e.xy, 0, 1e-15);
  }
}

TEST(LogStrain, StretchThenTurn) {
  const Mat2 U = Vec2(1.24, 0.9).asDiagonal();
  const Strain e = log_strain(rotation(std::numbers::pi / 2) * U);
  EXPECT_NEAR(e.xx, std::log(0.9), 1e-14);
  EXPECT_NEAR(e.yy, std::log(1.24), 1e-14);
  const Strain m = log_strain_material(rotation(std::numbers::pi / 2) * U);
  EXPECT_NEAR(m.xx, std::log(1.24), 1e-14);
}

TEST(LogStrain, SimpleShear) {
  // Principal stretches of F = [1 g; 0 1]: ln = +- asinh(g/2); the xy component is asinh(g/2)/sqrt(1 + g^2/4).
  for (double g : {1e-9, 1e-4, 0.1, 1.0, 2.0}) {
    Mat2 F = Mat2::Identity();
    F(0, 1) = g;
    const Strain e = log_strain(F);
    EXPECT_NEAR(volumetric(e), 0, 1e-15);
    EXPECT_NEAR(e.xy, std::asinh(g / 2) / std::sqrt(1 + g * g / 4), 1e-15);
    EXPECT_NEAR(principal(e).first, std::asinh(g / 2), 1e-14 * (1 + g));
    // sqrt(2/3 (2 (ln l)^2)) = 2/sqrt(3) ln l
    EXPECT_NEAR(deviatoric(e), 2 / std::sqrt(3.0) * std::asinh(g / 2), 1e-14 * (1 + g));
  }
}

TEST(LogStrain, KeepsItsDigitsAtExtremeShear) {
  // Shear of 1234.567, turned: det(F F^T) taken from F F^T would have lost 6 digits more than det F.
  Mat2 F = Mat2::Identity();
  F(0, 1) = 1234.567;
  for (double a = -3; a < 3; a += 0.37) {
    const Strain e = log_strain(rotation(a) * F);
    EXPECT_NEAR(volumetric(e), 0, 2e-12);
    EXPECT_NEAR(principal(e).first, std::asinh(1234.567 / 2), 2e-12);
  }
}

TEST(Principal, DirectionLiesInItsHalfOpenInterval) {
  EXPECT_DOUBLE_EQ(principal({-0.1, 0.2, 0.0}).angle, std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(principal({-0.1, 0.2, -0.0}).angle, std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(principal({-0.1, 0.2, -1e-300}).angle, std::numbers::pi / 2);
  EXPECT_EQ(principal({0.2, -0.1, -0.0}).angle, 0);
  EXPECT_NEAR(principal({0, 0, -0.1}).angle, -std::numbers::pi / 4, 1e-15);
}

TEST(LogStrain, NotAMotionIsNaN) {
  EXPECT_TRUE(std::isnan(log_strain(Vec2(-1, 1).asDiagonal()).xx));
  EXPECT_TRUE(std::isnan(log_strain(Mat2::Zero()).xx));
}

TEST(Increments, UndoTheUpdateOfTheirAnchor) {
  Mat2 G, F0;
  G << 0.01, 0.02, -0.03, 0.015;
  F0 << 1.1, 0.2, -0.1, 0.9;
  const Mat2 I = Mat2::Identity();
  const Strain f = increment_forward(F0, (I + G) * F0);
  const Strain c = increment_central(F0, (I - G / 2).inverse() * (I + G / 2) * F0);
  for (const Strain& e : {f, c}) {
    EXPECT_NEAR(e.xx, 0.01, 1e-15);
    EXPECT_NEAR(e.yy, 0.015, 1e-15);
    EXPECT_NEAR(e.xy, -0.005, 1e-15);
  }
}

}  // namespace
}  // namespace pivnp
