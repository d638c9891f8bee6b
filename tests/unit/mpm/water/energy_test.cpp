// Water in the pores: no energy from nothing in light nodes or beside an imposed level, and when a run may end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

// Explicit steps by linear functions, from the start as it is given, whatever they gain.
MpmOptions linear_and_free(Pair gravity, TransferKind transfer) {
  MpmOptions o = options(gravity);
  o.shape = ShapeKind::bilinear;
  o.transfer = transfer;
  o.stress_update = StressUpdate::usl;
  o.locking = Locking::selective;
  o.initial_equilibrium = false;
  o.pressure = PressureScheme::in_steps;
  o.energy_limit = 1e9;
  return o;
}

// A block falls into the next cells. As its points pass between linear functions they have nodes with next to no mass, which stiff
// water would drive ever faster.
TEST(PoreEnergy, LightNodesOfLinearFunctionsGiveNothing) {
  const double h = 0.02;
  MaterialOptions soil = saturated(1.6e6, 0.23, 0.45, 2e-7);
  Scene s = scene(Grid{{0, 0}, {h, h}, 9, 12}, {rectangle("lower", 0, 2 * h, 6 * h, 5 * h), rectangle("upper", 0, 5 * h, 6 * h, 9 * h)}, {soil, soil});
  s.water.emplace();
  s.water->level_m = 0.3;
  s.water->bulk_modulus_pa = 2.3e6;
  s.boundaries = {{"left", line({0, 0}, {0, 11 * h}, "roller")}};
  ContactOptions contact;
  contact.regions = {"upper"};
  contact.against = {"lower"};
  contact.friction = 0.0;
  s.contacts.emplace_back("bodies", contact);
  const MpmOptions o = linear_and_free({0, -9.81}, TransferKind::apic);
  Solver solver(o, s, 1);
  const double start = solver.energy().water;
  double turned_over = 0;
  for (int k = 1; k <= 40; ++k) {
    solver.advance_to(0.002 * k, silent);
    const EnergyRow now = solver.energy();
    turned_over = std::max(turned_over, start + std::abs(now.external) + now.plastic + now.darcy + std::abs(now.damping));
    ASSERT_LT(now.residual, 0.005 * turned_over) << solver.time();
  }
}

// A row that has just passed into the next cells hangs on nodes with a fiftieth of a cell's mass. It swings faster than the step bears.
TEST(PoreEnergy, ARowBetweenLightNodesDoesNotGrow) {
  const double h = 0.02, inside = 0.04;
  const MaterialOptions soil = saturated(1e6, 0.3, 0.4, 1e-7);
  Scene s = scene(Grid{{0, 0}, {h, h}, 9, 9}, {rectangle("soil", 2 * h, 2 * h, 6 * h, 5 * h)}, {soil});
  s.water.emplace();
  s.water->bulk_modulus_pa = 5e6;
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    s.particles.x0[k].y() += (0.25 + inside) * h;
    s.v0.push_back(1e-5 * Vec2(std::sin(1.7 * double(k)), std::cos(2.3 * double(k))));
  }
  for (const TransferKind transfer : {TransferKind::xpic, TransferKind::flip, TransferKind::apic}) {
    MpmOptions o = linear_and_free({0, 0}, transfer);
    if (transfer == TransferKind::xpic) o.xpic_order = 5;
    Solver solver(o, s, 1);
    const double start = solver.energy().kinetic;
    solver.advance_to(150 * solver.stable_step(), silent);
    EXPECT_LT(solver.energy().kinetic + solver.energy().water, 1.01 * start) << name_of(transfer);
  }
}

// A drained load on the upper face of a block that stands free, on B-splines: the row of nodes beyond the face has
// little mass. Moved on linearly by FLIP, it and the stiff water feed each other (explicit pressure: 2.2 times what was
// turned over, within 5 ms).
TEST(PoreEnergy, LightNodesUnderALoadGiveFlipNothing) {
  const double h = 0.01;
  MaterialOptions soil = saturated(1e6, 0.3, 0.4, 1e-5);
  soil.model = "mohr_coulomb";
  soil.friction_deg = 30;
  soil.cohesion_pa = 1000;
  Scene s = scene(Grid{{0, 0}, {h, h}, 15, 17}, {rectangle("soil", 0, 0, 8 * h, 8 * h)}, {soil});
  s.water.emplace();
  s.water->bulk_modulus_pa = 1e8;
  BoundaryOptions load = line({0, 8 * h}, {8 * h, 8 * h}, "traction");
  load.traction_pa = {0, -500};
  load.drained = true;
  s.boundaries = {{"base", line({0, 0}, {14 * h, 0}, "fixed")}, {"load", load}};
  for (const Locking locking : {Locking::none, Locking::fbar})
    for (const PressureScheme pressure : schemes) {
      MpmOptions o = linear_and_free({0, -9.81}, TransferKind::flip);
      o.shape = ShapeKind::bspline;
      o.locking = locking;
      o.pressure = pressure;
      Solver solver(o, s, 1);
      const double start = solver.energy().water;
      double turned_over = 0;
      for (int k = 1; k <= 4; ++k) {
        solver.advance_to(0.00125 * k, silent);
        const EnergyRow now = solver.energy();
        turned_over =
            std::max(turned_over, start + std::abs(now.external) + now.plastic + now.darcy + std::abs(now.damping));
        ASSERT_LT(now.residual, 0.02 * turned_over)
            << name_of(locking) << " " << name_of(pressure) << " " << solver.time();
      }
    }
}

