// The covariance of a particle's displacement: growth with the steps, transport by the motion, and the bound that the
// correlation of neighbouring vectors asks for.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/verification/np_testing.hpp"

namespace pivnp::np {
namespace {

using namespace testing;

const Grid grid{{0, 0}, {1, 1}, 13, 13};

void give_cov(NodalIncrements& d, float uu, float vv, float uv) { d.cov.assign(d.grid.node_count(), {uu, vv, uv}); }

TEST(Covariance, GrowsInProportionToTheStepsInATranslation) {
  for (const Anchor anchor : {Anchor::forward, Anchor::central}) {
    NodalIncrements d = sample_increments(AffineMotion::rotation(0, {0, 0}, {0.03, 0.01}), grid, anchor, 0, 1);
    give_cov(d, 4e-4f, 1e-4f, 5e-5f);
    Tracker tracker(bilinear(), block(grid, {3, 3}, {6, 6}, 4), 0);
    for (int k = 1; k <= 25; ++k) tracker.step(d, k);
    for (std::size_t p = 0; p < tracker.state().size(); ++p) {
      EXPECT_NEAR(tracker.state()[p].cov[0], 25 * 4e-4, 1e-9);
      EXPECT_NEAR(tracker.state()[p].cov[1], 25 * 1e-4, 1e-9);
      EXPECT_NEAR(tracker.state()[p].cov[2], 25 * 5e-5, 1e-9);
    }
    EXPECT_NEAR(tracker.frame().cov_u[0][0], 1e-2, 1e-8);
  }
}

TEST(Covariance, ErrorCorrelationGoesFromABoundToIndependence) {
  NodalIncrements d = sample_increments(AffineMotion::rotation(0, {0, 0}, {0, 0}), grid, Anchor::central, 0, 1);
  give_cov(d, 1, 1, 0);
  const std::vector<Vec2> places = {{4.5, 4.5}, {4, 4}, {4.25, 4}};
  const std::vector<double> squares = {0.25, 1, 0.25 * 0.25 + 0.75 * 0.75};  // sum N_i^2
  for (const double rho : {0.0, 0.3, 1.0}) {
    NpOptions options = bilinear();
    options.error_correlation = rho;
    Tracker tracker(options, particles_at(places), 0);
    tracker.step(d, 1);
    for (std::size_t p = 0; p < places.size(); ++p)
      EXPECT_NEAR(tracker.state()[p].cov[0], rho + (1 - rho) * squares[p], 1e-12);
  }
}

// The scatter of x over many runs of the same motion, each step's vectors all off by one common random error (windows
// that overlap fully), against the tracker's own covariance.
TEST(Covariance, IsCarriedByTheMotion) {
  constexpr int steps = 4, runs = 3000;
  constexpr double su = 0.01, sv = 0.004;
  const AffineMotion motion([](double t) {
    AffineMap map;
    map.A << 1 + 0.15 * t, 0.3 * t, -0.1 * t, 1 - 0.05 * t;
    map.b = Vec2(-2, 1) * 0.1 * t;
    return map;
  });
  for (const Anchor anchor : {Anchor::forward, Anchor::central}) {
    std::mt19937 random(2024);
    RecordProperty("seed", 2024);
    std::normal_distribution<double> normal;
    std::vector<NodalIncrements> exact;
    for (int k = 0; k < steps; ++k) exact.push_back(sample_increments(motion, grid, anchor, k, k + 1));
    Tracker reference(bilinear(), particles_at({{4.3, 4.6}}), 0);
    for (int k = 0; k < steps; ++k) {
      NodalIncrements d = exact[std::size_t(k)];
      give_cov(d, float(su * su), float(sv * sv), 0);
      reference.step(d, k + 1);
    }
    const auto predicted = reference.state()[0];
    std::array<double, 3> seen{0, 0, 0};
    for (int n = 0; n < runs; ++n) {
      Tracker tracker(bilinear(), particles_at({{4.3, 4.6}}), 0);
      for (int k = 0; k < steps; ++k) {
        NodalIncrements d = exact[std::size_t(k)];
        const double eu = su * normal(random), ev = sv * normal(random);
        for (auto& v : d.displacement) v = {v[0] + eu, v[1] + ev};
        tracker.step(d, k + 1);
      }
      const Vec2 e = tracker.state()[0].x - predicted.x;
      seen[0] += e.x() * e.x() / runs;
      seen[1] += e.y() * e.y() / runs;
      seen[2] += e.x() * e.y() / runs;
    }
    // 3000 runs know a variance to 2.6 %.
    EXPECT_NEAR(predicted.cov[0], seen[0], 0.1 * seen[0]);
    EXPECT_NEAR(predicted.cov[1], seen[1], 0.1 * seen[1]);
    EXPECT_NEAR(predicted.cov[2], seen[2], 0.1 * std::sqrt(seen[0] * seen[1]));
    EXPECT_GT(predicted.cov[0], 1.3 * steps * su * su);  // the motion itself made it grow
  }
}

TEST(Covariance, TheDefaultBoundsTheScatterOfIndependentErrorsToo) {
  constexpr int runs = 3000;
  std::mt19937 random(7);
  RecordProperty("seed", 7);
  std::normal_distribution<double> normal(0, 0.01);
  NodalIncrements d = sample_increments(AffineMotion::rotation(0, {0, 0}, {0, 0}), grid, Anchor::forward, 0, 1);
  give_cov(d, 1e-4f, 1e-4f, 0);
  // One among good nodes, one that rests on a fit: the upper half is lost.
  const std::vector<Vec2> places = {{4.3, 3.4}, {4.3, 6.7}};
  for (int j = 7; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) d.status[grid.node(i, j)] = VectorStatus::failed;
  const NodalIncrements quiet = d;
  std::array<double, 2> seen{0, 0}, claimed{0, 0};
  for (int n = 0; n < runs; ++n) {
    for (auto& v : d.displacement) v = {normal(random), normal(random)};
    Tracker tracker(bilinear(), particles_at(places), 0);
    tracker.step(d, 1);
    for (std::size_t p = 0; p < 2; ++p) {
      seen[p] += (tracker.state()[p].x - places[p]).squaredNorm() / 2 / runs;
      claimed[p] += tracker.state()[p].cov[0] / runs;
    }
  }
  EXPECT_LT(seen[0], claimed[0]);
  EXPECT_LT(seen[1], claimed[1]);
  EXPECT_LT(claimed[0], 5 * seen[0]);   // a bound, not a refuge
  EXPECT_LT(claimed[1], 10 * seen[1]);
  Tracker still(bilinear(), particles_at(places), 0);
  still.step(quiet, 1);
  EXPECT_GE(still.state()[1].cov[0], still.state()[0].cov[0]);  // a fit at the rim knows less
}

// Measured fields (float) are stepped several particles at a time, given ones (double) one by one: the same covariances,
// whatever the anchor and the correlation of errors, at borders and lost nodes too.
TEST(Covariance, ManyAtATimeAsOneByOne) {
  const unsigned seed = 5;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> amount(-0.3f, 0.3f), variance(1e-4f, 1e-2f);
  const Grid narrow{{-1, 2}, {0.5, 0.5}, 13, 11};
  const ParticleSet particles = block(narrow, {-1, 2}, {5, 7}, 4);
  for (const Anchor anchor : {Anchor::forward, Anchor::central})
    for (const double correlation : {1.0, 0.3}) {
      VectorField measured;
      NodalIncrements given;
      measured.grid = given.grid = narrow;
      measured.anchor = given.anchor = anchor;
      for (std::size_t n = 0; n < narrow.node_count(); ++n) {
        const std::array<float, 2> d{amount(random), amount(random)};
        const float uu = variance(random), vv = variance(random), uv = 0.4f * std::min(uu, vv);
        measured.displacement.push_back(d);
        given.displacement.push_back({double(d[0]), double(d[1])});
        measured.cov.push_back({uu, vv, uv});
        measured.status.push_back(n % 37 == 5 ? VectorStatus::rejected : VectorStatus::valid);
      }
      given.cov = measured.cov;
      given.status = measured.status;
      NpOptions options = bilinear();
      options.error_correlation = correlation;
      Tracker many(options, particles, 0), one(options, particles, 0);
      for (int k = 1; k <= 2; ++k) many.step(measured, k), one.step(given, k);
      std::size_t alive = 0;
      for (std::size_t p = 0; p < particles.size(); ++p) {
        const auto a = many.state()[p], b = one.state()[p];
        ASSERT_EQ(a.status, b.status) << p;
        alive += a.status != ParticleStatus::ended;
        EXPECT_LT((a.x - b.x).norm(), 1e-13);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a.cov[c], b.cov[c], 1e-13) << p;
      }
      EXPECT_GT(alive, particles.size() / 2);
    }
}

TEST(Covariance, UnknownOnceAPairLacksIt) {
  NodalIncrements d = sample_increments(AffineMotion::rotation(0, {0, 0}, {0, 0}), grid, Anchor::central, 0, 1);
  Tracker tracker(bilinear(), particles_at({{4, 4}}), 0);
  give_cov(d, 1, 1, 0);
  tracker.step(d, 1);
  EXPECT_EQ(tracker.frame().cov_u.size(), 1u);
  d.cov.clear();
  tracker.step(d, 2);
  EXPECT_TRUE(tracker.frame().cov_u.empty());
  give_cov(d, 1, 1, 0);
  tracker.step(d, 3);
  EXPECT_TRUE(tracker.frame().cov_u.empty());
}

}  // namespace
}  // namespace pivnp::np
