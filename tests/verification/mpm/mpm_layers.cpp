// Consolidation of layers, and over many steps, against finite volumes of one dimension (tests/support/layered_consolidation.hpp).
//
// 1. Layers of sand, silt and clay in a column drained at its top: from c_v t/h^2 = 3 on, c_v that of the least pervious one, pressures are
//    within 2 % of the load, whatever the contrast of permeability and stiffness, with projected pressure, and up to 100 times the
//    permeability with explicit pressure, by every shape.
// 2. Terzaghi's column of one height over permeabilities of eight decades, projected: pressures are within 1 % of the load from
//    c_v t/H^2 = 2 (h/H)^2 on, whatever the number of steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/support/layered_consolidation.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

struct Soil {
  int cells;
  double young, porosity, permeability;
};
struct Profile {
  std::string name;
  std::vector<Soil> layers;  // from the base upwards
  double rise;               // of the load, in c_v t/h^2 of the least pervious one
};

constexpr double cell = 0.05, load = 2e3, poisson = 0.22;

double modulus_of(double young) { return young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson)); }

/// The greatest error of a point's pressure over the load, at those times (c_v t/h^2 of the least pervious layer).
double error_of(const Profile& profile, ShapeKind shape, PressureScheme pressure, double bulk, const std::vector<double>& times) {
  std::vector<Region> regions;
  std::vector<MaterialOptions> materials;
  pivnp::test::LayeredConsolidation exact;
  exact.load = load;
  const double width = cell;
  double low = 0, slowest = 1e99;
  int cells = 0;
  for (const Soil& soil : profile.layers) cells += soil.cells;
  for (std::size_t k = 0; k < profile.layers.size(); ++k) {
    const Soil& soil = profile.layers[k];
    const bool last = k + 1 == profile.layers.size();
    const double high = last ? cells * cell : low + soil.cells * cell;
    const double modulus = modulus_of(soil.young), storage = soil.porosity / bulk;
    regions.push_back(rectangle("layer " + std::to_string(k), 0, low, width, high));
    materials.push_back(saturated(soil.young, poisson, soil.porosity, soil.permeability));
    exact.layers.push_back({high - low, modulus, soil.permeability, storage});
    slowest = std::min(slowest, soil.permeability / (9810 * (1 / modulus + storage)));
    low = high;
  }
  const double unit = cell * cell / slowest;
  Scene s = scene(Grid{{0, 0}, {cell, cell}, 2, cells + 4}, regions, materials);
  s.water.emplace();
  s.water->bulk_modulus_pa = bulk;
  BoundaryOptions top = line({0, low}, {width, low}, "traction");
  top.traction_pa = {0, -load};
  top.rise_s = exact.rise = profile.rise * unit;
  top.drained = true;
  s.boundaries = {{"base", line({0, 0}, {width, 0}, "roller")},
                  {"left", line({0, 0}, {0, low + 2 * cell}, "roller")},
                  {"right", line({width, 0}, {width, low + 2 * cell}, "roller")},
                  {"load", top}};
  WaterColumn c;
  c.shape = shape;
  c.pressure = pressure;
  c.courant = 0.4;
  if (shape == ShapeKind::bilinear) c.transfer = TransferKind::flip, c.stress = StressUpdate::musl;
  Solver solver(options_of(c), s, 1);
  double worst = 0;
  for (const double time : times) {
    solver.advance_to(time * unit, silent);
    const auto state = exact.at(time * unit, 120, 800);
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k)
      worst = std::max(worst, std::abs(double(f.field("pressure")(k, 0)) - state.at(s.particles.x0[k].y())) / load);
  }
  return worst;
}

const Profile sand_on_clay{"sand on clay, K x 300, E x 6", {{6, 4e6, 0.52, 2e-6}, {4, 24e6, 0.38, 6e-4}}, 0.3};
const Profile silt_on_clay{"silt on clay, K x 10", {{6, 4e6, 0.52, 2e-6}, {4, 4e6, 0.45, 2e-5}}, 0.3};
const Profile clay_on_sand{"clay on sand, K / 100, E / 10", {{4, 3e7, 0.36, 1e-4}, {6, 3e6, 0.5, 1e-6}}, 0.3};

TEST(MpmLayersSmall, PressuresAreThoseOfOneDimension) {
  for (const PressureScheme pressure : schemes) {
    const bool projected = pressure == PressureScheme::projected;
    const Profile& profile = projected ? sand_on_clay : silt_on_clay;
    const double error = error_of(profile, ShapeKind::bspline, pressure, projected ? 2.2e9 : 4e8, {3});
    std::printf("%s, %s: %.4f\n", profile.name.c_str(), std::string(name_of(pressure)).c_str(), error);
    EXPECT_LT(error, 0.02) << name_of(pressure);
  }
}

