// Heat: what conducts where, what is conserved, what swells, what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "pivnp/core/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/silent.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
using pivnp::test::refusal;
using ::testing::HasSubstr;

// Conducts so well, and is so soft, that heat passes its cells in few steps.
MaterialOptions warm(double conductivity = 400, double capacity = 800, double density = 1000) {
  MaterialOptions m = elastic(1e4, 0.2, density);
  m.grain_specific_heat_j_kg_k = capacity;
  m.conductivity_w_m_k = conductivity;
  return m;
}

MpmOptions still() {
  MpmOptions o = options();
  o.initial_equilibrium = false;
  o.end_at_rest = false;
  o.courant = 0.8;
  return o;
}

// A box of `nx` by `ny` cells of side h on rollers all around.
Scene box(int nx, int ny, double h, const MaterialOptions& material, int per_element = 4) {
  Scene s = scene(Grid{{0, 0}, {h, h}, nx + 1, ny + 1}, {rectangle("soil", 0, 0, nx * h, ny * h)}, {material}, per_element);
  const double x = nx * h, y = ny * h;
  s.boundaries = {{"base", line({0, 0}, {x, 0}, "roller")}, {"top", line({0, y}, {x, y}, "roller")},
                  {"left", line({0, 0}, {0, y}, "roller")}, {"right", line({x, 0}, {x, y}, "roller")}};
  s.heat.emplace();
  return s;
}

double temperature(const MotionFrame& f, std::size_t k) { return double(f.field("temperature")(k, 0)); }

// What is not in heat's books, over what is.
double lost_heat(const EnergyRow& now, const EnergyRow& start) {
  return (now.heat - start.heat - now.heat_made - now.heat_inflow) / std::max({std::abs(now.heat), std::abs(now.heat_made), std::abs(now.heat_inflow), 1e-300});
}

// Error of a column, 20 degrees at first, whose base is at 30 from time 0, at diffusivity t/H^2 = 0.1.
double error_of_column(int cells, ShapeKind shape, bool upright, int per_element) {
  const double height = 0.5, kappa = 5e-4, h = height / cells, time = 0.1 * height * height / kappa;
  Scene s = upright ? box(2, cells, h, warm(), per_element) : box(cells, 2, h, warm(), per_element);
  s.boundaries[upright ? 0 : 2].second.temperature_c = 30;
  MpmOptions o = still();
  o.shape = shape;
  Solver solver(o, s, 1);
  const EnergyRow start = solver.energy();
  solver.advance_to(time, silent);
  EXPECT_LT(std::abs(lost_heat(solver.energy(), start)), 1e-11);
  const MotionFrame f = solver.frame();
  double sum = 0;
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const double y = upright ? s.particles.x0[k].y() : s.particles.x0[k].x();
    const double e = temperature(f, k) - (20 + 10 * (1 - terzaghi(y / height, 0.1)));
    sum += e * e;
  }
  return std::sqrt(sum / double(f.u.size()));
}

TEST(Heat, ConductsAlongAColumnToTheSecondOrder) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline})
    for (const bool upright : {true, false})
      for (const int per_element : {4, 9}) {
        const double coarse = error_of_column(10, shape, upright, per_element), fine = error_of_column(20, shape, upright, per_element);
        EXPECT_LT(coarse, 0.05) << "of 10 K";
        EXPECT_GT(coarse / fine, 3.2) << int(shape) << upright << per_element << ' ' << coarse << ' ' << fine;
      }
}

