// A laboratory's element tests on a constitutive law at one point: no grid, no time step of a simulation.
//
// A specimen of unit size is strained step by step; what the test does not prescribe (a lateral stretch, say) is found such that the
// stress that the test holds is held. Strains are those that a laboratory states: of the initial size, compression positive.
// Undrained: the volume is constant (water and grains do not shrink beside the skeleton), and the pore pressure is what the total
// stress that is held leaves over, u = sigma' - sigma.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mpm/material/model.hpp"
#include "pivnp/core/choice.hpp"

namespace pivnp::mpm {

enum class ElementTest { triaxial, biaxial, oedometer, isotropic, simple_shear, direct_shear };
inline constexpr std::array element_test_names{
    NamedValue{"triaxial", ElementTest::triaxial},         NamedValue{"biaxial", ElementTest::biaxial},
    NamedValue{"oedometer", ElementTest::oedometer},       NamedValue{"isotropic", ElementTest::isotropic},
    NamedValue{"simple_shear", ElementTest::simple_shear}, NamedValue{"direct_shear", ElementTest::direct_shear}};
constexpr const auto& names_of(ElementTest) { return element_test_names; }
constexpr bool ends_by_stress(ElementTest test) { return test == ElementTest::oedometer || test == ElementTest::isotropic; }
constexpr bool is_shear(ElementTest test) { return test == ElementTest::simple_shear || test == ElementTest::direct_shear; }

struct ElementTestOptions {
  ElementTest test = ElementTest::triaxial;
  /// Cell pressure (triaxial, biaxial), vertical stress (shear), greatest stress that is reached (oedometer, isotropic), Pa, above 0.
  double pressure_pa = 0;
  /// Where the test ends: axial strain, or shear strain gamma; in (0, 0.9) for the first. Oedometer and isotropic end by stress: loaded
  /// from a hundredth of the pressure, and unloaded to a tenth of it.
  double strain = 0.2;
  /// Triaxial, biaxial, shear. Where not, free drainage.
  bool undrained = false;
  /// Horizontal over vertical effective stress at the start of a shear test.
  double k0 = 1;
  double rate_1_s = 1e-4;  // of the strain, for laws that depend on it
  int steps = 2000;
};

/// One value for the start and for each step. Stresses are effective Cauchy stresses, compression positive, Pa.
struct ElementPath {
  std::vector<double> strain;   // axial (of height; isotropic: of each side), or gamma
  std::vector<double> volume;   // volumetric strain 1 - J
  std::vector<double> vertical, horizontal, out_of_plane, shear;
  std::vector<double> mean, deviator;       // p' = tr sigma'/3; q = sqrt(3 J2)
  std::vector<double> major, minor;         // principal stresses
  std::vector<double> pore_pressure;        // change since the start
  /// History variables of the law that are numbers, by their names.
  std::vector<std::pair<std::string, std::vector<double>>> history;
  std::string ended;  // why before its end; empty: it reached it

  std::size_t size() const { return strain.size(); }
};

/// Peak of what a test is run for, of its path: where q (shear tests: the shear stress) is greatest.
std::size_t peak_of(const ElementPath& path, ElementTest test);

/// Runs a test. `cell_m`: side of the cells that softening is regularised by. Throws InputError naming `key`.<constant> for a material that its
/// law does not take, and for a pressure, strain or number of steps out of range.
ElementPath element_test(const MaterialOptions& material, const std::string& key, const ElementTestOptions& options, double cell_m = 0);

/// Cohesion c (Pa) and friction angle phi (degrees) of the line that fits peaks best: (s1 - s3)/2 = c cos phi + sin phi (s1 + s3)/2, or
/// tau = c + tan phi sigma for shear tests. One peak gives phi with c = 0. Nothing without a peak.
struct StrengthLine {
  double cohesion_pa = 0, friction_deg = 0;
};
std::optional<StrengthLine> strength_line(const std::vector<ElementPath>& paths, ElementTest test);

}  // namespace pivnp::mpm
