// What a comparison can be told.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::compare {

enum class TimeAlignment { none, onset };
inline constexpr std::array time_alignment_names{NamedValue{"none", TimeAlignment::none},
                                                 NamedValue{"onset", TimeAlignment::onset}};
constexpr const auto& names_of(TimeAlignment) { return time_alignment_names; }

enum class SpaceAlignment { none, outline };
inline constexpr std::array space_alignment_names{NamedValue{"none", SpaceAlignment::none},
                                                  NamedValue{"outline", SpaceAlignment::outline}};
constexpr const auto& names_of(SpaceAlignment) { return space_alignment_names; }

struct CompareOptions {
  Points reference_m;
  Points fixed_zone_m;
  TimeAlignment time_alignment = TimeAlignment::none;
  double time_offset_s = 0;
  SpaceAlignment space_alignment = SpaceAlignment::none;
  Pair second_shift_m = {0.0, 0.0};
  double second_rotation_deg = 0;
  double second_scale = 1;
  double second_time_scale = 1;
  std::optional<double> measurement_uncertainty_m;
  double gauge_uncertainty = 0;
  double numerical_uncertainty_m = 0;
  double input_uncertainty_m = 0;
  std::optional<double> correlation_m;
  double verdict_coverage = 0.5;
  std::optional<double> slope_base_m;
  std::optional<double> mobilised_m;
  double band_strain = 0.05;
  Points points_m;
  std::vector<double> increments_outside_m;
  bool levelling = false;
  int mesh_study = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("reference_m", self.reference_m,
          OptionInfo{.unit = "m",
                     .text = "polygon whose mean motion is subtracted from both (the far soil)"});
    visit("fixed_zone_m", self.fixed_zone_m,
          OptionInfo{.unit = "m",
                     .text = "polygon at rest: shift and rotation found there are removed from each"});
    visit("time_alignment", self.time_alignment,
          OptionInfo{.text = "onset: both motions begin at the same time"});
    visit("time_offset_s", self.time_offset_s, OptionInfo{.unit = "s", .text = "added to the second's times"});
    visit("space_alignment", self.space_alignment,
          OptionInfo{.text = "outline: shift and turn the second until the outlines at the start agree"});
    visit("second_shift_m", self.second_shift_m,
          OptionInfo{.unit = "m", .text = "added to the second's positions, after scale and rotation"});
    visit("second_rotation_deg", self.second_rotation_deg,
          OptionInfo{.unit = "deg", .text = "rotates the second about its origin, anticlockwise"});
    visit("second_scale", self.second_scale,
          OptionInfo{.text = "multiplies the second's lengths (a model's scale)", .min = 0, .above_min = true});
    visit("second_time_scale", self.second_time_scale,
          OptionInfo{.text = "multiplies the second's times", .min = 0, .above_min = true});
    visit("measurement_uncertainty_m", self.measurement_uncertainty_m,
          OptionInfo{.unit = "m",
                     .text = "standard uncertainty of a displacement besides random errors; default: the camera's residual",
                     .min = 0});
    visit("gauge_uncertainty", self.gauge_uncertainty,
          OptionInfo{.text = "relative standard uncertainty of the scale", .min = 0, .max = 1});
    visit("numerical_uncertainty_m", self.numerical_uncertainty_m,
          OptionInfo{.unit = "m",
                     .text = "standard numerical uncertainty of a displacement, if not by mesh_study",
                     .min = 0});
    visit("input_uncertainty_m", self.input_uncertainty_m,
          OptionInfo{.unit = "m",
                     .text = "standard uncertainty of a simulated displacement from the inputs",
                     .min = 0});
    visit("correlation_m", self.correlation_m,
          OptionInfo{.unit = "m",
                     .text = "distance over which particles share random errors; default: the gauge length",
                     .min = 0,
                     .above_min = true});
    visit("verdict_coverage", self.verdict_coverage,
          OptionInfo{.text = "fraction of the first's particles to be compared for verdicts (0: always)",
                     .min = 0,
                     .max = 1});
    visit("slope_base_m", self.slope_base_m,
          OptionInfo{.unit = "m",
                     .text = "height of the base below a slope, for run-out, crest and slope angle"});
    visit("mobilised_m", self.mobilised_m,
          OptionInfo{.unit = "m",
                     .text = "displacement of mobilised material; default: 5 % of the first's greatest",
                     .min = 0});
    visit("band_strain", self.band_strain,
          OptionInfo{.text = "deviatoric strain at which a shear band begins",
                     .min = 0,
                     .above_min = true});
    visit("points_m", self.points_m,
          OptionInfo{.unit = "m", .text = "material points whose histories are compared"});
    visit("increments_outside_m", self.increments_outside_m,
          OptionInfo{.unit = "m",
                     .text = "circle (centre x, y, radius) without comparison of increments (a tool)"});
    visit("levelling", self.levelling,
          OptionInfo{.text = "measure the simulation too: the first frame, carried by its motion, through the same PIV"});
    visit("mesh_study", self.mesh_study,
          OptionInfo{.text = "number of coarser grids (1.3 and 1.69 h) for the numerical uncertainty",
                     .min = 0,
                     .max = 2});
  }
};

}  // namespace pivnp::compare
