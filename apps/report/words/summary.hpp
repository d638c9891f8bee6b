// What a comparison comes to, in a few rows and sentences. Both are read from the metrics' verdicts, so they cannot disagree.
#pragma once

#include <string>
#include <vector>

#include "apps/report/content/content.hpp"
#include "apps/report/content/differences.hpp"
#include "apps/report/words/data_sets.hpp"

namespace pivnp::report {

/// One quantity of both data sets. Values that a comparison does not know are NaN.
struct SummaryRow {
  std::string quantity, unit;
  double first = 0, second = 0;
  double difference = 0, uncertainty = 0, factor = 0;  // it counts from so many uncertainties on
  Verdict verdict = Verdict::none;
  LostIn lost_in = LostIn::nothing;
  LimitFate limit = LimitFate::none;

  double counts_from() const { return factor * uncertainty; }
  /// The verdict, by what the difference is not resolved, and what became of the limit: "agrees; limit met".
  std::string words() const;
};

/// Eight at most, of those that the comparison knows: displacement, strain, run-out, slope, crest, outline, onset, speed.
std::vector<SummaryRow> summary_rows(const Content& content);

/// When and where the displacements are furthest apart: the time of the greatest RMS, and the thick of the twentieth of
/// the particles that differ most then.
struct Worst {
  double time = 0, rms = 0;
  Vec2 place = Vec2::Zero();  // NaN: not known
};
Worst worst_of(const Content& content, const DifferenceCurve& differences);

/// How far off, when and where, and whether the measurement could have told; then what is not known, and the limits.
std::string summary(const Content& content, const DataSetNames& names, const DifferenceCurve& differences);

/// The same of two histories.
std::string histories_summary(const Content& content);

/// The times that two histories have in common; {} where there are none.
std::vector<double> common_span(const Comparison& histories);

/// "The limit displacement_rms_m is exceeded: 0.03 m, ..." for each limit that is exceeded.
std::vector<std::string> missed_limits(const Content& content);

}  // namespace pivnp::report
