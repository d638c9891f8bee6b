// Water about an axis of symmetry: what flows through rings, what is conserved, what is at rest.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "tests/support/refusal.hpp"
#include "tests/support/silent.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {
namespace wet_rings {

using namespace test;

constexpr ShapeKind shapes[] = {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline};

double lost(const EnergyRow& now, const EnergyRow& start) {
  return std::abs(now.water_mass - start.water_mass - now.water_inflow) / start.water_mass;
}

WaterColumn round_column(ShapeKind shape, PressureScheme pressure) {
  WaterColumn c = small_column();
  c.about_axis = true;
  c.across = 8;
  c.shape = shape;
  c.pressure = pressure;
  c.load = 0;
  if (shape == ShapeKind::bilinear) c.transfer = TransferKind::flip, c.stress = StressUpdate::musl;
  return c;
}

// Through the base q R^2/2 a radian, through the rim q R H, whether a wall or a loaded face lets it in.
TEST(WetRings, AGivenFlowIsThatOfARadian) {
  for (const PressureScheme pressure : schemes)
    for (const bool through_rim : {false, true})
      for (const bool loaded : {false, true}) {
        const WaterColumn c = round_column(ShapeKind::bspline, pressure);
        const double R = 8 * c.spacing(), H = c.height, flux = 1e-7;
        Scene s = scene_of(c);
        s.grid.nx += 2;
        BoundaryOptions rim = line({R, 0}, {R, H}, loaded && through_rim ? "traction" : "roller");
        BoundaryOptions top = line({0, H}, {R, H}, loaded && !through_rim ? "traction" : "roller");
        BoundaryOptions& face = through_rim ? rim : top;
        face.flux_m_s = flux;
        if (loaded) face.traction_pa = Pair{0.0, 0.0};
        s.boundaries = {{"base", line({0, 0}, {R, 0}, "roller")}, {"rim", rim}, {"top", top}};
        Solver solver(options_of(c), s, 1);
        const EnergyRow start = solver.energy();
        const double time = c.at(0.1), water = 1000 * c.porosity * H * R * R / 2;
        EXPECT_NEAR(start.water_mass, water, 1e-9 * water) << "of a radian";
        solver.advance_to(time, silent);
        const EnergyRow e = solver.energy();
        const double expected = 1000 * flux * (through_rim ? R * H : R * R / 2) * time;
        EXPECT_NEAR(e.water_inflow, expected, (loaded ? 2e-3 : 1e-9) * expected) << through_rim << loaded;
        EXPECT_LT(lost(e, start), 1e-12);
        if (loaded) continue;
        double mean = 0, all = 0;
        const MotionFrame f = solver.frame();
        for (std::size_t k = 0; k < f.u.size(); ++k) {
          mean += s.particles.x0[k].x() * double(f.field("pressure")(k, 0));
          all += s.particles.x0[k].x();
        }
        const double rise = c.bulk * e.water_inflow / start.water_mass;
        EXPECT_NEAR(mean / all, rise, 0.01 * rise);
      }
}

// A round hill in a lake, and a pit with water around it.
TEST(WetRings, ARoundHillBesideALakeStaysAtRest) {
  const double h = 0.1, level = 0.8;
  for (const PressureScheme pressure : schemes)
    for (const ShapeKind shape : shapes) {
      Scene s = scene(Grid{{0, 0}, {h, h}, 26, 13}, {{"soil", Polygon({{0, 0}, {2.5, 0}, {2.5, 0.3}, {2, 0.3}, {1, 1}, {0, 1}}, "soil")}},
                      {saturated(1e7, 0.3, 0.35, 1e-4)});
      s.water.emplace();
      s.water->bulk_modulus_pa = 1e9;
      s.water->level_m = level;
      s.boundaries = {{"base", line({0, 0}, {2.5, 0}, "fixed")}, {"rim", line({2.5, 0}, {2.5, 1.2}, "roller")}};
      MpmOptions o = options({0, -9.81});
      o.geometry = Geometry::axisymmetric;
      o.shape = shape;
      o.transfer = shape == ShapeKind::bspline ? TransferKind::apic : TransferKind::flip;
      o.locking = shape == ShapeKind::bilinear ? Locking::fbar : Locking::none;
      o.equilibrium_tolerance = 1e-10;
      o.end_at_rest = false;
      o.pressure = pressure;
      Solver solver(o, s, 1);
      solver.find_initial_equilibrium(silent);
      const EnergyRow start = solver.energy();
      solver.advance_to(0.005, silent);
      const MotionFrame f = solver.frame();
      double fastest = 0;
      for (std::size_t k = 0; k < f.v.size(); ++k) {
        fastest = std::max(fastest, std::hypot(double(f.v[k][0]), double(f.v[k][1])));
        EXPECT_NEAR(double(f.field("pressure")(k, 0)), 9810 * std::max(0.0, level - s.particles.x0[k].y()), 2e-2);
      }
      EXPECT_LT(fastest, 1e-6 * std::sqrt(9.81)) << name_of(shape) << " " << name_of(pressure);
      EXPECT_LT(lost(solver.energy(), start), 1e-13);
    }
}

// Skempton's B of a pressure all round, and A = 1/3 of a thrust along the axis (elastic: the mean effective stress follows the volume).
TEST(WetRings, SkemptonsCoefficients) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    WaterColumn c = round_column(shape, PressureScheme::in_steps);
    c.permeability = 1e-12;
    c.bulk = 2e7;  // B .78
    c.across = 6;
    c.cells = 10;
    c.height = 0.1;
    const double R = 6 * c.spacing(), H = c.height, cell = 2e3, thrust = 3e3, bulk = c.young / 3 / (1 - 2 * c.poisson);
    const double B = 1 / (1 + c.porosity * bulk / c.bulk), time = 60 * H / std::sqrt(c.modulus() / c.density());
    Scene s = scene_of(c);
    s.grid.nx += 2;
    BoundaryOptions rim = line({R, 0}, {R, H}, "traction"), top = line({0, H}, {R, H}, "traction");
    rim.traction_pa = Pair{-cell, 0.0};
    top.traction_pa = Pair{0.0, -cell - thrust};
    rim.rise_s = top.rise_s = time / 3;
    s.boundaries = {{"base", line({0, 0}, {R + 2 * c.spacing(), 0}, "roller")}, {"rim", rim}, {"top", top}};
    MpmOptions o = options_of(c);
    Solver solver(o, s, 1);
    const EnergyRow start = solver.energy();
    solver.advance_to(time, silent);
    const double expected = B * (cell + thrust / 3);
    double mean = 0, all = 0;
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const Vec2 x = s.particles.x0[k];
      mean += x.x() * double(f.field("pressure")(k, 0));
      all += x.x();
      // (By B-splines what lies at the axis sees a few per cent less: docs/limits.md.)
      if (shape == ShapeKind::bilinear || x.x() > c.spacing()) {
        EXPECT_NEAR(double(f.field("pressure")(k, 0)), expected, 0.03 * expected) << x.transpose();
      }
    }
    EXPECT_NEAR(mean / all, expected, 0.005 * expected) << name_of(shape);
    EXPECT_LT(lost(solver.energy(), start), 1e-12);
  }
}

