// One step: which point is read, how F follows, births, threads, refusals. Held against core's plain shape functions.
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <omp.h>

#include <Eigen/LU>
#include <cstring>
#include <random>

#include "pivnp/core/error.hpp"
#include "tests/verification/np_testing.hpp"
#include "tests/support/shape.hpp"

namespace pivnp::np {
namespace {

using namespace testing;

const Grid grid{{-1, 2}, {0.5, 0.25}, 21, 17};
const Vec2 middle = (grid.origin + grid.upper()) / 2;

// Strong and rough: random nodal values up to a third of a spacing.
NodalIncrements rough(Anchor anchor, unsigned seed, const Grid& on = grid) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.0 / 3, 1.0 / 3);
  NodalIncrements d;
  d.anchor = anchor;
  d.grid = on;
  for (std::size_t n = 0; n < on.node_count(); ++n)
    d.displacement.push_back({value(random) * on.spacing.x(), value(random) * on.spacing.y()});
  d.status.assign(on.node_count(), VectorStatus::valid);
  return d;
}

struct Plain {
  Vec2 d = Vec2::Zero();
  Mat2 G = Mat2::Zero();
};

// The plain reference: core's locate and bilinear weights.
Plain read_at(const NodalIncrements& field, const Vec2& x, bool centre = false) {
  ElementPoint point;
  EXPECT_TRUE(locate(field.grid, x, point));
  const auto nodes = bilinear_nodes(field.grid, point);
  const BilinearWeights w = bilinear(field.grid, point);
  if (centre) point.xi = point.eta = 0.5;
  const BilinearWeights g = bilinear(field.grid, point);
  Plain out;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec2 v(field.displacement[nodes[k]][0], field.displacement[nodes[k]][1]);
    out.d += w.value[k] * v;
    out.G.col(0) += g.dx[k] * v;
    out.G.col(1) += g.dy[k] * v;
  }
  return out;
}

TEST(Step, ForwardReadsWhereTheParticleIs) {
  const NodalIncrements d = rough(Anchor::forward, 1);
  for (const bool centre : {false, true}) {
    NpOptions options = bilinear();
    options.gradient = centre ? GradientPlace::element : GradientPlace::particle;
    Tracker tracker(options, block(grid, grid.origin, grid.upper(), 9), 0);
    tracker.step(d, 1);
    for (std::size_t p = 0; p < tracker.state().size(); ++p) {
      const Vec2& X = tracker.particles().x0[p];
      const Plain plain = read_at(d, X, centre);
      const Mat2 F = Mat2::Identity() + plain.G;
      const auto now = tracker.state()[p];
      if (F.determinant() <= 0) {
        EXPECT_EQ(now.status, ParticleStatus::ended);
        EXPECT_EQ(tracker.particles().end_reason[p], EndReason::bad_state);
        continue;
      }
      ASSERT_EQ(now.status, ParticleStatus::active);
      EXPECT_LT((now.x - X - plain.d).norm(), 1e-14);
      EXPECT_LT((now.F - F).norm(), 1e-13);
    }
  }
}

TEST(Step, CentralSolvesForTheMidPointAcrossElements) {
  // Gradients up to 4/3 and kinks at every element's border: the hardest the rule is made for.
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    NodalIncrements d = rough(Anchor::central, seed);
    for (auto& v : d.displacement) v = {v[0] + 0.7 * grid.spacing.x(), v[1] - 0.9 * grid.spacing.y()};
    const Vec2 inset = 2 * grid.spacing;
    Tracker tracker(bilinear(), block(grid, grid.origin + inset, grid.upper() - inset, 9), 0);
    tracker.step(d, 1);
    std::size_t followed = 0, crossed = 0;
    for (std::size_t p = 0; p < tracker.state().size(); ++p) {
      const auto now = tracker.state()[p];
      if (now.status == ParticleStatus::ended) continue;
      ASSERT_EQ(now.status, ParticleStatus::active);
      const Vec2& X = tracker.particles().x0[p];
      const Vec2 xm = (X + now.x) / 2;
      const Plain plain = read_at(d, xm);
      EXPECT_LT(((now.x - X - plain.d).array() / grid.spacing.array()).abs().maxCoeff(), 1e-13);
      const Mat2 A = Mat2::Identity() - plain.G / 2, B = Mat2::Identity() + plain.G / 2;
      EXPECT_LT((A * now.F - B).norm(), 1e-11);
      ElementPoint from, at;
      ASSERT_TRUE(locate(grid, X, from) && locate(grid, xm, at));
      crossed += from.i != at.i || from.j != at.j;
      ++followed;
    }
    EXPECT_GT(followed, tracker.state().size() * 9 / 10);
    EXPECT_GT(crossed, 50u);
  }
}

