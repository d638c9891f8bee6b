// Water in the pores, explicit and projected (docs/theory/mpm_water.md).
//
// 1. Terzaghi 1923 (with compressible water: p0 = q/(1 + n M/K_w), c_v = K/(gamma (1/M + n/K_w))): a load at once and self
//    weight at once on a column drained at its top. Criterion: pressure within 1 % of p0 at T .1, .3, .7 at every point, E
//    1e6 .. 1e8 Pa, K 1e-11 .. 1e-3 m/s, bilinear, uGIMP and B-spline; settlement within 1 %; water lost below 1e-12 of all.
//    The columns are as high as makes flow and waves ask for the same step (and inertia small), and the water in the table over
//    E and K is as soft as makes it a hundred times stiffer than the skeleton: one with K_w 2.2 GPa, M 10 MPa beside them.
// 2. A footing, undrained: the same bearing capacity as dry soil of nu 0.499 on the same cells, within 3 %, and less of a
//    checkerboard in the pressure than in the dry soil's mean stress: the part that alternates from cell to cell.
// In small, for every build: one column a shape, both loads, and the footing on cells of B/8.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "mpm/state/scheme_rows.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
struct Deviation {
  double pressure = 0, settlement = 0, water = 0;  // over p0; over the end's; over all

  void raise(const Deviation& d) {
    pressure = std::max(pressure, d.pressure);
    settlement = std::max(settlement, d.settlement);
    water = std::max(water, d.water);
  }
};

// What a point at a depth has sunk: the strain below it is that of the load less the pressure.
double settlement_below(const WaterColumn& c, double depth_over_height, double T) {
  double left = 0;  // integral of p/p0 from the depth down to the base, over the height
  for (int m = 1; m < 400; m += 2)
    left += 8 / std::pow(m * M_PI, 2) * std::cos(m * M_PI * depth_over_height / 2) * std::exp(-std::pow(m * M_PI / 2, 2) * T);
  const double all = 1 - depth_over_height, share = c.undrained_share();
  return c.load * c.height / c.modulus() * (all - share * left);
}

// (What comes at once shakes a projected column for the few steps that a wave takes through it.)
double residual_of(const WaterColumn& c) { return c.pressure == PressureScheme::projected ? 0.25 : 0.03; }

Deviation step_load(const WaterColumn& c) {
  const Scene s = scene_of(c);
  Solver solver(options_of(c), s, 1);
  const EnergyRow start = solver.energy();
  const double p0 = c.undrained_share() * c.load;
  Deviation worst;
  for (const double T : {0.1, 0.3, 0.7}) {
    solver.advance_to(c.at(T + 0.5 * c.rise), silent);
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double depth = 1 - s.particles.x0[k].y() / c.height;
      worst.pressure = std::max(worst.pressure, std::abs(double(f.field("pressure")(k, 0)) / p0 - terzaghi(depth, T)));
      worst.settlement = std::max(worst.settlement, std::abs(double(f.u[k][1]) + settlement_below(c, depth, T)) /
                                                        settlement_below(c, 0, 10));
    }
    const EnergyRow e = solver.energy();
    worst.water = std::max(worst.water, std::abs(e.water_mass - start.water_mass - e.water_inflow) / start.water_mass);
    EXPECT_LT(std::abs(e.residual), residual_of(c) * std::abs(e.external));
  }
  return worst;
}

// (Under a gravity that strains every column alike.)
Deviation self_weight(WaterColumn c) {
  c.gravity = c.load / (c.density() * c.height);
  c.load = 0;
  const Scene s = scene_of(c);
  Solver solver(options_of(c), s, 1);
  const EnergyRow start = solver.energy();
  const double hydrostatic = 1000 * c.gravity * c.height, excess = c.undrained_share() * c.density() * c.gravity * c.height - hydrostatic;
  Deviation worst;
  for (const double T : {0.1, 0.3, 0.7}) {
    solver.advance_to(c.at(T), silent);
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double depth = 1 - s.particles.x0[k].y() / c.height;
      const double exact = hydrostatic * depth + excess * terzaghi_triangle(depth, T);
      worst.pressure = std::max(worst.pressure, std::abs(double(f.field("pressure")(k, 0)) - exact) / excess);
    }
    const EnergyRow e = solver.energy();
    worst.water = std::max(worst.water, std::abs(e.water_mass - start.water_mass - e.water_inflow) / start.water_mass);
    EXPECT_LT(std::abs(e.residual), residual_of(c) * std::abs(e.external));
  }
  return worst;
}