// Flow along the axis is as fast at it as away from it: cells ten times as wide as high, between which little passes.
TEST(WetRings, FlowAlongTheAxisIsTheSameAtEveryRadius) {
  for (const PressureScheme pressure : schemes) {
    WaterColumn c = round_column(ShapeKind::bilinear, pressure);
    c.cells = 8;
    const double h = c.spacing(), wide = 20 * h;
    Scene s = scene(Grid{{0, 0}, {10 * h, h}, 3, c.cells + 1}, {rectangle("soil", 0, 0, wide, c.height)}, {saturated(c.young, c.poisson, c.porosity, c.permeability)});
    s.water.emplace();
    s.water->bulk_modulus_pa = c.bulk;
    s.boundaries = {{"base", line({0, 0}, {wide, 0}, "roller")}, {"rim", line({wide, 0}, {wide, c.height}, "roller")}, {"top", line({0, c.height}, {wide, c.height}, "roller")}};
    s.boundaries[0].second.pressure_pa = 5e3;
    Solver solver(options_of(c), s, 1);
    solver.advance_to(c.at(0.1), silent);
    const MotionFrame f = solver.frame();
    std::map<double, std::pair<double, double>> at_height;  // least and greatest
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double p = double(f.field("pressure")(k, 0));
      auto& [least, most] = at_height.try_emplace(std::round(s.particles.x0[k].y() / h * 8), p, p).first->second;
      least = std::min(least, p);
      most = std::max(most, p);
    }
    EXPECT_EQ(at_height.size(), 16u);
    for (const auto& [y, range] : at_height) EXPECT_NEAR(range.first, range.second, (pressure == PressureScheme::projected ? 2e-3 : 2e-4) * 5e3) << name_of(pressure) << " at " << y;
  }
}

