#include "compare/compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "compare/alignment/onset.hpp"
#include "compare/alignment/outlines.hpp"
#include "compare/alignment/partners.hpp"
#include "compare/alignment/reference.hpp"
#include "compare/data/data_set.hpp"
#include "compare/data/transformed.hpp"
#include "compare/measures/bands.hpp"
#include "compare/measures/decomposition.hpp"
#include "compare/measures/differences.hpp"
#include "compare/measures/distribution.hpp"
#include "compare/measures/numerics.hpp"
#include "compare/measures/points.hpp"
#include "compare/metrics/metrics.hpp"
#include "compare/metrics/remarks.hpp"
#include "compare/metrics/shapes.hpp"
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
  if ((limits.run_out_m || limits.slope_angle_deg) && !options.slope_base_m)
    throw InputError("compare.limits." + std::string(limits.run_out_m ? "run_out_m" : "slope_angle_deg") +
                     ": needs compare.slope_base_m, which is not given");
}

// A side by name, and where its particles lie.
std::string where(const Side& side) {
  Vec2 lower = side.material_position().front(), upper = lower;
  for (const Vec2& x : side.material_position()) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  const auto span = [&](int axis) { return number(lower[axis], 4) + " to " + number(upper[axis], 4); };
  return quoted(side.motion()) + " (x " + span(0) + ", y " + span(1) + " " + side.motion().length_unit() + ")";
}

std::vector<std::size_t> paired_particles(const Alignment& alignment, const Side& first, const Side& second) {
  std::vector<std::size_t> paired;
  for (std::size_t p = 0; p < first.size(); ++p)
    if (has_partner(alignment.partners()[p])) paired.push_back(p);
  if (paired.empty())
    throw InputError("compare: no particle of the first, " + where(first) + ", finds a partner in the second, " +
                     where(second) + "; expected material positions that overlap (same origin, unit and labels)");
  return paired;
}

std::string covariance_source(const Differences& differences, const Side& first, const Side& second,
                              bool given) {
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
  add(total.sum_numerical > 0, "numerical uncertainty of the second");
  add(total.sum_input > 0, "uncertainty of the model's inputs");
  return text;
}

// Whose noise floor is the record's own; empty: nobody's.
std::string floor_source(const StrainNotes& notes, const MotionSource& first, const MotionSource& second) {
  std::string text;
  const std::array<const MotionSource*, 2> motions{&first, &second};
  for (std::size_t s = 0; s < 2; ++s)
    if (notes[s] && std::isfinite(notes[s]->floor_dev))
      text += (text.empty() ? "" : " and ") + motions[s]->name() + " (" + notes[s]->floor_source + ")";
  return text;
}

void add_motion_metrics(const Differences& differences, const Wording& everywhere, const Wording& at_end,
                        const std::string& speed_unit, Comparison& out) {
  const Tally &total = differences.total(), &last = differences.last();
  add_displacement_metrics(total, everywhere, total.peak_first, out.metrics);
  add_displacement_metrics(last, at_end, total.peak_first, out.metrics);
  add_peak_metrics(total, everywhere, out.metrics);
  add_uncertainty_metrics(total, everywhere, out.metrics);
  add_uncertainty_metrics(last, at_end, out.metrics);
  add_velocity_metrics(differences.rates(), everywhere, speed_unit, out.metrics);
  add_strain_metrics(total, everywhere, out.metrics);
  add_strain_metrics(last, at_end, out.metrics);
  if (!(total.peak_first > 0))
    out.remarks.push_back("The first does not move: no metrics relative to its displacement.");
  if (const std::size_t unknown = total.displacement.count_unknown();
      unknown > 0 && unknown < total.displacement.count())
    out.remarks.push_back(std::to_string(unknown) + " of " + std::to_string(total.displacement.count()) +
                          " particle-times have no known uncertainty: none is stated for what holds them.");
  if (const std::size_t lost = total.displacement.count() - total.strain_dev.count(); lost > 0)
    out.remarks.push_back(std::to_string(lost) + " of " + std::to_string(total.displacement.count()) +
                          " particle-times have no strain: a deformation gradient is not known, or not positive.");
}

