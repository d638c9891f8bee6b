// Soils on the smooth Mohr-Coulomb surface of Abbo & Sloan. Criteria: 1e5 random strain increments a soil, edges and apex
// included, end with F <= 1e-8 max(c, p, 1 kPa); a step is within 1e-3 of a thousand of them; gradients agree with finite
// differences to 1e-6.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "mpm/material/smooth_mohr_coulomb.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/mpm/material/soil_point.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
using Point = SoilPoint;

struct Soil {
  std::string name;
  MaterialOptions options;
};
void PrintTo(const Soil& soil, std::ostream* out) { *out << soil.name; }

std::vector<Soil> smooth_soils() {
  std::vector<Soil> out;
  const auto add = [&](const std::string& name, auto&& change) {
    MaterialOptions m = soil("mohr_coulomb_smooth");
    change(m);
    out.push_back({name, m});
  };
  add("sand", [](auto& m) { m.friction_deg = 43; });
  add("dilatant", [](auto& m) { m.friction_deg = 35, m.dilatancy_deg = 10; });
  add("associated", [](auto& m) { m.friction_deg = 30, m.dilatancy_deg = 30; });
  add("cohesive", [](auto& m) { m.friction_deg = 25, m.cohesion_pa = 2000, m.tension_pa = 1e9; });
  add("no_tension", [](auto& m) { m.friction_deg = 25, m.cohesion_pa = 2000; });
  add("cut_off", [](auto& m) { m.friction_deg = 25, m.dilatancy_deg = 5, m.cohesion_pa = 2000, m.tension_pa = 500; });
  add("clay", [](auto& m) { m.friction_deg = 0, m.cohesion_pa = 2000, m.tension_pa = 1e9; });
  add("softening", [](auto& m) {
    m.friction_deg = 35, m.dilatancy_deg = 10, m.cohesion_pa = 2000, m.tension_pa = 1e9;
    m.friction_residual_deg = 25, m.cohesion_residual_pa = 200, m.softening_shape = 50, m.dilatancy_fade = 0.05;
  });
  add("stress_dependent", [](auto& m) { m.friction_deg = 30, m.friction_low_stress_deg = 43, m.friction_half_pa = 1e4; });
  return out;
}

class MpmSmoothSoils : public testing::TestWithParam<Soil> {
 protected:
  std::unique_ptr<Material> law = make_material(GetParam().options, "material.a");
  const SmoothMohrCoulomb& smooth = dynamic_cast<const SmoothMohrCoulomb&>(*law);
};

// Stresses all over the surface: triaxial edges, the plane strain side, the neighbourhood of the apex.
TEST_P(MpmSmoothSoils, GradientsAreThoseOfTheSurface) {
  constexpr unsigned seed = 3;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> n(0, 1);
  std::uniform_real_distribution<double> size(0, 5);
  const StrengthLaw strength(GetParam().options, 0);
  const AbboSloan surface(10);
  double worst = 0;
  for (int k = 0; k < 3000; ++k) {
    const double scale = std::pow(10, size(random)), p = scale * std::abs(n(random));
    Tensor s{-p + scale * n(random), -p + scale * n(random), -p + scale * n(random), scale * n(random)};
    if (k % 3 == 0) s = {-p, -p + scale * 1e-3 * n(random), -p - scale, 0};  // an edge, almost
    if (k % 7 == 0) s = {-p, -p, -p, 1e-3 * scale};                            // the axis, almost
    const double history = 0.02 * std::abs(n(random)), J = 1 + 0.01 * n(random);
    const auto F = [&](const Tensor& t, double h) {
      const Invariants at(t);
      return surface.place(at, strength.at(h, -at.mean / J), J).F;
    };
    const Invariants at(s);
    const Strength here = strength.at(history, -at.mean / J);
    if (std::abs(at.mean) < 1e-3 * scale) continue;  // the strength has a corner at zero pressure
    const AbboSloan::Place place = surface.place(at, here, J);
    const Tensor g = surface.gradient(place);
    const double h = 1e-4 * std::max(at.bar, 1e-2 * scale) * (at.bar > 1e-2 * scale ? 0.1 : 1);
    for (std::size_t q = 0; q < 4; ++q) {
      const auto slope = [&](double step) {
        Tensor a = s, b = s;
        a[q] -= step;
        b[q] += step;
        return (F(b, history) - F(a, history)) / (2 * step);
      };
      const double fd = (4 * slope(0.5 * h) - slope(h)) / 3;  // fourth order
      // (A stress whose difference steps over the join of the section sees a jump in the third derivative.)
      worst = std::max(worst, std::abs(fd / (q == 3 ? 2 : 1) - g[q]));
    }
    if (GetParam().options.softening_shape > 0) {
      const double d = 1e-5, by_history = (F(s, history + d) - F(s, history - d)) / (2 * d);
      EXPECT_NEAR(surface.by_history(place), by_history, 1e-6 * std::max(std::abs(by_history), scale));
    }
  }
  EXPECT_LT(worst, 1e-6);
  pivnp::test::verification_row("Abbo-Sloan surface, " + GetParam().name, "gradient against finite differences to 1e-6",
                                number(worst, 2));
}

