// Soils at a point: softening, dilatancy and friction that change, Drucker-Prager,
// mu(I), water.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "mpm/material/material.hpp"
#include "mpm/material/mohr_coulomb.hpp"
#include "mpm/material/smooth_mohr_coulomb.hpp"
#include "pivnp/core/error.hpp"
#include "tests/unit/mpm/material/soil_point.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
using Point = SoilPoint;

TEST(SmoothMohrCoulomb, RandomIncrementsEndOnOrInsideTheSurface) {
  for (const double cohesion : {0.0, 2000.0})
    for (const bool softens : {false, true}) {
      MaterialOptions o = soil("mohr_coulomb_smooth", 35, cohesion);
      o.dilatancy_deg = 5;
      if (softens) {
        o.friction_residual_deg = 25;
        o.softening_shape = 50;
      }
      const auto law = make_material(o, "m");
      std::mt19937_64 random(5);
      std::normal_distribution<double> n(0, 3e-4);
      Point p;
      for (int k = 0; k < 2000; ++k) {
        p.advance(*law, {n(random) - 1e-4, n(random) - 1e-4, 0.1 * n(random), n(random)}, n(random));
        ASSERT_LE(dynamic_cast<const SmoothMohrCoulomb&>(*law).relative_yield(p.stress, p.plastic_dev, p.J), 1e-8) << k;
      }
    }
}

// Stresses, stiffness, cohesion and apex of another size (a model's, or a mountain's): the same strains end alike.
TEST(SmoothMohrCoulomb, IsTheSameLawAtEverySizeOfStress) {
  for (const double size : {1.0 / 512, 64.0})
    for (const double cohesion : {0.0, 300.0}) {
      const auto law_of = [&](double by) {
        MaterialOptions o = soil("mohr_coulomb_smooth", 33, by * cohesion);
        o.young_pa = by * 4e6;
        o.dilatancy_deg = 4;
        o.apex_pa = by * 6;
        return make_material(o, "m");
      };
      const auto law = law_of(1), other = law_of(size);
      std::mt19937_64 random(11);
      std::normal_distribution<double> n(0, 1e-4);
      Point a, b;
      for (int k = 0; k < 500; ++k) {
        const Tensor de{n(random) - 3e-5, n(random) - 3e-5, 0.1 * n(random), n(random)};
        a.advance(*law, de);
        b.advance(*other, de);
        for (std::size_t q = 0; q < 4; ++q) ASSERT_EQ(b.stress[q], size * a.stress[q]) << k;
      }
    }
}

// Without rounding in between (theta within 25 degrees) the smooth surface is Mohr-Coulomb's.
TEST(SmoothMohrCoulomb, AgreesWithTheClosedFormInPlaneStrain) {
  MaterialOptions o = soil("mohr_coulomb_smooth", 30);
  o.apex_pa = 1;
  const auto smooth = make_material(o, "m");
  o.model = "mohr_coulomb";
  const auto sharp = make_material(o, "m");
  Point a, b;
  a.stress = b.stress = {-5000, -10000, -5000, 0};
  for (int k = 0; k < 400; ++k)
    for (auto [p, law] : {std::pair{&a, smooth.get()}, {&b, sharp.get()}}) p->advance(*law, {5e-6, -5e-6, 0, 3e-6});
  for (std::size_t q = 0; q < 4; ++q) EXPECT_NEAR(a.stress[q], b.stress[q], 0.003 * std::abs(b.mean()));
  EXPECT_NEAR(a.plastic_dev, b.plastic_dev, 0.01 * b.plastic_dev);
}

TEST(SmoothMohrCoulomb, OpenSandFliesFreeAndLandsWithItsVolume) {
  const auto law = make_material(soil("mohr_coulomb_smooth", 30), "m");
  Point p;
  p.advance(*law, {-1e-4, -1e-4, 0, 0});
  const double loaded = p.mean();
  p.advance(*law, {5e-3, 5e-3, 0, 0});
  EXPECT_NEAR(p.opening, 0.01 - 2e-4, 1e-9);
  EXPECT_LT(std::abs(p.mean()), 1e-6);
  EXPECT_LT(p.bar(), 10);  // the floor
  p.advance(*law, {-3e-3, -3e-3, 0, 2e-3});
  EXPECT_LT(std::abs(p.mean()), 1e-6);
  p.advance(*law, {-2e-3, -2e-3, 0, 0});
  EXPECT_EQ(p.opening, 0);
  EXPECT_NEAR(p.mean(), loaded, 1e-6 * std::abs(loaded));
}

