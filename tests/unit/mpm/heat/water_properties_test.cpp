// Water whose properties follow its temperature: the fits against tables, a closed box that is heated, permeability, a thin band.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "mpm/heat/bands.hpp"
#include "mpm/water/water_properties.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/heated_band.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/silent.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
using pivnp::test::refusal;
using ::testing::HasSubstr;

// Density: CRC Handbook (ITS-90); viscosity: IAPWS 2008 at 0.1 MPa.
TEST(WaterProperties, AreThoseOfTables) {
  const struct {
    double celsius, density, viscosity;
  } rows[] = {{0, 999.84, 1.7916e-3}, {10, 999.70, 1.3059e-3}, {20, 998.21, 1.0016e-3}, {30, 995.65, 0.7972e-3}, {40, 992.22, 0.6527e-3},
              {50, 988.04, 0.5465e-3}, {60, 983.20, 0.4660e-3}, {80, 971.80, 0.3540e-3}, {100, 958.35, 0.2816e-3}};
  for (const auto& row : rows) {
    EXPECT_NEAR(water_density(row.celsius), row.density, 0.03) << row.celsius;
    EXPECT_NEAR(water_viscosity(row.celsius), row.viscosity, 1e-3 * row.viscosity) << row.celsius;
  }
  const auto expansion = [](double t) { return -std::log(water_density(t + 0.5) / water_density(t - 0.5)); };
  EXPECT_NEAR(expansion(20), 2.07e-4, 2e-6);
  EXPECT_NEAR(expansion(80), 6.4e-4, 5e-6);
  EXPECT_EQ(water_density(400), water_density(150));
}

WaterColumn closed() {
  WaterColumn c;
  c.young = 2e7, c.poisson = 0.33, c.porosity = 0.4, c.permeability = 1e-11, c.grains = 2700;
  c.height = 0.06, c.cells = 6, c.load = 0;
  return c;
}

Scene warm(const WaterColumn& c, double conductivity) {
  Scene s = scene_of(c);
  MaterialOptions& m = s.materials[0];
  m.grain_specific_heat_j_kg_k = 837;
  m.grain_thermal_expansion_1_k = 3e-5;
  m.skeleton_thermal_expansion_1_k = 0;
  m.conductivity_w_m_k = conductivity;
  s.heat.emplace();
  s.water->properties = WaterProperties::by_temperature;
  return s;
}

// All volumes are given: n K_w times what water and grains would swell by. From 20 to some 75 degrees water swells by 2.4 %, where the
// expansion at 20 degrees makes 1.1 %.
TEST(WaterProperties, AClosedBoxTakesThePressureOfWhatItsWaterSwellsBy) {
  for (const PressureScheme scheme : schemes) {
    WaterColumn c = closed();
    c.pressure = scheme;
    Scene s = warm(c, 5e6);
    s.boundaries.emplace_back("top", line({0, c.height}, {2 * c.spacing(), c.height}, "roller"));
    s.boundaries[0].second.heat_flux_w_m2 = 5e8;
    Solver solver(options_of(c), s, 1);
    solver.advance_to(2e-2, silent);
    const MotionFrame f = solver.frame();
    double pressure = 0, expected = 0, hottest = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double t = double(f.field("temperature")(k, 0));
      hottest = std::max(hottest, t);
      pressure += double(f.field("pressure")(k, 0)) / double(f.u.size());
      expected += 2.2e9 * ((998.2063 / water_density(t) - 1) + 0.6 / 0.4 * 3e-5 * (t - 20)) / double(f.u.size());
    }
    EXPECT_GT(hottest, 70);
    EXPECT_NEAR(pressure, expected, 5e-3 * expected) << int(scheme);
  }
}

