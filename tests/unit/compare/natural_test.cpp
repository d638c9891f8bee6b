// Natural neighbours between scattered particles: weights, displacements and strain read by them.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

#include "compare/alignment/partners.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/compare/motions.hpp"
#include "tests/unit/compare/scattered.hpp"

namespace pivnp::compare {
namespace {

TEST(NaturalNeighbours, WeightsReproduceThePoint) {
  const unsigned seed = 20261121;
  SCOPED_TRACE(seed);
  for (const std::vector<Vec2>& points : {jittered(seed), square_lattice(10, 10, 1)}) {
    const MaterialMesh mesh(points, std::vector<double>(points.size(), 1));
    std::mt19937 random(seed + 1);
    std::uniform_real_distribution<double> place(0.5, 9.5);
    int inside = 0, more_than_three = 0;
    for (int k = 0; k < 2000; ++k) {
      const Vec2 x(place(random), place(random));
      const auto found = mesh.find_natural(x);
      if (!found) continue;
      Vec2 sum = found->beyond;
      double total = 0;
      for (const Natural::Share& s : found->shares) {
        EXPECT_GT(s.weight, 0);
        total += s.weight;
        sum += s.weight * points[std::size_t(s.point)];
      }
      EXPECT_NEAR(total, 1, 1e-12);
      EXPECT_NEAR((sum - x).norm(), 0, 1e-9);
      ++inside;
      more_than_three += found->shares.size() > 3;
    }
    EXPECT_GT(inside, 1800);
    EXPECT_GT(more_than_three, inside / 2);
  }
}

// Worked by hand: at the middle of a square each corner gives up a quarter of the new cell; the corners of the squares
// around touch it at most.
TEST(NaturalNeighbours, TheMiddleOfASquareBelongsToItsCornersAlike) {
  const std::vector<Vec2> points = square_lattice(6, 6, 1);
  const MaterialMesh mesh(points, std::vector<double>(points.size(), 1));
  const auto middle = mesh.find_natural(Vec2(3, 3));
  ASSERT_TRUE(middle);
  const std::vector<double> w = dense(*middle, points.size());
  for (const std::size_t corner : {14U, 15U, 20U, 21U}) EXPECT_NEAR(w[corner], 0.25, 1e-12);
  // On a particle: that particle alone.
  const auto at = mesh.find_natural(points[14]);
  ASSERT_TRUE(at);
  EXPECT_NEAR(dense(*at, points.size())[14], 1, 1e-12);
}

// The weight on a particle is the share of the new Voronoi cell that was nearest to it: counted on a fine raster.
TEST(NaturalNeighbours, WeightsAreTheAreasTakenFromTheVoronoiCells) {
  const unsigned seed = 7;
  const std::vector<Vec2> points = jittered(seed);
  const MaterialMesh mesh(points, std::vector<double>(points.size(), 1));
  for (const Vec2& x : {Vec2(4.3, 5.1), Vec2(6.05, 3.4), Vec2(5.5, 6.72)}) {
    const auto found = mesh.find_natural(x);
    ASSERT_TRUE(found);
    std::vector<double> counted(points.size(), 0.0);
    double all = 0;
    constexpr int n = 400;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const Vec2 y = x + Vec2(4.0 * (i + 0.5) / n - 2, 4.0 * (j + 0.5) / n - 2);
        std::size_t nearest = 0;
        for (std::size_t p = 1; p < points.size(); ++p)
          if ((points[p] - y).squaredNorm() < (points[nearest] - y).squaredNorm()) nearest = p;
        if ((points[nearest] - y).squaredNorm() < (x - y).squaredNorm()) continue;
        counted[nearest] += 1;
        all += 1;
      }
    const std::vector<double> w = dense(*found, points.size());
    for (std::size_t p = 0; p < points.size(); ++p) EXPECT_NEAR(w[p], counted[p] / all, 0.01) << p;
  }
}

// Displacements between particles, by the sum of natural neighbours and their own gradients: exact to the second
// degree, and far closer on a wave than triangles without gradients.
TEST(NaturalNeighbours, WithGradientsAreExactToTheSecondDegree) {
  const std::vector<Vec2> points = jittered(11);
  const MaterialMesh mesh(points, std::vector<double>(points.size(), 1));
  const auto u = [](const Vec2& x) {
    return Vec2(0.1 * x.x() * x.x() - 0.03 * x.x() * x.y(), 0.2 * x.y() * x.y() + x.x());
  };
  const auto wave = [](const Vec2& x) { return Vec2(std::sin(0.7 * x.x() + 0.4 * x.y()), 0); };
  DataSetState second, third;
  for (const Vec2& x : points) {
    second.u.push_back(u(x));
    Mat2 G;
    G << 0.2 * x.x() - 0.03 * x.y(), -0.03 * x.x(), 1, 0.4 * x.y();
    second.F.push_back(Mat2::Identity() + G);
    third.u.push_back(wave(x));
    const double slope = std::cos(0.7 * x.x() + 0.4 * x.y());
    G << 0.7 * slope, 0.4 * slope, 0, 0;
    third.F.push_back(Mat2::Identity() + G);
  }
  double natural = 0, linear = 0;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      const Vec2 x(1.5 + 0.1771 * i, 1.5 + 0.1713 * j);
      const auto a = mesh.find_natural(x);
      const auto b = mesh.find(x);
      ASSERT_TRUE(a && b);
      EXPECT_LT((partner_state(*a, second).u - u(x)).norm(), 1e-8);
      Vec2 plain = Vec2::Zero();
      for (std::size_t k = 0; k < 3; ++k) plain += b->weight[k] * third.u[std::size_t(b->vertex[k])];
      natural += (partner_state(*a, third).u - wave(x)).squaredNorm();
      linear += (plain - wave(x)).squaredNorm();
    }
  EXPECT_LT(natural, 0.1 * linear);
}

