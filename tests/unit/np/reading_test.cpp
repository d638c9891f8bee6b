// What reading between the nodes costs a path: estimated from the field, carried, stated and flagged.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/verification/np_testing.hpp"

namespace pivnp::np {
namespace {

namespace reading {

using testing::particles_at;

const Grid grid{{0, 0}, {16, 16}, 33, 33};

NpOptions with(ShapeFunctions shape) {
  NpOptions options;
  options.shape = shape;
  return options;
}

NodalIncrements shear_wave(double wavelength, double gradient, double phase) {
  NodalIncrements d;
  d.grid = grid;
  const double k = 2 * M_PI / wavelength;
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i)
      d.displacement.push_back({gradient / k * std::sin(k * grid.position(i, j).y() + phase), 0});
  d.status.assign(grid.node_count(), VectorStatus::valid);
  d.cov.assign(grid.node_count(), {1e-8f, 1e-8f, 0});
  return d;
}

}  // namespace reading

TEST(Reading, TheErrorOfAWaveFallsWithTheOrderOfTheShape) {
  const auto order = [](ShapeFunctions shape) {
    const auto error = [&](double k) { return wave_reading_error(shape, 2 - 2 * std::cos(k)); };
    return std::log2(error(0.4) / error(0.2));
  };
  EXPECT_NEAR(order(ShapeFunctions::bilinear), 2, 0.1);
  EXPECT_NEAR(order(ShapeFunctions::quadratic), 3, 0.1);
  EXPECT_NEAR(order(ShapeFunctions::bspline3), 4, 0.1);
  // of linear interpolation k^2/8 at the middle of an element, RMS over it sqrt(8/15)
  EXPECT_NEAR(wave_reading_error(ShapeFunctions::bilinear, 2 - 2 * std::cos(0.2)), 0.04 / 8 * std::sqrt(8.0 / 15), 2e-5);
}

// Particles on a shear wave that no shape reads exactly: the bias stated against the error made, all phases.
TEST(Reading, TheBiasAddsUpAlongThePathAndIsStated) {
  for (const ShapeFunctions shape : {ShapeFunctions::bilinear, ShapeFunctions::quadratic, ShapeFunctions::bspline2,
                                     ShapeFunctions::cubic, ShapeFunctions::bspline3, ShapeFunctions::triangles})
    for (const double wavelength : {3.3 * 16, 5.0 * 16, 9.0 * 16}) {
      double made = 0, stated = 0, within = 0, count = 0;
      for (const double phase : {0.0, 0.7, 1.4, 2.1}) {
        const NodalIncrements d = reading::shear_wave(wavelength, 0.05, phase);
        std::vector<Vec2> places;
        for (double y = 130; y < 380; y += 1.7) places.emplace_back(250, y);
        Tracker tracker(reading::with(shape), reading::particles_at(places), 0);
        constexpr int steps = 20;
        for (int n = 0; n < steps; ++n) tracker.step(d, n + 1);
        const double k = 2 * M_PI / wavelength;
        for (std::size_t p = 0; p < places.size(); ++p) {
          const double off = tracker.state()[p].x.x() - places[p].x() - steps * 0.05 / k * std::sin(k * places[p].y() + phase);
          const double sigma = std::sqrt(tracker.state()[p].cov[0]);
          made += off * off, stated += sigma * sigma, ++count, within += std::abs(off) <= 3 * sigma;
        }
      }
      SCOPED_TRACE(std::string(name_of(shape)) + ", " + std::to_string(wavelength / 16) + " elements");
      EXPECT_GT(std::sqrt(stated / made), 0.6);
      EXPECT_LT(std::sqrt(stated / made), 2);
      // Of odd order, the error is greatest where the wave crosses zero, and the estimate of splines is not.
      EXPECT_GT(within / count, shape == ShapeFunctions::bspline2 ? 0.65 : 0.85);
    }
}

// A wave of three elements that is zero at each third node: polynomials miss most of it beside their own zero.
TEST(Reading, PolynomialsAreFlaggedWhereTheWaveCrossesZero) {
  for (const ShapeFunctions shape : {ShapeFunctions::quadratic, ShapeFunctions::cubic}) {
    const NodalIncrements d = reading::shear_wave(3 * 16, 0.05, 0);
    std::vector<Vec2> places;
    for (double y = 130; y < 380; y += 1.7) places.emplace_back(250, y);
    Tracker tracker(reading::with(shape), reading::particles_at(places), 0);
    for (int n = 0; n < 20; ++n) tracker.step(d, n + 1);
    double wrong = 0, flagged = 0;
    const double k = 2 * M_PI / (3 * 16);
    for (std::size_t p = 0; p < places.size(); ++p) {
      const double off = tracker.state()[p].x.x() - places[p].x() - 20 * 0.05 / k * std::sin(k * places[p].y());
      if (std::abs(off) < 0.5) continue;
      ++wrong, flagged += tracker.state()[p].status == ParticleStatus::flagged;
    }
    SCOPED_TRACE(std::string(name_of(shape)));
    EXPECT_GT(wrong, 0.5 * double(places.size()));
    EXPECT_GT(flagged, 0.95 * wrong);
  }
}

TEST(Reading, APathThatRestsOnItIsFlaggedAndAGoodOneIsNot) {
  const NodalIncrements short_wave = reading::shear_wave(4 * 16, 0.05, 0.3), long_wave = reading::shear_wave(16 * 16, 0.005, 0.3);
  for (const bool is_short : {true, false}) {
    std::vector<Vec2> places;
    for (double y = 130; y < 380; y += 1.7) places.emplace_back(250, y);
    Tracker tracker(reading::with(ShapeFunctions::bilinear), reading::particles_at(places), 0);
    for (int n = 0; n < 20; ++n) tracker.step(is_short ? short_wave : long_wave, n + 1);
    std::size_t flagged = 0;
    for (std::size_t p = 0; p < places.size(); ++p) flagged += tracker.state()[p].status == ParticleStatus::flagged;
    if (is_short) EXPECT_GT(flagged, places.size() * 8 / 10);
    else EXPECT_EQ(flagged, 0u);
  }
}

// Vectors that are noise alone: what looks like a bias averages out, and leaves the stated error near the true one.
TEST(Reading, NoiseIsNoBias) {
  std::mt19937 random(3);
  RecordProperty("seed", 3);
  std::normal_distribution<double> normal(0, 0.02);
  std::vector<Vec2> places;
  for (double y = 130; y < 380; y += 3.1)
    for (double x = 130; x < 380; x += 3.3) places.emplace_back(x, y);
  Tracker tracker({}, reading::particles_at(places), 0);
  for (int n = 0; n < 40; ++n) {
    NodalIncrements d = reading::shear_wave(1e6, 0, 0);
    for (auto& v : d.displacement) v = {normal(random), normal(random)};
    d.cov.assign(d.grid.node_count(), {4e-4f, 4e-4f, 0});
    tracker.step(d, n + 1);
  }
  double made = 0, stated = 0, flagged = 0;
  for (std::size_t p = 0; p < places.size(); ++p) {
    made += (tracker.state()[p].x - places[p]).squaredNorm();
    stated += tracker.state()[p].cov[0] + tracker.state()[p].cov[1];
    flagged += tracker.state()[p].status == ParticleStatus::flagged;
  }
  EXPECT_GT(stated, made);
  EXPECT_LT(stated, 4 * made);
  EXPECT_LT(flagged, 0.05 * double(places.size()));
}

// What pairs share adds up: n pairs have n^2 times its variance, and a saved state goes on with it.
TEST(Reading, WhatPairsShareAddsUp) {
  VectorField field = vector_field(reading::shear_wave(1e6, 0, 0), {0, 1});
  field.cov.assign(field.grid.node_count(), {4e-4f, 4e-4f, 0});
  field.correlation_length = 1e6f;  // nothing but what is shared
  const ParticleSet set = reading::particles_at({{250, 250}});
  Tracker straight({}, set, 0), resumed({}, set, 0);
  for (int n = 0; n < 30; ++n) straight.step(field, n + 1);
  Tracker first({}, set, 0);
  for (int n = 0; n < 10; ++n) first.step(field, n + 1);
  resumed.load(first.save());
  for (int n = 10; n < 30; ++n) resumed.step(field, n + 1);
  const double one = 4e-4 / (ReadingErrors::shared_spacings * ReadingErrors::shared_spacings * 16 * 16);
  EXPECT_NEAR(straight.state()[0].cov_F[0], 900 * one, .01 * 900 * one);
  EXPECT_EQ(straight.state()[0].cov_F[0], resumed.state()[0].cov_F[0]);
}

// What cov counts along a path is not what a gradient is off by; where nodes have failed, by a local fit too.
TEST(Reading, APathFactorCountsInTheDisplacementAlone) {
  for (const ShapeFunctions shape : {ShapeFunctions::bspline3, ShapeFunctions::bilinear, ShapeFunctions::quadratic, ShapeFunctions::triangles})
    for (const bool gap : {false, true}) {
      VectorField field = vector_field(reading::shear_wave(1e6, 0, 0), {0, 1});
      field.cov.assign(field.grid.node_count(), {4e-4f, 1e-4f, 1e-5f});
      if (gap) field.status[field.grid.node(15, 15)] = VectorStatus::failed;
      const ParticleSet set = reading::particles_at({{250, 250}});
      Tracker plain(reading::with(shape), set, 0), factored(reading::with(shape), set, 0);
      plain.step(field, 1), factored.step(field, 1);
      field.path_factor.assign(field.grid.node_count(), 3);
      factored.step(field, 2);
      const auto one = plain.state()[0], both = factored.state()[0];
      ASSERT_EQ(one.status, gap && shape != ShapeFunctions::triangles ? ParticleStatus::flagged : one.status);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(both.cov[k], 4 * one.cov[k], 1e-6 * one.cov[0]) << int(shape) << gap;
      if (!gap && shape != ShapeFunctions::triangles) {
        EXPECT_NEAR(both.cov_F[0], 2 * one.cov_F[0], 1e-6 * one.cov_F[0]);
      }
    }
  VectorField field = vector_field(reading::shear_wave(1e6, 0, 0), {0, 1});
  field.path_factor.assign(7, 1);
  EXPECT_THROW(Tracker({}, reading::particles_at({{250, 250}}), 0).step(field, 1), InputError);
}

// Of a gradient: the scatter over many runs against cov_F.
TEST(Reading, TheCovarianceOfFIsThatOfItsScatter) {
  std::mt19937 random(8);
  RecordProperty("seed", 8);
  std::normal_distribution<double> normal(0, 0.02);
  std::vector<Vec2> places;
  for (double y = 130; y < 380; y += 3.1)
    for (double x = 130; x < 380; x += 3.3) places.emplace_back(x, y);
  for (const ShapeFunctions shape : {ShapeFunctions::bilinear, ShapeFunctions::bspline3}) {
    Tracker tracker(reading::with(shape), reading::particles_at(places), 0);
    for (int n = 0; n < 10; ++n) {
      NodalIncrements d = reading::shear_wave(1e6, 0, 0);
      for (auto& v : d.displacement) v = {normal(random), normal(random)};
      d.cov.assign(d.grid.node_count(), {4e-4f, 4e-4f, 0});
      tracker.step(d, n + 1);
    }
    double made = 0, stated = 0;
    for (std::size_t p = 0; p < places.size(); ++p) {
      made += (tracker.state()[p].F - Mat2::Identity()).squaredNorm();
      stated += 2 * (tracker.state()[p].cov_F[0] + tracker.state()[p].cov_F[1]);
    }
    EXPECT_GT(std::sqrt(stated / made), 0.7) << name_of(shape);
    EXPECT_LT(std::sqrt(stated / made), 1.4) << name_of(shape);
    EXPECT_EQ(tracker.frame().field("cov_F").values.size(), 3 * places.size());
  }
}

}  // namespace
}  // namespace pivnp::np
