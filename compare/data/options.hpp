// What a comparison can be told, and the limits it is held to.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/options.hpp"

namespace pivnp::compare {

struct CompareOptions {
  Points reference_m;
  Points fixed_zone_m;
  std::string time_alignment = "none";
  double time_offset_s = 0;
  std::string space_alignment = "none";
  Pair second_shift_m = {0.0, 0.0};
  double second_rotation_deg = 0;
  double second_scale = 1;
  double second_time_scale = 1;
  std::optional<double> measurement_uncertainty_m;
  double gauge_uncertainty = 0;
  double numerical_uncertainty_m = 0;
  double input_uncertainty_m = 0;
  std::optional<double> slope_base_m;
  std::optional<double> mobilised_m;
  double band_strain = 0.05;
  Points points_m;
  std::vector<double> increments_outside_m;
  bool levelling = false;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("reference_m", self.reference_m,
          OptionInfo{.unit = "m",
                     .text = "polygon of material whose mean motion is subtracted from both sides (the far soil)"});
    visit("fixed_zone_m", self.fixed_zone_m,
          OptionInfo{.unit = "m",
                     .text = "polygon of material that stands still: the shift and rotation found there are taken off "
                             "each side at each time"});
    visit("time_alignment", self.time_alignment,
          OptionInfo{.text = "onset: the second's clock is set so that both motions begin at the same time",
                     .choices = {"none", "onset"}});
    visit("time_offset_s", self.time_offset_s, OptionInfo{.unit = "s", .text = "added to the second's times"});
    visit("space_alignment", self.space_alignment,
          OptionInfo{.text = "outline: the second's coordinates are shifted and turned so that both outlines at the common "
                             "start agree (within fixed_zone_m, where given)",
                     .choices = {"none", "outline"}});
    visit("second_shift_m", self.second_shift_m,
          OptionInfo{.unit = "m", .text = "added to the second's positions, after scale and rotation"});
    visit("second_rotation_deg", self.second_rotation_deg,
          OptionInfo{.unit = "deg", .text = "turns the second about its origin, counter-clockwise"});
    visit("second_scale", self.second_scale,
          OptionInfo{.text = "multiplies the second's lengths (a model's scale)", .min = 0, .above_min = true});
    visit("second_time_scale", self.second_time_scale,
          OptionInfo{.text = "multiplies the second's times", .min = 0, .above_min = true});
    visit("measurement_uncertainty_m", self.measurement_uncertainty_m,
          OptionInfo{.unit = "m",
                     .text = "standard uncertainty of a displacement component beside the random error (left out: the "
                             "camera's residual)",
                     .min = 0});
    visit("gauge_uncertainty", self.gauge_uncertainty,
          OptionInfo{.text = "relative standard uncertainty of the scale of lengths", .min = 0, .max = 1});
    visit("numerical_uncertainty_m", self.numerical_uncertainty_m,
          OptionInfo{.unit = "m",
                     .text = "standard numerical uncertainty of a displacement component, where it is known otherwise "
                             "than by coarser grids",
                     .min = 0});
    visit("input_uncertainty_m", self.input_uncertainty_m,
          OptionInfo{.unit = "m",
                     .text = "standard uncertainty of a simulated displacement component from the model's inputs",
                     .min = 0});
    visit("slope_base_m", self.slope_base_m,
          OptionInfo{.unit = "m",
                     .text = "height of the base a slope rests on: run-out, crest and slope angle are taken above it"});
    visit("mobilised_m", self.mobilised_m,
          OptionInfo{.unit = "m",
                     .text = "displacement above which material counts as mobilised (left out: 5 % of the first's "
                             "greatest)",
                     .min = 0});
    visit("band_strain", self.band_strain,
          OptionInfo{.text = "deviatoric strain above which a ridge is a shear band, and at which it begins",
                     .min = 0,
                     .above_min = true});
    visit("points_m", self.points_m,
          OptionInfo{.unit = "m", .text = "material points whose histories are compared"});
    visit("increments_outside_m", self.increments_outside_m,
          OptionInfo{.unit = "m",
                     .text = "circle (centre x, y, radius) inside which increments are not compared (a tool)"});
    visit("levelling", self.levelling,
          OptionInfo{.text = "also measure the simulation: the first frame, carried by the simulated motion, goes "
                             "through the same PIV and particles"});
  }
};

/// Thresholds; what is left out is not judged.
struct LimitOptions {
  std::optional<double> displacement_rms_m;
  std::optional<double> displacement_p95_m;
  std::optional<double> displacement_max_m;
  std::optional<double> displacement_bias_m;
  std::optional<double> velocity_rms_m_s;
  std::optional<double> strain_rms;
  std::optional<double> strain_p95;
  std::optional<double> displacement_over_u;
  std::optional<double> outline_iou_min;
  std::optional<double> hausdorff_m;
  std::optional<double> run_out_m;
  std::optional<double> slope_angle_deg;
  std::optional<double> coverage_min;
  std::optional<double> history_rms;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("displacement_rms_m", self.displacement_rms_m,
          OptionInfo{.unit = "m", .text = "greatest RMS displacement difference, over space and time", .min = 0});
    visit("displacement_p95_m", self.displacement_p95_m,
          OptionInfo{.unit = "m", .text = "greatest 95th percentile of the displacement difference", .min = 0});
    visit("displacement_max_m", self.displacement_max_m,
          OptionInfo{.unit = "m", .text = "greatest displacement difference of any particle and time", .min = 0});
    visit("displacement_bias_m", self.displacement_bias_m,
          OptionInfo{.unit = "m", .text = "greatest size of either component of the mean difference", .min = 0});
    visit("velocity_rms_m_s", self.velocity_rms_m_s,
          OptionInfo{.unit = "m/s", .text = "greatest RMS velocity difference", .min = 0});
    visit("strain_rms", self.strain_rms,
          OptionInfo{.text = "greatest RMS difference of deviatoric strain, over space and time", .min = 0});
    visit("strain_p95", self.strain_p95,
          OptionInfo{.text = "greatest 95th percentile of the difference of deviatoric strain", .min = 0});
    visit("displacement_over_u", self.displacement_over_u,
          OptionInfo{.text = "greatest RMS displacement difference in units of its standard uncertainty", .min = 0});
    visit("outline_iou_min", self.outline_iou_min,
          OptionInfo{.text = "least share that the final outlines have in common", .min = 0, .max = 1});
    visit("hausdorff_m", self.hausdorff_m,
          OptionInfo{.unit = "m", .text = "greatest Hausdorff distance (95 %) of the final outlines", .min = 0});
    visit("run_out_m", self.run_out_m,
          OptionInfo{.unit = "m", .text = "greatest difference of run-out (needs compare.slope_base_m)", .min = 0});
    visit("slope_angle_deg", self.slope_angle_deg,
          OptionInfo{.unit = "deg", .text = "greatest difference of the final slope angle (needs compare.slope_base_m)",
                     .min = 0});
    visit("coverage_min", self.coverage_min,
          OptionInfo{.text = "least share of the first's particles that find a partner", .min = 0, .max = 1});
    visit("history_rms", self.history_rms,
          OptionInfo{.text = "greatest RMS difference of two histories, in their own unit", .min = 0});
  }
};

}  // namespace pivnp::compare