// Deformation gradients likewise: exact to the second degree up to the edge, whatever the lattice.
TEST(NaturalNeighbours, StrainIsExactToTheSecondDegree) {
  for (const std::vector<Vec2>& points : {jittered(11), square_lattice(10, 10, 1)}) {
    const MaterialMesh mesh(points, std::vector<double>(points.size(), 1));
    const auto F = [](const Vec2& x) {
      Mat2 f;
      f << 1 + 0.01 * x.x() * x.x() - 0.004 * x.x() * x.y(), 0.1, 0.02 * x.y() * x.y(), 1 + 0.003 * x.y();
      return f;
    };
    DataSetState state;
    for (const Vec2& x : points) {
      state.u.push_back(Vec2::Zero());
      state.F.push_back(F(x));
    }
    int read = 0;
    for (double px = 0.2; px < 10; px += 0.131)
      for (double py = 0.2; py < 10; py += 0.177) {
        const auto place = mesh.find_natural(Vec2(px, py));
        if (!place || place->curving.empty()) continue;
        const Vec2 x = Vec2(px, py) - place->beyond;
        EXPECT_LT((partner_state(*place, state).F - F(x)).norm(), 1e-5) << x.transpose();
        ++read;
      }
    EXPECT_GT(read, 3500);
  }
}

// A row of particles, or two, holds no gradient: F is then read linearly, not wrongly. Nor is it carried over a jump to
// where no material would be left.
TEST(NaturalNeighbours, StrainIsReadLinearlyWhereItMustBe) {
  DataSetState state;
  const std::vector<Vec2> rows = square_lattice(8, 2, 1);
  for (const Vec2& x : rows) {
    state.u.push_back(Vec2::Zero());
    state.F.push_back(Vec2(1 + 0.1 * x.x(), 1).asDiagonal().toDenseMatrix());
  }
  const auto place = MaterialMesh(rows, std::vector<double>(rows.size(), 1)).find_natural(Vec2(3.2, 1.1));
  ASSERT_TRUE(place);
  EXPECT_TRUE(place->curving.empty());
  EXPECT_NEAR(partner_state(*place, state).F(0, 0), 1.32, 1e-9);

  const std::vector<Vec2> block = square_lattice(9, 9, 1);
  DataSetState jump;
  for (const Vec2& x : block) {
    jump.u.push_back(Vec2::Zero());
    jump.F.push_back(Vec2(x.x() < 4 ? 0.01 : 3, 1).asDiagonal().toDenseMatrix());
  }
  const MaterialMesh mesh(block, std::vector<double>(block.size(), 1));
  for (double x = 1; x < 8; x += 0.1)
    EXPECT_GE(partner_state(mesh.find_natural(Vec2(x, 4.7)).value(), jump).F.determinant(), 0) << x;
}