TEST(Step, CentralStepsUndoThemselves) {
  const NodalIncrements there = rough(Anchor::central, 11);
  NodalIncrements back = there;
  for (auto& d : back.displacement) d = {-d[0], -d[1]};
  const Vec2 inset = 2 * grid.spacing;
  Tracker tracker(bilinear(), block(grid, grid.origin + inset, grid.upper() - inset, 4), 0);
  tracker.step(there, 1);
  tracker.step(back, 2);
  for (std::size_t p = 0; p < tracker.state().size(); ++p) {
    const auto now = tracker.state()[p];
    if (now.status == ParticleStatus::ended) continue;
    EXPECT_LT((now.x - tracker.particles().x0[p]).norm(), 1e-12);
    EXPECT_LT((now.F - Mat2::Identity()).norm(), 1e-10);
  }
}

TEST(Step, UnevenTimesAndBirths) {
  const AffineMotion motion = AffineMotion::rotation(0, Vec2::Zero(), {0.1, 0});
  ParticleSet set = particles_at({middle, middle, middle});
  set.born = {0, 1, 1.5};
  Tracker tracker(bilinear(), set, 0);
  EXPECT_EQ(tracker.state()[1].status, ParticleStatus::unborn);
  tracker.step(sample_increments(motion, grid, Anchor::central, 0, 1), 1);
  EXPECT_EQ(tracker.state()[1].status, ParticleStatus::active);
  EXPECT_EQ(tracker.state()[2].status, ParticleStatus::unborn);
  EXPECT_EQ(tracker.state()[1].x, middle);  // born at the end of this pair: not moved by it
  tracker.step(sample_increments(motion, grid, Anchor::central, 1, 3.5), 3.5);
  EXPECT_EQ(tracker.frame().time, 3.5);
  EXPECT_NEAR(tracker.frame().u[0][0], 0.35, 1e-7);
  EXPECT_NEAR(tracker.frame().u[1][0], 0.25, 1e-7);
  EXPECT_EQ(tracker.frame().u[2][0], 0.0f);
  EXPECT_EQ(tracker.state()[2].status, ParticleStatus::active);
}

