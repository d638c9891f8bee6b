// Biaxial tests on wet specimens that no water leaves, whose plastic work heats them: the pressure against the work.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

struct Biaxial {
  double strain = 0, work = 0, pressure = 0, mean = 0, deviator = 0, heat_lost = 0, water_lost = 0;
};

struct Specimen {
  double young = 2e8, strength = 2e5, skeleton = 0, share = 1.0 / 300;  // of the capacity of heat, so that heat matters
  int per_element = 4;
};
constexpr double porosity = 0.4, poisson = 0.33, water_modulus = 2.2e9;

double capacity_of(const Specimen& of) { return of.share * (0.6 * 2700 * 837 + porosity * 1000 * 4186); }

// A quarter of the specimen: symmetry at the left and below, a smooth platen that comes down, nothing at the right.
std::vector<Biaxial> compress(const Specimen& of) {
  const double h = 0.025, width = 0.05, height = 0.1, speed = 0.1;
  MaterialOptions m = elastic(1, poisson, 0);
  m.young_pa = of.young;
  m.model = "von_mises";
  m.shear_strength_pa = of.strength;
  m.porosity = porosity;
  m.permeability_m_s = 1e-12;
  m.grain_density_kg_m3 = 2700;
  m.grain_specific_heat_j_kg_k = 837 * of.share;
  m.grain_thermal_expansion_1_k = 3e-5;
  m.skeleton_thermal_expansion_1_k = of.skeleton;
  m.conductivity_w_m_k = 1.4 * of.share;
  Scene s = scene(Grid{{0, 0}, {h, h}, 5, 7}, {rectangle("soil", 0, 0, width, height)}, {m}, of.per_element);
  s.water.emplace();
  s.water->specific_heat_j_kg_k *= of.share;
  s.heat.emplace();
  s.boundaries = {{"middle", line({0, 0}, {0, 6 * h}, "roller")}, {"base", line({0, 0}, {4 * h, 0}, "roller")}};
  RigidOptions platen;
  platen.polygon_m = {{-h, height}, {4 * h, height}, {4 * h, height + 2 * h}, {-h, height + 2 * h}};
  platen.velocity_m_s = {0, -speed};
  platen.friction = 0;
  s.bodies.emplace_back("platen", platen);
  MpmOptions o = options();
  o.initial_equilibrium = false;
  o.end_at_rest = false;
  o.pressure = PressureScheme::in_steps;
  Solver solver(o, s, 1);
  const EnergyRow start = solver.energy();
  std::vector<Biaxial> rows;
  for (const double strain : {0.02, 0.06}) {
    solver.advance_to(strain * height / speed, silent);
    const MotionFrame f = solver.frame();
    const EnergyRow e = solver.energy();
    Biaxial row{.strain = strain, .work = e.heat_made / (width * height)};
    const double n = double(f.u.size());
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const auto stress = [&](std::size_t c) { return double(f.field("stress")(k, c)); };
      row.pressure += double(f.field("pressure")(k, 0)) / n;
      row.mean -= (stress(0) + stress(1) + stress(2)) / (3 * n);
      row.deviator += (stress(0) - stress(1)) / n;
    }
    row.heat_lost = (e.heat - start.heat - e.heat_made - e.heat_inflow) / e.heat_made;
    row.water_lost = (e.water_mass - start.water_mass - e.water_inflow) / start.water_mass;
    EXPECT_GT(e.darcy, 1e-9 * e.plastic) << "water moves between points";
    EXPECT_NEAR(e.heat_made, e.plastic + e.darcy, 1e-13 * e.plastic);
    rows.push_back(row);
  }
  return rows;
}

// Nothing flows, and a flow without dilatancy changes no volume: with the total mean stress s (a free side: half the stress difference,
// which is twice the strength), the skeleton's K and its growth b_s,
//   p (1/K + n/K_w) = s/K + (beta - b_s) W/C.
TEST(HeatedBiaxial, ThePressureFollowsTheWork) {
  for (const Specimen& of : {Specimen{}, Specimen{.young = 6e8, .skeleton = 3e-5, .share = 1.0 / 100}}) {
    const double bulk = of.young / (3 * (1 - 2 * poisson)), beta = porosity * 3.4e-4 + (1 - porosity) * 3e-5 - of.skeleton;
    for (const Biaxial& row : compress(of)) {
      const auto under = [&](double mean) { return (mean / bulk + beta * row.work / capacity_of(of)) / (1 / bulk + porosity / water_modulus); };
      const double expected = under(of.strength), measured = under(row.mean + row.pressure);
      EXPECT_GT(expected - of.strength / bulk / (1 / bulk + porosity / water_modulus), 0.05 * expected) << "heat matters";
      EXPECT_NEAR(row.deviator, 2 * of.strength, 1e-3 * of.strength);
      EXPECT_NEAR(row.pressure, measured, 0.002 * expected) << row.strain;
      EXPECT_NEAR(row.pressure, expected, 0.01 * expected) << row.strain;
      EXPECT_LT(std::abs(row.heat_lost), 1e-9);
      EXPECT_LT(std::abs(row.water_lost), 1e-12);
    }
  }
}

}  // namespace
}  // namespace pivnp::mpm
