#include "compare/compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "compare/alignment/bring_together.hpp"
#include "compare/alignment/mistakes.hpp"
#include "compare/alignment/partners.hpp"
#include "compare/alignment/reference.hpp"
#include "compare/data/data_set.hpp"
#include "compare/metrics/findings.hpp"
#include "compare/metrics/numerical.hpp"
#include "compare/metrics/remarks.hpp"
#include "compare/metrics/rows.hpp"
#include "compare/shapes/outline.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

void check_comparable(const MotionSource& first, const MotionSource& second) {
  for (const MotionSource* m : {&first, &second}) {
    if (m->particles().size() == 0) throw InputError("compare: motion " + quoted(*m) + " has no particles");
    if (m->times().empty()) throw InputError("compare: motion " + quoted(*m) + " has no frames");
  }
  auto same = [&](const char* what, const std::string& a, const std::string& b) {
    if (a != b)
      throw InputError("compare: the " + std::string(what) + " unit of the first, " + quoted(first) + ", is '" + a +
                       "', that of the second, " + quoted(second) + ", is '" + b + "'; expected the same");
  };
  same("length", first.length_unit(), second.length_unit());
  same("time", first.time_unit(), second.time_unit());
}

// What can be said before any frame is read.
void check_options(const CompareOptions& options, const LimitOptions& limits) {
  if (!options.reference_m.empty() && !options.fixed_zone_m.empty())
    throw InputError("compare.fixed_zone_m: given together with compare.reference_m; expected one of them");
  if (!options.increments_outside_m.empty() && options.increments_outside_m.size() != 3)
    throw InputError("compare.increments_outside_m: found " + std::to_string(options.increments_outside_m.size()) +
                     " numbers, expected 3: centre and radius");
  if (const LimitRow* row = limit_without_its_option(limits, options))
    throw InputError("compare.limits." + row->name + ": needs compare." + row->needs + ", which is not given");
}

// A data set by name, and where its particles lie.
std::string where(const DataSet& set) {
  Vec2 lower = set.material_position().front(), upper = lower;
  for (const Vec2& x : set.material_position()) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  const auto span = [&](int axis) { return number(lower[axis], 4) + " to " + number(upper[axis], 4); };
  return quoted(set.motion()) + " (x " + span(0) + ", y " + span(1) + " " + set.motion().length_unit() + ")";
}

std::vector<std::size_t> paired_particles(const Alignment& alignment, const DataSet& first, const DataSet& second, const std::string& mistake) {
  std::vector<std::size_t> paired;
  for (std::size_t p = 0; p < first.size(); ++p)
    if (has_partner(alignment.partners()[p])) paired.push_back(p);
  if (paired.empty())
    throw InputError("compare: no particle of the first, " + where(first) + ", finds a partner in the second, " +
                     where(second) + "; expected material positions that overlap (same origin, unit and labels)" +
                     (mistake.empty() ? "" : ". " + mistake));
  return paired;
}

std::string covariance_source(const Differences& differences, const DataSet& first, const DataSet& second,
                              bool given, bool clock) {
  const bool a = differences.cov_known(0), b = differences.cov_known(1);
  const Tally& total = differences.total();
  std::string text = a && b ? "covariances of both motions added"
                     : a    ? "covariance of the first (" + first.motion().name() + ")"
                     : b    ? "covariance of the second (" + second.motion().name() + ")"
                            : "";
  const auto add = [&](bool there, const char* what) {
    if (there) text += (text.empty() ? "" : " and ") + std::string(what);
  };
  add(given, "camera, gauge and frame of reference");
  add(clock, "uncertainty of the clock's offset");
  add(total.sum_numerical > 0, "numerical uncertainty of the second");
  add(total.sum_input > 0, "uncertainty of the model's inputs");
  return text;
}

// Whose covariance of F is known; empty: nobody's.
std::string strain_source(const Differences& differences, const MotionSource& first, const MotionSource& second) {
  std::string text;
  if (differences.cov_F_known(0)) text = "covariance of F of " + first.name();
  if (differences.cov_F_known(1)) text = text.empty() ? "covariance of F of " + second.name() : "covariances of F of both";
  if (!text.empty() && differences.strain_gauge() > 0)
    text += " and what averaging over the gauge length (" + number(differences.strain_gauge(), 3) + " " + first.length_unit() +
            ") would change";
  return text;
}

