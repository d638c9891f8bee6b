// Sand that slides over its toe and is laid down on the base. Rows of low strain there are rows in which finite shear has
// turned round: first the face leans forward, then it is rolled under, and where the second shear has undone the first
// the stretches are equal once more. Criteria: the deformation gradient that points carry is that of their neighbours'
// paths, its logarithmic deviator within 5 % in the mean from a cell and a half above the base to four; the row of least
// strain is within a cell and a half of the base, on both meshes (so it is as thin as the layer that a mesh can shear), and
// the neighbours' paths have it, too. What is added up along the path (the measure strain_dev_path), both shears, has no such row: it
// is alike within 10 % above and below.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

double stretch_of(const Mat2& F) {  // difference of the principal logarithmic strains
  const double sum = 0.5 * F.squaredNorm(), J = F.determinant();
  return std::acosh(std::max(1.0, sum / std::abs(J)));
}

struct Row {
  double carried = 0, by_neighbours = 0, along_path = 0, points = 0;
};

/// Rows of half a cell over the base, of the sand that was laid down between x of `from` and `to`.
std::vector<Row> rows_of_toe(double h, double from, double to) {
  Scene s = scene(Grid{{0, 0}, {h, h}, int(std::lround(0.6 / h)) + 1, int(std::lround(0.27 / h)) + 1},
                  {{"sand", Polygon({{0, 0}, {0.33, 0}, {0.186, 0.25}, {0, 0.25}}, "sand")}}, {sand(43)});
  s.boundaries = {{"base", line({0, 0}, {0.6, 0}, "fixed")}, {"left", line({0, 0}, {0, 0.27}, "roller")}};
  MpmOptions o = options({0, -9.81});
  o.transfer = TransferKind::apic;  // whose friction leaves a toe that turned round once; without it shear goes on
  o.courant = 0.4;  // twice as long steps leave the rows a little more alike
  Solver solver(o, s, 1);
  const auto gradient = [](const MotionFrame& f, std::size_t k) { return Mat2{{double(f.F[k][0]), double(f.F[k][1])}, {double(f.F[k][2]), double(f.F[k][3])}}; };
  std::vector<double> along_path(s.particles.size(), 0.0);
  MotionFrame frame = solver.frame();
  for (int step = 1; step <= 26; ++step) {
    solver.advance_to(0.02 * step, silent);
    const MotionFrame next = solver.frame();
    for (std::size_t k = 0; k < along_path.size(); ++k) along_path[k] += stretch_of(Mat2(gradient(next, k) * gradient(frame, k).inverse()));
    frame = next;
  }
  const std::vector<Vec2>& x0 = s.particles.x0;
  const auto now = [&](std::size_t k) { return Vec2(x0[k] + Vec2(double(frame.u[k][0]), double(frame.u[k][1]))); };
  std::vector<Row> rows(8);
  for (std::size_t k = 0; k < x0.size(); ++k) {
    const Vec2 x = now(k);
    const auto row = std::size_t(x.y() / (h / 2));
    if (x.x() < from || x.x() > to || x.y() < 0 || row >= rows.size()) continue;
    Mat2 before = Mat2::Zero(), after = Mat2::Zero();
    for (std::size_t j = 0; j < x0.size(); ++j) {
      const Vec2 d = x0[j] - x0[k];
      if (j == k || d.norm() > 0.8 * h) continue;
      before += d * d.transpose();
      after += (now(j) - x) * d.transpose();
    }
    rows[row].carried += stretch_of(gradient(frame, k));
    rows[row].along_path += along_path[k];
    rows[row].by_neighbours += stretch_of(after * before.inverse());
    rows[row].points += 1;
  }
  for (Row& r : rows) {
    if (r.points == 0) continue;
    r.carried /= r.points;
    r.by_neighbours /= r.points;
    r.along_path /= r.points;
  }
  return rows;
}

TEST(MpmToe, RowsOfLowStrainAreWhereFiniteShearHasTurnedRound) {
  for (const double h : {0.0075, 0.00375}) {
    const std::vector<Row> rows = rows_of_toe(h, 0.38, 0.43);
    double carried = 0, by_neighbours = 0;
    for (std::size_t r = 1; r < rows.size(); ++r) {  // (nothing comes closer to the base than half a cell)
      ASSERT_GT(rows[r].points, 5);
      std::printf("cells of %.2f mm, %.1f to %.1f cells over the base: %.2f carried, %.2f by neighbours, %.2f along the path (%.0f points)\n",
                  1e3 * h, 0.5 * double(r), 0.5 * double(r + 1), rows[r].carried, rows[r].by_neighbours, rows[r].along_path, rows[r].points);
      if (r < 3) continue;
      carried += rows[r].carried / 5;
      by_neighbours += rows[r].by_neighbours / 5;
    }
    EXPECT_NEAR(carried, by_neighbours, 0.05 * by_neighbours);
    const double least = std::min(rows[1].carried, rows[2].carried), least_path = std::min(rows[1].by_neighbours, rows[2].by_neighbours);
    EXPECT_LT(least, 0.7 * rows[5].carried);
    EXPECT_LT(least_path, 0.7 * rows[5].by_neighbours);
    for (const std::size_t r : {1u, 2u}) EXPECT_NEAR(rows[r].along_path, rows[5].along_path, 0.1 * rows[5].along_path);
    pivnp::test::verification_row("sand laid down at a toe, cells of " + number(1e3 * h) + " mm",
                                  "strain carried over that of the neighbours' paths within 5 %, 1.5 to 4 cells over the base",
                                  number(carried / by_neighbours, 4));
  }
}

}  // namespace
}  // namespace pivnp::mpm
