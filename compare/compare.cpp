#include "compare/compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "compare/alignment.hpp"
#include "compare/differences.hpp"
#include "compare/increments.hpp"
#include "compare/metrics.hpp"
#include "compare/outline.hpp"
#include "compare/reference.hpp"
#include "compare/side.hpp"
#include "compare/slope.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/strain.hpp"

namespace pivnp::compare {

namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100 * share);
  return text;
}

std::string quoted(const MotionSource& motion) { return "'" + motion.name() + "'"; }

void check_comparable(const MotionSource& first, const MotionSource& second) {
  for (const MotionSource* m : {&first, &second}) {
    if (m->particles().size() == 0) throw InputError("compare: motion " + quoted(*m) + " has no particles");
    if (m->times().empty()) throw InputError("compare: motion " + quoted(*m) + " has no frames");
  }
  auto same = [&](const char* what, const std::string& a, const std::string& b) {
    if (a != b)
      throw InputError("compare: the " + std::string(what) + " unit of motion " + quoted(first) + " is '" + a +
                       "', that of " + quoted(second) + " is '" + b + "'; expected the same");
  };
  same("length", first.length_unit(), second.length_unit());
  same("time", first.time_unit(), second.time_unit());
}

std::vector<std::size_t> paired_particles(const Alignment& alignment, const Side& first, const Side& second) {
  std::vector<std::size_t> paired;
  for (std::size_t p = 0; p < first.size(); ++p)
    if (has_partner(alignment.partners()[p])) paired.push_back(p);
  if (paired.empty())
    throw InputError("compare: no particle of motion " + quoted(first.motion()) + " finds a partner in motion " +
                     quoted(second.motion()) +
                     "; expected material positions that overlap (same origin, unit and labels)");
  return paired;
}

void remark_alignment(const Alignment& alignment, const Side& first, const Side& second, const CommonTimes& common,
                      std::vector<std::string>& remarks) {
  const std::string names = quoted(second.motion()) + " (second) against " + quoted(first.motion()) + " (first)";
  remarks.push_back(alignment.by_identity()
                        ? names + ": particles paired by identity (same ids at the same material positions)."
                        : names + ": particles paired by material position, the second interpolated linearly on the "
                                  "Delaunay triangulation of its material positions (no triangle of a circumradius "
                                  "above " +
                              number(MaterialMesh::alpha_ratio) +
                              " spacings; up to half a spacing beyond its edge from the nearest point of the edge), "
                              "and linearly in time.");
  remarks.push_back("Coverage: " + percent(alignment.coverage_first()) + " of the first's and " +
                    percent(alignment.coverage_second()) + " of the second's particles found a partner.");
  for (const Side* side : {&first, &second}) {
    if (side->counted_anew())
      remarks.push_back("Motion " + quoted(side->motion()) + " begins before the other: its displacement and strain "
                        "are counted from " + number(common.start) + " " + side->motion().time_unit() + ".");
    if (side->born_later() > 0)
      remarks.push_back(std::to_string(side->born_later()) + " particles of motion " + quoted(side->motion()) +
                        " are not there at the common start and are not compared.");
  }
  const std::size_t all = first.motion().times().size();
  if (common.times.size() < all)
    remarks.push_back(std::to_string(all - common.times.size()) + " of the first's " + std::to_string(all) +
                      " times lie outside the second's and are not compared.");
}

std::string covariance_source(const Differences& differences, const Side& first, const Side& second) {
  const bool a = differences.cov_known(0), b = differences.cov_known(1);
  if (a && b) return "covariances of both motions added";
  if (a) return "covariance of the first (" + first.motion().name() + ")";
  if (b) return "covariance of the second (" + second.motion().name() + ")";
  return "";
}

void add_coverage(const Alignment& alignment, const Differences& differences, std::size_t first_size,
                  const std::string& at_end, std::vector<Metric>& metrics) {
  metrics.push_back({"coverage_first", alignment.coverage_first(), "1", not_known,
                     "share of the first's particles that found a partner, at the common start", ""});
  metrics.push_back({"coverage_second", alignment.coverage_second(), "1", not_known,
                     "share of the second's particles that found a partner, at the common start", ""});
  metrics.push_back({"coverage_first_final", double(differences.last().displacement.count()) / double(first_size), "1",
                     not_known, "share of the first's particles that still have a partner, " + at_end, ""});
}