// A load on pervious soil that drains in little more than the time of its waves: the light nodes beyond its face take
// energy neither in nor out, however short the steps. (As a continuation of the nodes inside, whatever the load, they
// gave a third of its work, and two and a half times of it in steps of a quarter.)
TEST(PoreEnergy, ALoadOnPerviousSoilGivesItsWorkOnly) {
  WaterColumn c;
  c.young = 4e6;
  c.poisson = 0;
  c.porosity = 0.42;
  c.permeability = 3e-4;
  c.height = 0.2;
  c.bulk = 3e8;
  for (const double courant : {0.4, 0.1}) {
    c.courant = courant;
    Solver solver(options_of(c), scene_of(c), 1);
    solver.advance_to(c.at(0.02), silent);
    EXPECT_LT(std::abs(solver.energy().residual), 0.05 * solver.energy().external) << courant;
  }
}

// Of a block on a base, what its energies leave unexplained over what has been turned over, the greatest of `looks`
// until a time.
double greatest_gain(const MpmOptions& o, Scene s, double until, int looks) {
  Solver solver(o, std::move(s), 1);
  const EnergyRow start = solver.energy();
  double turned_over = start.kinetic + start.elastic + start.water, greatest = 0;
  for (int k = 1; k <= looks; ++k) {
    solver.advance_to(until * k / looks, silent);
    const EnergyRow now = solver.energy();
    turned_over =
        std::max(turned_over, start.water + std::abs(now.external) + now.plastic + now.darcy + std::abs(now.damping));
    greatest = std::max(greatest, now.residual / turned_over);
  }
  return greatest;
}

Scene block_on_base(const MaterialOptions& soil, double bulk, const BoundaryOptions& base) {
  const double h = 0.02;
  Scene s = scene(Grid{{0, 0}, {h, h}, 5, 13}, {rectangle("soil", 0, 0, 4 * h, 10 * h)}, {soil});
  s.water.emplace();
  s.water->bulk_modulus_pa = bulk;
  s.boundaries = {{"base", base},
                  {"left", line({0, 0}, {0, 12 * h}, "roller")},
                  {"right", line({4 * h, 0}, {4 * h, 12 * h}, "roller")}};
  return s;
}

// Undrained soil that swings under its weight at once keeps its books at any time: the water's energy is that of the
// skeleton's volume. (With the pressure of a step before, 3 % came and went, and 5 with projected pressure.)
TEST(PoreEnergy, UndrainedSwingsKeepTheirBooks) {
  for (const PressureScheme pressure : schemes)
    for (const TransferKind transfer : {TransferKind::flip, TransferKind::apic}) {
      MpmOptions o = linear_and_free({0, -9.81}, transfer);
      o.pressure = pressure;
      const double gain = greatest_gain(
          o, block_on_base(saturated(1e6, 0.3, 0.4, 1e-7), 4e6, line({0, 0}, {0.08, 0}, "roller")), 0.02, 10);
      EXPECT_LT(gain, 0.02) << name_of(pressure) << " " << name_of(transfer);
    }
}

// Water that a base lets in or out at once, in a layer thinner than a cell: the skeleton takes little work that the
// water does not give (where strain is smoothed beside the base, 23 times as much with a given pressure and 9 times
// with a given flow), and what flows while the skeleton gives way dissipates by the mean of the potentials before and
// after (4.8 % by those after).
TEST(PoreEnergy, WaterThroughTheBaseGivesItsWorkOnly) {
  struct Case {
    const char* what;
    double permeability, most;
    Pair gravity;
    void (*set)(BoundaryOptions&);
  };
  const Case cases[] = {
      {"pressure", 1e-6, 0.005, {0, 0}, [](BoundaryOptions& b) { b.pressure_pa = 1e3; }},
      {"flow", 1e-6, 0.5, {0, 0}, [](BoundaryOptions& b) { b.flux_m_s = 1e-4; }},
      {"drained and pervious", 3e-4, 0.015, {0, -9.81}, [](BoundaryOptions& b) { b.drained = true; }}};
  for (const Case& c : cases) {
    BoundaryOptions base = line({0, 0}, {0.08, 0}, "roller");
    c.set(base);
    const Scene s = block_on_base(saturated(1e6, 0.25, 0.45, c.permeability), 2e7, base);
    EXPECT_LT(greatest_gain(linear_and_free(c.gravity, TransferKind::flip), s, 0.02, 8), c.most) << c.what;
  }
}

