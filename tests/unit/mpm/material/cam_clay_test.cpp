// Modified Cam-Clay against the closed forms of its equations; Lambda = (lambda - kappa)/lambda, eta = q/p.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mpm/scene/element_test.hpp"
#include "pivnp/core/math.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr double lambda = 0.21, kappa = 0.045, phi = 26, void_ratio = 1.3;

MaterialOptions kaolin(double ocr = 1) {
  MaterialOptions m;
  m.model = "modified_cam_clay";
  m.density_kg_m3 = 1700;
  m.poisson = 0.28;
  m.friction_deg = phi;
  m.own_value("lambda") = lambda;
  m.own_value("kappa") = kappa;
  m.own_value("void_ratio") = void_ratio;
  m.own_value("preconsolidation_pa") = 500;
  m.own_value("ocr") = ocr;
  return m;
}

double slope_in_compression() {
  const double sine = std::sin(radians(phi));
  return 6 * sine / (3 - sine);
}

ElementPath tested(const MaterialOptions& m, ElementTest test, double pressure, double strain, bool undrained = false, int steps = 2000) {
  ElementTestOptions o;
  o.test = test;
  o.pressure_pa = pressure;
  o.strain = strain;
  o.undrained = undrained;
  o.steps = steps;
  return element_test(m, "material.clay", o);
}

// v constant: (p/p0)^(1/Lambda) = OCR/(1 + eta^2/M^2) from yield on, p = p0 before.
TEST(CamClay, UndrainedPathsFollowTheirEquation) {
  const double M = slope_in_compression(), p0 = 150e3;
  for (const double ocr : {1.0, 1.6, 3.0, 8.0}) {
    const ElementPath path = tested(kaolin(ocr), ElementTest::triaxial, p0, 0.6, true);
    ASSERT_EQ(path.ended, "");
    for (std::size_t k = 0; k < path.size(); ++k) {
      if (path.history[0].second[k] == 0) {
        EXPECT_NEAR(path.mean[k], p0, 1e-9 * p0) << ocr;
        continue;
      }
      const double eta = path.deviator[k] / path.mean[k];
      ASSERT_NEAR(path.mean[k], p0 * std::pow(ocr / (1 + eta * eta / (M * M)), 1 - kappa / lambda), 1e-3 * p0) << ocr << ", step " << k;
    }
    EXPECT_NEAR(path.deviator.back(), M * path.mean.back(), 5e-3 * p0) << ocr;
  }
}

// At the critical state q = M p, and v lies (lambda - kappa) ln 2 below the isotropic compression line.
TEST(CamClay, DrainedCompressionEndsAtTheCriticalState) {
  const double M = slope_in_compression(), p0 = 80e3, p = 3 * p0 / (3 - M);
  for (const double ocr : {1.0, 2.5}) {
    const ElementPath path = tested(kaolin(ocr), ElementTest::triaxial, p0, 0.85);
    ASSERT_EQ(path.ended, "");
    EXPECT_NEAR(path.deviator.back(), M * p, 3e-3 * M * p) << ocr;
    // On the swelling line of p_c = OCR p0 at the start.
    const double v = 1 + void_ratio + (lambda - kappa) * std::log(ocr) - lambda * std::log(p / p0) - (lambda - kappa) * std::log(2.0);
    EXPECT_NEAR((1 - path.volume.back()) * (1 + void_ratio), v, 2e-3) << ocr;
  }
}

// Virgin compression by lambda, unloading by kappa.
TEST(CamClay, CompressionAndSwellingLines) {
  const double top = 400e3;
  const ElementPath path = tested(kaolin(), ElementTest::isotropic, top, 0.2);
  const std::size_t at = std::size_t(std::max_element(path.mean.begin(), path.mean.end()) - path.mean.begin());
  const auto v = [&](std::size_t k) { return (1 - path.volume[k]) * (1 + void_ratio); };
  EXPECT_NEAR(v(0) - v(at), lambda * std::log(path.mean[at] / path.mean[0]), 1e-4);
  EXPECT_NEAR(v(path.size() - 1) - v(at), kappa * std::log(10.0), 1e-4);
}

// Stress has one unit: stresses times 1e3, the same bits of ratios up to round-off.
TEST(CamClay, KnowsNoUnitOfStress) {
  MaterialOptions large = kaolin(2);
  large.own_value("preconsolidation_pa") = 5e5;
  const ElementPath a = tested(kaolin(2), ElementTest::biaxial, 40e3, 0.3), b = tested(large, ElementTest::biaxial, 40e6, 0.3);
  for (std::size_t k = 0; k < a.size(); k += 50) {
    EXPECT_NEAR(b.deviator[k], 1e3 * a.deviator[k], 1e-5 * b.deviator.back());
    EXPECT_NEAR(b.volume[k], a.volume[k], 1e-7);
  }
}