// Criterion: a strain error keeps at least 95 % of its size, here one that is a wave of eight spacings of the second,
// read where the first's particles are; and the noise of F is not amplified by reading it.
TEST(NaturalNeighbours, AWaveOfStrainIsKept) {
  for (const bool regular : {true, false}) {
    std::vector<Vec2> points = regular ? square_lattice(30, 30, 1) : std::vector<Vec2>();
    if (!regular)
      for (const Vec2& x : jittered(5))
        for (int k = 0; k < 9; ++k) points.push_back(x + Vec2(10 * (k % 3), 10 * (k / 3)));
    const MaterialMesh mesh(points, std::vector<double>(points.size(), 1));
    double noise = 0, read = 0;
    std::string kept_text;
    for (const double length : {8.0, 6.0, 4.0}) {
      const double k = 2 * std::numbers::pi / length;
      const auto wave = [&](const Vec2& x) { return std::cos(k * (0.8 * x.x() + 0.6 * x.y())); };
      DataSetState state;
      for (const Vec2& x : points) {
        state.u.push_back(Vec2::Zero());
        state.F.push_back(Vec2(1 + 0.01 * wave(x), 1).asDiagonal().toDenseMatrix());
      }
      double kept = 0, whole = 0;
      for (double px = 4; px < 26; px += 0.217)
        for (double py = 4; py < 26; py += 0.253) {
          const auto place = mesh.find_natural(Vec2(px, py));
          ASSERT_TRUE(place);
          kept += wave(Vec2(px, py)) * (partner_state(*place, state).F(0, 0) - 1) / 0.01;
          whole += wave(Vec2(px, py)) * wave(Vec2(px, py));
          if (length < 8) continue;
          std::vector<double> w = dense(*place, points.size());
          for (const Natural::Term& t : place->curving) w[std::size_t(t.point)] += t.weight;
          for (const double v : w) noise += v * v;
          ++read;
        }
      kept_text += (kept_text.empty() ? "" : ", ") + number(100 * kept / whole, 3) + " % (" + number(length) + ")";
      EXPECT_GT(kept / whole, length == 8 ? 0.97 : length == 6 ? 0.95 : 0.85) << "regular " << regular;
      EXPECT_LT(kept / whole, 1.02);
    }
    EXPECT_LT(noise / read, 1);
    test::verification_row(
        std::string("strain wave of 8, 6, 4 spacings between particles, ") + (regular ? "lattice" : "scattered"),
        "at least 95 % of its size at 8", kept_text + "; noise of F kept " + number(std::sqrt(noise / read), 3));
  }
}

// No share of a particle on the other side of a gap, and nothing beyond half a spacing from the edge.
TEST(NaturalNeighbours, DoNotReachOverAGap) {
  std::vector<Vec2> points;
  for (const Vec2& x : square_lattice(12, 6, 1))
    if (x.x() < 6 || x.x() > 8.2) points.push_back(x);  // columns 6.5 and 7.5 are missing
  const MaterialMesh mesh(points, std::vector<double>(points.size(), 1));
  EXPECT_FALSE(mesh.find_natural(Vec2(7, 3.2)));
  for (double y = 0.6; y < 5.5; y += 0.13)
    for (double x = 4.6; x < 6; x += 0.07) {
      const auto found = mesh.find_natural(Vec2(x, y));
      ASSERT_TRUE(found) << x << ' ' << y;
      for (const Natural::Share& s : found->shares) EXPECT_LT(points[std::size_t(s.point)].x(), 6);
    }
}

}  // namespace
}  // namespace pivnp::compare