TEST(Step, SameBitsForAnyNumberOfThreads) {
  // Large enough that every loop is shared out.
  const Grid large{{0, 0}, {1, 1}, 161, 151};
  const int before = omp_get_max_threads();
  std::vector<std::vector<std::byte>> results;
  for (const int threads : {1, 2, 5}) {
    omp_set_num_threads(threads);
    Tracker tracker(bilinear(), block(large, large.origin, large.upper(), 1), 0);
    for (unsigned k = 0; k < 4; ++k) {
      NodalIncrements d = rough(k % 2 == 0 ? Anchor::central : Anchor::forward, 100 + k, large);
      for (auto& v : d.displacement) v = {v[0] / 4, v[1] / 4};
      d.cov.assign(large.node_count(), {1e-6f, 2e-6f, 5e-7f});
      for (std::size_t n = k; n < d.status.size(); n += 17) d.status[n] = VectorStatus::failed;
      for (std::size_t n = k; n < d.status.size(); n += 13) d.status[n] = VectorStatus::replaced;
      tracker.step(vector_field(d, {0, 1}), k + 1);
    }
    results.push_back(tracker.save());
  }
  omp_set_num_threads(before);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

// Nothing is fused in the vectorised step: every instruction set gives the same bits.
TEST(Step, SameBitsForAnyInstructionSet) {
  ParticleSet particles = block(grid, grid.origin, grid.upper(), 9);
  for (const ShapeFunctions shape : {ShapeFunctions::bilinear, ShapeFunctions::bspline3}) {
  std::vector<std::vector<std::byte>> results;
  for (const std::int64_t disabled : {std::int64_t(0), std::int64_t(HWY_AVX3 | HWY_AVX3_DL),
                                      std::int64_t(HWY_AVX3 | HWY_AVX3_DL | HWY_AVX2), ~std::int64_t(HWY_STATIC_TARGET)}) {
    hwy::DisableTargets(disabled);
    NpOptions options;
    options.shape = shape;
    Tracker tracker(options, particles, 0);
    for (unsigned k = 0; k < 4; ++k) {
      NodalIncrements d = rough(k % 2 == 0 ? Anchor::central : Anchor::forward, 50 + k);
      d.cov.assign(grid.node_count(), {1e-4f, 2e-4f, 3e-5f});
      for (std::size_t n = k; n < d.status.size(); n += 19) d.status[n] = VectorStatus::failed;
      tracker.step(vector_field(d, {0, 1}), k + 1);
    }
    results.push_back(tracker.save());
  }
  hwy::DisableTargets(0);
  for (std::size_t k = 1; k < results.size(); ++k) EXPECT_EQ(results[0], results[k]) << k;
  }
}

// A measured field is stepped in lanes, a given one particle by particle: the same places and gradients, also where F does
// not commute with the step and the gradient is taken at the element's centre.
TEST(Step, ManyAtATimeFollowTheSameF) {
  for (const Anchor anchor : {Anchor::forward, Anchor::central})
    for (const GradientPlace gradient : {GradientPlace::particle, GradientPlace::element}) {
      NpOptions options = bilinear();
      options.gradient = gradient;
      const ParticleSet particles = block(grid, grid.origin, grid.upper(), 4);
      Tracker many(options, particles, 0), one(options, particles, 0);
      for (unsigned k = 0; k < 3; ++k) {
        const VectorField measured = vector_field(rough(anchor, 70 + k), {0, 1});
        NodalIncrements given = rough(anchor, 70 + k);
        for (std::size_t n = 0; n < grid.node_count(); ++n)
          given.displacement[n] = {double(measured.displacement[n][0]), double(measured.displacement[n][1])};
        many.step(measured, k + 1);
        one.step(given, k + 1);
      }
      std::size_t alive = 0;
      for (std::size_t p = 0; p < particles.size(); ++p) {
        const auto a = many.state()[p], b = one.state()[p];
        ASSERT_EQ(a.status, b.status) << p;
        alive += a.status != ParticleStatus::ended;
        EXPECT_LT((a.x - b.x).norm(), 1e-12);
        EXPECT_LT((a.F - b.F).norm(), 1e-11 * b.F.norm());
      }
      EXPECT_GT(alive, particles.size() / 2);
    }
}

// The same by cubic B-splines, with covariances, at borders and lost nodes. The lanes hold coefficients in single
// precision. The motion is smooth, so that there is one mid-point only.
TEST(Step, ManyAtATimeFollowTheSameSplines) {
  const ReversingVortex vortex(middle, 2.5 * grid.spacing.minCoeff(), 1.2, 8);
  for (const Anchor anchor : {Anchor::forward, Anchor::central})
    for (const GradientPlace gradient : {GradientPlace::particle, GradientPlace::element}) {
      NpOptions options;
      options.shape = ShapeFunctions::bspline3;
      options.gradient = gradient;
      const ParticleSet particles = block(grid, grid.origin, grid.upper(), 9);
      Tracker many(options, particles, 0), one(options, particles, 0);
      for (int k = 0; k < 3; ++k) {
        NodalIncrements given = sample_increments(vortex, grid, anchor, k, k + 1);
        given.cov.assign(grid.node_count(), {1e-4f, 2e-4f, 3e-5f});
        for (std::size_t n = 3; n < given.status.size(); n += 41) given.status[n] = VectorStatus::failed;
        for (std::size_t n = 8; n < given.status.size(); n += 17) given.status[n] = VectorStatus::replaced;
        many.step(vector_field(given, {k, k + 1}), k + 1);
        one.step(given, k + 1);
      }
      std::size_t alive = 0, active = 0;
      for (std::size_t p = 0; p < particles.size(); ++p) {
        const auto a = many.state()[p], b = one.state()[p];
        ASSERT_EQ(a.status, b.status) << p;
        alive += a.status != ParticleStatus::ended;
        active += a.status == ParticleStatus::active;
        EXPECT_LT((a.x - b.x).norm(), 1e-6);
        EXPECT_LT((a.F - b.F).norm(), 1e-5);
        EXPECT_LT((a.bias - b.bias).norm(), 1e-6);
        for (std::size_t c = 0; c < 3; ++c) {
          EXPECT_NEAR(a.random[c], b.random[c], 1e-6 * (b.random[0] + b.random[1]));
          EXPECT_NEAR(a.cov_F[c], b.cov_F[c], 1e-5 * (b.cov_F[0] + b.cov_F[1]));
        }
      }
      EXPECT_GT(alive, particles.size() / 2);
      EXPECT_GT(active, 0u);
    }
}

TEST(Step, RefusesWhatIsNoPair) {
  const NodalIncrements d = rough(Anchor::central, 1);
  Tracker tracker(bilinear(), particles_at({middle}), 2);
  EXPECT_THROW(tracker.step(d, 2), InputError);
  EXPECT_THROW(tracker.step(d, std::nan("")), InputError);
  NodalIncrements shorter = d;
  shorter.status.pop_back();
  EXPECT_THROW(tracker.step(shorter, 3), InputError);
  NodalIncrements odd_cov = d;
  odd_cov.cov.resize(3);
  EXPECT_THROW(tracker.step(odd_cov, 3), InputError);
  NodalIncrements line = d;
  line.grid.nx = 1;
  EXPECT_THROW(tracker.step(line, 3), InputError);
  EXPECT_EQ(tracker.time(), 2);
  tracker.step(d, 3);
  EXPECT_EQ(tracker.time(), 3);
}

TEST(Step, RefusesBadOptionsAndParticles) {
  NpOptions options = bilinear();
  options.error_correlation = 1.5;
  EXPECT_THROW(Tracker(options, particles_at({middle}), 0), InputError);
  ParticleSet set = particles_at({middle});
  set.end.clear();
  EXPECT_THROW(Tracker({}, set, 0), InputError);
  EXPECT_THROW(Tracker({}, particles_at({{std::nan(""), 0}}), 0), InputError);
}

}  // namespace
}  // namespace pivnp::np