WaterColumn column_of(ShapeKind shape, PressureScheme pressure, double young, double permeability, int cells) {
  WaterColumn c;
  c.shape = shape;
  c.pressure = pressure;
  c.young = young;
  c.permeability = permeability;
  c.cells = cells;
  c.bulk = std::min(2.2e9, 100 * c.porosity * c.modulus());
  // High enough for waves to have died out long before water has left.
  c.height = std::max(400 * permeability * cells, 500 * c.consolidation() / std::sqrt(c.modulus() / c.density()));
  c.load = 1e-4 * c.modulus();
  return c;
}

void expect_within(const Deviation& d, double pressure) {
  EXPECT_LT(d.pressure, pressure);
  EXPECT_LT(d.settlement, 0.01);
  EXPECT_LT(d.water, 1e-12);
}

TEST(MpmTerzaghiSmall, StepLoadAndSelfWeight) {
  for (const PressureScheme pressure : schemes)
    for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline}) {
      const WaterColumn c = column_of(shape, pressure, 1e7, 1e-5, 8);
      const Deviation load = step_load(c), weight = self_weight(c);
      std::printf("%s, %s, 8 cells: step load %.4f, settlement %.4f, self weight %.4f\n", std::string(name_of(pressure)).c_str(),
                  std::string(name_of(shape)).c_str(), load.pressure, load.settlement, weight.pressure);
      expect_within(load, 0.01);
      expect_within(weight, 0.01);
    }
}

TEST(MpmTerzaghi, StepLoadAndSelfWeightOverDecades) {
  for (const PressureScheme pressure : schemes)
    for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline}) {
      Deviation load, weight;
      for (const double young : {1e6, 1e7, 1e8})
        for (const double permeability : {1e-11, 1e-9, 1e-7, 1e-5, 1e-3}) {
          const WaterColumn c = column_of(shape, pressure, young, permeability, 10);
          load.raise(step_load(c));
          weight.raise(self_weight(c));
        }
      expect_within(load, 0.01);
      expect_within(weight, 0.01);
      pivnp::test::verification_row("Terzaghi, " + std::string(name_of(pressure)) + ", " + std::string(name_of(shape)) + ", E 1e6 .. 1e8, K 1e-11 .. 1e-3, 10 cells",
                                    "pressure within 1 % of p0 at T .1, .3, .7, settlement within 1 %, water to 1e-12",
                                    "load " + number(100 * load.pressure, 2) + " %, settlement " + number(100 * load.settlement, 2) +
                                        " %, self weight " + number(100 * weight.pressure, 2) + " %, water " + number(std::max(load.water, weight.water), 2));
    }
}

// The column is round: the same pressures at every point, those at the axis among them.
WaterColumn round_column(ShapeKind shape, PressureScheme pressure, double young, double permeability, int cells) {
  WaterColumn c = column_of(shape, pressure, young, permeability, cells);
  c.about_axis = true;
  c.across = 3;
  return c;
}

TEST(MpmTerzaghiSmall, ARoundColumn) {
  for (const PressureScheme pressure : schemes)
    for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
      const WaterColumn c = round_column(shape, pressure, 1e7, 1e-5, 8);
      const Deviation load = step_load(c), weight = self_weight(c);
      std::printf("round column, %s, %s, 8 cells: step load %.4f, settlement %.4f, self weight %.4f\n", std::string(name_of(pressure)).c_str(),
                  std::string(name_of(shape)).c_str(), load.pressure, load.settlement, weight.pressure);
      expect_within(load, 0.01);
      expect_within(weight, 0.01);
    }
}

TEST(MpmTerzaghi, ARoundColumn) {
  for (const PressureScheme pressure : schemes)
    for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline}) {
      Deviation load, weight;
      for (const auto& [young, permeability] : {std::pair{3e6, 2e-9}, {4e7, 3e-6}}) {
        const WaterColumn c = round_column(shape, pressure, young, permeability, 10);
        load.raise(step_load(c));
        weight.raise(self_weight(c));
      }
      expect_within(load, 0.01);
      expect_within(weight, 0.01);
      pivnp::test::verification_row("Terzaghi about the axis, " + std::string(name_of(pressure)) + ", " + std::string(name_of(shape)) + ", E 3e6 and 4e7, K 2e-9 and 3e-6, 10 cells",
                                    "pressure within 1 % of p0 at T .1, .3, .7, settlement within 1 %, water to 1e-12",
                                    "load " + number(100 * load.pressure, 2) + " %, settlement " + number(100 * load.settlement, 2) + " %, self weight " +
                                        number(100 * weight.pressure, 2) + " %, water " + number(std::max(load.water, weight.water), 2));
    }
}

