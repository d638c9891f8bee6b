// Element tests on laws whose answers are known in closed form.
#include "mpm/scene/element_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pivnp/core/error.hpp"
#include "pivnp/core/math.hpp"
#include "tests/unit/mpm/material/soil_point.hpp"

namespace pivnp::mpm {
namespace {

ElementTestOptions element_of(ElementTest test, double pressure, double strain = 0.1) {
  ElementTestOptions o;
  o.test = test;
  o.pressure_pa = pressure;
  o.strain = strain;
  o.steps = 400;
  return o;
}

// Mohr-Coulomb at failure: s1 = s3 tan^2(45 + phi/2) + 2 c tan(45 + phi/2), in every form of compression.
TEST(ElementTests, PeaksAreThoseOfTheStrength) {
  const double phi = 33, c = 4e3, root = std::tan(radians(45 + phi / 2));
  MaterialOptions m = test::soil("mohr_coulomb", phi, c);
  m.dilatancy_deg = 7;
  for (const ElementTest test : {ElementTest::triaxial, ElementTest::biaxial}) {
    std::vector<ElementPath> paths;
    for (const double p : {40e3, 130e3}) {
      paths.push_back(element_test(m, "material.a", element_of(test, p)));
      EXPECT_EQ(paths.back().ended, "");
      EXPECT_NEAR(paths.back().horizontal.back(), p, 1e-6 * p);
      EXPECT_NEAR(paths.back().vertical.back(), p * root * root + 2 * c * root, 1e-3 * p * root * root);
    }
    const auto line = strength_line(paths, test);
    ASSERT_TRUE(line);
    EXPECT_NEAR(line->friction_deg, phi, 0.05);
    EXPECT_NEAR(line->cohesion_pa, c, 0.02 * c);
  }
}

// Dilatancy: at failure in triaxial compression d eps_v/d eps_a = -2 sin psi/(1 - sin psi) of logarithmic strains.
TEST(ElementTests, VolumeGrowsByTheDilatancy) {
  MaterialOptions m = test::soil("mohr_coulomb", 36);
  m.dilatancy_deg = 9;
  m.young_pa = 1e8;
  const ElementPath path = element_test(m, "material.a", element_of(ElementTest::triaxial, 80e3));
  const std::size_t a = path.size() / 2, b = path.size() - 1;
  const double volume = std::log((1 - path.volume[b]) / (1 - path.volume[a])), axial = std::log((1 - path.strain[b]) / (1 - path.strain[a]));
  const double sine = std::sin(radians(9.0));
  EXPECT_NEAR(volume / -axial, 2 * sine / (1 - sine), 2e-3);
}

// Undrained: volume constant; q at failure 2 s_u, however large the pressure; the pore pressure keeps the cell pressure.
TEST(ElementTests, UndrainedKeepsTheVolume) {
  MaterialOptions m = test::soil("mohr_coulomb", 28);
  ElementTestOptions o = element_of(ElementTest::triaxial, 120e3, 0.08);
  o.undrained = true;
  const ElementPath path = element_test(m, "material.a", o);
  for (const double v : path.volume) EXPECT_NEAR(v, 0, 1e-12);
  // Elastic isotropy and no dilatancy: p' stays, so q = M p' with M = 6 sin phi/(3 - sin phi).
  const double sine = std::sin(radians(28.0));
  EXPECT_NEAR(path.mean.back(), 120e3, 1e-3 * 120e3);
  EXPECT_NEAR(path.deviator.back(), 6 * sine / (3 - sine) * 120e3, 2e-3 * 120e3);
  EXPECT_NEAR(path.pore_pressure.back(), 120e3 - path.horizontal.back(), 1e-6 * 120e3);
}

// One dimension: K0 = nu/(1 - nu), and the height by the logarithmic strain s/M of an elastic skeleton, back on unloading.
TEST(ElementTests, AnOedometerIsElasticInOneDimension) {
  MaterialOptions m = test::soil("linear_elastic");
  m.young_pa = 2e6;
  m.poisson = 0.25;
  const double modulus = 2e6 * 0.75 / (1.25 * 0.5);
  const ElementPath path = element_test(m, "material.a", element_of(ElementTest::oedometer, 50e3));
  const std::size_t top = std::size_t(std::max_element(path.vertical.begin(), path.vertical.end()) - path.vertical.begin());
  EXPECT_NEAR(path.vertical[top], 50e3, 1);
  const double J = (1 - path.strain[top]);  // Kirchhoff stress J s = M ln of the height's stretch, less that of the start
  EXPECT_NEAR(std::log(J), -(J * 50e3 - 500) / modulus, 2e-5);
  EXPECT_NEAR((path.horizontal[top] * J - 500) / (path.vertical[top] * J - 500), 0.25 / 0.75, 1e-3);
  EXPECT_NEAR(path.vertical.back(), 5e3, 1);
  EXPECT_NEAR(std::log(1 - path.strain.back()), -((1 - path.strain.back()) * 5e3 - 500) / modulus, 2e-5);
}

// Simple shear at constant vertical stress: the horizontal plane does not extend, so it carries cos psi sin phi/(1 - sin psi sin phi) of
// the vertical stress (Davis 1968): sin phi without dilatancy, tan phi with psi = phi.
TEST(ElementTests, ShearIsThatOfDavis) {
  const double phi = 32, sine = std::sin(radians(phi));
  for (const double psi : {0.0, 11.0, 32.0}) {
    MaterialOptions m = test::soil("mohr_coulomb", phi);
    m.dilatancy_deg = psi;
    const ElementPath path = element_test(m, "material.a", element_of(ElementTest::simple_shear, 60e3, 0.05));
    EXPECT_EQ(path.ended, "");
    EXPECT_NEAR(path.vertical.back(), 60e3, 0.1);
    EXPECT_NEAR(path.shear.back() / 60e3, std::cos(radians(psi)) * sine / (1 - std::sin(radians(psi)) * sine), 0.005) << psi;
  }
}

// The specimen turns as it shears: b of a shear gamma has principal logarithmic strains +-asinh(gamma/2), at half the angle whose tangent
// is 2/gamma to the base.
TEST(ElementTests, AShearedSpecimenTurns) {
  MaterialOptions m = test::soil("linear_elastic");
  ElementTestOptions o = element_of(ElementTest::simple_shear, 1e5, 1.2);
  o.undrained = true;
  o.steps = 2000;
  const ElementPath path = element_test(m, "material.a", o);
  const double gamma = 1.2, twice_strain = 2 * std::asinh(gamma / 2), root = std::sqrt(4 + gamma * gamma), G = m.young_pa / (2 * (1 + m.poisson));
  EXPECT_NEAR(path.shear.back(), G * twice_strain * 2 / root, 1e-3 * G);
  EXPECT_NEAR(path.vertical.back() - path.horizontal.back(), 2 * G * twice_strain * gamma / root, 1e-3 * G);
}

// Units: stresses and pressures times a number give the same strains.
TEST(ElementTests, KnowNoUnitOfStress) {
  const double scale = 7e3;
  MaterialOptions a = test::soil("mohr_coulomb_smooth", 30, 2e3), b = a;
  a.softening_shape = b.softening_shape = 20;
  a.friction_residual_deg = b.friction_residual_deg = 24;
  b.young_pa *= scale, b.cohesion_pa *= scale;
  b.apex_pa *= scale;
  const ElementPath one = element_test(a, "material.a", element_of(ElementTest::biaxial, 30e3));
  const ElementPath other = element_test(b, "material.a", element_of(ElementTest::biaxial, scale * 30e3));
  ASSERT_EQ(one.size(), other.size());
  EXPECT_LT(one.deviator.back(), 0.97 * one.deviator[peak_of(one, ElementTest::biaxial)]);  // it softens
  for (std::size_t k = 0; k < one.size(); k += 50) {
    EXPECT_NEAR(scale * one.deviator[k], other.deviator[k], 1e-4 * scale * 30e3) << k;
    EXPECT_NEAR(one.volume[k], other.volume[k], 1e-6) << k;
  }
}

// From F: a solid without stress is compressed to the cell pressure first.
TEST(ElementTests, ANeoHookeanSolidIsCompressedToThePressure) {
  MaterialOptions m = test::soil("neo_hookean");
  m.young_pa = 1e6;
  const ElementPath path = element_test(m, "material.a", element_of(ElementTest::triaxial, 20e3, 0.05));
  EXPECT_NEAR(path.vertical.front(), 20e3, 1);
  EXPECT_NEAR(path.horizontal.back(), 20e3, 1);
  EXPECT_NEAR(path.volume.front(), 0, 1e-12);
  EXPECT_GT(path.deviator.back(), 0.9 * 1e6 * 0.05);
}

TEST(ElementTests, RefusesWhatIsNoTest) {
  const MaterialOptions m = test::soil("mohr_coulomb", 30);
  ElementTestOptions o = element_of(ElementTest::oedometer, 1e5);
  o.undrained = true;
  EXPECT_THROW(element_test(m, "material.a", o), InputError);
  EXPECT_THROW(element_test(m, "material.a", element_of(ElementTest::triaxial, -1)), InputError);
  EXPECT_THROW(element_test(m, "material.a", element_of(ElementTest::triaxial, 1e5, 0.95)), InputError);
}

}  // namespace
}  // namespace pivnp::mpm