// Adds every common time, in order, until one side has nothing left to compare.
void walk_times(const CommonTimes& common, Side& first, Side& second, Alignment& alignment, const Reference& reference,
                Numerics& numerics, Differences& differences, Bands& bands, PointHistories& points, Comparison& out,
                Progress& progress) {
  for (double time : common.times) {
    if (progress.stop_requested()) throw Interrupted();
    const SideState& a = first.at(time);
    const SideState& b = second.at(time);
    alignment.update(b.followed);
    const auto frame = reference.fit(a, b);
    const std::vector<Vec2>& numerical = numerics.at(time, b, alignment.partners());
    if (!frame || !differences.add(a, b, alignment.partners(), *frame, numerical)) {
      const std::string what = (frame ? "o particle has a partner any more at " : "o reference particle is left at ") +
                               number(time) + " " + first.motion().time_unit();
      if (out.time.size() == 1)
        throw InputError("compare: n" + what + ", the first time after the start, expected some");
      out.remarks.push_back("N" + what + ": the comparison ends at the time before.");
      break;
    }
    bands.add(a, b);
    points.add(a, b, *frame, numerical);
    out.time.push_back(time);
    progress.update("compare", std::int64_t(out.time.size()), std::int64_t(common.times.size()));
  }
  if (out.time.empty())
    throw InputError("compare: no particle of motion " + quoted(first.motion()) + " has a partner in motion " +
                     quoted(second.motion()) + " at any common time, expected one at least");
}

Transform transform_of(const CompareOptions& options) {
  Transform t;
  t.scale = options.second_scale;
  t.angle = options.second_rotation_deg * std::numbers::pi / 180;
  t.shift = Vec2(options.second_shift_m[0], options.second_shift_m[1]);
  t.time_scale = options.second_time_scale;
  t.time_offset = options.time_offset_s;
  return t;
}

// The offset to add to the second's times, with what it is uncertain by.
Onset find_offset(const MotionSource& first, const MotionSource& second, const CompareOptions& options) {
  const bool turn = !options.fixed_zone_m.empty();
  const Points& zone = turn ? options.fixed_zone_m : options.reference_m;
  const Onset offset = onset_offset(participation(first, zone, turn), participation(second, zone, turn));
  if (!std::isfinite(offset.time))
    throw InputError("compare.time_alignment: \"onset\", but motion " + quoted(first) + " or " + quoted(second) +
                     " shows no onset, expected both to move from rest");
  return offset;
}

// The rigid motion that brings the second's outline at the common start onto the first's.
RigidFit find_place(const MotionSource& first, const MotionSource& second, const CompareOptions& options) {
  const CommonTimes common = common_times(first, second);
  const Side a(first, common), b(second, common);
  return match_sides(a, b, options.fixed_zone_m);
}

