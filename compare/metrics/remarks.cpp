#include "compare/metrics/remarks.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100 * share);
  return text;
}

// Whether an option differs from what it is when left out.
bool stated(double v) { return v != 0; }
bool stated(const Pair& v) { return v != Pair{0.0, 0.0}; }
template <class T>
bool stated(const std::vector<T>& v) { return !v.empty(); }
template <class T>
bool stated(const std::optional<T>& v) { return v.has_value(); }
bool stated(const std::string&) { return false; }  // a choice

}  // namespace

std::string quoted(const MotionSource& motion) { return "'" + motion.name() + "'"; }

void remark_alignment(const Alignment& alignment, const Side& first, const Side& second, const CommonTimes& common,
                      std::vector<std::string>& remarks) {
  const std::string names = quoted(second.motion()) + " (second) against " + quoted(first.motion()) + " (first)";
  remarks.push_back(alignment.by_identity()
                        ? names + ": particles paired by identity (same ids at the same material positions)."
                        : names + ": particles paired by material position, the second interpolated by "
                                  "natural neighbours among its material positions (no triangle of a circumradius "
                                  "above " +
                              number(MaterialMesh::alpha_ratio) +
                              " spacings; up to half a spacing beyond its edge from the nearest point of the edge), "
                              "and linearly in time.");
  remarks.push_back("Coverage: " + percent(alignment.coverage_first()) + " of the first's and " +
                    percent(alignment.coverage_second()) + " of the second's particles found a partner.");
  for (const Side* side : {&first, &second}) {
    if (side->counted_anew())
      remarks.push_back("Motion " + quoted(side->motion()) + " is under way at the common start: its displacement and "
                        "strain are counted from " + number(common.start) + " " + side->motion().time_unit() + ".");
    if (side->born_later() > 0)
      remarks.push_back(std::to_string(side->born_later()) + " particles of motion " + quoted(side->motion()) +
                        " are not there at the common start and are not compared.");
  }
  const std::size_t all = first.motion().times().size();
  if (common.times.size() < all)
    remarks.push_back(std::to_string(all - common.times.size()) + " of the first's " + std::to_string(all) +
                      " times lie outside the second's and are not compared.");
}

void remark_units(const CompareOptions& options, const LimitOptions& limits, const std::string& unit,
                  std::vector<std::string>& remarks) {
  if (unit == "m") return;
  bool given = false;
  const auto look = [&](std::string_view, const auto& value, const OptionInfo& info) {
    given = given || ((info.unit == "m" || info.unit == "m/s") && stated(value));
  };
  CompareOptions::fields(options, look);
  LimitOptions::fields(limits, look);
  if (given) remarks.push_back("Lengths given under compare are read in the motions' own unit, " + unit + ".");
}

void add_coverage(const Alignment& alignment, const Differences& differences, const Side& first,
                  const std::string& at_end, Comparison& out) {
  std::vector<Metric>& metrics = out.metrics;
  metrics.push_back({"coverage_first", alignment.coverage_first(), "1", not_known,
                     "share of the first's particles that found a partner, at the common start", ""});
  metrics.push_back({"coverage_second", alignment.coverage_second(), "1", not_known,
                     "share of the second's particles that found a partner, at the common start", ""});
  metrics.push_back({"coverage_first_final", double(differences.last().displacement.count()) / double(first.size()), "1",
                     not_known, "share of the first's particles that still have a partner, " + at_end, ""});
  metrics.push_back({"coverage_time", double(out.time.size()) / double(first.motion().times().size()), "1", not_known,
                     "share of the first's times at which both sides are known and have particles to compare", ""});
}

void add_frame(const Reference& reference, const Tally& last, const std::string& unit, const std::string& at_end,
               std::vector<Metric>& metrics) {
  if (!reference.given()) return;
  const bool turns = reference.turns();
  const std::string prefix = turns ? "fixed_zone_shift_" : "reference_shift_";
  const std::string off = " subtracted from that side, " + at_end;
  for (std::size_t s = 0; s < 2; ++s) {
    const RigidFit& fit = last.frame[s];
    const std::string side = s == 0 ? "first" : "second";
    const std::string how = "; uncertainty: jackknife over blocks of the polygon" +
                            std::string(fit.sigma_shift.allFinite() ? "" : ", too few blocks here");
    for (int axis = 0; axis < 2; ++axis) {
      const std::string name = axis == 0 ? "x" : "y";
      const std::string what =
          turns ? "shift in " + name + " of the " + side + "'s particles in compare.fixed_zone_m, at their centre,"
                : "mean u_" + name + " of the " + side + "'s particles in compare.reference_m,";
      metrics.push_back({prefix + side + "_" + name, fit.motion.shift[axis], unit, fit.sigma_shift[axis],
                         what + off + how, ""});
    }
    if (!turns) continue;
    constexpr double deg = 180 / std::numbers::pi;
    metrics.push_back(
        {"fixed_zone_rotation_" + side, fit.motion.angle * deg, "deg", fit.sigma_angle * deg,
         "rotation of the " + side + "'s particles in compare.fixed_zone_m, counter-clockwise," + off + how, ""});
  }
}

void add_time_offset(const Onset& offset, const std::string& time_unit, Comparison& out) {
  out.metrics.push_back({"time_offset", offset.time, time_unit, offset.sigma,
                         "added to the second's times so that both motions begin together: difference of the zeros of "
                         "lines through the rise (2 to 25 %) of sum u(t).u(T) / sum u(T)^2 to the power 1 or 1/2; "
                         "uncertainty: scatter about both lines", ""});
  out.remarks.push_back("The second's clock was set by " + number(offset.time) + " " + time_unit +
                        " (standard uncertainty " + number(offset.sigma, 2) + " " + time_unit +
                        ") so that both motions begin together.");
}

void add_place(const RigidFit& place, const std::string& unit, Comparison& out) {
  const std::string how = " given to the second's coordinates so that its outline at the common start lies on the first's "
                          "(least squares across the outline); uncertainty: jackknife over pieces of the outline";
  for (int axis = 0; axis < 2; ++axis) {
    const std::string name = axis == 0 ? "x" : "y";
    out.metrics.push_back({"coordinate_shift_" + name, place.motion.shift[axis], unit, place.sigma_shift[axis],
                           "shift in " + name + ", at the centre of the matched outline," + how, ""});
  }
  constexpr double deg = 180 / std::numbers::pi;
  out.metrics.push_back({"coordinate_rotation", place.motion.angle * deg, "deg", place.sigma_angle * deg,
                         "rotation, counter-clockwise," + how, ""});
  out.remarks.push_back("The second's coordinates were shifted by (" + number(place.motion.shift.x()) + ", " +
                        number(place.motion.shift.y()) + ") " + unit + " and turned by " +
                        number(place.motion.angle * deg) + " degrees so that both outlines agree at the common start.");
}

void add_convergence(const Numerics& numerics, Comparison& out) {
  if (!numerics.given()) return;
  const GridConvergence& g = numerics.convergence();
  out.metrics.push_back({"grid_convergence_order", g.order, "1", not_known,
                         "order at which displacements of the second side converge from the coarser grids, over all "
                         "particles at the last common time; held to 0.5 ... 2 (1 with two grids)", ""});
  if (!g.asymptotic)
    out.remarks.push_back(
        "The coarser grids do not show an order of convergence between 0.5 and 2 (or there is only one): "
        "the numerical uncertainty carries a safety factor of 3.");
}

}  // namespace pivnp::compare