// cos x cos y in a closed box decays as one.
double error_of_box(int cells) {
  const double side = 0.4, h = side / cells, kappa = 5e-4, pi = M_PI, time = 0.5 / (kappa * 2 * pi * pi / side / side);
  Scene s = box(cells, cells, h, warm());
  const auto shape = [&](const Vec2& x) { return std::cos(pi * x.x() / side) * std::cos(pi * x.y() / side); };
  s.temperature0.resize(s.particles.size());
  for (std::size_t k = 0; k < s.particles.size(); ++k) s.temperature0[k] = 20 + 10 * shape(s.particles.x0[k]);
  Solver solver(still(), s, 2);
  const EnergyRow start = solver.energy();
  solver.advance_to(time, silent);
  const EnergyRow end = solver.energy();
  EXPECT_EQ(end.heat_inflow, 0);
  EXPECT_NEAR(end.heat, start.heat, 1e-9 * 10 * 1000 * 800 * side * side);
  const MotionFrame f = solver.frame();
  double sum = 0;
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const double e = temperature(f, k) - (20 + 10 * std::exp(-0.5) * shape(s.particles.x0[k]));
    sum += e * e;
  }
  return std::sqrt(sum / double(f.u.size()));
}

TEST(Heat, ConductsInABoxToTheSecondOrder) {
  const double coarse = error_of_box(10), fine = error_of_box(20);
  EXPECT_LT(coarse, 0.1);
  EXPECT_GT(coarse / fine, 3.2) << coarse << ' ' << fine;
}

// Two layers in series: the flux is that of their resistances.
TEST(Heat, PassesLayersInSeries) {
  const double h = 0.05;
  Scene s = scene(Grid{{0, 0}, {h, h}, 3, 11}, {rectangle("a", 0, 0, 2 * h, 5 * h), rectangle("b", 0, 5 * h, 2 * h, 10 * h)}, {warm(400, 80), warm(40, 80)});
  s.boundaries = box(2, 10, h, warm()).boundaries;
  s.heat.emplace();
  s.boundaries[0].second.temperature_c = 40;
  s.boundaries[1].second.temperature_c = 20;
  Solver solver(still(), s, 1);
  const double time = 1200;
  solver.advance_to(time, silent);
  const MotionFrame f = solver.frame();
  const double flux = 20 / (5 * h / 400 + 5 * h / 40);
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const double y = s.particles.x0[k].y(), exact = y < 5 * h ? 40 - flux * y / 400 : 20 + flux * (10 * h - y) / 40;
    EXPECT_NEAR(temperature(f, k), exact, 0.02) << y;
  }
}

TEST(Heat, AGivenFlowWarmsAClosedBox) {
  Scene s = box(4, 3, 0.1, warm());
  s.boundaries[3].second.heat_flux_w_m2 = 1000;
  s.heat->reference_c = 0;
  Solver solver(still(), s, 1);
  const EnergyRow start = solver.energy();
  EXPECT_NEAR(start.heat, 20 * 800 * 1000 * 0.12, 1e-6);
  solver.advance_to(10, silent);
  EXPECT_NEAR(solver.energy().heat_inflow, 1000 * 10 * 0.3, 1e-6);
  EXPECT_LT(std::abs(lost_heat(solver.energy(), start)), 1e-12);
}

// What lies beyond warms a body that conducts well: exponentially.
TEST(Heat, ConvectionFollowsTheDifference) {
  Scene s = box(3, 3, 0.1, warm(4e4));
  s.boundaries[1].second.temperature_c = 50;
  s.boundaries[1].second.heat_transfer_w_m2_k = 400;
  Solver solver(still(), s, 1);
  const double time = 300;
  solver.advance_to(time, silent);
  const MotionFrame f = solver.frame();
  for (std::size_t k = 0; k < f.u.size(); ++k) EXPECT_NEAR(temperature(f, k), 50 - 30 * std::exp(-400 * time / (800 * 1000 * 0.3)), 0.05);
}

// A collapsing dry column: what yields warms, and all of it.
TEST(Heat, WorkBecomesHeat) {
  MaterialOptions m = sand(25, 1e5);
  m.grain_specific_heat_j_kg_k = 800;
  m.conductivity_w_m_k = 1;
  Scene s = column(0.2, m);
  s.boundaries.pop_back();
  s.heat.emplace();
  MpmOptions o = options({0, -9.81});
  o.initial_equilibrium = false;
  Solver solver(o, s, 2);
  const EnergyRow start = solver.energy();
  solver.advance_to(0.1, silent);
  const EnergyRow end = solver.energy();
  EXPECT_GT(end.plastic, 0.1);
  EXPECT_NEAR(end.heat_made, end.plastic, 1e-12 * end.plastic);
  EXPECT_LT(std::abs(lost_heat(end, start)), 1e-9);
}

