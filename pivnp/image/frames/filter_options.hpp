// What is done to frames before they are correlated: section [preprocess].
#pragma once

#include <array>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::image {

/// What of a sequence stands for what does not move in it.
enum class Background { none, mean, minimum, median, pattern };
inline constexpr std::array background_names{NamedValue{"none", Background::none}, NamedValue{"mean", Background::mean},
                                             NamedValue{"minimum", Background::minimum},
                                             NamedValue{"median", Background::median},
                                             NamedValue{"pattern", Background::pattern}};
constexpr const auto& names_of(Background) { return background_names; }

/// In the order in which they are applied. What is 0 or none is left out.
struct FilterOptions {
  bool choose = false;
  Background background = Background::none;
  int background_frames = 25;
  double high_pass_px = 0;
  int clahe_px = 0;
  double clahe_limit = 2;
  double cap_std = 0;
  double local_px = 0;

  bool any() const {
    return background != Background::none || high_pass_px > 0 || clahe_px > 0 || cap_std > 0 || local_px > 0;
  }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("choose", self.choose,
          OptionInfo{
              .text = "try every filter on pairs made of the case's frames; apply those that lower the error"});
    visit(
        "background", self.background,
        OptionInfo{
            .text =
                "subtracted: mean, minimum or median over the sequence; pattern: dirt and reflections on the glass"});
    visit(
        "background_frames", self.background_frames,
        OptionInfo{
            .text = "frames that the background is taken from, evenly spaced", .min = 3, .max = 255});
    visit("high_pass_px", self.high_pass_px,
          OptionInfo{.unit = "px",
                     .text = "standard deviation of the Gaussian blur that is subtracted (0: none)",
                     .min = 0,
                     .max = 1000});
    visit("clahe_px", self.clahe_px,
          OptionInfo{.unit = "px",
                     .text = "side of the tiles of contrast-limited equalisation (CLAHE; 0: none)",
                     .min = 0,
                     .max = 2000});
    visit("clahe_limit", self.clahe_limit,
          OptionInfo{.text = "CLAHE: greatest slope of a tile's equalisation", .min = 1, .max = 100});
    visit("cap_std", self.cap_std,
          OptionInfo{.text = "cap grey values so many standard deviations above their median (0: no cap)",
                     .min = 0,
                     .max = 20});
    visit("local_px", self.local_px,
          OptionInfo{
              .unit = "px",
              .text = "standard deviation of the Gaussian window that evens out mean and contrast (0: none)",
              .min = 0,
              .max = 1000});
  }
};

}  // namespace pivnp::image