TEST_P(MpmSmoothSoils, RandomIncrementsEndOnOrInsideTheSurface) {
  constexpr unsigned seed = 20240601;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> n(0, 1);
  std::uniform_real_distribution<double> size(-7, -2);
  constexpr int count = 100000;
  Point p;
  double worst = 0;
  for (int k = 0; k < count; ++k) {
    const double s = std::pow(10, size(random));
    if (k % 50 == 0) p = Point{};
    // Edges: every fifth increment is triaxial; the apex is met by expansion.
    Tensor de{s * (n(random) - 0.3), s * (n(random) - 0.3), 0.1 * s * n(random), s * n(random)};
    if (k % 5 == 0) de = {de[0], de[1], de[0], 0};
    const double before = p.dissipated;
    const Tensor start = p.stress;
    p.advance(*law, de, s * n(random));
    for (const double c : p.stress) ASSERT_TRUE(std::isfinite(c)) << "increment " << k;
    const double f = smooth.relative_yield(p.stress, p.plastic_dev, p.J);
    worst = std::max(worst, f);
    ASSERT_LE(f, 1e-8) << "increment " << k;
    ASSERT_GE(p.opening, 0) << "increment " << k;
    // Plastic work is the trapezoid's over the substeps: a few per cent of |stress| |strain| where the stress jumps.
    const double turned_over = (std::sqrt(product(start, start)) + std::sqrt(product(p.stress, p.stress)) + 10) *
                               std::sqrt(product(de, de));
    ASSERT_GE(p.dissipated, before - 0.02 * turned_over - 1e-9 * std::abs(before)) << "increment " << k;
  }
  pivnp::test::verification_row("Abbo-Sloan surface, " + GetParam().name,
                                "1e5 random increments, F <= 1e-8 max(c, p, 1 kPa)", number(worst, 2));
}

TEST_P(MpmSmoothSoils, OneStepIsWithinAThousandthOfAThousand) {
  constexpr unsigned seed = 17;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> n(0, 3e-4);
  double worst = 0;
  for (int k = 0; k < 100; ++k) {
    Point one;
    one.stress = {-6000, -4000, -4500, 500};
    Point many = one;
    const Tensor de{n(random) - 1e-4, n(random) - 1e-4, 0.3 * n(random), n(random)};
    one.advance(*law, de);
    for (int q = 0; q < 1000; ++q) many.advance(*law, {de[0] / 1000, de[1] / 1000, de[2] / 1000, de[3] / 1000});
    const double scale = std::max({GetParam().options.cohesion_pa, -many.mean(), 1000.0});
    if (one.separated != many.separated || (many.separated && GetParam().options.tension_pa > 0)) continue;  // tension lost at once
    for (std::size_t c = 0; c < 4; ++c) worst = std::max(worst, std::abs(one.stress[c] - many.stress[c]) / scale);
  }
  EXPECT_LT(worst, 1e-3);
  pivnp::test::verification_row("Abbo-Sloan surface, " + GetParam().name,
                                "one step within 1e-3 of a thousand substeps", number(worst, 2));
}

INSTANTIATE_TEST_SUITE_P(Soils, MpmSmoothSoils, testing::ValuesIn(smooth_soils()),
                         [](const auto& i) { return i.param.name; });

}  // namespace
}  // namespace pivnp::mpm
