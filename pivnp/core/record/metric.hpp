// One number of a comparison, with what it takes to read it.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/choice.hpp"

namespace pivnp {

/// What is said of a difference E by what it is uncertain by (ASME V&V 20; compare/metrics/significance.hpp decides):
/// agrees (within Metric::within()), differs (by more than all that is uncertain, mesh and inputs among it), larger (than
/// the known errors; those of the mesh or of the inputs are not known), not_resolved (Metric::lost_in says by what),
/// withheld (too little of the material was compared), none (no difference, or its uncertainty is not known).
enum class Verdict { none, agrees, differs, larger, not_resolved, withheld };
inline constexpr std::array verdict_names{NamedValue{"", Verdict::none},
                                          NamedValue{"agrees", Verdict::agrees},
                                          NamedValue{"differs", Verdict::differs},
                                          NamedValue{"larger than the measurement's error", Verdict::larger},
                                          NamedValue{"not resolved", Verdict::not_resolved},
                                          NamedValue{"no verdict", Verdict::withheld}};
constexpr const auto& names_of(Verdict) { return verdict_names; }

/// The part of the uncertainty in which a difference is lost.
enum class LostIn { nothing, measurement, mesh, inputs };
inline constexpr std::array lost_in_names{NamedValue{"", LostIn::nothing},
                                          NamedValue{"measurement", LostIn::measurement},
                                          NamedValue{"mesh", LostIn::mesh},
                                          NamedValue{"inputs", LostIn::inputs}};
constexpr const auto& names_of(LostIn) { return lost_in_names; }

/// What became of the limit of [compare.limits] that holds a metric.
enum class LimitFate { none, met, exceeded };
inline constexpr std::array limit_fate_names{NamedValue{"", LimitFate::none},
                                             NamedValue{"met", LimitFate::met},
                                             NamedValue{"exceeded", LimitFate::exceeded}};
constexpr const auto& names_of(LimitFate) { return limit_fate_names; }

/// As records state it; none for words of a later version. Before schema 1.9 one word stood for the verdict or the limit.
constexpr Verdict verdict_named(std::string_view name) {
  if (name == "not distinguishable at this u_val") return Verdict::not_resolved;
  return value_named<Verdict>(name).value_or(Verdict::none);
}
constexpr LimitFate limit_fate_named(std::string_view name) {
  if (name == "within limit") return LimitFate::met;
  if (name == "over limit") return LimitFate::exceeded;
  return value_named<LimitFate>(name).value_or(LimitFate::none);
}

struct Metric {
  std::string name;        // for example displacement_rms
  double value = 0;
  std::string unit;
  double uncertainty = 0;  // standard uncertainty of the value from the measurement; NaN if not known
  std::string definition;  // one line
  Verdict verdict = Verdict::none;
  double factor = unknown;  // of a difference: it counts from so many uncertainties on
  LostIn lost_in = LostIn::nothing;
  LimitFate limit = LimitFate::none;
  // Standard uncertainties that the grid and the model's inputs add within `uncertainty`; NaN: not known, and not in it.
  double numerical = unknown, input = unknown;
  double scale = unknown;  // the size of what is compared, in the metric's unit; NaN: not known

  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  /// Found to be there: by more than its uncertainty.
  bool told_apart() const { return verdict == Verdict::differs || verdict == Verdict::larger; }
  bool lost() const { return verdict == Verdict::agrees || verdict == Verdict::not_resolved; }

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
  LimitFate fate() const { return met ? LimitFate::met : LimitFate::exceeded; }
};

inline bool any_exceeded(const std::vector<LimitResult>& limits) {
  for (const LimitResult& limit : limits)
    if (!limit.met) return true;
  return false;
}

}  // namespace pivnp