void add_reference(const Reference& reference, const Tally& last, const std::string& unit, const std::string& at_end,
                   std::vector<Metric>& metrics) {
  if (!reference.given()) return;
  for (std::size_t s = 0; s < 2; ++s)
    for (int axis = 0; axis < 2; ++axis) {
      const std::string side = s == 0 ? "first" : "second", name = axis == 0 ? "x" : "y";
      metrics.push_back({"reference_shift_" + side + "_" + name, last.shift[s][axis], unit, not_known,
                         "mean u_" + name + " of the " + side + "'s particles in compare.reference_m, subtracted from "
                         "that side, " + at_end, ""});
    }
}

// Neighbours drift apart as the material stretches: by the greater principal stretch of F, followed up to four.
double present_spacing(double spacing, const Mat2& F) {
  const double stretch = std::exp(principal(log_strain(F)).first);
  return spacing * (std::isfinite(stretch) ? std::clamp(stretch, 1.0, 4.0) : 1.0);
}

// Where a side's particles are now, in the frame of the comparison.
MaterialMesh present_mesh(const Side& side, const Vec2& shift) {
  std::vector<Vec2> x;
  std::vector<double> spacing;
  for (std::size_t p = 0; p < side.size(); ++p) {
    if (!side.state().followed[p]) continue;
    x.push_back(side.material_position()[p] + side.state().u[p] - shift);
    spacing.push_back(present_spacing(side.spacing()[p], side.state().F[p]));
  }
  return MaterialMesh(std::move(x), std::move(spacing));
}

// Both sides as they are at the last common time compared.
void add_outlines(const Side& first, const Side& second, const Differences& differences, const CompareOptions& options,
                  Comparison& out) {
  const Tally& last = differences.last();
  const MaterialMesh mesh_first = present_mesh(first, last.shift[0]), mesh_second = present_mesh(second, last.shift[1]);
  const std::array<double, 2> spacing{first.median_spacing(), second.median_spacing()};
  const double cell = std::min(spacing[0], spacing[1]) / 4, grow = std::max(spacing[0], spacing[1]) / 2;
  const Lattice lattice = lattice_around(mesh_first, mesh_second, cell, grow, options.slope_base_m);
  const Cover cover_first = cover(mesh_first, spacing[0] / 2, lattice);
  const Cover cover_second = cover(mesh_second, spacing[1] / 2, lattice);
  out.outline_first = outline(cover_first);
  out.outline_second = outline(cover_second);

  if (out.outline_first.empty() || out.outline_second.empty()) {
    out.remarks.push_back("The particles of one side lie too far apart at the end to have an outline.");
    return;
  }
  const std::string& unit = first.motion().length_unit();
  out.metrics.push_back({"outline_iou", intersection_over_union(cover_first, cover_second), "1", not_known,
                         "area common to both outlines over the area of either, at the last common time, on cells of " +
                             number(lattice.cell) + " " + unit + "; uncertainty not estimated", ""});
  if (!options.slope_base_m) return;
  const SlopeShape shape_first = slope_shape(cover_first, *options.slope_base_m, spacing[0]);
  const SlopeShape shape_second = slope_shape(cover_second, *options.slope_base_m, spacing[1]);
  if (shape_first.faces == 0 || shape_second.faces == 0) {
    out.remarks.push_back("One side has no material above compare.slope_base_m at the end: no slope angle.");
    return;
  }
  std::array<double, 2> sigma{0, 0};
  for (std::size_t s = 0; s < 2; ++s)
    if (differences.cov_known(s)) sigma[s] = last.rms_sigma(s);
  add_slope_metrics(shape_first, shape_second, spacing, sigma, unit, out.metrics);
  auto way = [](const SlopeShape& shape) { return shape.faces > 0 ? "+x" : "-x"; };
  out.remarks.push_back(std::string("The slope faces ") + way(shape_first) + " on the first side and " +
                        way(shape_second) + " on the second" +
                        (shape_first.faces == shape_second.faces ? "." : ": run-out and angle are not subtracted."));
}

void add_motion_metrics(const Differences& differences, const Wording& everywhere, const Wording& at_end,
                        Comparison& out) {
  const Tally &total = differences.total(), &last = differences.last();
  add_displacement_metrics(total, everywhere, total.peak_first, out.metrics);
  add_displacement_metrics(last, at_end, total.peak_first, out.metrics);
  add_peak_metrics(total, everywhere, out.metrics);
  add_strain_metrics(total, everywhere, out.metrics);
  add_strain_metrics(last, at_end, out.metrics);
  if (!(total.peak_first > 0))
    out.remarks.push_back("The first does not move: no metrics relative to its displacement.");
  if (const std::size_t lost = total.displacement.count() - total.strain_dev.count(); lost > 0)
    out.remarks.push_back(std::to_string(lost) + " of " + std::to_string(total.displacement.count()) +
                          " particle-times have no strain: a deformation gradient is not positive.");
}