// First order in the step: the shear modulus is that of the trial.
TEST(CamClay, RefinedStepsConverge) {
  const auto strength = [](int steps) { return tested(kaolin(1.5), ElementTest::triaxial, 100e3, 0.3, false, steps).deviator.back(); };
  const double exact = strength(6400), coarse = strength(60) - exact, fine = strength(120) - exact;
  EXPECT_LT(std::abs(coarse), 5e-3 * exact);
  EXPECT_GT(coarse / fine, 1.8);
  EXPECT_LT(coarse / fine, 4.4);
}

// A layer at rest stays at rest once its preconsolidation is set; a plate pushed into it keeps the balance of energy.
TEST(CamClay, ALayerRestsAndBearsAPlate) {
  Scene s = scene(Grid{{0, 0}, {0.1, 0.1}, 31, 21}, {rectangle("clay", 0, 0, 3, 1)}, {kaolin(1.5)});
  s.boundaries = {{"base", line({0, 0}, {3, 0}, "fixed")}, {"left", line({0, 0}, {0, 2}, "roller")}, {"right", line({3, 0}, {3, 2}, "roller")}};
  MpmOptions o = options({0, -9.81});
  o.gravity_m_s2 = {0, -9.81};
  o.initial_equilibrium = true;
  Solver still(o, s, 1);
  still.find_initial_equilibrium(silent);
  still.advance_to(0.2, silent);
  for (const auto& u : still.frame().u) ASSERT_LT(std::hypot(u[0], u[1]), 2e-3 * 0.1);  // of a cell

  RigidOptions plate;
  plate.polygon_m = {{1.2, 1}, {1.8, 1}, {1.8, 1.3}, {1.2, 1.3}};
  plate.velocity_m_s = Pair{0.0, -0.2};
  s.bodies = {{"plate", plate}};
  Solver loaded(o, s, 1);
  loaded.find_initial_equilibrium(silent);
  loaded.advance_to(0.3, silent);
  const EnergyRow e = loaded.energy();
  EXPECT_GT(e.external, 0);
  EXPECT_LT(std::abs(e.residual), 0.03 * e.external);
}

// Weight that comes in a confined layer without stress compresses it along the lines of its state, from the least pressure on.
TEST(CamClay, ALayerTakesItsWeightFromNothing) {
  MaterialOptions clay = kaolin();
  clay.own_value("preconsolidation_pa") = 5e3;
  Scene s = scene(Grid{{0, 0}, {0.1, 0.1}, 11, 21}, {rectangle("clay", 0, 0, 1, 1)}, {clay});
  s.boundaries = {{"base", line({0, 0}, {1, 0}, "fixed")}, {"left", line({0, 0}, {0, 2}, "roller")}, {"right", line({1, 0}, {1, 2}, "roller")}};
  MpmOptions o = options({0, -9.81});
  o.gravity_from_m_s2 = Pair{0.0, 0.0};
  o.gravity_ramp_s = 0.6;
  o.damping = 0.2;
  Solver solver(o, s, 1);
  solver.advance_to(0.9, silent);
  const MotionFrame frame = solver.frame();
  for (std::size_t k = 0; k < frame.v.size(); ++k) {
    ASSERT_TRUE(std::isfinite(frame.u[k][1]));
    ASSERT_GT(frame.u[k][1], -0.25);
    ASSERT_LT(std::hypot(frame.u[k][0], 0), 0.02);
  }
}

TEST(CamClay, RefusesWhatItCannotBe) {
  const auto fault = [](auto&& change) {
    MaterialOptions m = kaolin();
    change(m);
    try {
      make_material(m, "material.clay");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(fault([](MaterialOptions&) {}), "");
  EXPECT_EQ(fault([](MaterialOptions& m) { m.own_value("kappa") = 0.3; }), "material.clay.kappa: found 0.3, expected less than lambda");
  EXPECT_NE(fault([](MaterialOptions& m) { m.own_value("void_ratio").reset(); }).find("material.clay.void_ratio: missing"), std::string::npos);
  EXPECT_NE(fault([](MaterialOptions& m) { m.poisson = 0.48; }).find("material.clay.poisson: found 0.48, expected at most 0.45"), std::string::npos);
  EXPECT_NE(fault([](MaterialOptions& m) { m.young_pa = 1e6; }).find("material.clay.young_pa: given with model"), std::string::npos);
}

}  // namespace
}  // namespace pivnp::mpm