// The stated step holds at the axis too.
TEST(WetRings, StepsAreBoundedBelowTheStatedLimit) {
  for (const ShapeKind shape : shapes)
    for (const TransferKind transfer : {TransferKind::flip, TransferKind::apic})
      for (const double permeability : {1e-6, 1e-2})
        for (const double spread : {1.0, 1.9}) {
          if (shape == ShapeKind::bilinear && transfer == TransferKind::apic && permeability < 1e-3) continue;
          RandomBlock b{shape, transfer, PressureScheme::in_steps, 1e7, permeability};
          b.spread = spread;
          b.about_axis = true;
          EXPECT_FALSE(grows_in(b, 0.95)) << name_of(shape) << " " << name_of(transfer) << " " << permeability << " " << spread;
        }
}

// What slumps with the water's surface inside keeps all water, and gains no energy.
TEST(WetRings, ASlumpingColumnKeepsItsWater) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    MaterialOptions m = saturated(2e6, 0.3, 0.4, 1e-3);
    m.model = "mohr_coulomb";
    m.friction_deg = 25;
    Scene s = scene(Grid{{0, 0}, {0.1, 0.1}, 26, 14}, {rectangle("soil", 0, 0, 0.8, 1)}, {m});
    s.water.emplace();
    s.water->bulk_modulus_pa = 2e7;
    s.water->level_m = 0.62;
    s.boundaries = {{"base", line({0, 0}, {2.5, 0}, "fixed")}};
    MpmOptions o = options({0, -9.81});
    o.geometry = Geometry::axisymmetric;
    o.shape = shape;
    if (shape == ShapeKind::bilinear) o.stress_update = StressUpdate::musl;
    o.transfer = shape == ShapeKind::bspline ? TransferKind::apic : TransferKind::flip;
    o.initial_equilibrium = false;
    Solver solver(o, s, 1);
    const EnergyRow start = solver.energy();
    solver.advance_to(0.3, silent);
    const EnergyRow e = solver.energy();
    EXPECT_EQ(solver.ended(), 0u);
    EXPECT_LT(lost(e, start), 1e-9) << name_of(shape);
    EXPECT_LT(e.residual, 0.01 * e.external) << name_of(shape);
    double furthest = 0;
    for (const auto& u : solver.frame().u) furthest = std::max(furthest, double(u[0]));
    EXPECT_GT(furthest, 0.1) << "it slumps";
  }
}

TEST(WetRings, ACheckpointAndThreadsChangeNoBit) {
  const auto make = [](int threads) {
    MaterialOptions m = saturated(2e6, 0.3, 0.4, 1e-3);
    Scene s = scene(Grid{{0, 0}, {0.05, 0.05}, 21, 14}, {rectangle("soil", 0, 0, 0.8, 0.5)}, {m});
    s.water.emplace();
    s.water->bulk_modulus_pa = 2e7;
    s.water->level_m = 0.45;
    s.boundaries = {{"base", line({0, 0}, {1, 0}, "fixed")}};
    MpmOptions o = options({0, -9.81});
    o.geometry = Geometry::axisymmetric;
    o.initial_equilibrium = false;
    return std::make_unique<Solver>(o, s, threads);
  };
  const auto one = make(1), three = make(3), resumed = make(2);
  one->advance_to(0.005, silent);
  resumed->load(one->save());
  three->advance_to(0.005, silent);
  for (Solver* s : {one.get(), three.get(), resumed.get()}) s->advance_to(0.01, silent);
  EXPECT_EQ(one->save(), three->save());
  EXPECT_EQ(one->save(), resumed->save());
}

TEST(WetRings, WhatDoesNotGoWithThemIsNamed) {
  const auto says = [](const std::function<void(Scene&, MpmOptions&)>& change) {
    const WaterColumn c = round_column(ShapeKind::bspline, PressureScheme::in_steps);
    Scene s = scene_of(c);
    MpmOptions o = options_of(c);
    change(s, o);
    return pivnp::test::refusal([&] { Solver(o, s, 1); });
  };
  EXPECT_EQ(says([](Scene&, MpmOptions&) {}), "");
  const std::vector<std::pair<std::string, std::function<void(Scene&, MpmOptions&)>>> wrong = {
      {"heat", [](Scene& s, MpmOptions&) { s.heat.emplace(); }},
      {"contact.c", [](Scene& s, MpmOptions&) { s.contacts = {{"c", {}}}; }},
      {"boundary.base.type", [](Scene& s, MpmOptions&) { s.boundaries[0].second.type = BoundaryType::tied; }},
      {"centrifuge", [](Scene& s, MpmOptions&) { s.centrifuge.emplace(); }},
      {"mpm.gravity_m_s2", [](Scene&, MpmOptions& o) { o.gravity_m_s2 = {1, -9}; }},
  };
  for (const auto& [key, change] : wrong) EXPECT_EQ(says(change).substr(0, key.size()), key);
}

}  // namespace wet_rings
}  // namespace
}  // namespace pivnp::mpm
