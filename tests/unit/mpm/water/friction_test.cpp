// Friction beside water: what rubs on a wall or on other material is the skeleton, by its share of the normal stress.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/silent.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr double tilt = 10 * M_PI / 180, earth = 9.81, ramp_time = 0.05;
// Of acceleration: friction on 4 % of the weight (the strain that drives the pressure is evened out beside a wall).
const double of_weight = 0.04 * 0.25 * earth * std::cos(tilt);

MpmOptions tilting() {
  MpmOptions o = options({earth * std::sin(tilt), -earth * std::cos(tilt)});
  o.gravity_from_m_s2 = Pair{0, -1e-3};
  o.gravity_ramp_s = ramp_time;
  o.initial_equilibrium = false;
  o.end_at_rest = false;
  o.energy_limit = 1e9;
  o.pressure = PressureScheme::in_steps;
  return o;
}

// What is above a height has slid down the slope by the end of the ramp, with an acceleration that rises in time as
// gravity does, up to:
double slid(Solver& solver, const Scene& s, double above) {
  solver.advance_to(ramp_time, silent);
  const MotionFrame f = solver.frame();
  double sum = 0, n = 0;
  for (std::size_t k = 0; k < f.v.size(); ++k)
    if (s.particles.x0[k].y() > above) sum += double(f.v[k][0]), ++n;
  return sum / n / (0.5 * ramp_time);
}

struct FrictionSlope {
  ShapeKind shape = ShapeKind::bspline;
  double friction = 0.25, share = 0.5;  // of the weight that the water bears, undrained
  bool drained = false, open = false;   // the soil; the wall
};

// A piece of an endless layer that lies on a frictional base.
double sliding_of(const FrictionSlope& c) {
  const double h = 0.01, height = 0.06, width = 0.03, young = 1e7, porosity = 0.4;
  MaterialOptions soil = saturated(young, 0, porosity, 1e-12);
  soil.drained = c.drained;
  Scene s = scene(Grid{{0, 0}, {h, h}, 4, 9}, {rectangle("soil", 0, 0, width, height)}, {soil});
  s.water.emplace();
  s.water->bulk_modulus_pa = porosity * young * c.share / (1 - c.share);
  BoundaryOptions sides = line({0, 0}, {0, 0.08}, "tied"), base = line({0, 0}, {width, 0}, "frictional");
  sides.across_m = Pair{width, 0};
  base.friction = c.friction;
  if (c.open) base.drained = true;
  s.boundaries = {{"base", base}, {"sides", sides}};
  MpmOptions o = tilting();
  o.shape = c.shape;
  if (c.shape == ShapeKind::bilinear) o.transfer = TransferKind::flip, o.stress_update = StressUpdate::musl;
  Solver solver(o, s, 1);
  return slid(solver, s, 0);
}

TEST(WaterFriction, AnUndrainedLayerSlidesOnAWallThatHoldsItDrained) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline}) {
    for (const double share : {0.5, 0.9}) {
      const double expected = earth * (std::sin(tilt) - 0.25 * (1 - share) * std::cos(tilt));
      EXPECT_NEAR(sliding_of({.shape = shape, .share = share}), expected, of_weight) << name_of(shape) << share;
    }
    EXPECT_NEAR(sliding_of({.shape = shape, .drained = true}), 0, 0.02) << name_of(shape);
    EXPECT_NEAR(sliding_of({.shape = shape, .open = true}), 0, 0.02) << name_of(shape);  // no pressure at the wall
    const double held = earth * (std::sin(tilt) - 0.1 * std::cos(tilt));
    EXPECT_NEAR(sliding_of({.shape = shape, .friction = 0.1, .drained = true}), held, 0.02 * held) << name_of(shape);
  }
}

// A dry block on saturated soil in a box: the soil bears it by its pores.
double sliding_on_soil(bool drained, double share) {
  const double h = 0.01, width = 0.12, below = 0.04, above = 0.02, young = 1e7, porosity = 0.4;
  MaterialOptions soil = saturated(young, 0, porosity, 1e-12), block;
  soil.drained = drained;
  block.model = "linear_elastic";
  block.young_pa = young;
  block.poisson = 0;
  block.density_kg_m3 = 8000;
  Scene s =
      scene(Grid{{-3 * h, 0}, {h, h}, 19, 10},
            {rectangle("soil", 0, 0, width, below), rectangle("block", 0, below, width, below + above)}, {soil, block});
  s.water.emplace();
  s.water->bulk_modulus_pa = porosity * young * share / (1 - share);
  s.boundaries = {{"base", line({0, 0}, {width, 0}, "roller")},
                  {"left", line({0, 0}, {0, below - h}, "roller")},
                  {"right", line({width, 0}, {width, below - h}, "roller")}};
  ContactOptions contact;
  contact.regions = {"block"};
  contact.friction = 0.25;
  s.contacts.emplace_back("face", contact);
  MpmOptions o = tilting();
  o.shape = ShapeKind::bilinear;  // (the block's do not reach the nodes that the box holds)
  o.transfer = TransferKind::flip;
  o.stress_update = StressUpdate::musl;
  Solver solver(o, s, 1);
  return slid(solver, s, below);
}

TEST(WaterFriction, ABlockSlidesOnUndrainedSoil) {
  EXPECT_NEAR(sliding_on_soil(true, 0.5), 0, 0.05);
  const double expected = earth * (std::sin(tilt) - 0.25 * 0.5 * std::cos(tilt));
  EXPECT_NEAR(sliding_on_soil(false, 0.5), expected, of_weight);
}

// A rigid plate that lies on saturated soil in a box, whose pores bear a share of it.
double plate_on_soil(bool drained, double share) {
  const double h = 0.01, width = 0.12, height = 0.04, young = 1e7, porosity = 0.4;
  MaterialOptions soil = saturated(young, 0, porosity, 1e-12);
  soil.drained = drained;
  Scene s = scene(Grid{{-3 * h, 0}, {h, h}, 19, 10}, {rectangle("soil", 0, 0, width, height)}, {soil});
  s.water.emplace();
  s.water->bulk_modulus_pa = porosity * young * share / (1 - share);
  s.boundaries = {{"base", line({0, 0}, {width, 0}, "roller")},
                  {"left", line({0, 0}, {0, height}, "roller")},
                  {"right", line({width, 0}, {width, height}, "roller")}};
  RigidOptions plate;
  plate.polygon_m = {{0, height}, {width, height}, {width, height + 2 * h}, {0, height + 2 * h}};
  plate.mass_kg_m = 8000 * width * 2 * h;
  plate.friction = 0.25;
  plate.turns = false;
  s.bodies.emplace_back("plate", plate);
  MpmOptions o = tilting();
  Solver solver(o, s, 1);
  solver.advance_to(ramp_time, silent);
  return solver.body_displacement(0).x() / (ramp_time * ramp_time / 6);
}

TEST(WaterFriction, ARigidPlateSlidesOnUndrainedSoil) {
  constexpr double share = 0.9;
  EXPECT_NEAR(plate_on_soil(true, share), 0, 0.05);
  const double expected = earth * (std::sin(tilt) - 0.25 * (1 - share) * std::cos(tilt));
  EXPECT_NEAR(plate_on_soil(false, share), expected, of_weight);
}

}  // namespace
}  // namespace pivnp::mpm