void remark_units(const CompareOptions& options, const LimitOptions& limits, const std::string& unit,
                  std::vector<std::string>& remarks) {
  if (unit == "m" || (options.reference_m.empty() && !options.slope_base_m && !limits.displacement_rms_m)) return;
  remarks.push_back("Lengths given under compare are read in the motions' own unit, " + unit + ".");
}

// Adds every common time, in order, until one side has nothing left to compare.
void walk_times(const CommonTimes& common, Side& first, Side& second, Alignment& alignment, const Reference& reference,
                Differences& differences, Comparison& out, Progress& progress) {
  for (double time : common.times) {
    if (progress.stop_requested()) throw Interrupted();
    const SideState& a = first.at(time);
    const SideState& b = second.at(time);
    alignment.update(b.followed);
    const auto shift = reference.shift(a, b);
    if (!shift || !differences.add(a, b, alignment.partners(), *shift)) {
      const char* what = shift ? "No particle has a partner any more at " : "No reference particle is left at ";
      out.remarks.push_back(what + number(time) + " " + first.motion().time_unit() +
                            ": the comparison ends at the time before.");
      break;
    }
    out.time.push_back(time);
    progress.update("compare", std::int64_t(out.time.size()), std::int64_t(common.times.size()));
  }
  if (out.time.empty())
    throw InputError("compare: no particle of motion " + quoted(first.motion()) + " has a partner in motion " +
                     quoted(second.motion()) + " at any common time, expected one at least");
}

void add_increments(const MotionSource& first, const std::vector<std::size_t>& paired, const CompareOptions& options,
                    const Tally& last, Comparison& out) {
  if (out.time.size() < 2) return;
  std::vector<Vec2> x0;
  for (const std::size_t p : paired) x0.push_back(first.particles().x0[p]);
  const double reference = last.shift[0].norm() / double(out.time.size() - 1);
  const auto field = [&](const std::string& name) -> const DifferenceField& {
    return *std::find_if(out.fields.begin(), out.fields.end(), [&](const DifferenceField& f) { return f.name == name; });
  };
  add_increment_metrics(field("difference_x"), field("difference_y"), out.time.size(), x0, options.increments_outside_m,
                        reference, first.length_unit(), out.metrics);
}

}  // namespace

Comparison compare(const MotionSource& first_motion, const MotionSource& second_motion, const CompareOptions& options,
                   const LimitOptions& limits, Progress& progress) {
  check_comparable(first_motion, second_motion);
  const CommonTimes common = common_times(first_motion, second_motion);
  Side first(first_motion, common), second(second_motion, common);
  Alignment alignment(first, second);
  const Reference reference(options.reference_m, first, second);

  Comparison out;
  remark_alignment(alignment, first, second, common, out.remarks);
  const std::vector<std::size_t> paired = paired_particles(alignment, first, second);
  for (std::size_t p : paired) out.id.push_back(first_motion.particles().id[p]);
  Differences differences(paired, first_motion.length_unit());

  walk_times(common, first, second, alignment, reference, differences, out, progress);

  const std::string& unit = first_motion.length_unit();
  const std::string at_end =
      "at the last common time (" + number(out.time.back()) + " " + first_motion.time_unit() + ")";
  const std::string covariance = covariance_source(differences, first, second);
  out.coverage_first = alignment.coverage_first();
  out.coverage_second = alignment.coverage_second();
  add_motion_metrics(differences, {"", "over all common particles and times", covariance, unit},
                     {"_final", at_end, covariance, unit}, out);
  add_coverage(alignment, differences, first.size(), at_end, out.metrics);
  add_reference(reference, differences.last(), unit, at_end, out.metrics);
  // Read anew: where the comparison ended early, the sides stand one time further.
  Side end_first(first_motion, common), end_second(second_motion, common);
  end_first.at(out.time.back());
  end_second.at(out.time.back());
  add_outlines(end_first, end_second, differences, options, out);
  remark_units(options, limits, unit, out.remarks);
  out.fields = differences.take_fields();
  out.series = differences.take_series();
  add_increments(first_motion, paired, options, differences.last(), out);
  out.over_limit = apply_limits(limits, out.metrics);
  return out;
}

}  // namespace pivnp::compare
