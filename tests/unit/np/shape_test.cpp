// Shape functions of every kind: what they repeat exactly, their measured order, lost nodes, both anchors.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <random>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/np/triangle_gather.hpp"
#include "tests/support/verification.hpp"
#include "tests/verification/np_testing.hpp"

namespace pivnp::np {
namespace {

using namespace testing;

struct Shape {
  ShapeFunctions shape;
  int degree;           // of the polynomials it repeats: values of order degree + 1, gradients of order degree
  bool tensor = true;   // all products x^a y^b, a, b <= degree; else total degree
};
const std::vector<Shape> shapes = {{ShapeFunctions::bilinear, 1}, {ShapeFunctions::quadratic, 2},
                                   {ShapeFunctions::cubic, 3},    {ShapeFunctions::bspline2, 2},
                                   {ShapeFunctions::bspline3, 3}, {ShapeFunctions::triangles, 1, false}};

NpOptions with(ShapeFunctions shape, GradientPlace gradient = GradientPlace::particle) {
  NpOptions options;
  options.shape = shape;
  options.gradient = gradient;
  return options;
}

using Field = std::function<Vec2(const Vec2&)>;

NodalIncrements sampled(const Field& d, const Grid& grid, Anchor anchor) {
  NodalIncrements out;
  out.anchor = anchor;
  out.grid = grid;
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      const Vec2 v = d(grid.position(i, j));
      out.displacement.push_back({v.x(), v.y()});
    }
  out.status.assign(grid.node_count(), VectorStatus::valid);
  return out;
}

Mat2 numeric_gradient(const Field& d, const Vec2& x) {
  constexpr double h = 1e-5;
  Mat2 G;
  G.col(0) = (d(x + Vec2(h, 0)) - d(x - Vec2(h, 0))) / (2 * h);
  G.col(1) = (d(x + Vec2(0, h)) - d(x - Vec2(0, h))) / (2 * h);
  return G;
}

// 18 x 14 cells: no multiple of 2 and 3 along y, so that the last group of cells is moved back.
TEST(Shapes, RepeatThePolynomialsOfTheirDegreeUpToTheBorder) {
  const Grid grid{{-1, 2}, {0.5, 0.25}, 18, 14};
  std::mt19937 random(3);
  RecordProperty("seed", 3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const Shape& shape : shapes) {
    const auto power = [&](double v, int n) { return std::pow(v, n); };
    const Field d = [&](const Vec2& x) {
      const double a = (x.x() + 1) / 8.5, b = (x.y() - 2) / 3.25;
      const double cross = shape.tensor ? power(a, shape.degree) * power(b, shape.degree) : 0;
      return Vec2(0.1 + 0.05 * power(a, shape.degree) - 0.03 * b + 0.02 * cross,
                  -0.05 + 0.04 * power(b, shape.degree) + 0.02 * a - 0.01 * cross);
    };
    for (const Anchor anchor : {Anchor::forward, Anchor::central}) {
      std::vector<Vec2> places;
      for (int k = 0; k < 400; ++k)
        places.push_back(grid.origin + (grid.upper() - grid.origin).cwiseProduct(Vec2(unit(random), unit(random))));
      places.push_back(grid.position(3, 5));
      places.push_back(grid.origin);
      Tracker tracker(with(shape.shape), particles_at(places), 0);
      tracker.step(sampled(d, grid, anchor), 1);
      std::size_t followed = 0;
      for (std::size_t p = 0; p < places.size(); ++p) {
        const auto now = tracker.state()[p];
        if (now.status == ParticleStatus::ended) continue;  // its mid-point is outside
        ++followed;
        EXPECT_EQ(now.status, ParticleStatus::active);
        const Vec2 at = anchor == Anchor::central ? Vec2((places[p] + now.x) / 2) : places[p];
        EXPECT_LT((now.x - places[p] - d(at)).norm(), 3e-14) << name_of(shape.shape) << " " << p;
        const Mat2 G = numeric_gradient(d, at), half = G / 2;
        const Mat2 left = anchor == Anchor::central ? Mat2((Mat2::Identity() - half) * now.F - Mat2::Identity() - half)
                                                    : Mat2(now.F - Mat2::Identity() - G);
        EXPECT_LT(left.norm(), 2e-9) << name_of(shape.shape) << " " << p;
      }
      EXPECT_GT(followed, 380u);
    }
  }
}

TEST(Shapes, MeasuredOrderOnASmoothField) {
  const Field d = [](const Vec2& x) {
    return Vec2(0.02 * std::sin(5 * x.x() + 1) * std::cos(4 * x.y()), 0.02 * std::cos(3 * x.x()) * std::sin(6 * x.y() + 2));
  };
  const Grid coarse{{0.05, 0.05}, {0.0301, 0.0299}, 31, 31};
  const ParticleSet cloud = block(coarse, {0.05, 0.05}, {0.95, 0.945}, 1);
  for (const Shape& shape : shapes)
    for (const Anchor anchor : {Anchor::forward, Anchor::central}) {
      std::vector<double> place, gradient;
      for (const int cells : {18, 36, 72}) {
        const Grid grid{{0, 0}, {1.0 / cells, 1.0 / cells}, cells + 1, cells + 1};
        Tracker tracker(with(shape.shape), cloud, 0);
        tracker.step(sampled(d, grid, anchor), 1);
        double sum = 0, sum_F = 0;
        for (std::size_t p = 0; p < cloud.size(); ++p) {
          const Vec2& X = cloud.x0[p];
          Vec2 at = X;
          if (anchor == Anchor::central)
            for (int k = 0; k < 60; ++k) at = X + 0.5 * d(at);
          const Mat2 G = numeric_gradient(d, at);
          const Mat2 A = Mat2::Identity() - G / 2, B = Mat2::Identity() + G / 2;
          const auto now = tracker.state()[p];
          sum += (now.x - X - d(at)).squaredNorm();
          sum_F += anchor == Anchor::central ? (A * now.F - B).squaredNorm() : (now.F - Mat2::Identity() - G).squaredNorm();
        }
        place.push_back(std::sqrt(sum / double(cloud.size())));
        gradient.push_back(std::sqrt(sum_F / double(cloud.size())));
      }
      const double order = std::log2(place[0] / place[2]) / 2, order_F = std::log2(gradient[0] / gradient[2]) / 2;
      std::printf("%-9s %-7s place %.2e -> %.2e (order %.2f), gradient %.2e -> %.2e (order %.2f)\n", std::string(name_of(shape.shape)).c_str(),
                  anchor == Anchor::central ? "central" : "forward", place[0], place[2], order, gradient[0], gradient[2],
                  order_F);
      EXPECT_GT(order, shape.degree + 1 - 0.15) << name_of(shape.shape);
      EXPECT_GT(order_F, shape.degree - 0.15) << name_of(shape.shape);
      pivnp::test::verification_row("shape functions, " + std::string(name_of(shape.shape)),
                                    "order at least " + std::to_string(shape.degree + 1) + " in place, " +
                                        std::to_string(shape.degree) + " in the gradient (less .15)",
                                    number(order, 3) + ", " + number(order_F, 3));
    }
}

TEST(Shapes, AtTheElementsCentreTheGradientGainsAnOrder) {
  // One particle in the middle of each cell reads the same either way; elsewhere only the centre does.
  const Field d = [](const Vec2& x) { return Vec2(0.02 * std::sin(5 * x.x()) * std::cos(4 * x.y()), 0); };
  std::vector<double> worst;
  for (const int cells : {20, 40}) {
    const Grid grid{{0, 0}, {1.0 / cells, 1.0 / cells}, cells + 1, cells + 1};
    const ParticleSet set = block(grid, {0.1, 0.1}, {0.9, 0.9}, 1);
    Tracker tracker(with(ShapeFunctions::bilinear, GradientPlace::element), set, 0);
    tracker.step(sampled(d, grid, Anchor::forward), 1);
    double most = 0;
    for (std::size_t p = 0; p < set.size(); ++p)
      most = std::max(most, (tracker.state()[p].F - Mat2::Identity() - numeric_gradient(d, set.x0[p])).norm());
    worst.push_back(most);
  }
  EXPECT_GT(std::log2(worst[0] / worst[1]), 1.9);
  for (const Shape& shape : shapes) {  // the option is heard by all of them, and moves no particle
    const Grid grid{{0, 0}, {0.1, 0.1}, 13, 13};
    const ParticleSet set = particles_at({{0.512, 0.533}, {0.71, 0.44}});
    Tracker a(with(shape.shape), set, 0), b(with(shape.shape, GradientPlace::element), set, 0);
    a.step(sampled(d, grid, Anchor::central), 1);
    b.step(sampled(d, grid, Anchor::central), 1);
    EXPECT_LT((a.state()[0].x - b.state()[0].x).norm(), 1e-13) << name_of(shape.shape);
    if (shape.tensor) {
      EXPECT_GT((a.state()[0].F - b.state()[0].F).norm(), 1e-6) << name_of(shape.shape);
    }
  }
}

TEST(Shapes, LostNodesLeaveAffineMotionExactAndTheRestAlone) {
  const AffineMotion motion([](double t) {
    AffineMap map;
    map.A << 1 + 0.04 * t, 0.03 * t, -0.02 * t, 1 - 0.01 * t;
    return map;
  });
  const Grid grid{{-3, -3}, {0.5, 0.5}, 14, 14};
  for (const Shape& shape : shapes)
    for (const Anchor anchor : {Anchor::forward, Anchor::central}) {
      NodalIncrements d = sample_increments(motion, grid, anchor, 0, 1);
      for (const auto& [i, j] : {std::pair{6, 6}, {7, 6}, {2, 10}, {0, 0}}) {
        d.status[grid.node(i, j)] = VectorStatus::rejected;
        d.displacement[grid.node(i, j)] = {50, -70};  // must not be read
      }
      d.status[grid.node(10, 3)] = VectorStatus::replaced;
      Tracker tracker(with(shape.shape), block(grid, {-2.5, -2.5}, {3, 3}, 4), 0);
      tracker.step(d, 1);
      std::size_t flagged = 0;
      for (std::size_t p = 0; p < tracker.state().size(); ++p) {
        const auto now = tracker.state()[p];
        const Vec2& X = tracker.particles().x0[p];
        ASSERT_NE(now.status, ParticleStatus::ended) << name_of(shape.shape);
        flagged += now.status == ParticleStatus::flagged;
        EXPECT_LT((now.x - motion.position(X, 1)).norm(), 1e-12) << name_of(shape.shape);
        EXPECT_LT((now.F - motion.deformation(X, 1)).norm(), 1e-11) << name_of(shape.shape);
      }
      EXPECT_GT(flagged, 20u);
      EXPECT_LT(flagged, tracker.state().size() / 2);
    }
}

TEST(Shapes, AGridTooSmallForTheShapeIsReadBilinearly) {
  const Grid grid{{0, 0}, {1, 1}, 2, 2};
  const AffineMotion shear = AffineMotion::shear(0.1, 0);
  for (const Shape& shape : shapes) {
    Tracker tracker(with(shape.shape), particles_at({{0.3, 0.6}}), 0);
    tracker.step(sample_increments(shear, grid, Anchor::forward, 0, 1), 1);
    EXPECT_NEAR(tracker.state()[0].x.x(), 0.36, 1e-15) << name_of(shape.shape);
  }
}

TEST(Shapes, CovarianceOfAllIsABound) {
  constexpr int runs = 200;  // which know a variance to 10 %
  const Grid grid{{0, 0}, {1, 1}, 12, 12};
  const std::vector<Vec2> places = {{5.3, 5.4}, {0.2, 0.1}, {5, 6}, {10.9, 3.5}};
  std::mt19937 random(11);
  RecordProperty("seed", 11);
  std::normal_distribution<double> normal(0, 0.01);
  for (const Shape& shape : shapes) {
    NodalIncrements d = sampled([](const Vec2&) { return Vec2(0, 0); }, grid, Anchor::forward);
    d.cov.assign(grid.node_count(), {1e-4f, 1e-4f, 0});
    std::vector<double> seen(places.size(), 0), claimed(places.size(), 0);
    for (int n = 0; n < runs; ++n) {
      for (auto& v : d.displacement) v = {normal(random), normal(random)};
      Tracker tracker(with(shape.shape), particles_at(places), 0);
      tracker.step(d, 1);
      for (std::size_t p = 0; p < places.size(); ++p) {
        seen[p] += (tracker.state()[p].x - places[p]).squaredNorm() / 2 / runs;
        claimed[p] = tracker.state()[p].cov[0];
      }
    }
    for (std::size_t p = 0; p < places.size(); ++p) {
      EXPECT_LT(seen[p], 1.3 * claimed[p]) << name_of(shape.shape) << " " << p;
      EXPECT_LT(claimed[p], 20 * seen[p]) << name_of(shape.shape) << " " << p;
    }
  }
}

TEST(Scattered, RandomNodesFollowAnAffineMotionExactlyAndSmoothOnesToSecondOrder) {
  std::mt19937 random(21);
  RecordProperty("seed", 21);
  std::uniform_real_distribution<double> unit(0, 1);
  const AffineMotion motion = AffineMotion::rotation(0.2, {0.5, 0.5}, {0.02, 0});
  const Field smooth = [](const Vec2& x) { return Vec2(0.02 * std::sin(4 * x.x()) * std::cos(3 * x.y()), 0.01 * x.x()); };
  std::vector<double> error;
  for (const int count : {400, 6400}) {
    Scattered nodes, wave;
    for (int k = 0; k < count; ++k) nodes.place.emplace_back(unit(random), unit(random));
    nodes.status.assign(nodes.place.size(), VectorStatus::valid);
    nodes.place.push_back({0.5, 0.5});
    nodes.status.push_back(VectorStatus::rejected);
    wave = nodes;
    for (const Anchor anchor : {Anchor::forward, Anchor::central}) {
      nodes.anchor = anchor;
      nodes.displacement.clear();
      for (const Vec2& x : nodes.place) {
        const Vec2 d = anchor == Anchor::central ? motion.central_increment(x, 0, 1) : motion.forward_increment(x, 0, 1);
        nodes.displacement.push_back({d.x(), d.y()});
      }
      nodes.displacement.back() = {9, 9};
      Tracker tracker({}, particles_at({{0.5, 0.5}, {0.31, 0.62}, {0.7, 0.4}, {5, 5}}), 0);
      tracker.step(nodes, 1, 1, 1);
      for (std::size_t p = 0; p < 3; ++p) {
        EXPECT_LT((tracker.state()[p].x - motion.position(tracker.particles().x0[p], 1)).norm(), 1e-13);
        EXPECT_LT((tracker.state()[p].F - motion.deformation({0, 0}, 1)).norm(), 1e-10);
      }
      EXPECT_EQ(tracker.particles().end_reason[3], EndReason::no_vectors);
    }
    for (const Vec2& x : wave.place) wave.displacement.push_back({smooth(x).x(), smooth(x).y()});
    wave.anchor = Anchor::forward;
    std::vector<Vec2> places;
    for (int k = 0; k < 500; ++k) places.emplace_back(0.15 + 0.7 * unit(random), 0.15 + 0.7 * unit(random));
    Tracker tracker({}, particles_at(places), 0);
    tracker.step(wave, 1, 1, 1);
    double sum = 0;
    for (std::size_t p = 0; p < places.size(); ++p)
      sum += (tracker.state()[p].x - places[p] - smooth(places[p])).squaredNorm() / double(places.size());
    error.push_back(std::sqrt(sum));
  }
  EXPECT_GT(std::log2(error[0] / error[1]) / 2, 1.8);  // 16 times the nodes: a quarter of the spacing
}

TEST(Scattered, LongTrianglesAreFlaggedOrHoldNothing) {
  Scattered nodes;
  for (const Vec2& x : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1), Vec2(1, 1), Vec2(4, 0.5)}) nodes.place.push_back(x);
  nodes.displacement.assign(5, {0.1, 0});
  nodes.status.assign(5, VectorStatus::valid);
  nodes.anchor = Anchor::forward;
  const std::vector<Vec2> places = {{0.4, 0.3}, {2, 0.5}};
  Tracker bridged({}, particles_at(places), 0), cut({}, particles_at(places), 0);
  bridged.step(nodes, 1.5, 10, 1);
  EXPECT_EQ(bridged.state()[0].status, ParticleStatus::active);
  EXPECT_EQ(bridged.state()[1].status, ParticleStatus::flagged);
  cut.step(nodes, 1.5, 2, 1);
  EXPECT_EQ(cut.state()[0].status, ParticleStatus::active);
  EXPECT_EQ(cut.particles().end_reason[1], EndReason::no_vectors);
  nodes.cov.resize(2);
  EXPECT_THROW(cut.step(nodes, 1.5, 2, 2), InputError);
}

}  // namespace
}  // namespace pivnp::np
