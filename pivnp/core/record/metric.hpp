// One number of a comparison, with what it takes to read it.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/choice.hpp"

namespace pivnp {

/// What is said of a value: of one that a limit holds, whether it meets it; else of a difference, that it is lost in its
/// uncertainty (ASME V&V 20), or nothing; withheld: too little of the material was compared to say anything.
enum class Verdict { none, met, exceeded, not_distinguishable, withheld };
inline constexpr std::array verdict_names{NamedValue{"", Verdict::none}, NamedValue{"met", Verdict::met},
                                          NamedValue{"exceeded", Verdict::exceeded},
                                          NamedValue{"not distinguishable at this u_val", Verdict::not_distinguishable},
                                          NamedValue{"no verdict", Verdict::withheld}};
constexpr const auto& names_of(Verdict) { return verdict_names; }

/// As records state it, in the words of schema 1.1 too; none for words of a later version.
constexpr Verdict verdict_named(std::string_view name) {
  if (name == "within limit") return Verdict::met;
  if (name == "over limit") return Verdict::exceeded;
  return value_named<Verdict>(name).value_or(Verdict::none);
}

struct Metric {
  std::string name;        // for example displacement_rms
  double value = 0;
  std::string unit;
  double uncertainty = 0;  // standard uncertainty of the value from the measurement; NaN if not known
  std::string definition;  // one line
  Verdict verdict = Verdict::none;
  double factor = std::numeric_limits<double>::quiet_NaN();  // of a difference: so many uncertainties are distinguishable

  /// Quantile of the normal distribution for one side, 95 %: of two one-sided tests (Schuirmann 1987), and of power.
  static constexpr double one_sided = 1.645;
  /// The least tolerance within which a difference is shown to lie with 95 %: both one-sided tests reject that it is
  /// beyond. NaN for what is no difference, or of unknown uncertainty.
  double within() const { return (value < 0 ? -value : value) + one_sided * uncertainty + 0 * factor; }
  /// A real difference of this size would have been found in 95 of 100 cases.
  double seen() const { return (factor + one_sided) * uncertainty; }
};

/// nullptr: there is none of that name.
inline const Metric* find(const std::vector<Metric>& metrics, std::string_view name) {
  for (const Metric& metric : metrics)
    if (metric.name == name) return &metric;
  return nullptr;
}

/// What a limit demanded and what was reached (NaN: the metric is not known, which exceeds the limit).
struct LimitResult {
  std::string key;  // of [compare.limits]
  double limit = 0, reached = 0;
  bool met = false;
  double within = std::numeric_limits<double>::quiet_NaN();  // of a greatest value: shown to lie within this with 95 %

  /// Met, and shown to be by two one-sided tests: not by chance.
  bool shown() const { return met && within <= limit; }
  Verdict verdict() const { return met ? Verdict::met : Verdict::exceeded; }
};

inline bool any_exceeded(const std::vector<LimitResult>& limits) {
  for (const LimitResult& limit : limits)
    if (!limit.met) return true;
  return false;
}

}  // namespace pivnp
