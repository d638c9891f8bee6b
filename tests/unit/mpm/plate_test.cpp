// Rigid plates and circles meet the material at its face.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr double plate_cell = 0.01, column_height = 0.16;

// A plate of no friction above a column between smooth walls, so many cells above it; it goes down by so many and stops.
Scene plate_on_column(double above, double travel, double speed) {
  MaterialOptions m = elastic(1e6, 0, 1000);
  m.model = "neo_hookean";
  Scene s = scene(Grid{{0, 0}, {plate_cell, plate_cell}, 5, 22}, {rectangle("soil", 0, 0, 0.04, column_height)}, {m});
  s.boundaries = {{"base", line({0, 0}, {0.04, 0}, "fixed")},
                  {"left", line({0, 0}, {0, 0.21}, "roller")},
                  {"right", line({0.04, 0}, {0.04, 0.21}, "roller")}};
  RigidOptions plate;
  const double low = column_height + above * plate_cell;
  plate.polygon_m = {{-0.02, low}, {0.06, low}, {0.06, low + 0.025}, {-0.02, low + 0.025}};
  plate.velocity_m_s = {0, -speed};
  plate.until_s = (above + travel) * plate_cell / speed;
  plate.friction = 0;
  s.bodies = {{"plate", plate}};
  return s;
}

struct PlateRun {
  double lost;                 // cells between the plate's face and the column's
  double least = 1e9, most = 0;  // stress of the rows but for those at the base, over that of the strain
  EnergyRow energy;
};

PlateRun run_plate(ShapeKind shape, double above, double travel, double speed) {
  Scene s = plate_on_column(above, travel, speed);
  MpmOptions o = options();
  o.shape = shape;
  o.damping = 0.05;
  if (shape == ShapeKind::bilinear) o.transfer = TransferKind::flip, o.stress_update = StressUpdate::musl;
  o.end_at_rest = false;
  Solver solver(o, s, 1);
  solver.advance_to(*s.bodies[0].second.until_s + 0.3, silent);
  const MotionFrame frame = solver.frame();
  const auto top = [&] {
    double sum = 0, n = 0;
    for (std::size_t k = 0; k < frame.u.size(); ++k) {
      const double y = solver.particles().x0[k].y();
      if (y > column_height - 0.5 * plate_cell) sum += y + double(frame.u[k][1]) + 0.25 * plate_cell * double(frame.F[k][3]), ++n;
    }
    return sum / n;
  };
  PlateRun out;
  const double now = column_height - travel * plate_cell, F = now / column_height, exact = 0.5e6 * (F - 1 / F);  // of neo_hookean
  out.lost = std::abs(top() - now) / plate_cell;
  for (double y = 0.25 * column_height; y < column_height; y += 0.5 * plate_cell) {
    const double q = mean_stress(solver, 1, y + 0.5 * plate_cell, y) / exact;
    out.least = std::min(out.least, q);
    out.most = std::max(out.most, q);
  }
  out.energy = solver.energy();
  return out;
}

TEST(Plates, AColumnLosesNothingUnderAPlate) {
  for (const ShapeKind shape : {ShapeKind::bspline, ShapeKind::gimp, ShapeKind::bilinear}) {
    const PlateRun found = run_plate(shape, 0, 0.48, 0.01);
    EXPECT_LT(found.lost, 0.02) << int(shape);
    if (shape == ShapeKind::bilinear) continue;  // (its rows alternate where points have crossed cells)
    EXPECT_GT(found.least, 0.97) << int(shape);
    EXPECT_LT(found.most, 1.03) << int(shape);
    EXPECT_LT(std::abs(found.energy.residual), 0.05 * found.energy.external) << int(shape);
  }
}

// From anywhere above the face, and through the places of several nodes (a column pressed by a seventh is an uneven quadrature).
TEST(Plates, ContactBeginsAtTheFaceAndDoesNotDrift) {
  for (const ShapeKind shape : {ShapeKind::bspline, ShapeKind::gimp})
    for (const double above : {0.0, 0.37}) {
      const PlateRun found = run_plate(shape, above, 2.3, 0.05);
      EXPECT_LT(found.lost, 0.02) << int(shape) << " from " << above;
      EXPECT_GT(found.least, 0.92) << int(shape) << " from " << above;
      EXPECT_LT(found.most, 1.05) << int(shape) << " from " << above;
      EXPECT_LT(std::abs(found.energy.residual), 0.03 * found.energy.external) << int(shape) << " from " << above;
    }
}