TEST(MpmTerzaghi, StiffWater) {
  for (const PressureScheme pressure : schemes) {
    WaterColumn c;
    c.pressure = pressure;
    c.young = 1e7;
    c.poisson = 0;
    c.load = 1e4;
    c.permeability = 1e-5;
    c.height = 0.1;
    const Deviation d = step_load(c);
    expect_within(d, 0.01);
    pivnp::test::verification_row("Terzaghi, " + std::string(name_of(pressure)) + ", M 10 MPa, K_w 2.2 GPa, K 1e-5, H 0.1 m, 10 cells",
                                  "pressure within 1 % of p0, settlement within 1 %", number(100 * d.pressure, 2) + " %, " + number(100 * d.settlement, 2) + " %");
  }
}

TEST(MpmTerzaghi, OrderInTheCell) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    double error[3];
    for (const int k : {0, 1, 2}) {
      WaterColumn c = column_of(shape, PressureScheme::in_steps, 1e7, 1e-5, 5 << k);
      c.height = 0.04;
      error[k] = self_weight(c).pressure;
    }
    const double order = 0.5 * std::log2(error[0] / error[2]);
    pivnp::test::verification_row("Terzaghi, explicit, " + std::string(name_of(shape)) + ", self weight, 5 to 20 cells", "stated: order in h; below 0.2 % with 20 cells",
                                  number(order, 2) + ", " + number(100 * error[2], 2) + " % with 20 cells");
    EXPECT_LT(error[2], error[0]);
    EXPECT_LT(error[2], 0.002);
  }
}

// A lake over a saturated sample falls. Total stress and pressure outside fall by the same; of that, soft water takes a part at
// once, and the rest leaves as in Terzaghi's consolidation. The largest deviation of the pressure at T .1, .3, .7, over what the
// lake's pressure fell by.
double drawdown(ShapeKind shape, int cells, double share) {
  WaterColumn c;
  c.young = 1e7;
  c.poisson = 0.2;
  c.permeability = 1e-5;
  c.height = 0.06;
  c.cells = cells;
  c.shape = shape;
  c.load = 0;
  c.gravity = 9.81;
  c.bulk = c.porosity * c.modulus() * share / (1 - share);
  Scene s = scene_of(c);
  const double fall = 0.05, low = 0.1;
  s.water->level_history = {{0, low + fall}, {c.at(2e-3), low}};
  MpmOptions o = options_of(c);
  o.initial_equilibrium = true;
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  const double fallen = 1000 * c.gravity * fall;
  double worst = 0;
  for (const double T : {0.1, 0.3, 0.7}) {
    solver.advance_to(c.at(T), silent);
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double y = s.particles.x0[k].y();
      const double expected = 1000 * c.gravity * (low - y) + (1 - share) * fallen * terzaghi(1 - y / c.height, T);
      worst = std::max(worst, std::abs(double(f.field("pressure")(k, 0)) - expected) / fallen);
    }
  }
  return worst;
}

TEST(MpmDrawdownSmall, ALakeThatFallsOverASample) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    const double d = drawdown(shape, 8, 0.5);
    std::printf("lake that falls, %s, 8 cells: %.4f\n", std::string(name_of(shape)).c_str(), d);
    EXPECT_LT(d, 0.01);
  }
}

TEST(MpmDrawdown, ALakeThatFallsOverASample) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline}) {
    double worst = 0;
    for (const double share : {0.3, 0.6}) worst = std::max(worst, drawdown(shape, 10, share));
    EXPECT_LT(worst, 0.01);
    pivnp::test::verification_row("lake that falls over a saturated sample, " + std::string(name_of(shape)) + ", 10 cells, pore water that follows by 0.3 and 0.6 of the fall at once",
                                  "pressure within 1 % of the fall in the lake's pressure at T .1, .3, .7", number(100 * worst, 2) + " %");
  }
}

// Half of a rough footing of width 2 on clay (wet and dry of one shear modulus) 4 wide and 2.5 deep; its nodes sink at a speed.
struct Bearing {
  double capacity, checkerboard;  // mean over a settlement of 2.5 to 4 % of the width; over the mean, of pressure or mean stress
};