// One step of an open point against many: strains of so many radii of the surface at its greatest mean stress (zero), in
// random directions. What is allowed is a thousandth of the scale of the strength, here 1 kPa for sand (with a radius of some
// 9 Pa by the floor alone) and c; where strain runs nearly along a flat side of the surface and turns a corner slowly, sand
// may keep up to its radius.
TEST(SmoothMohrCoulomb, AnOpenPointsStepIsThatOfAThousand) {
  constexpr unsigned seed = 5;
  SCOPED_TRACE(seed);
  for (const double cohesion : {0.0, 10000.0})
    for (const double radii : {0.5, 3.0, 20.0, 200.0})
      for (const double dilatancy : {0.0, 10.0}) {
        SCOPED_TRACE(testing::Message() << "c " << cohesion << ", radii " << radii << ", dilatancy " << dilatancy);
        MaterialOptions o = soil("mohr_coulomb_smooth", cohesion > 0 ? 25 : 35, cohesion);
        o.dilatancy_deg = dilatancy;
        if (cohesion > 0) o.friction_residual_deg = 20, o.cohesion_residual_pa = 9000, o.softening_shape = 1;
        const auto law = make_material(o, "m");
        const double scale = std::max(cohesion, 1000.0), radius = cohesion > 0 ? 1.3e4 : 9;
        const double one_radius = radius / (2 * law->elastic().shear);
        std::mt19937_64 random(seed);
        std::normal_distribution<double> n(0, 1);
        double sum = 0, worst = 0;
        const int points = 40, steps = 400;
        for (int k = 0; k < points; ++k) {
          Point one;
          one.separated = 1;
          one.opening = 100 * radii * one_radius;
          const auto strained = [&](double share) -> Tensor {
            Tensor de{n(random), n(random), 0.2 * n(random), n(random)};
            const double size = share * one_radius / std::sqrt(product(de, de));
            return {de[0] * size, de[1] * size, de[2] * size, de[3] * size};
          };
          for (int q = 0; q < 5; ++q) one.advance(*law, strained(2));
          one.opening = 2 * radii * one_radius;
          Point many = one;
          const Tensor de = strained(radii);
          one.advance(*law, de);
          for (int q = 0; q < steps; ++q) many.advance(*law, {de[0] / steps, de[1] / steps, de[2] / steps, de[3] / steps});
          ASSERT_GT(many.opening, 0);
          EXPECT_NEAR(one.opening, many.opening, 0.01 * many.opening);
          EXPECT_NEAR(one.mean(), 0, 1e-9 * scale);
          double error = 0;
          for (std::size_t c = 0; c < 4; ++c) error = std::max(error, std::abs(one.stress[c] - many.stress[c]) / scale);
          sum += error;
          worst = std::max(worst, error);
        }
        EXPECT_LT(sum / points, 3e-4);
        EXPECT_LT(worst, cohesion == 0 && radii > 100 ? 0.01 : 1e-3);
      }
}

// Compression that closes an open point within the step, after it has sheared while it was open.
TEST(SmoothMohrCoulomb, ClosesWithinAStepAsInAThousand) {
  for (const double cohesion : {0.0, 10000.0})
    for (const double dilatancy : {0.0, 10.0}) {
      SCOPED_TRACE(testing::Message() << "c " << cohesion << ", dilatancy " << dilatancy);
      MaterialOptions o = soil("mohr_coulomb_smooth", 35, cohesion);
      o.dilatancy_deg = dilatancy;
      const auto law = make_material(o, "m");
      Point one;
      one.separated = 1;
      one.opening = 1e-3;
      Point many = one;
      const Tensor de{-1.5e-3, -5e-4, 0, 4e-4};
      one.advance(*law, de);
      for (int q = 0; q < 1000; ++q) many.advance(*law, {de[0] / 1000, de[1] / 1000, 0, de[3] / 1000});
      EXPECT_EQ(one.opening, 0);
      EXPECT_EQ(many.opening, 0);
      const double scale = std::max({cohesion, -many.mean(), 1000.0});
      for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(one.stress[c], many.stress[c], 1e-3 * scale) << c;
      EXPECT_NEAR(one.plastic_dev, many.plastic_dev, 0.01 * many.plastic_dev);
    }
}

