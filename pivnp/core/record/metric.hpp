// One number of a comparison, with what it takes to read it.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/choice.hpp"

namespace pivnp {

/// What is said of a value: of one that a limit holds, whether it meets it; else of a difference, that it is lost in its
/// uncertainty (ASME V&V 20), or nothing.
enum class Verdict { none, met, exceeded, not_distinguishable };
inline constexpr std::array verdict_names{NamedValue{"", Verdict::none}, NamedValue{"met", Verdict::met},
                                          NamedValue{"exceeded", Verdict::exceeded},
                                          NamedValue{"not distinguishable at this u_val", Verdict::not_distinguishable}};
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

  Verdict verdict() const { return met ? Verdict::met : Verdict::exceeded; }
};

inline bool any_exceeded(const std::vector<LimitResult>& limits) {
  for (const LimitResult& limit : limits)
    if (!limit.met) return true;
  return false;
}

}  // namespace pivnp