Bearing footing(int cells, ShapeKind shape, bool wet, PressureScheme pressure = PressureScheme::in_steps, bool flip = false) {
  const double h = 1.0 / cells, strength = 1000, poisson = wet ? 0.3 : 0.499, shear = 1.9e5, young = 2 * shear * (1 + poisson);
  MaterialOptions m = wet ? saturated(young, poisson, 0.4, 0, 2667) : elastic(young, poisson, 2000);
  m.model = "tresca";
  m.shear_strength_pa = strength;
  Scene s = scene(Grid{{0, 0}, {h, h}, 4 * cells + 1, 3 * cells + 1}, {rectangle("clay", 0, 0, 4, 2.5)}, {m});
  if (wet) {
    s.water.emplace();
    s.water->bulk_modulus_pa = 0.4 * 2 * shear * 1.4993 / (3 * (1 - 2 * 0.4993));  // the mixture's nu is 0.4993
  }
  const double v = 0.0006 * std::sqrt(shear * 50 / 2000);
  s.boundaries = {{"low", line({0, 0}, {4, 0}, "roller")},
                  {"left", line({0, 0}, {0, 3}, "roller")},
                  {"right", line({4, 0}, {4, 3}, "roller")},
                  {"footing", line({0, 2.5}, {1, 2.5}, "fixed")}};
  BoundaryOptions& plate = s.boundaries.back().second;  // the nodes within it, beside water and without
  plate.line_m.clear();
  plate.polygon_m = {{-0.1, 2.49}, {1.01, 2.49}, {1.01, 2.9}, {-0.1, 2.9}};
  plate.velocity_m_s = Pair{0, -v};
  MpmOptions o = options();
  o.shape = shape;
  o.locking = Locking::fbar;
  if (wet) o.pressure = pressure;
  if (pressure == PressureScheme::projected) o.energy_limit = 1e9;  // (a wall that starts at once, and waves that nothing damps)
  if (flip || shape == ShapeKind::bilinear) o.transfer = TransferKind::flip;
  if (shape == ShapeKind::bilinear) o.stress_update = StressUpdate::musl;
  o.initial_equilibrium = false;
  Solver solver(o, s, 2);
  // Before the first row of points has left the footing's cells; the mean over some times, as undamped waves pass.
  const std::array<double, 4> times = {0.05, 0.06, 0.07, 0.08};
  double external[2] = {0, 0}, alternating = 0, size = 0;
  for (const double time : times) {
    solver.advance_to(time / v, silent);
    external[time > times.front()] = solver.energy().external;
    std::map<std::pair<int, int>, std::pair<double, int>> of_cell;
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      auto& [sum, n] = of_cell[{int(s.particles.x0[k].x() / h), int(s.particles.x0[k].y() / h)}];
      sum += wet ? double(f.field("pressure")(k, 0))
                 : -double(f.field("stress")(k, 0) + f.field("stress")(k, 1) + f.field("stress")(k, 2)) / 3;
      ++n;
    }
    const auto mean = [&](int i, int j) {
      const auto& [sum, n] = of_cell.at({i, j});
      return sum / n;
    };
    // What alternates along both axes: (1, -2, 1)/4 along each, which linear and quadratic fields leave at zero.
    const int top = int(std::lround(2.5 / h)) - 2;
    for (int j = top - cells; j < top; ++j)
      for (int i = 1; i + 1 < cells; ++i) {
        double q = 0;
        for (int a = -1; a < 2; ++a)
          for (int b = -1; b < 2; ++b) q += (a ? 1 : -2) * (b ? 1 : -2) * mean(i + a, j + b) / 16;
        alternating += std::abs(q);
        size += std::abs(mean(i, j));
      }
  }
  return {(external[1] - external[0]) / (times.back() - times.front()) / strength, alternating / size};
}

TEST(MpmUndrainedSmall, StripFooting) {
  const Bearing dry = footing(4, ShapeKind::bilinear, false);
  for (const PressureScheme pressure : schemes) {
    const Bearing wet = footing(4, ShapeKind::bilinear, true, pressure);
    std::printf("strip footing, %s, h = B/8: dry %.3f, undrained %.3f, checkerboard %.3f and %.3f\n", std::string(name_of(pressure)).c_str(),
                dry.capacity, wet.capacity, dry.checkerboard, wet.checkerboard);
    EXPECT_NEAR(wet.capacity, dry.capacity, 0.03 * dry.capacity);
    EXPECT_LT(wet.checkerboard, 0.04);  // 3 % is asked for, and held, with cells of B/16
  }
}

// (Projected, by FLIP: APIC takes energy out in each step, of which the others take ten times as many.)
TEST(MpmUndrained, StripFooting) {
  for (const PressureScheme pressure : schemes)
    for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline}) {
      const bool flip = pressure == PressureScheme::projected;
      const Bearing dry = footing(8, shape, false, PressureScheme::in_steps, flip), wet = footing(8, shape, true, pressure, flip);
      pivnp::test::verification_row("strip footing, undrained, " + std::string(name_of(pressure)) + ", " + std::string(name_of(shape)) +
                                        (flip ? ", FLIP" : "") + ", h = B/16",
                                    "bearing capacity within 3 % of the dry soil's with nu .499, checkerboard below 3 %",
                                    number(wet.capacity, 4) + " (dry " + number(dry.capacity, 4) + "), " + number(100 * wet.checkerboard, 2) +
                                        " % (dry " + number(100 * dry.checkerboard, 2) + " %)");
      EXPECT_NEAR(wet.capacity, dry.capacity, 0.03 * dry.capacity);
      EXPECT_LT(wet.checkerboard, 0.03);
    }
}

}  // namespace
}  // namespace pivnp::mpm
