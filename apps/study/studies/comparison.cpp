#include "apps/study/studies/comparison.hpp"

#include <utility>

#include "apps/study/pipeline/record/report_input.hpp"

namespace pivnp::app {

Case comparison_case(const CompareSources& sources, const compare::CompareOptions& options,
                     const compare::LimitOptions& limits) {
  Case c;
  const auto short_name = [](const std::string& text) { return text.substr(text.find_last_of('/', text.find(':')) + 1); };
  c.name = short_name(sources.first) + " against " + short_name(sources.second);
  c.compare = options;
  c.compare.mesh_study = 0;  // of a case that simulates
  c.limits = limits;
  return c;
}

RunOutcome finish_comparison(const Case& c, Comparison comparison, io::RecordWriter& writer,
                             const RunSettings& settings) {
  writer.set_comparison(comparison);
  writer.finish();
  RunOutcome outcome;
  outcome.limits = comparison.limits;
  outcome.record = settings.out / "record.h5";
  outcome.metrics = comparison.metrics;
  tell_record(c, outcome, std::move(comparison), nullptr, settings.out, settings.report);
  return outcome;
}

}  // namespace pivnp::app
