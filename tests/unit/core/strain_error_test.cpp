// The error of strains by a covariance of F, against the scatter of strains of gradients drawn with it.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "pivnp/core/particles/strain.hpp"
#include "pivnp/core/particles/strain_error.hpp"

namespace pivnp {
namespace {

Mat2 made(double xx, double xy, double yx, double yy) {
  Mat2 F;
  F << xx, xy, yx, yy;
  return F;
}

Mat2 turned(double angle) { return made(std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)); }

TEST(StrainError, IsTheScatterOfDrawnGradients) {
  const std::array<double, 3> row{4e-6, 1e-6, 1e-6};
  const Mat2 R = made(row[0], row[2], row[2], row[1]), half = R.llt().matrixL();
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  // Still; strains of one, two and five standard deviations; large shear, stretch, and both turned.
  const Mat2 still = Mat2::Identity();
  for (const Mat2& F : {still, made(1, .004, 0, 1), made(1.002, .003, 0, .999), made(1.01, 0, 0, 1), made(1, .5, 0, 1),
                        made(1.4, 0, 0, .7), Mat2(turned(.8) * made(1.4, .3, 0, .7)), Mat2(turned(1) * made(.9, 0, 0, .9))}) {
    const Strain e = log_strain(F);
    double dev = 0, vol = 0;
    StrainVariance stated;  // of what is measured, on the average
    constexpr int n = 40000;
    for (int k = 0; k < n; ++k) {
      Mat2 E;
      for (int r = 0; r < 2; ++r) E.row(r) = (half * Vec2(normal(random), normal(random))).transpose();
      const Strain off = log_strain(F + E);
      dev += std::pow(deviatoric(off) - deviatoric(e), 2) / n, vol += std::pow(volumetric(off) - volumetric(e), 2) / n;
      const StrainVariance one = strain_variance(F + E, row);
      stated.dev += one.dev / n, stated.vol += one.vol / n;
    }
    EXPECT_NEAR(std::sqrt(stated.vol / vol), 1, .02) << F;
    // About two standard deviations of strain it is a third too large.
    EXPECT_NEAR(std::sqrt(stated.dev / dev), 1, deviatoric(e) > .01 ? .03 : .35) << F << ' ' << std::sqrt(stated.dev) << ' ' << std::sqrt(dev);
  }
}

TEST(StrainError, KnowsNothingOfNoMaterial) {
  EXPECT_TRUE(std::isnan(strain_variance(made(-1, 0, 0, 1), {1, 1, 0}).dev));
  EXPECT_TRUE(std::isnan(strain_variance(made(1, 0, 0, 1), {std::nan(""), 1, 0}).vol));
  EXPECT_EQ(strain_variance(made(1.1, 0, 0, 1), {0, 0, 0}).dev, 0);
}

}  // namespace
}  // namespace pivnp