// Without expansion heat is a passenger: the motion has the same bits.
TEST(Heat, LeavesMotionAlone) {
  const auto run = [](bool heated) {
    MaterialOptions m = sand(25, 1e5);
    Scene s = column(0.2, m);
    if (heated) {
      s.heat.emplace();
      s.materials[0].grain_specific_heat_j_kg_k = 800;
      s.materials[0].conductivity_w_m_k = 1;
    }
    s.boundaries.pop_back();
    MpmOptions o = options({0, -9.81});
    o.initial_equilibrium = false;
    Solver solver(o, s, 1);
    solver.advance_to(0.05, silent);
    return solver.frame();
  };
  const MotionFrame with = run(true), without = run(false);
  EXPECT_EQ(with.u, without.u);
  EXPECT_EQ(with.field("stress").values, without.field("stress").values);
  EXPECT_EQ(without.find("temperature"), nullptr);
}

// A closed wet box that is heated: dp/dT of water, grains and skeleton, without and with the skeleton's growth.
TEST(Heat, UndrainedHeatingRaisesThePressure) {
  for (const PressureScheme scheme : {PressureScheme::in_steps, PressureScheme::projected})
    for (const double skeleton : {0.0, 3e-5}) {
      WaterColumn c;
      c.young = 2e7, c.poisson = 0.33, c.porosity = 0.4, c.permeability = 1e-11, c.grains = 2700;
      c.height = 0.06, c.cells = 6, c.load = 0, c.pressure = scheme;
      Scene s = scene_of(c);
      MaterialOptions& m = s.materials[0];
      m.grain_specific_heat_j_kg_k = 837;
      m.grain_thermal_expansion_1_k = 3e-5;
      m.skeleton_thermal_expansion_1_k = skeleton;
      m.conductivity_w_m_k = 5e6;  // so that all of it warms as one
      s.heat.emplace();
      s.boundaries.emplace_back("top", line({0, c.height}, {2 * c.spacing(), c.height}, "roller"));
      s.boundaries[0].second.heat_flux_w_m2 = 1e6;
      Solver solver(options_of(c), s, 1);
      const double time = 2e-2;
      solver.advance_to(time, silent);
      const MotionFrame f = solver.frame();
      const EnergyRow e = solver.energy();
      double rise = 0, pressure = 0, stress = 0;
      for (std::size_t k = 0; k < f.u.size(); ++k) {
        rise += (temperature(f, k) - 20) / double(f.u.size());
        pressure += double(f.field("pressure")(k, 0)) / double(f.u.size());
        stress += double(f.field("stress")(k, 1)) / double(f.u.size());
      }
      const double capacity = 0.6 * 2700 * 837 + 0.4 * 1000 * 4186, beta = 0.4 * 3.4e-4 + 0.6 * 3e-5;
      EXPECT_NEAR(rise, 1e6 * time / (capacity * c.height), 1e-5 * rise);
      EXPECT_NEAR(pressure, beta * rise * 2.2e9 / 0.4, 2e-3 * pressure) << skeleton;
      EXPECT_NEAR(stress, -2e7 / (3 * 0.34) * skeleton * rise, 0.01 * 2e7 * 3e-5 * rise + 1);
      EXPECT_LT(std::abs(e.residual), 0.01 * std::abs(e.external) + 1e-9);
    }
}

