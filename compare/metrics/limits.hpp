// The limits that a comparison can be held to.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compare/data/options.hpp"
#include "pivnp/core/record/metric.hpp"
#include "pivnp/core/registry.hpp"

namespace pivnp::compare {

/// One key of [compare.limits]. The metrics that it holds name it (metrics/rows.hpp).
struct LimitRow {
  std::string name;       // the key
  std::string unit;       // of the limit, as the key's ending says it; empty for numbers
  std::string text;       // one line, no full stop
  bool least = false;     // the value must not be below the limit; else its size must not be above
  double max = std::numeric_limits<double>::infinity();  // greatest limit that makes sense
  std::string needs = "";  // key of [compare] without which it cannot be evaluated; empty: none
};
Registry<LimitRow>& limit_rows();

/// Thresholds by key; what is left out is not evaluated.
class LimitOptions {
 public:
  LimitOptions() = default;
  LimitOptions(const LimitOptions&) = default;
  /// Takes the other's limits; what operator[] has given out stays valid (a command's flags are set afterwards).
  LimitOptions& operator=(const LimitOptions& other);
  /// Throws InputError for a key that no row has.
  std::optional<double>& operator[](std::string_view key);
  const std::optional<double>& operator[](std::string_view key) const;
  bool any() const;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    for (const LimitRow& row : limit_rows())
      visit(std::string_view(row.name), self[row.name],
            OptionInfo{.unit = row.unit, .text = row.text, .min = 0, .max = row.max});
  }

 private:
  std::map<std::string, std::optional<double>, std::less<>> given_;
};

/// The first limit that is given without the option it needs; nullptr: there is none.
const LimitRow* limit_without_its_option(const LimitOptions& limits, const CompareOptions& options);

/// Gives the metrics that a limit holds their verdicts, and says what became of each limit. Of several metrics under one
/// key the one furthest from the limit counts; a metric that could not be computed exceeds its limit.
std::vector<LimitResult> apply_limits(const LimitOptions& limits, std::vector<Metric>& metrics);

}  // namespace pivnp::compare
