// What a case says about image correlation: section [piv].
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/options.hpp"
#include "pivnp/core/record/vector_status.hpp"

namespace pivnp::piv {

/// Names of the correlation methods, in the order of their list (methods.hpp).
std::vector<std::string> piv_method_names();

/// What brings the noise of a dense field down.
enum class Smoothing { adaptive, window };
inline constexpr std::array smoothing_names{NamedValue{"adaptive", Smoothing::adaptive},
                                            NamedValue{"window", Smoothing::window}};
constexpr const auto& names_of(Smoothing) { return smoothing_names; }

struct PivOptions {
  std::string method = "default";
  Smoothing smoothing = Smoothing::adaptive;
  int order = 1;
  int window_px = 32;
  int first_window_px = 0;
  int passes = 0;
  int ensemble = 1;
  bool follow_regions = true;
  Anchor anchor = Anchor::central;
  double median_threshold = 2.0;
  double median_floor_px = 0.1;
  double min_score = 0.1;
  double max_sigma_px = 0.7;
  double min_usable = 0.4;
  bool replace = true;
  int closure = 3;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("method", self.method,
          OptionInfo{.text = "default is gn",
                     .names = &piv_method_names});
    visit("smoothing", self.smoothing,
          OptionInfo{.text = "gn, fast: adaptive, as far as the noise requires; window, subsets of window_px only"});
    visit("order", self.order,
          OptionInfo{.text = "gn with smoothing = window: order of the subsets' deformation", .min = 0, .max = 2});
    visit("window_px", self.window_px,
          OptionInfo{.unit = "px",
                     .text = "side of the last interrogation window",
                     .min = 8,
                     .max = 256});
    visit("first_window_px", self.first_window_px,
          OptionInfo{.unit = "px",
                     .text = "side of the first window; finds displacements up to a quarter of it (0: chosen)",
                     .min = 0,
                     .max = 512});
    visit("passes", self.passes, OptionInfo{.text = "passes with the last window (0: chosen)", .min = 0, .max = 20});
    visit("ensemble", self.ensemble,
          OptionInfo{.text = "fft, ncc: consecutive pairs whose correlations are averaged, for poor texture in steady motion",
                     .min = 1,
                     .max = 64});
    visit("follow_regions", self.follow_regions,
          OptionInfo{.text = "regions move with their material; still texture outside is masked"});
    visit("anchor", self.anchor,
          OptionInfo{.text = "place of a vector: middle of the pair, or its first frame"});
    visit("median_threshold", self.median_threshold,
          OptionInfo{.text = "normalised median test: residual over neighbours' scatter", .min = 0, .above_min = true});
    visit("median_floor_px", self.median_floor_px,
          OptionInfo{.unit = "px", .text = "scatter that the median test always allows", .min = 0});
    visit("min_score", self.min_score,
          OptionInfo{.text = "correlation coefficient below which a vector is rejected", .min = -1, .max = 1});
    visit("max_sigma_px", self.max_sigma_px,
          OptionInfo{.unit = "px",
                     .text = "stated standard deviation above which a vector is rejected",
                     .min = 0,
                     .above_min = true});
    visit("min_usable", self.min_usable,
          OptionInfo{.text = "fraction of a window that masks and the image's edge must leave", .min = 0, .max = 1});
    visit("replace", self.replace,
          OptionInfo{.text = "rebuild rejected vectors from valid neighbours (marked as replaced)"});
    visit("closure", self.closure,
          OptionInfo{.text = "chains of steps compared with direct pairs of their ends, for systematic errors (below 2: none)",
                     .min = 0,
                     .max = 100});
  }
};

}  // namespace pivnp::piv