// A wet block that is sheared between plates, its volume kept: pressure against plastic work, p = K_w beta W/(n C).
TEST(Heat, UndrainedShearRaisesThePressureByItsWork) {
  WaterColumn c;
  c.young = 2e7, c.poisson = 0.33, c.porosity = 0.4, c.permeability = 1e-11, c.grains = 2700, c.height = 0.2, c.cells = 4, c.load = 0;
  c.shape = ShapeKind::bilinear, c.damping = 0;
  Scene s = scene_of(c);
  MaterialOptions& m = s.materials[0];
  m.model = "von_mises";
  m.shear_strength_pa = 2e5;
  m.grain_specific_heat_j_kg_k = 837;
  m.grain_thermal_expansion_1_k = 3e-5;
  m.skeleton_thermal_expansion_1_k = 0;
  m.conductivity_w_m_k = 1.4;
  s.heat.emplace();
  BoundaryOptions sides = line({0, 0}, {0, c.height + 2 * c.spacing()}, "tied"), top = line({0, c.height}, {2 * c.spacing(), c.height}, "fixed");
  sides.across_m = Pair{2 * c.spacing(), 0};
  top.velocity_m_s = Pair{2, 0};
  s.boundaries = {{"base", line({0, 0}, {2 * c.spacing(), 0}, "fixed")}, {"sides", sides}, {"top", top}};
  Solver solver(options_of(c), s, 1);
  solver.advance_to(0.04, silent);
  const MotionFrame f = solver.frame();
  const EnergyRow e = solver.energy();
  double pressure = 0;
  for (std::size_t k = 0; k < f.u.size(); ++k) pressure += double(f.field("pressure")(k, 0)) / double(f.u.size());
  const double capacity = 0.6 * 2700 * 837 + 0.4 * 1000 * 4186, beta = 0.4 * 3.4e-4 + 0.6 * 3e-5, volume = 2 * c.spacing() * c.height;
  EXPECT_GT(e.plastic, 5e4 * volume);
  EXPECT_NEAR(pressure, 2.2e9 / 0.4 * beta * e.heat_made / (volume * capacity), 0.01 * pressure);
  EXPECT_NEAR(e.heat_made, e.plastic, 1e-9 * e.plastic);
}

// A front that steady seepage carries along a column, with conduction (Ogata & Banks 1961), upwards and downwards.
TEST(Heat, TheFlowCarriesAFront) {
  for (const bool up : {true, false}) {
    WaterColumn c;
    c.young = 1e8, c.bulk = 2e5, c.porosity = 0.4, c.permeability = 0.06, c.height = 1, c.cells = 20, c.load = 0;
    Scene s = scene_of(c);
    MaterialOptions& m = s.materials[0];
    m.grain_specific_heat_j_kg_k = 837;
    m.conductivity_w_m_k = 1.2e4;
    s.water->thermal_expansion_1_k = 0;
    s.heat.emplace();
    s.boundaries.emplace_back("top", line({0, c.height}, {2 * c.spacing(), c.height}, "roller"));
    BoundaryOptions &base = s.boundaries[0].second, &top = s.boundaries.back().second;
    const double flow = 0.06;
    (up ? base : top).flux_m_s = flow;
    (up ? top : base).pressure_pa = 0;
    (up ? base : top).temperature_c = 30;
    Solver solver(options_of(c), s, 2);
    const EnergyRow start = solver.energy();
    const double capacity = 0.6 * 2650 * 837 + 0.4 * 1000 * 4186, v = 1000 * 4186 * flow / capacity, kappa = 1.2e4 / capacity;
    const double time = 0.4 / v;
    solver.advance_to(time, silent);
    const MotionFrame f = solver.frame();
    double worst = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double y = s.particles.x0[k].y(), x = up ? y : c.height - y, w = 2 * std::sqrt(kappa * time);
      const double exact = 20 + 5 * (std::erfc((x - v * time) / w) + std::exp(v * x / kappa) * std::erfc((x + v * time) / w));
      worst = std::max(worst, std::abs(temperature(f, k) - exact));
    }
    EXPECT_LT(worst, 0.1) << "of 10 K";
    const EnergyRow end = solver.energy();
    EXPECT_LT(std::abs(lost_heat(end, start)), 1e-9);
    EXPECT_GT(end.darcy, 0);
    EXPECT_NEAR(end.heat_made, end.plastic + end.darcy, 1e-12 * end.darcy);
  }
}