// 4.13, 4.14 on a path that reverses: strength never comes back.
class SofteningModels : public testing::TestWithParam<const char*> {};

TEST_P(SofteningModels, StrengthFallsAlongThePathAndDoesNotComeBack) {
  MaterialOptions o = soil(GetParam(), 0, 2000);
  o.tension_pa = 1e9;
  o.cohesion_residual_pa = 500;
  o.softening_shape = 30;
  const auto law = make_material(o, "m");
  Point p;
  double before = 0;
  const auto expected = [&](double k) { return 500 + 1500 * std::exp(-30 * k); };
  for (int k = 0; k < 4000; ++k) {
    before = p.plastic_dev;
    p.advance(*law, {0, 0, 0, k % 2000 < 1000 ? 1e-5 : -1e-5});
    if (p.plastic_dev > before) {
      EXPECT_LE(p.bar(), expected(before) * (1 + 1e-6));
      EXPECT_GE(p.bar(), expected(p.plastic_dev) * (1 - 0.02));
    }
  }
  EXPECT_NEAR(p.plastic_dev, 4e-2 * 2 / std::sqrt(3), 0.1 * p.plastic_dev);
  EXPECT_NEAR(std::abs(p.stress[3]), expected(p.plastic_dev), 0.01 * 2000);
}

TEST_P(SofteningModels, DilatancyFades) {
  MaterialOptions o = soil(GetParam(), 35);
  o.dilatancy_deg = 10;
  o.dilatancy_fade = 0.01;
  const auto law = make_material(o, "m");
  Point p;
  p.stress = {-1e4, -1e4, -1e4, 0};
  // Shear at constant pressure: what expands is plastic.
  double volume = 0;
  for (int k = 0; k < 20000; ++k) {
    p.advance(*law, {0, 0, 0, 1e-5});
    const double back = -(p.mean() + 1e4) / (3 * (1e7 / (3 * 0.4)));
    p.advance(*law, {back, back, back, 0});
    volume += 3 * back;
  }
  // d(volume) = sin psi(k) dg with dg the shear of plane strain, dk = dg/sqrt 3: bounded by psi0 fade sqrt 3.
  EXPECT_NEAR(volume, std::sin(10 * M_PI / 180) * 0.01 * std::sqrt(3), 0.1 * volume);
}

TEST_P(SofteningModels, FrictionFallsWithPressure) {
  MaterialOptions o = soil(GetParam(), 30);
  o.friction_low_stress_deg = 43;
  o.friction_half_pa = 1e4;
  o.apex_pa = 1;
  const auto law = make_material(o, "m");
  for (const double pressure : {200.0, 1e4, 2e5}) {
    Point p;
    p.stress = {-pressure, -pressure, -pressure, 0};
    for (int k = 0; k < 3000; ++k) {
      p.advance(*law, {0, 0, 0, 1e-6 * pressure / 200});
      const double back = -(p.mean() + pressure) / (3 * (1e7 / (3 * 0.4)));
      p.advance(*law, {back, back, back, 0});
    }
    const double phi = (30 + 13 / (1 + pressure / 1e4)) * M_PI / 180;
    const double in_plane = -0.5 * (p.stress[0] + p.stress[1]);
    const double radius = std::hypot(0.5 * (p.stress[0] - p.stress[1]), p.stress[3]);
    EXPECT_NEAR(radius / in_plane, std::sin(phi), 0.03 * std::sin(phi)) << pressure;
  }
}

INSTANTIATE_TEST_SUITE_P(Both, SofteningModels, testing::Values("mohr_coulomb", "mohr_coulomb_smooth"));

// A band one cell wide sheared by a given slip dissipates the same whatever the cell, with a length.
TEST(Softening, DissipationOfABandDoesNotDependOnItsCells) {
  MaterialOptions o = soil("mohr_coulomb", 0, 2000);
  o.tension_pa = 1e9;
  o.cohesion_residual_pa = 500;
  o.softening_shape = 50;
  const auto work = [&](double cell) {
    const auto law = make_material(o, "m", cell);
    Point p;
    const double slip = 0.02;  // m
    for (int k = 0; k < 4000; ++k) p.advance(*law, {0, 0, 0, 0.5 * slip / cell / 4000});
    return p.dissipated * cell;  // J/m^2
  };
  const double wild = work(0.05) / work(0.0125);
  EXPECT_GT(wild, 1.1);
  o.softening_length_m = 0.03;
  const double first = work(0.05), second = work(0.025), third = work(0.0125);
  EXPECT_NEAR(second, first, 0.02 * first);
  EXPECT_NEAR(third, first, 0.02 * first);
}