// At 60 degrees water has 1/2.149 of its viscosity at 20, at which the permeability is given.
TEST(WaterProperties, WarmSoilConsolidatesFaster) {
  WaterColumn c;
  c.cells = 6, c.bulk = 2.2e8;
  const double faster = 1.0016 / 0.4660;
  Scene s = warm(c, 0);
  s.materials[0].grain_thermal_expansion_1_k = 0;
  s.temperature0.assign(s.particles.size(), 60.0);
  const MpmOptions o = options_of(c);
  Solver solver(o, s, 1), copy(o, s, 1);
  solver.advance_to(c.at(0.05) / faster, silent);
  copy.load(solver.save());
  for (Solver* each : {&solver, &copy}) each->advance_to(c.at(0.15) / faster, silent);
  const MotionFrame f = solver.frame();
  EXPECT_EQ(f.field("pressure").values, copy.frame().field("pressure").values) << "a checkpoint";
  double worst = 0;
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const double depth = 1 - s.particles.x0[k].y() / c.height;
    worst = std::max(worst, std::abs(double(f.field("pressure")(k, 0)) / (c.load * c.undrained_share()) - terzaghi(depth, 0.15)));
  }
  EXPECT_LT(worst, 0.03);
}

// A zone of a cell with its band, the cell's means in a column, against the band resolved with other fits of water.
TEST(WaterProperties, AThinBandIsTheResolvedOne) {
  for (const double permeability : {1e-11, 1e-9, 1e-7}) {
    pivnp::test::HeatedBand of;
    of.permeability = permeability;
    of.by_temperature = true;
    HeatSoil soil;
    soil.capacity = of.capacity, soil.conductivity = of.conductivity, soil.swelling = of.beta, soil.band = of.thickness;
    soil.storage = of.storage(), soil.mobility = of.mobility();
    soil.by_temperature = true, soil.porosity = of.porosity, soil.grains = of.grains, soil.reference_c = of.start_c;
    pivnp::test::HeatedBand constant = of;
    constant.by_temperature = false;
    pivnp::test::ResolvedBand resolved(of), other(constant);
    ShearBand band;
    const double cell = 1, speed = 1, dt = 4e-4, each = dt / (cell * cell);
    std::vector<double> hot(21, 0.0), pressure(21, 0.0);
    double worst = 0, matters = 0;
    for (int step = 0; step < 10000; ++step) {
      resolved.slip(speed, dt);
      other.slip(speed, dt);
      const double p = pressure[0] + band.over_pressure(of.thickness);
      const double work = dt * speed * std::max(0.0, of.stress - p) * of.tan_friction() / cell;
      const std::vector<double> old = hot, was = pressure;
      const auto gain = [&](const std::vector<double>& x, std::size_t k) {
        return (k == 0 ? 2 * (x[1] - x[0]) : (k + 1 < x.size() ? x[k + 1] - x[k] : 0) + x[k - 1] - x[k]);
      };
      for (std::size_t k = 0; k < hot.size(); ++k) hot[k] += of.conductivity / of.capacity * each * gain(old, k) + (k == 0 ? work / of.capacity : 0);
      for (std::size_t k = 0; k < hot.size(); ++k) {
        const double from = of.start_c + old[k], to = of.start_c + hot[k];
        const double swollen = k == 0 ? advance_band(band, soil, cell, work, dt, from, to) : soil.swells(from, to);
        pressure[k] += of.mobility() / of.storage() * each * gain(was, k) + swollen / of.storage();
      }
      worst = std::max(worst, std::abs(pressure[0] + band.over_pressure(of.thickness) - resolved.pressure()));
      matters = std::max(matters, std::abs(other.pressure() - resolved.pressure()));
    }
    EXPECT_LT(worst, 0.018e6) << permeability;
    EXPECT_NEAR(hot[0] + band.hotter(of.thickness), resolved.temperature(), 0.05 * resolved.temperature()) << permeability;
    EXPECT_GT(matters, 0.05e6) << permeability;
  }
}

TEST(WaterProperties, RefuseWhatDoesNotGoWithThem) {
  const auto with = [](const std::function<void(Scene&)>& change) {
    return refusal([&] {
      Scene s = warm(closed(), 1);
      change(s);
      Solver(options_of(closed()), s, 1);
    });
  };
  EXPECT_EQ(with([](Scene&) {}), "");
  EXPECT_THAT(with([](Scene& s) { s.heat.reset(), s.materials[0] = scene_of(closed()).materials[0]; }), HasSubstr("water.properties: found 'temperature' without [heat]"));
  EXPECT_THAT(with([](Scene& s) { s.water->thermal_expansion_1_k = 2e-4; }), HasSubstr("water.thermal_expansion_1_k"));
}

}  // namespace
}  // namespace pivnp::mpm