// Warm water leaves by one tied side and comes in by the other; a plane wave conducts through the seam.
TEST(Heat, TiedSidesAreOne) {
  const double h = 0.05, kappa = 5e-4, length = 8 * h;
  Scene s = scene(Grid{{0, 0}, {h, h}, 9, 4}, {rectangle("soil", 0, 0, length, 3 * h)}, {warm()});
  BoundaryOptions sides = line({0, 0}, {0, 3 * h}, "tied");
  sides.across_m = Pair{length, 0};
  s.boundaries = {{"base", line({0, 0}, {length, 0}, "fixed")}, {"sides", sides}};
  s.heat.emplace();
  const auto wave = [&](double x) { return std::sin(2 * M_PI * x / length); };
  for (std::size_t k = 0; k < s.particles.size(); ++k) s.temperature0.push_back(20 + 10 * wave(s.particles.x0[k].x()));
  Solver solver(still(), s, 1);
  const double time = 0.5 * length * length / (4 * M_PI * M_PI * kappa);
  solver.advance_to(time, silent);
  const MotionFrame f = solver.frame();
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const double w = wave(s.particles.x0[k].x());
    sum += w * (temperature(f, k) - 20), squares += w * w;
  }
  const double left = sum / squares;
  EXPECT_NEAR(left, 10 * std::exp(-0.5), 0.04 * left) << "eight cells";
  for (std::size_t k = 0; k < f.u.size(); ++k)
    EXPECT_NEAR(temperature(f, k), 20 + left * wave(s.particles.x0[k].x()), 0.02 * left);
  EXPECT_NEAR(solver.energy().heat, 0, 1e-6);
}

TEST(Heat, ACheckpointGoesOnWithTheSameBits) {
  Scene s = box(4, 4, 0.05, warm());
  s.boundaries[0].second.temperature_c = 40;
  Solver solver(still(), s, 1), other(still(), s, 2);
  solver.advance_to(0.31, silent);
  other.load(solver.save());
  solver.advance_to(1, silent);
  other.advance_to(1, silent);
  EXPECT_EQ(solver.frame().field("temperature").values, other.frame().field("temperature").values);
  EXPECT_EQ(solver.energy().heat, other.energy().heat);
}

TEST(Heat, RefusesWhatDoesNotGoWithIt) {
  const auto with = [](const std::function<void(Scene&, MpmOptions&)>& change) {
    return refusal([&] {
      Scene s = box(3, 3, 0.1, warm());
      MpmOptions o = still();
      change(s, o);
      Solver(o, s, 1);
    });
  };
  EXPECT_EQ(with([](Scene&, MpmOptions&) {}), "");
  EXPECT_THAT(with([](Scene& s, MpmOptions&) { s.heat.reset(); }), HasSubstr("material.soil.grain_specific_heat_j_kg_k"));
  EXPECT_THAT(with([](Scene& s, MpmOptions&) { s.materials[0].conductivity_w_m_k.reset(); }), HasSubstr("material.soil.conductivity_w_m_k"));
  EXPECT_THAT(with([](Scene& s, MpmOptions&) { s.materials[0].grain_specific_heat_j_kg_k.reset(); }), HasSubstr("material.soil.grain_specific_heat_j_kg_k"));
  EXPECT_THAT(with([](Scene& s, MpmOptions&) { s.materials[0].band_thickness_m = 0.01; }), HasSubstr("material.soil.band_thickness_m"));
  EXPECT_THAT(with([](Scene& s, MpmOptions&) { s.boundaries[0].second.heat_transfer_w_m2_k = 1; }), HasSubstr("boundary.base.heat_transfer_w_m2_k"));
  EXPECT_THAT(with([](Scene& s, MpmOptions&) { s.boundaries[0].second.temperature_c = 1, s.boundaries[0].second.heat_flux_w_m2 = 1; }), HasSubstr("boundary.base"));
  EXPECT_THAT(with([](Scene&, MpmOptions& o) { o.sleep_below_m_s = 1; }), HasSubstr("mpm.sleep_below_m_s"));
}

}  // namespace
}  // namespace pivnp::mpm
