#include "compare/metrics/shapes.hpp"

#include <algorithm>
#include <cmath>

#include "compare/data/nearest_edge.hpp"
#include "compare/metrics/metrics.hpp"
#include "compare/shapes/outline.hpp"
#include "compare/shapes/slope.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

// Distances from points `step` apart on `rings` to the segments of `to`; at most about 10^8 pairs are looked at.
Quantile distances(const std::vector<std::vector<Vec2>>& rings, const std::vector<std::vector<Vec2>>& to, double step) {
  std::vector<Vec2> points;
  for (const auto& ring : rings)
    for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
      const Vec2 side = ring[k + 1] - ring[k];
      const int pieces = std::max(1, int(std::ceil(side.norm() / step)));
      for (int j = 0; j < pieces; ++j) points.push_back(ring[k] + (double(j) / pieces) * side);
    }
  std::size_t segments = 0;
  for (const auto& ring : to) segments += ring.size();
  const std::size_t stride = points.size() * segments / 100'000'000 + 1;
  Quantile out;
  for (std::size_t p = 0; p < points.size(); p += stride) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& ring : to)
      for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
        const Vec2 &a = ring[k], &b = ring[k + 1];
        nearest = std::min(nearest, (points[p] - (a + nearest_parameter(a, b, points[p]) * (b - a))).squaredNorm());
      }
    const double distance = std::sqrt(nearest);
    out.add(distance > 1e-9 * step ? distance : 0);  // less is rounding
  }
  return out;
}

// Area whose displacement is above a threshold, and what it is uncertain by if |u| has the error `sigma`: half its
// change when the threshold moves by sigma both ways (one error shared by all), and the scatter of a sum of areas that
// count with the probability of a normal error each (errors of their own), in squares.
struct Mobilised {
  double area = 0, uncertainty = not_known;
};

Mobilised mobilised(const Side& side, const RigidMotion& frame, double threshold, double sigma) {
  Mobilised m;
  double lower = 0, upper = 0, variance = 0;
  for (std::size_t p = 0; p < side.size(); ++p) {
    if (!side.state().followed[p]) continue;
    const Vec2& X = side.material_position()[p];
    const double above = (frame.undo(X + side.state().u[p]) - X).norm() - threshold;
    const double area = side.spacing()[p] * side.spacing()[p];
    if (above > 0) m.area += area;
    if (!(sigma > 0)) continue;
    if (above > -sigma) lower += area;
    if (above > sigma) upper += area;
    const double share = 0.5 * std::erfc(-above / sigma / std::sqrt(2.0));
    variance += area * area * share * (1 - share);
  }
  if (sigma > 0) m.uncertainty = std::hypot((lower - upper) / 2, std::sqrt(variance));
  return m;
}

void add_mobilised(const Shapes& shapes, const Tally& last, const Tally& total, const CompareOptions& options,
                   const std::array<double, 2>& sigma, const std::string& unit, std::vector<Metric>& metrics) {
  const double threshold = options.mobilised_m.value_or(0.05 * total.peak_first);
  if (!(threshold > 0)) return;
  const std::string definition = "area of the particles with |u| above " + number(threshold) + " " + unit +
                                 " at the last common time";
  const std::string how =
      "; uncertainty: half the change when the threshold moves by the RMS error of u both ways, and the scatter if "
      "every particle errs by itself, in squares";
  std::array<Mobilised, 2> m;
  const std::array<const Side*, 2> sides{&shapes.first, &shapes.second};
  for (std::size_t s = 0; s < 2; ++s) m[s] = mobilised(*sides[s], last.frame[s].motion, threshold, sigma[s]);
  double both = not_known;  // of those that are known
  if (sigma[0] > 0 || sigma[1] > 0)
    both = std::hypot(sigma[0] > 0 ? m[0].uncertainty : 0, sigma[1] > 0 ? m[1].uncertainty : 0);
  const std::string area_unit = unit + "^2";
  metrics.push_back({"mobilised_area_first", m[0].area, area_unit, m[0].uncertainty, definition + ", first" + how, ""});
  metrics.push_back(
      {"mobilised_area_second", m[1].area, area_unit, m[1].uncertainty, definition + ", second" + how, ""});
  metrics.push_back(difference_metric("mobilised_area_difference", m[1].area - m[0].area, area_unit, both,
                                      definition + ", second minus first" + how));
}

// Outermost place, on the side the slope faces, where the profile reaches `height`; NaN if it nowhere does.
double crest_place(const Profile& profile, double height, int faces) {
  const std::ptrdiff_t n = std::ptrdiff_t(profile.height.size());
  for (std::ptrdiff_t k = faces > 0 ? n - 1 : 0; k >= 0 && k < n; k -= faces) {
    const double here = profile.height[std::size_t(k)];
    if (here < height) continue;
    const std::ptrdiff_t out = k + faces;
    const double beyond = out >= 0 && out < n ? profile.height[std::size_t(out)] : 0;
    const double share = here > beyond ? (here - height) / (here - beyond) : 0;
    return profile.x(std::size_t(k)) + faces * share * profile.width;
  }
  return not_known;
}

// An outline of length L that moves outwards by u everywhere changes either area by at most L u: so much is the share
// in common uncertain by, to first order, if an outline's errors are one and the same all along it.
void add_overlap(const Cover& first, const Cover& second, const std::array<double, 2>& known_to,
                 const std::string& cells, Comparison& out) {
  const Overlap area = overlap(first, second);
  const double u = std::hypot(length_of(out.outline_first) * known_to[0], length_of(out.outline_second) * known_to[1]) /
                   area.either;
  const double iou = area.common / area.either;
  out.metrics.push_back({"outline_iou", iou, "1", u,
                         "area common to both outlines over the area of either" + cells +
                             "; uncertainty, a bound: length of each outline times what it is uncertain by (half a "
                             "particle spacing, rectangular, and the error of u, where known) over the area of either",
                         1 - iou < 2 * u ? not_distinguishable : ""});
}