// Whose noise floor is known, and from what; empty: nobody's.
std::string floor_source(const Differences& differences, const StrainNotes& notes, const CompareOptions& options,
                         const MotionSource& first, const MotionSource& second) {
  std::string text;
  const std::array<const MotionSource*, 2> motions{&first, &second};
  const auto add = [&](std::size_t s, const std::string& from, const char* when) {
    text += (text.empty() ? "" : " and ") + motions[s]->name() + " (" + from + ")" + when;
  };
  for (std::size_t s = 0; s < 2; ++s) {
    if (notes[s] && std::isfinite(notes[s]->floor_dev))
      add(s, std::string(name_of(notes[s]->floor_source)), " at its last frame");
    else if (differences.floor_in_zone(s))
      add(s, options.fixed_zone_m.empty() ? "compare.reference_m" : "compare.fixed_zone_m", "");
  }
  return text;
}

// Adds every common time, in order, until one data set has nothing left to compare.
void walk_times(const CommonTimes& common, DataSet& first, DataSet& second, Alignment& alignment, const Reference& reference,
                Numerics& numerics, Differences& differences, Bands& bands, PointHistories& points, Pressures& pressures,
                std::vector<std::string>& remarks, Progress& progress) {
  for (double time : common.times) {
    if (progress.stop_requested()) throw Interrupted();
    const DataSetState& a = first.at(time);
    const DataSetState& b = second.at(time);
    alignment.update(b.followed);
    const auto frame = reference.fit(a, b);
    const std::vector<Vec2>& numerical = numerics.at(time, b, alignment.partners());
    if (!frame || !differences.add(a, b, alignment.partners(), *frame, numerical)) {
      const std::string what = (frame ? "o particle has a partner any more at " : "o reference particle is left at ") +
                               number(time) + " " + first.motion().time_unit();
      if (differences.times().size() == 1)
        throw InputError("compare: n" + what + ", the first time after the start, expected some");
      remarks.push_back("N" + what + ": the comparison ends at the time before.");
      break;
    }
    bands.add(a, b);
    points.add(a, b, *frame, numerical);
    pressures.add(a, b, alignment.partners());
    progress.update("compare", std::int64_t(differences.times().size()), std::int64_t(common.times.size()));
  }
  if (differences.times().empty())
    throw InputError("compare: no particle of motion " + quoted(first.motion()) + " has a partner in motion " +
                     quoted(second.motion()) + " at any common time, expected one at least");
}

// Over which strains of either are averaged; 0: neither says so.
double gauge_of(const StrainNotes& notes) {
  double gauge = 0;
  for (const auto& note : notes)
    if (note && note->gauge_length > gauge) gauge = note->gauge_length;
  return gauge;
}

// Of too little of the material nothing is said: values stay, uncertainties and verdicts go. Gives why, one sentence.
std::string withhold(const Findings& f, double least, std::vector<Metric>& metrics) {
  const double start = f.coverage[0], end = double(f.last().displacement.count()) / double(f.particles);
  if (!(std::min(start, end) < least)) return "";
  for (Metric& m : metrics) {
    if (std::isnan(m.factor) && m.name != "outline_iou") continue;
    m.verdict = Verdict::withheld;
    m.uncertainty = not_known;
  }
  const auto percent = [](double share) { return number(100 * share, 3) + " %"; };
  return "No verdict: " + percent(start) + " of the first's particles have a partner at the common start and " + percent(end) +
         " at the last common time, less than compare.verdict_coverage asks for (" + percent(least) +
         "); particles that ended in either data set count as not compared.";
}

// In the order of the record.
std::vector<ComparisonTable> tables_of(const Findings& findings) {
  std::vector<ComparisonTable> tables{findings.differences.over_space()};
  for (ComparisonTable& table : findings.bands.tables(findings.length_unit, findings.time_unit))
    tables.push_back(std::move(table));
  tables.insert(tables.end(), findings.points.tables.begin(), findings.points.tables.end());
  tables.push_back(distribution_table(findings.differences.last_particles(), findings.length_unit));
  for (const FieldDecomposition& field : findings.decompositions)
    tables.push_back(table_of(field, findings.length_unit));
  return tables;
}

