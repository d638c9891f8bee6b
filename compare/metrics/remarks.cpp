#include "compare/metrics/remarks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "compare/data/stated.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100 * share);
  return text;
}

void remark_motion(const Findings& f, std::vector<std::string>& remarks) {
  const Tally& total = f.total();
  const std::size_t all = total.displacement.count();
  if (!(total.peak_first > 0))
    remarks.push_back("The first does not move: no metrics relative to its displacement.");
  if (const std::size_t unknown = total.displacement.count_unknown(); unknown > 0 && unknown < all)
    remarks.push_back(std::to_string(unknown) + " of " + std::to_string(all) +
                      " particle-times have no known uncertainty: metrics that contain them have none.");
  if (const std::size_t lost = all - total.strain_dev.count(); lost > 0)
    remarks.push_back(std::to_string(lost) + " of " + std::to_string(all) +
                      " particle-times have no strain: a deformation gradient is not known, or not positive.");
}

void remark_shapes(const ShapeMeasures& shapes, std::vector<std::string>& remarks) {
  if (!shapes.between)
    remarks.push_back("The particles of one data set lie too far apart at the end to have an outline.");
  if (shapes.nothing_above_base)
    remarks.push_back("One data set has no material above compare.slope_base_m at the end: no slope angle.");
  if (!shapes.slope) return;
  const auto way = [](const SlopeShape& s) { return s.faces > 0 ? "towards +x" : "towards -x"; };
  remarks.push_back("The slope faces " + std::string(way(shapes.slope->shape[0])) + " in the first data set, " +
                    way(shapes.slope->shape[1]) + " in the second" +
                    (shapes.slope->same_way() ? "." : ": run-out and angle are not subtracted."));
}

void remark_decompositions(const std::vector<FieldDecomposition>& decompositions, std::vector<std::string>& remarks) {
  std::string inadequate;
  for (const FieldDecomposition& d : decompositions)
    if (!d.of.adequate) inadequate += (inadequate.empty() ? "" : ", ") + std::string(d.field.symbol);
  if (!inadequate.empty())
    remarks.push_back("Polynomials do not represent local features (clusters of residuals beyond 3 times their RMS) in " +
                      inadequate + ": the decomposition's coefficients are no basis for a verdict there.");
}

}  // namespace

std::string quoted(const MotionSource& motion) { return "'" + motion.name() + "'"; }

void remark_alignment(const Alignment& alignment, const DataSet& first, const DataSet& second,
                      const CommonTimes& common, std::vector<std::string>& remarks) {
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
  for (const DataSet* set : {&first, &second}) {
    if (set->counted_anew())
      remarks.push_back("Motion " + quoted(set->motion()) + " is under way at the common start: its displacement and "
                        "strain are counted from " + number(common.start) + " " + set->motion().time_unit() + ".");
    if (set->born_later() > 0)
      remarks.push_back(std::to_string(set->born_later()) + " particles of motion " + quoted(set->motion()) +
                        " are not there at the common start and are not compared.");
  }
  const std::size_t all = first.motion().times().size();
  if (common.times.size() < all)
    remarks.push_back(std::to_string(all - common.times.size()) + " of the first's " + std::to_string(all) +
                      " times lie outside the second's and are not compared.");
}

void remark_findings(const Findings& f, std::vector<std::string>& remarks) {
  remark_motion(f, remarks);
  if (f.convergence && !f.convergence->asymptotic)
    remarks.push_back(
        "The grids do not show an order of convergence between 0.5 and 2 (or there is only one coarser grid): the numerical "
        "uncertainty of the displacements is the range over the grids, not an extrapolation, and no bound.");
  remark_shapes(f.shapes, remarks);
  for (const std::string& where : f.points.lost)
    remarks.push_back("The material point " + where + " of compare.points_m is not followed on both data sets.");
  remark_decompositions(f.decompositions, remarks);
}

std::string remark_outside(const std::vector<std::string>& metrics) {
  constexpr std::size_t named = 4;
  std::string list;
  for (std::size_t k = 0; k < std::min(named, metrics.size()); ++k) list += (k > 0 ? ", " : "") + metrics[k];
  if (metrics.size() > named) list += " and " + std::to_string(metrics.size() - named) + " more";
  return "The grids are out of the asymptotic range for " + list +
         ": their numerical uncertainty is the range over the three grids and no bound; finer grids would tell.";
}

void remark_units(const CompareOptions& options, const LimitOptions& limits, const std::string& unit,
                  std::vector<std::string>& remarks) {
  if (unit == "m") return;
  if (states_any_in(options, "m", "m/s") || states_any_in(limits, "m", "m/s"))
    remarks.push_back("Lengths given under compare are read in the motions' own unit, " + unit + ".");
}

void remark_offsets(const Findings& f, std::vector<std::string>& remarks) {
  if (const auto& begins = f.beginnings.difference; begins && !f.time_offset && std::abs(begins->time) > 2 * begins->sigma)
    remarks.push_back("The second begins to move " + number(std::abs(begins->time), 3) + " " + f.time_unit +
                      (begins->time > 0 ? " later" : " earlier") + " than the first (standard uncertainty " +
                      number(begins->sigma, 2) + " " + f.time_unit + "): their clocks may differ, which every difference holds; "
                      "compare.time_offset_s or time_alignment sets the second's.");
  if (f.beginnings.rest_over_u.value_or(0) > 2)
    remarks.push_back("While the second stands still, the first differs from it by " + number(*f.beginnings.rest_over_u, 2) +
                      " times the uncertainty: it moves already, or its errors are larger than stated. Differences of "
                      "fewer uncertainties than that may be error.");
  if (f.time_offset)
    remarks.push_back("The second's clock was set by " + number(f.time_offset->time) + " " + f.time_unit +
                      " (standard uncertainty " + number(f.time_offset->sigma, 2) + " " + f.time_unit +
                      ") so that both motions begin together. A difference in how they begin is taken off with it; the "
                      "offset's uncertainty times the speed is in u_val.");
  if (f.place)
    remarks.push_back("The second's coordinates were shifted by (" + number(f.place->motion.shift.x()) + ", " +
                      number(f.place->motion.shift.y()) + ") " + f.length_unit + " and turned by " +
                      number(f.place->motion.angle * 180 / std::numbers::pi) +
                      " degrees so that both outlines agree at the common start.");
}

}  // namespace pivnp::compare