// Water pressed through a loaded face at a given rate q into what is deep against (c t)^(1/2): the pressure at the face
// is 2 q gamma/K (c t/pi)^(1/2), and as much in a layer thinner than a cell as behind a wall. (Given to the points of
// the face themselves it raised the pressure against the stiffness of the water alone: 1.1 times the theory's in
// explicit and 61 times in projected steps, and gave .6 of the work in the thin layer. The free surface of projected
// steps yields.)
TEST(PoreEnergy, WaterThroughALoadedFaceRaisesThePressureAsThroughAWall) {
  const double q = 1e-4, bulk = 2e8, time = 0.05, modulus = 1.2e6, h = 0.02;
  const auto of = [&](double permeability, PressureScheme pressure, bool wall) {
    Scene s = block_on_base(saturated(1e6, 0.25, 0.45, permeability), bulk, line({0, 0}, {4 * h, 0}, "roller"));
    BoundaryOptions load = line({0, 10 * h}, {4 * h, 10 * h}, "traction");
    load.traction_pa = {0, 0};
    if (!wall) s.boundaries.emplace_back("load", load);
    s.boundaries[wall ? 0 : 3].second.flux_m_s = q;
    MpmOptions o = linear_and_free({0, 0}, TransferKind::flip);
    o.pressure = pressure;
    Solver solver(o, s, 1);
    solver.advance_to(time, silent);
    const MotionFrame f = solver.frame();
    double pressure_at_face = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k)
      if (std::abs(s.particles.x0[k].y() - (wall ? 0 : 10 * h)) < 0.5 * h)
        pressure_at_face = double(f.field("pressure")(k, 0));
    return std::pair(pressure_at_face, solver.energy());
  };
  const double K = 4e-4, c = K * modulus / 9810, z = 0.25 * h / std::sqrt(4 * c * time);
  const double exact = 2 * q * 9810 / K * std::sqrt(c * time / std::numbers::pi) *
                       (std::exp(-z * z) - z * std::sqrt(std::numbers::pi) * std::erfc(z));
  EXPECT_NEAR(of(K, PressureScheme::in_steps, false).first, exact, 0.05 * exact);
  const auto [projected, books] = of(K, PressureScheme::projected, false);
  EXPECT_GT(projected, 0.5 * exact);
  EXPECT_LT(projected, 1.05 * exact);
  EXPECT_LT(books.elastic + books.darcy, books.external);
  EXPECT_GT(books.elastic + books.darcy, 0.3 * books.external);
  const EnergyRow thin = of(1e-6, PressureScheme::in_steps, false).second,
                  behind = of(1e-6, PressureScheme::in_steps, true).second;
  EXPECT_NEAR(thin.external, behind.external, 0.02 * behind.external);
  EXPECT_LT(std::abs(thin.residual), 0.25 * thin.external);
}

// Up to a face that is drained, whichever of both loads comes first in the case.
TEST(PoreEnergy, WaterThroughALoadedFaceGoesInUpToItsEnd) {
  const double h = 0.02;
  std::vector<double> at_top[2];
  for (const bool flow_first : {true, false}) {
    Scene s = block_on_base(saturated(1e6, 0.25, 0.45, 1e-6), 2e8, line({0, 0}, {4 * h, 0}, "roller"));
    s.boundaries.pop_back();
    BoundaryOptions top = line({0, 10 * h}, {4 * h, 10 * h}, "traction"),
                    side = line({4 * h, 0}, {4 * h, 10 * h}, "traction");
    top.traction_pa = side.traction_pa = {0, 0};
    top.flux_m_s = 1e-4;
    side.drained = true;
    s.boundaries.emplace_back(flow_first ? "top" : "side", flow_first ? top : side);
    s.boundaries.emplace_back(flow_first ? "side" : "top", flow_first ? side : top);
    Solver solver(linear_and_free({0, 0}, TransferKind::flip), s, 1);
    solver.advance_to(0.02, silent);
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k)
      if (s.particles.x0[k].y() > 9.5 * h) at_top[flow_first].push_back(double(f.field("pressure")(k, 0)));
  }
  ASSERT_EQ(at_top[0].size(), 8u);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(at_top[0][k], at_top[1][k], 1e-6 * at_top[0][0]) << k;
  EXPECT_GT(at_top[0].back(), 0.5 * at_top[0].front());
}

