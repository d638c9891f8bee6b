// Every option struct lists its fields once, beside itself; one visitor turns the list into the TOML reader, the
// written-out case, --help, docs/case.md and the suggestion of the nearest key.
//
//   struct NpOptions {
//     int per_element = 4;
//     template <class Self, class Visitor>
//     static void fields(Self& self, Visitor&& visit) {
//       visit("per_element", self.per_element,
//             OptionInfo{.unit = "", .text = "numerical particles seeded per occupied element", .min = 1, .max = 400});
//     }
//   };
//
// Field types understood by every visitor: bool, int, double, std::string, Pair (two numbers), Points (list of
// two numbers), std::vector<double>, std::vector<std::string>, and std::optional of a bool, int, double, string, Pair.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace pivnp {

using Pair = std::array<double, 2>;
using Points = std::vector<Pair>;

/// What is known of one option beside its name, type and default.
struct OptionInfo {
  std::string_view unit = "";  // SI symbol or px; empty for counts and choices
  std::string_view text = "";  // one line, no full stop
  double min = -std::numeric_limits<double>::infinity();  // numbers: least value allowed
  double max = std::numeric_limits<double>::infinity();   // numbers: greatest value allowed
  bool above_min = false;                                 // min itself is not allowed
  std::vector<std::string_view> choices = {};             // strings: the values allowed; empty: any
};

}  // namespace pivnp
