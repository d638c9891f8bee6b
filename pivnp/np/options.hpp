// The options of numerical particles.
#pragma once

#include "pivnp/core/choice.hpp"
#include "pivnp/core/options.hpp"
#include "pivnp/core/particles/seed_pattern.hpp"

namespace pivnp::np {

enum class ShapeFunctions { bilinear, quadratic, cubic, bspline2, bspline3, triangles };
inline constexpr std::array shape_functions_names{
    NamedValue{"bilinear", ShapeFunctions::bilinear}, NamedValue{"quadratic", ShapeFunctions::quadratic},
    NamedValue{"cubic", ShapeFunctions::cubic},       NamedValue{"bspline2", ShapeFunctions::bspline2},
    NamedValue{"bspline3", ShapeFunctions::bspline3}, NamedValue{"triangles", ShapeFunctions::triangles}};
constexpr const auto& names_of(ShapeFunctions) { return shape_functions_names; }
/// Cells that a gradient is taken over, along an axis.
constexpr int cells_spanned(ShapeFunctions shape) {
  using enum ShapeFunctions;
  if (shape == quadratic || shape == bspline2) return 2;
  if (shape == cubic || shape == bspline3) return 3;
  return 1;
}

/// Where the gradient of an increment is taken.
enum class GradientPlace { particle, element };
inline constexpr std::array gradient_place_names{NamedValue{"particle", GradientPlace::particle},
                                                 NamedValue{"element", GradientPlace::element}};
constexpr const auto& names_of(GradientPlace) { return gradient_place_names; }

/// What holds summed increments to the first frame.
enum class DriftScheme { none, corrected, leapfrog, reference_update };
inline constexpr std::array drift_scheme_names{
    NamedValue{"none", DriftScheme::none}, NamedValue{"corrected", DriftScheme::corrected},
    NamedValue{"leapfrog", DriftScheme::leapfrog}, NamedValue{"reference_update", DriftScheme::reference_update}};
constexpr const auto& names_of(DriftScheme) { return drift_scheme_names; }

struct NpOptions {
  int per_element = 4;
  SeedPattern seeding = SeedPattern::even;
  ShapeFunctions shape = ShapeFunctions::bspline3;
  GradientPlace gradient = GradientPlace::particle;
  double error_correlation = 1.0;
  DriftScheme drift = DriftScheme::none;
  int drift_interval = 10;
  bool reseed = false;
  Points still_zone_px = {};
  Points still_zone_m = {};
  int still_frames = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("per_element", self.per_element,
          OptionInfo{.text = "numerical particles per occupied element: 1, 4, 9, 16 ...", .min = 1, .max = 400});
    visit("seeding", self.seeding,
          OptionInfo{.text = "pattern of the particles in an element"});
    visit("shape", self.shape,
          OptionInfo{.text = "shape functions: B-splines, bilinear, elements of 9 and 16 nodes, Delaunay triangles"});
    visit("gradient", self.gradient,
          OptionInfo{.text = "where the gradient is taken: at the particle or at the element's centre"});
    visit("error_correlation", self.error_correlation,
          OptionInfo{.text = "correlation of the errors of neighbouring vectors (1: a bound)",
                     .min = 0,
                     .max = 1});
    visit("drift", self.drift,
          OptionInfo{.text = "corrected: fused with direct correlation at intervals; leapfrog: in every frame, not fused; reference_update: Stanier et al. 2016"});
    visit("drift_interval", self.drift_interval,
          OptionInfo{.text = "frames between corrections (drift = corrected)", .min = 1, .max = 100000});
    visit("reseed", self.reseed,
          OptionInfo{.text = "new particles where material enters an empty element; strains count from birth"});
    visit("still_zone_px", self.still_zone_px,
          OptionInfo{.unit = "px", .text = "polygon (column, row) of material at rest, for the noise floor of strain"});
    visit("still_zone_m", self.still_zone_m, OptionInfo{.unit = "m", .text = "the same in the world"});
    visit("still_frames", self.still_frames,
          OptionInfo{.text = "number of first frames without motion, for the same",
                     .min = 0});
  }
};

}  // namespace pivnp::np
