// A soil that softens while it is compressed without lateral strain: its law, and a column under a plate, against the path
// integrated on its own.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"
#include "tests/unit/mpm/material/soil_point.hpp"

namespace pivnp::mpm {
namespace {
namespace k0_softening {

using namespace test;

constexpr double young = 1e7, poisson = 0.25, peak = 18, residual = 8, shape = 100;  // deg; of exp(-shape k)

MaterialOptions softening_soil(const std::string& model) {
  MaterialOptions m = soil(model, peak);
  m.young_pa = young;
  m.poisson = poisson;
  m.friction_residual_deg = residual;
  m.softening_shape = shape;
  m.apex_pa = 1;
  return m;
}

struct Path {
  double across, down, plastic_dev;
};

// From stresses K0 of elasticity: the two horizontal stresses are equal, the state lies on the edge of triaxial compression, and
// with psi = 0 the plastic strains are -2 l down and l across, k grows by 2 l.
Path compressed(double down, double strain) {
  constexpr int steps = 20000;
  const double bulk = young / 3 / (1 - 2 * poisson), shear = young / 2 / (1 + poisson), lame = bulk - 2 * shear / 3;
  Path p{poisson / (1 - poisson) * down, down, 0};
  const auto ratio = [](double k) {
    const double s = std::sin(M_PI / 180 * (residual + (peak - residual) * std::exp(-shape * k)));
    return (1 - s) / (1 + s);
  };
  for (int n = 0; n < steps; ++n) {
    const double de = strain / steps, y = p.down - (lame + 2 * shear) * de, x = p.across - lame * de;
    double low = 0, high = x > ratio(p.plastic_dev) * y ? de : 0;
    for (int i = 0; i < 50; ++i) {
      const double l = 0.5 * (low + high);
      (x - 2 * shear * l > ratio(p.plastic_dev + 2 * l) * (y + 4 * shear * l) ? low : high) = l;
    }
    p = {x - 2 * shear * low, y + 4 * shear * low, p.plastic_dev + 2 * low};
  }
  return p;
}

TEST(K0Softening, TheLawsFollowThePath) {
  // (The smooth law rounds the edge.)
  for (const auto& [model, allowed] : {std::pair{"mohr_coulomb", 1e-3}, {"mohr_coulomb_smooth", 0.02}}) {
    const auto law = make_material(softening_soil(model), model, 1.0);
    SoilPoint point;
    point.stress = {-1000 * poisson / (1 - poisson), -1000, -1000 * poisson / (1 - poisson), 0};
    constexpr int steps = 500;
    for (int k = 0; k < steps; ++k) point.advance(*law, {0, -0.02 / steps, 0, 0});
    const Path exact = compressed(-1000, 0.02);
    EXPECT_NEAR(point.stress[0], exact.across, allowed * std::abs(exact.across)) << model;
    EXPECT_NEAR(point.stress[1], exact.down, allowed * std::abs(exact.down)) << model;
    EXPECT_NEAR(point.plastic_dev, exact.plastic_dev, allowed * exact.plastic_dev + 1e-5) << model;
    EXPECT_GT(exact.across / exact.down, 1.15 * compressed(-1000, 0.004).across / compressed(-1000, 0.004).down);  // it has softened
  }
}

struct Stresses {
  double across, down;
};

// What a column of so many cells bears as a smooth plate compresses it, mean Kirchhoff stresses.
Stresses column_under_a_plate(int cells, double strain, const MaterialOptions& material) {
  const double wide = 0.01 * cells;
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, cells + 1, 17}, {rectangle("soil", 0, 0, wide, 0.1)}, {material});
  s.boundaries = {{"base", line({0, 0}, {wide, 0}, "roller")},
                  {"left", line({0, 0}, {0, 0.16}, "roller")},
                  {"right", line({wide, 0}, {wide, 0.16}, "roller")}};
  const double aside = 1000 * poisson / (1 - poisson);
  s.stress0.assign(s.particles.size(), {-aside, -1000, -aside, 0});
  RigidOptions plate;
  plate.polygon_m = {{-0.01, 0.1}, {wide + 0.01, 0.1}, {wide + 0.01, 0.13}, {-0.01, 0.13}};
  plate.velocity_m_s = Pair{0.0, -0.02};
  plate.friction = 0.0;
  s.bodies = {{"plate", plate}};
  MpmOptions o = options();
  o.initial_equilibrium = false;
  o.locking = Locking::none;
  Solver solver(o, s, 1);
  solver.advance_to(0.1 * (1 - std::exp(-strain)) / 0.02, silent);
  const double J = std::exp(-strain);  // laws work with tau = J sigma
  return {mean_stress(solver, 0, 0.1) * J, mean_stress(solver, 1, 0.1) * J};
}

// A cell wide, which has no room for a band.
TEST(K0Softening, SoDoesAColumnUnderAPlate) {
  const Path exact = compressed(-1000, 0.02);
  const Stresses found = column_under_a_plate(1, 0.02, softening_soil("mohr_coulomb"));
  EXPECT_NEAR(found.down, exact.down, 2e-3 * std::abs(exact.down));
  EXPECT_NEAR(found.across, exact.across, 2e-3 * std::abs(exact.across));
}

// Wider ones leave that path as strain gathers in bands, and keep to it where softening is averaged over more than bands are apart
// (docs/theory/mpm_materials.md#when-a-softening-path-is-stable).
TEST(K0Softening, AWideColumnDoesSoWithNonLocalSoftening) {
  const Path exact = compressed(-1000, 0.01);
  MaterialOptions m = softening_soil("mohr_coulomb");
  EXPECT_GT(column_under_a_plate(10, 0.01, m).across / exact.across, 1.05);
  m.softening_average = SofteningAverage::nonlocal;
  m.softening_length_m = 0.05;
  const Stresses found = column_under_a_plate(10, 0.01, m);
  EXPECT_NEAR(found.down, exact.down, 5e-3 * std::abs(exact.down));
  EXPECT_NEAR(found.across, exact.across, 5e-3 * std::abs(exact.across));
}

}  // namespace k0_softening
}  // namespace
}  // namespace pivnp::mpm
