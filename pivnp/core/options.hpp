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
// two numbers), std::vector<double>, std::vector<std::string>, an enum whose names are listed beside it (choice.hpp), and
// std::optional of a bool, int, double, string, Pair or such an enum. A choice that grows with a registry (registry.hpp)
// is a string whose names come from there.
#pragma once

#include <array>
#include <cstddef>
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
  std::vector<std::string> (*names)() = nullptr;          // strings: the values allowed; left out: any
  std::string_view alias = "";                            // a former name of the key, still read
};

inline bool in_range(const OptionInfo& info, double value) {
  return (info.above_min ? value > info.min : value >= info.min) && value <= info.max;
}
/// Whether the greatest number allowed is the last one below a whole number, which itself is not.
bool excludes_max(const OptionInfo& info);
/// The range of a number in words, "8 to 256", "more than 0"; empty: any.
std::string range_text(const OptionInfo& info);

}  // namespace pivnp