// Rain on the loaded face of dry soil is lifted there by what brings it, as through a wall. (Booked by its pressure
// alone, it gained two thirds of that.)
TEST(PoreEnergy, RainOnALoadedFaceIsBookedWithItsHeight) {
  BoundaryOptions load = line({0, 0.2}, {0.08, 0.2}, "traction");
  load.traction_pa = {0, 0};
  load.flux_m_s = 2e-4;
  Scene s = block_on_base(saturated(1e8, 0.25, 0.45, 1e-3), 1e6, line({0, 0}, {0.08, 0}, "roller"));
  s.boundaries.emplace_back("rain", load);
  s.water->level_m = 0.05;
  MpmOptions o = linear_and_free({0, -9.81}, TransferKind::flip);
  o.initial_equilibrium = true;
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  solver.advance_to(0.05, silent);
  const EnergyRow e = solver.energy();
  EXPECT_NEAR(e.water_inflow, 1000 * 2e-4 * 0.08 * 0.05, 1e-9);
  EXPECT_LT(std::abs(e.residual), 1e-4 * e.water_inflow * 9.81 * 0.2);
}

// Nothing is seen to move long before the pressure has gone: a run that ended then would repeat a pressure that is not that of its time.
TEST(PoreRest, ConsolidationIsNotAtRest) {
  WaterColumn c = small_column();
  c.load = 0;
  c.cells = 5;
  c.gravity = 9.81;
  MpmOptions o = options_of(c);
  o.end_at_rest = true;
  Solver solver(o, scene_of(c), 1);
  const double weight = c.density() * c.gravity * c.height, water = 1000 * c.gravity * c.height;
  for (const double T : {0.5, 1.0}) {
    solver.advance_to(c.at(T), silent);
    const MotionFrame f = solver.frame();
    double worst = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double depth = 1 - (solver.particles().x0[k].y() + double(f.u[k][1])) / c.height;
      const double exact = water * depth + (weight * c.undrained_share() - water) * terzaghi_triangle(depth, T);
      worst = std::max(worst, std::abs(double(f.field("pressure")(k, 0)) - exact) / weight);
    }
    EXPECT_LT(worst, 0.01) << T;
    EXPECT_FALSE(solver.at_rest()) << T;
  }
  solver.advance_to(c.at(3.5), silent);
  EXPECT_TRUE(solver.at_rest());
}

// Above a level that is imposed the pores are full without pressure, and nothing seeps down: what flows follows the
// excess pressure. A load consolidates the column as it would without gravity, and the lift of what it presses out is
// no loss of energy.
TEST(PoreWater, FlowBesideAnImposedLevelIsThatOfTheExcess) {
  const auto column = [](bool heavy, bool loaded) {
    WaterColumn c = small_column();
    c.gravity = heavy ? 9.81 : 0;
    c.load = loaded ? 1000 : 0;
    Scene s = scene_of(c);
    if (heavy) {
      s.water->groundwater = Groundwater::level;
      s.water->level_m = 0.3 * c.height;
    }
    MpmOptions o = options_of(c);
    o.initial_equilibrium = heavy;
    Solver solver(o, s, 1);
    if (heavy) solver.find_initial_equilibrium(silent);
    solver.advance_to(c.at(loaded ? 0.1 : 0.3), silent);
    const MotionFrame f = solver.frame();
    std::vector<double> excess;
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double depth = heavy ? std::max(0.0, 0.3 * c.height - s.particles.x0[k].y()) : 0;
      excess.push_back(double(f.field("pressure")(k, 0)) - 9810 * depth);
    }
    return std::pair(excess, solver.energy());
  };
  const auto [still, at_rest] = column(true, false);
  for (const double excess : still) EXPECT_NEAR(excess, 0, 5);
  EXPECT_NEAR(at_rest.water_inflow, 0, 1e-9 * at_rest.water_mass);
  const auto [pressed, balance] = column(true, true);
  const auto [light, alike] = column(false, true);
  for (std::size_t k = 0; k < light.size(); ++k) EXPECT_NEAR(pressed[k], light[k], 10);
  EXPECT_NEAR(balance.residual, alike.residual, 0.002 * alike.darcy);
  EXPECT_NEAR(balance.darcy, alike.darcy, 0.01 * alike.darcy);
}

}  // namespace
}  // namespace pivnp::mpm