// With a border through cells and through nodes, and soil that lets nothing through.
TEST(MpmLayersSmall, TheThreadsDoNotChangeABit) {
  for (const PressureScheme pressure : schemes) {
    Scene s = scene(Grid{{0, 0}, {cell, cell}, 6, 14},
                    {rectangle("clay", 0, 0, 5 * cell, 4.3 * cell), rectangle("sand", 0, 4.3 * cell, 5 * cell, 8 * cell),
                     rectangle("rock", 0, 8 * cell, 5 * cell, 10 * cell)},
                    {saturated(4e6, poisson, 0.5, 1e-7), saturated(2e7, poisson, 0.4, 1e-5), saturated(5e7, poisson, 0.2, 0)});
    s.water.emplace();
    s.water->bulk_modulus_pa = 5e8;
    BoundaryOptions top = line({0, 10 * cell}, {5 * cell, 10 * cell}, "traction");
    top.traction_pa = {0, -load};
    top.drained = true;
    s.boundaries = {{"base", line({0, 0}, {5 * cell, 0}, "roller")}, {"load", top}};
    WaterColumn c;
    c.pressure = pressure;
    expect_same_bits(options_of(c), s);
  }
}

TEST(MpmLayers, PressuresAreThoseOfOneDimension) {
  const std::vector<Profile> profiles = {
      sand_on_clay,
      clay_on_sand,
      silt_on_clay,
      {"sand on clay, K x 1e6", {{6, 4e6, 0.52, 1e-7}, {4, 24e6, 0.38, 0.1}}, 0.3},
      {"sand on clay, E x 20", {{6, 2e6, 0.52, 2e-6}, {4, 4e7, 0.38, 2e-4}}, 0.3},
      {"liner of clay in sand", {{4, 2e7, 0.4, 3e-5}, {4, 4e6, 0.5, 1e-6}, {4, 2e7, 0.4, 3e-5}}, 0.5},
      {"sand in clay", {{4, 4e6, 0.5, 2e-6}, {2, 2e7, 0.4, 4e-4}, {4, 4e6, 0.5, 2e-6}}, 0.5},
  };
  for (const PressureScheme pressure : schemes)
    for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline})
      for (const Profile& profile : profiles) {
        double least = 1, most = 0;
        for (const Soil& soil : profile.layers) {
          least = std::min(least, soil.permeability);
          most = std::max(most, soil.permeability);
        }
        if (pressure == PressureScheme::in_steps && most > 100 * least) continue;  // millions of steps
        const double error = error_of(profile, shape, pressure, pressure == PressureScheme::projected ? 2.2e9 : 4e8, {3, 6});
        pivnp::test::verification_row("layers, " + profile.name + ", " + std::string(name_of(pressure)) + ", " + std::string(name_of(shape)),
                                      "pressure within 2 % of the load at c_v t/h^2 3 and 6, of one-dimensional finite volumes",
                                      number(100 * error, 2) + " %");
        EXPECT_LT(error, 0.02) << profile.name << ", " << name_of(pressure) << ", " << name_of(shape);
      }
}

double terzaghi_error(double permeability, int cells, double rise, const std::vector<double>& times) {
  Profile column{"one soil", {{cells, 7e6, 0.35, permeability}}, rise};
  return error_of(column, ShapeKind::bspline, PressureScheme::projected, 2.2e9, times);
}

TEST(MpmManyStepsSmall, DoNotChangeThePressure) {
  for (const double permeability : {3e-5, 3e-6, 3e-7}) {
    const double error = terzaghi_error(permeability, 10, 0.02, {2, 4});
    std::printf("Terzaghi, K %.0e m/s, projected: %.4f\n", permeability, error);
    EXPECT_LT(error, 0.01) << permeability;
  }
}

TEST(MpmManySteps, DoNotChangeThePressure) {
  for (const double permeability : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
    const double error = terzaghi_error(permeability, 10, 0.02, {2, 6});
    pivnp::test::verification_row("Terzaghi, half a metre, projected, K " + number(permeability, 1) + " m/s, 10 cells",
                                  "pressure within 1 % of the load at c_v t/h^2 2 and 6, whatever the number of steps",
                                  number(100 * error, 2) + " %");
    EXPECT_LT(error, 0.01) << permeability;
  }
}

}  // namespace
}  // namespace pivnp::mpm