struct Covers {
  Cover start, end;
};

void add_slope(const std::array<Covers, 2>& covers, const std::array<double, 2>& spacing,
               const std::array<double, 2>& sigma, double base, const std::string& unit, Comparison& out) {
  const std::array<SlopeShape, 2> shape{slope_shape(covers[0].end, base, spacing[0]),
                                        slope_shape(covers[1].end, base, spacing[1])};
  if (shape[0].faces == 0 || shape[1].faces == 0) {
    out.remarks.push_back("One side has no material above compare.slope_base_m at the end: no slope angle.");
    return;
  }
  add_slope_metrics(shape[0], shape[1], spacing, sigma, unit, out.metrics);
  std::array<double, 2> retreat, place;
  for (std::size_t s = 0; s < 2; ++s) {
    const Profile start = profile_above(covers[s].start, base), end = profile_above(covers[s].end, base);
    const double height = 0.9 * *std::max_element(start.height.begin(), start.height.end());
    const int faces = shape[s].faces;
    retreat[s] = faces * (crest_place(start, height, faces) - crest_place(end, height, faces));
    place[s] = std::hypot(spacing[s] / std::sqrt(12.0), sigma[s]);
  }
  const std::string definition =
      "how far the crest's edge drew back: the outermost place where the area-height profile reaches 90 % of its "
      "greatest value at the common start, then minus at the last common time (not a number: nowhere any more)";
  const std::string how = "; uncertainty: half a particle spacing (rectangular) and the error of u, where known";
  out.metrics.push_back({"crest_retreat_first", retreat[0], unit, place[0], definition + ", first" + how, ""});
  out.metrics.push_back({"crest_retreat_second", retreat[1], unit, place[1], definition + ", second" + how, ""});
  if (std::isfinite(retreat[1] - retreat[0]) && shape[0].faces == shape[1].faces)
    out.metrics.push_back(difference_metric("crest_retreat_difference", retreat[1] - retreat[0], unit,
                                            std::hypot(place[0], place[1]), definition + ", second minus first" + how));
  auto way = [](const SlopeShape& s) { return s.faces > 0 ? "towards +x" : "towards -x"; };
  out.remarks.push_back("The slope faces " + std::string(way(shape[0])) + " on the first side, " + way(shape[1]) +
                        " on the second" +
                        (shape[0].faces == shape[1].faces ? "." : ": run-out and angle are not subtracted."));
}

}  // namespace

double hausdorff_95(const std::vector<std::vector<Vec2>>& first, const std::vector<std::vector<Vec2>>& second,
                    double step) {
  if (first.empty() || second.empty()) return not_known;
  return std::max(distances(first, second, step).at(0.95), distances(second, first, step).at(0.95));
}

void add_shapes(const Shapes& shapes, const Differences& differences, const CompareOptions& options, Comparison& out) {
  const Tally& last = differences.last();
  const std::string& unit = shapes.first.motion().length_unit();
  const std::array<const Side*, 2> sides{&shapes.first, &shapes.second};
  const std::array<const MaterialMesh*, 2> start{&shapes.start_first, &shapes.start_second};
  const std::array<MaterialMesh, 2> end{present_mesh(shapes.first, last.frame[0].motion),
                                        present_mesh(shapes.second, last.frame[1].motion)};
  const std::array<double, 2> spacing{sides[0]->median_spacing(), sides[1]->median_spacing()},
      sigma = last.known_sigma();
  const double cell = std::min(spacing[0], spacing[1]) / 4, grow = std::max(spacing[0], spacing[1]) / 2;
  const Lattice lattice = lattice_around(end[0], end[1], cell, grow, options.slope_base_m);
  const Cover first = cover(end[0], spacing[0] / 2, lattice), second = cover(end[1], spacing[1] / 2, lattice);
  out.outline_first = outline(first);
  out.outline_second = outline(second);
  add_mobilised(shapes, last, differences.total(), options, sigma, unit, out.metrics);
  if (out.outline_first.empty() || out.outline_second.empty()) {
    out.remarks.push_back("The particles of one side lie too far apart at the end to have an outline.");
    return;
  }
  const std::string cells = ", at the last common time, on cells of " + number(lattice.cell) + " " + unit;
  std::array<double, 2> known_to;
  for (std::size_t s = 0; s < 2; ++s) known_to[s] = std::hypot(spacing[s] / std::sqrt(12.0), sigma[s]);
  add_overlap(first, second, known_to, cells, out);
  const double place = std::hypot(known_to[0], known_to[1]);
  out.metrics.push_back(difference_metric(
      "outline_hausdorff_95", hausdorff_95(out.outline_first, out.outline_second, lattice.cell), unit, place,
      "Hausdorff distance of the outlines, 95 %: of points a cell apart on each, the 95th percentile of the distance "
      "to "
      "the other, the greater of both ways" +
          cells +
          "; uncertainty: half a particle spacing of each side (rectangular) and the errors of u, where known"));
  if (!options.slope_base_m) return;
  const Lattice before = lattice_around(*start[0], *start[1], cell, grow, options.slope_base_m);
  const std::array<Covers, 2> covers{Covers{cover(*start[0], spacing[0] / 2, before), first},
                                     Covers{cover(*start[1], spacing[1] / 2, before), second}};
  add_slope(covers, spacing, sigma, *options.slope_base_m, unit, out);
}

}  // namespace pivnp::compare