// Data sets are read anew where the walk has left them beyond what is wanted. Limits are the caller's to apply.
Comparison compare_sets(const MotionSource& first_motion, const MotionSource& second_motion,
                        const CompareOptions& options, const LimitOptions& limits, const Refinement& refinement,
                        const std::vector<std::vector<Metric>>& on_coarser, const StrainNotes& notes,
                        const Together& together, Progress& progress) {
  const CommonTimes common = common_times(first_motion, second_motion);
  DataSet first(first_motion, common), second(second_motion, common);
  Alignment alignment(first, second);
  const bool turn = !options.fixed_zone_m.empty();
  const Reference reference(turn ? options.fixed_zone_m : options.reference_m, turn,
                            turn ? "compare.fixed_zone_m" : "compare.reference_m", first, second);
  const MaterialMesh start_first = present_mesh(first, {}), start_second = present_mesh(second, {});

  Comparison out;
  out.names = {first_motion.name(), second_motion.name()};
  remark_alignment(alignment, first, second, common, out.remarks);
  const std::string mistake =
      likely_mistake(start_first, first.median_spacing(), start_second, second.median_spacing(), first_motion.length_unit());
  if (!mistake.empty()) out.doubts.push_back(mistake);
  Differences differences(paired_particles(alignment, first, second, mistake), first, common.times.size(), options, notes,
                          together.time ? together.time->sigma : 0);
  Numerics numerics(refinement, first, second, common);
  Bands bands(options.band_strain, first, second);
  PointHistories points(options, first, second);
  Pressures pressures(first, second, differences.paired(), common);
  walk_times(common, first, second, alignment, reference, numerics, differences, bands, points, pressures, out.remarks, progress);

  const std::string &unit = first_motion.length_unit(), &time_unit = first_motion.time_unit();
  const bool given = options.measurement_uncertainty_m.value_or(0) > 0 || options.gauge_uncertainty > 0 || turn;
  const double end = differences.times().back(), u_dev = differences.last().dev_uncertainty();
  // Where the comparison ended early, the data sets stand one time further.
  DataSet end_first(first_motion, common), end_second(second_motion, common);
  end_first.at(end);
  end_second.at(end);
  Findings findings{.differences = differences,
                    .pressures = pressures,
                    .length_unit = unit,
                    .time_unit = time_unit,
                    .at_end = "at the last common time (" + number(end) + " " + time_unit + ")",
                    .covariance = covariance_source(differences, first, second, given, together.time.has_value()),
                    .floor = floor_source(differences, notes, options, first_motion, second_motion),
                    .strain = strain_source(differences, first_motion, second_motion),
                    .coverage = {alignment.coverage_first(), alignment.coverage_second()},
                    .particles = first.size(),
                    .times = first_motion.times().size(),
                    .reference_given = reference.given(),
                    .reference_turns = reference.turns(),
                    .convergence = numerics.given() ? std::optional(numerics.convergence()) : std::nullopt,
                    .shapes = measure_shapes({start_first, start_second, end_first, end_second}, differences, options),
                    .bands = bands.measure(end_first, end_second, differences.last(), gauge_of(notes)),
                    .points = points.measure(unit, time_unit),
                    .distributions = measure_distributions(differences.last_particles()),
                    .decompositions = decompose_fields(differences.last_particles(), u_dev),
                    .beginnings = beginnings(differences),
                    .time_offset = together.time,
                    .place = together.place};
  out.metrics = metrics_of(findings);
  if (const std::string why = withhold(findings, options.verdict_coverage, out.metrics); !why.empty())
    out.remarks.push_back(why);
  if (!on_coarser.empty()) {
    const std::vector<std::string> outside = add_numerical(out.metrics, on_coarser, refinement.ratio);
    if (!outside.empty()) out.remarks.push_back(remark_outside(outside));
  }
  // What carries covariances was measured: it has neither mesh nor inputs.
  const bool measured = differences.cov_known(0) && differences.cov_known(1);
  judge(out.metrics, {measured, measured}, unit);
  remark_findings(findings, out.remarks);
  remark_units(options, limits, unit, out.remarks);
  remark_offsets(findings, out.remarks);
  out.outlines = std::move(findings.shapes.outlines);
  out.tables = tables_of(findings);
  out.fields = differences.take_fields();
  if (std::optional<ComparisonField> pressure = pressures.field()) out.fields.push_back(std::move(*pressure));
  return out;
}

}  // namespace

Comparison compare(const MotionSource& first, const MotionSource& given_second, const CompareOptions& options,
                   const LimitOptions& limits, Progress& progress, const Refinement& given_refinement,
                   const StrainNotes& notes) {
  check_comparable(first, given_second);
  check_options(options, limits);
  const Together together = bring_together(first, given_second, options);
  // Coarser grids share the second's coordinates and clock.
  std::vector<std::unique_ptr<TransformedMotion>> moved;
  const auto seen = [&](const MotionSource& motion) -> const MotionSource& {
    if (together.second.identity()) return motion;
    moved.push_back(std::make_unique<TransformedMotion>(motion, together.second));
    return *moved.back();
  };
  const MotionSource& second = seen(given_second);
  Refinement refinement{{}, given_refinement.ratio};
  for (const MotionSource* coarser : given_refinement.coarser) refinement.coarser.push_back(&seen(*coarser));
  std::vector<std::vector<Metric>> on_coarser;
  for (const MotionSource* coarser : refinement.coarser)
    on_coarser.push_back(
        compare_sets(first, *coarser, options, limits, {}, {}, {notes[0], {}}, together, progress).metrics);
  Comparison out = compare_sets(first, second, options, limits, refinement, on_coarser, notes, together, progress);
  out.limits = apply_limits(limits, out.metrics);
  return out;
}

}  // namespace pivnp::compare