TEST(DruckerPrager, HasMohrCoulombsStrengthInPlaneStrain) {
  for (const double psi : {0.0, 10.0, 30.0}) {
    MaterialOptions o = soil("drucker_prager", 30, 1000);
    o.dilatancy_deg = psi;
    o.tension_pa = 1e9;
    const auto law = make_material(o, "m");
    Point p;
    p.stress = {-1e4, -1e4, -1e4, 0};
    for (int k = 0; k < 20000; ++k) {
      p.advance(*law, {0, 0, 0, 1e-6});
      const double in_plane = 0.5 * (p.stress[0] + p.stress[1]);
      const double back = -(in_plane + 1e4) / (2 * 1e7);  // plane strain: ezz stays
      p.advance(*law, {back, back, 0, 0});
    }
    const double radius = std::hypot(0.5 * (p.stress[0] - p.stress[1]), p.stress[3]);
    const double in_plane = -0.5 * (p.stress[0] + p.stress[1]);
    EXPECT_NEAR(radius, in_plane * 0.5 + 1000 * std::cos(M_PI / 6), 0.01 * radius) << psi;
  }
}

TEST(MuI, FrictionGrowsWithTheRateAsTheLawSays) {
  MaterialOptions o = soil("mu_i", 21);
  o.friction_flow_deg = 33;
  o.grain_diameter_m = 1e-3;
  const auto law = make_material(o, "m");
  const double p0 = 500, low = std::sin(21 * M_PI / 180), high = std::sin(33 * M_PI / 180);
  for (const double rate : {0.0, 1.0, 30.0, 1000.0}) {
    Point p;
    p.stress = {-p0, -p0, -p0, 0};
    const double dt = rate > 0 ? 1e-6 / rate : 0;
    for (int k = 0; k < 5000; ++k) p.advance(*law, {0, 0, 0, 0.5e-6}, 0, dt);
    const double I = rate * 1e-3 * std::sqrt(2650 / p0);
    EXPECT_NEAR(p.bar() / -p.mean(), low + (high - low) * I / (I + 0.279), 1e-4) << rate;
    EXPECT_NEAR(p.mean(), -p0, 1e-6);
  }
}

TEST(SoilOptions, NonsenseNamesItsKey) {
  const auto message = [](const MaterialOptions& o) -> std::string {
    try {
      make_material(o, "material.sand", 0.01);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const auto expect = [&](auto&& change, const std::string& key, const std::string& model = "mohr_coulomb") {
    MaterialOptions o = soil(model);
    change(o);
    EXPECT_NE(message(o).find("material.sand." + key), std::string::npos) << key << ": " << message(o);
  };
  expect([](auto& o) { o.friction_residual_deg = 35; o.softening_shape = 1; }, "friction_residual_deg");
  expect([](auto& o) { o.friction_residual_deg = 25; }, "softening_shape");
  expect([](auto& o) { o.softening_shape = 10; }, "softening_shape");
  expect([](auto& o) { o.softening_length_m = 1; }, "softening_length_m");
  expect([](auto& o) { o.friction_low_stress_deg = 40; }, "friction_low_stress_deg");
  expect([](auto& o) { o.friction_low_stress_deg = 20; o.friction_half_pa = 1e4; }, "friction_low_stress_deg");
  expect([](auto& o) { o.friction_half_pa = 1e4; }, "friction_half_pa");
  expect([](auto& o) { o.dilatancy_fade = 0.0; }, "dilatancy_fade");
  expect([](auto& o) { o.apex_pa = 0; }, "apex_pa", "mohr_coulomb_smooth");
  expect([](auto& o) { o.friction_residual_deg = 25; }, "friction_residual_deg", "drucker_prager");
  expect([](auto& o) { o.friction_flow_deg = 40; }, "friction_flow_deg");
  expect([](auto& o) { o.friction_flow_deg = 20; o.grain_diameter_m = 1e-3; }, "friction_flow_deg", "mu_i");
  expect([](auto& o) { o.friction_flow_deg = 40; }, "grain_diameter_m", "mu_i");
  expect([](auto&) {}, "bulk_pa", "water");
}

}  // namespace
}  // namespace pivnp::mpm