// A smooth circle (a sphere on the axis) of so many cells' radius goes down from a cell above elastic ground; its force a metre (a radian)
// at travels of so many radii.
std::vector<double> pressed_by_circle(double cells, const std::vector<double>& travels, bool sphere = false) {
  constexpr double radius = 0.04, face = 0.12, speed = 0.2;
  const double h = radius / cells, wide = sphere ? 0.12 : 0.24;
  Scene s = scene(Grid{{0, 0}, {h, h}, int(std::lround(wide / h)) + 1, int(std::lround(0.24 / h)) + 1},
                  {rectangle("soil", 0, 0, wide, face)}, {elastic(1e6, 0.3, 1000)});
  s.boundaries = {{"base", line({0, 0}, {wide, 0}, "fixed")}, {"right", line({wide, 0}, {wide, 0.24}, "roller")}};
  if (!sphere) s.boundaries.push_back({"left", line({0, 0}, {0, 0.24}, "roller")});
  RigidOptions circle;
  circle.circle_m = {sphere ? 0 : 0.12, face + radius + h, radius};
  circle.velocity_m_s = {0, -speed};
  circle.friction = 0;
  s.bodies = {{"circle", circle}};
  MpmOptions o = options();
  if (sphere) o.geometry = Geometry::axisymmetric;
  o.initial_equilibrium = false;
  o.end_at_rest = false;
  Solver solver(o, s, 1);
  std::vector<double> forces;
  for (const double travel : travels) {
    const double middle = (h + travel * radius) / speed, half = 0.01 * radius / speed;
    solver.advance_to(middle - half, silent);
    const double before = solver.body_impulse(0).y();
    solver.advance_to(middle + half, silent);
    forces.push_back((before - solver.body_impulse(0).y()) / (2 * half));
  }
  const EnergyRow e = solver.energy();
  EXPECT_LT(std::abs(e.residual), 5e-3 * e.external) << cells;
  return forces;
}

// Contact begins at the face, and the circle goes in as far on coarse cells as on fine ones: within a fiftieth of the coarse cell, that is
// 0.01, 0.005 radii. (Where nodes have a quarter of a cell's mass it began half a cell too early.)
TEST(Circles, MeetTheFaceWhereItIs) {
  const std::vector<double> travels = {-0.06, -0.03, 0.2, 0.35};
  std::vector<std::vector<double>> found;
  for (const double cells : {4.0, 8.0}) found.push_back(pressed_by_circle(cells, travels));
  for (std::size_t k = 0; k < found.size(); ++k)
    for (const std::size_t early : {0u, 1u}) EXPECT_LT(std::abs(found[k][early]), 1e-3 * std::abs(found[k][3])) << k;
  const double slope = (found[1][3] - found[1][2]) / (travels[3] - travels[2]);  // N/m a radius
  for (const std::size_t at : {2u, 3u}) EXPECT_NEAR(found[0][at], found[1][at], std::abs(slope) * 0.02 / 4) << travels[at];
}

// A sphere on the axis as well, down to the piece beside the axis: it goes in as far within .06 of the coarse cell. (A field that falls
// with the distance from its centre alone found no layer there, and pressed before it touched.)
TEST(Circles, SpheresMeetTheFaceToo) {
  const std::vector<double> travels = {-0.06, -0.03, 0.1, 0.2, 0.28};
  std::vector<std::vector<double>> found;
  for (const double cells : {4.0, 8.0}) found.push_back(pressed_by_circle(cells, travels, true));
  for (std::size_t k = 0; k < found.size(); ++k)
    for (const std::size_t early : {0u, 1u}) EXPECT_LT(std::abs(found[k][early]), 1e-3 * found[k][4]) << k;
  for (const std::size_t at : {2u, 3u, 4u}) {
    const std::size_t to = std::max<std::size_t>(at, 3);
    const double slope = (found[1][to] - found[1][to - 1]) / (travels[to] - travels[to - 1]);  // N a radian and radius
    EXPECT_NEAR(found[0][at], found[1][at], slope * 0.06 / 4) << travels[at];
  }
}

TEST(Plates, BitsDependOnNeitherThreadsNorRestarts) {
  const Scene s = plate_on_column(0.1, 0.4, 0.05);
  Solver one(options(), s, 1), two(options(), s, 2), again(options(), s, 2);
  one.advance_to(0.06, silent);
  again.load(one.save());
  one.advance_to(0.09, silent);
  two.advance_to(0.06, silent);
  two.advance_to(0.09, silent);
  again.advance_to(0.09, silent);
  EXPECT_GT(std::abs(one.body_impulse(0).y()), 0);
  EXPECT_TRUE(one.save() == two.save());
  EXPECT_TRUE(one.save() == again.save());
}

}  // namespace
}  // namespace pivnp::mpm