// Sides are read anew where the walk has left them beyond what is wanted.
Comparison compare_sides(const MotionSource& first_motion, const MotionSource& second_motion,
                         const CompareOptions& options, const LimitOptions& limits, const Refinement& refinement,
                         const StrainNotes& notes, Progress& progress) {
  const CommonTimes common = common_times(first_motion, second_motion);
  Side first(first_motion, common), second(second_motion, common);
  Alignment alignment(first, second);
  const bool turn = !options.fixed_zone_m.empty();
  const Reference reference(turn ? options.fixed_zone_m : options.reference_m, turn,
                            turn ? "compare.fixed_zone_m" : "compare.reference_m", first, second);
  const MaterialMesh start_first = present_mesh(first, {}), start_second = present_mesh(second, {});

  Comparison out;
  remark_alignment(alignment, first, second, common, out.remarks);
  const std::vector<std::size_t> paired = paired_particles(alignment, first, second);
  for (std::size_t p : paired) out.id.push_back(first_motion.particles().id[p]);
  Differences differences(paired, first.material_position(), common.times.size(), options, notes,
                          first_motion.length_unit(), first_motion.time_unit());
  Numerics numerics(refinement, first, second, common);

  Bands bands(options.band_strain, first, second);
  PointHistories points(options, first, second);

  walk_times(common, first, second, alignment, reference, numerics, differences, bands, points, out, progress);

  const std::string &unit = first_motion.length_unit(), &time_unit = first_motion.time_unit();
  const std::string at_end = "at the last common time (" + number(out.time.back()) + " " + time_unit + ")";
  const bool given = options.measurement_uncertainty_m.value_or(0) > 0 || options.gauge_uncertainty > 0 || turn;
  const std::string covariance = covariance_source(differences, first, second, given);
  const std::string floor = floor_source(notes, first_motion, second_motion);
  out.coverage_first = alignment.coverage_first();
  out.coverage_second = alignment.coverage_second();
  add_motion_metrics(differences, {"", "over all common particles and times", covariance, unit, floor},
                     {"_final", at_end, covariance, unit, floor}, unit + "/" + time_unit, out);
  add_coverage(alignment, differences, first, at_end, out);
  add_frame(reference, differences.last(), unit, at_end, out.metrics);
  add_convergence(numerics, out);
  // Where the comparison ended early, the sides stand one time further.
  Side end_first(first_motion, common), end_second(second_motion, common);
  end_first.at(out.time.back());
  end_second.at(out.time.back());
  add_shapes({start_first, start_second, end_first, end_second}, differences, options, out);
  bands.finish(end_first, end_second, differences.last().frame, differences.last().floor_dev, unit, time_unit, out);
  points.finish(unit, time_unit, out);
  add_distributions(differences.snapshot(), differences.last().displacement.rms_uncertainty(),
                    differences.last().floor_dev, unit, out);
  add_decompositions(differences.snapshot(), differences.last().floor_dev, unit, out);
  remark_units(options, limits, unit, out.remarks);
  if (out.time.size() > 1)
    differences.rates().add_increment_metrics(
        differences.last().frame[0].motion.shift.norm() / double(out.time.size() - 1), unit, out.metrics);
  differences.take(out);
  return out;
}

}  // namespace

Comparison compare(const MotionSource& first, const MotionSource& given_second, const CompareOptions& options,
                   const LimitOptions& limits, Progress& progress, const Refinement& given_refinement,
                   const StrainNotes& notes) {
  check_comparable(first, given_second);
  check_options(options, limits);
  Transform transform = transform_of(options);
  std::optional<Onset> offset;
  if (options.time_alignment == "onset") {
    const TransformedMotion second(given_second, transform);
    offset = find_offset(first, second, options);
    transform.time_offset += offset->time;
  }
  std::optional<RigidFit> place;
  if (options.space_alignment == "outline") {
    place = find_place(first, TransformedMotion(given_second, transform), options);
    const RigidMotion& m = place->motion;
    transform.shift = m.apply(transform.shift);
    transform.angle += m.angle;
  }
  // Coarser grids share the second's coordinates and clock.
  std::vector<std::unique_ptr<TransformedMotion>> moved;
  const auto seen = [&](const MotionSource& motion) -> const MotionSource& {
    if (transform.identity()) return motion;
    moved.push_back(std::make_unique<TransformedMotion>(motion, transform));
    return *moved.back();
  };
  const MotionSource& second = seen(given_second);
  Refinement refinement{{}, given_refinement.ratio};
  for (const MotionSource* coarser : given_refinement.coarser) refinement.coarser.push_back(&seen(*coarser));

  Comparison out = compare_sides(first, second, options, limits, refinement, notes, progress);
  if (offset) add_time_offset(*offset, first.time_unit(), out);
  if (place) add_place(*place, first.length_unit(), out);
  out.limits = apply_limits(limits, out.metrics);
  out.over_limit = std::any_of(out.limits.begin(), out.limits.end(), [](const LimitResult& l) { return !l.within; });
  return out;
}

}  // namespace pivnp::compare
