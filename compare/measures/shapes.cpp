#include "compare/measures/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "compare/data/nearest_edge.hpp"
#include "compare/data/statistics.hpp"
#include "compare/shapes/outline.hpp"

namespace pivnp::compare {

namespace {

// Distances from points `step` apart on `rings` to the segments of `to`; at most about 10^8 pairs are looked at.
Quantile distances(const std::vector<std::vector<Vec2>>& rings, const std::vector<std::vector<Vec2>>& to, double step) {
  const std::vector<Vec2> points = points_along(rings, step);
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

struct MobilisedArea {
  double area = 0, uncertainty = not_known;
  Vec2 moment = Vec2::Zero();  // sum of area times displacement
};

MobilisedArea mobilised_area(const DataSet& set, const RigidMotion& frame, double threshold, double sigma) {
  MobilisedArea m;
  double lower = 0, upper = 0, variance = 0;
  for (std::size_t p = 0; p < set.size(); ++p) {
    if (!set.state().followed[p]) continue;
    const Vec2& X = set.material_position()[p];
    const Vec2 u = frame.undo(X + set.state().u[p]) - X;
    const double above = u.norm() - threshold;
    const double area = set.spacing()[p] * set.spacing()[p];
    if (above > 0) {
      m.area += area;
      m.moment += area * u;
    }
    if (!(sigma > 0)) continue;
    if (above > -sigma) lower += area;
    if (above > sigma) upper += area;
    const double share = 0.5 * std::erfc(-above / sigma / std::sqrt(2.0));
    variance += area * area * share * (1 - share);
  }
  if (sigma > 0) m.uncertainty = std::hypot((lower - upper) / 2, std::sqrt(variance));
  return m;
}

std::optional<ShapeMeasures::Mobilised> mobilised(const PerDataSet<const DataSet*>& sets, const Differences& differences,
                                                  const CompareOptions& options, const PerDataSet<double>& sigma) {
  ShapeMeasures::Mobilised m;
  m.threshold = options.mobilised_m.value_or(0.05 * differences.total().peak_first);
  if (!(m.threshold > 0)) return std::nullopt;
  for (std::size_t s = 0; s < 2; ++s) {
    const MobilisedArea found =
        mobilised_area(*sets[s], differences.last().frame[s].motion, m.threshold, sigma[s]);
    m.area[s] = found.area;
    m.uncertainty[s] = found.uncertainty;
    constexpr double degree = std::numbers::pi / 180;
    const Vec2 travel = found.moment / found.area;  // not a number where nothing is mobilised
    const bool moved = travel.norm() > 0;
    m.travel_angle_deg[s] = moved ? std::atan2(-travel.y(), std::abs(travel.x())) / degree : not_known;
    // An error across the path turns it; sigma is that of both components together.
    m.travel_uncertainty_deg[s] =
        moved && sigma[s] > 0 ? sigma[s] / std::sqrt(2.0) / travel.norm() / degree : not_known;
  }
  m.difference_uncertainty = not_known;
  if (sigma[0] > 0 || sigma[1] > 0)
    m.difference_uncertainty = std::hypot(sigma[0] > 0 ? m.uncertainty[0] : 0, sigma[1] > 0 ? m.uncertainty[1] : 0);
  return m;
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

// Of the largest ring: what has broken off is no toe.
double toe(const std::vector<std::vector<Vec2>>& rings, int faces) {
  const std::vector<Vec2>* body = nullptr;
  double greatest = 0;
  for (const std::vector<Vec2>& ring : rings) {
    double area = 0;
    for (std::size_t k = 0; k + 1 < ring.size(); ++k) area += ring[k].x() * ring[k + 1].y() - ring[k].y() * ring[k + 1].x();
    if (area > greatest) greatest = area, body = &ring;
  }
  if (body == nullptr) return not_known;
  double out = body->front().x();
  for (const Vec2& x : *body) out = faces > 0 ? std::max(out, x.x()) : std::min(out, x.x());
  return out;
}

struct Covers {
  Cover start, end;
};

ShapeMeasures::Slope slope(const PerDataSet<Covers>& covers, const PerDataSet<SlopeShape>& shape, double base) {
  ShapeMeasures::Slope out;
  out.shape = shape;
  for (std::size_t s = 0; s < 2; ++s) {
    const Profile start = profile_above(covers[s].start, base), end = profile_above(covers[s].end, base);
    const double height = 0.9 * *std::max_element(start.height.begin(), start.height.end());
    const int faces = shape[s].faces;
    out.crest_retreat[s] = faces * (crest_place(start, height, faces) - crest_place(end, height, faces));
  }
  return out;
}

struct TipErrors {
  double given = 0;  // RMS error that no covariance states: camera, gauge, frame of reference
  double tip = 0;
};

// `sigma`: the RMS error of all particles.
TipErrors tip_errors(const DataSet& set, const RigidMotion& frame, const SlopeShape& shape, double base, double sigma) {
  const DataSetState& state = set.state();
  Vec2 there(0, 0);
  double stated = 0, all = 0, count = 0;
  for (std::size_t p = 0; p < state.cov.size(); ++p) {
    const Vec2 variance(state.cov[p][0], state.cov[p][1]);
    if (!state.followed[p] || !std::isfinite(variance.sum())) continue;
    stated += variance.sum(), ++all;
    const Vec2 x = frame.undo(set.material_position()[p] + state.u[p]);
    if (shape.faces * (x.x() - shape.thin_from) < 0 || x.y() < base) continue;
    there += variance, ++count;
  }
  if (count == 0) return {sigma, 0};
  return {std::sqrt(std::max(0.0, sigma * sigma - stated / all)),
          std::sqrt((there.x() + shape.thinness * shape.thinness * there.y()) / count)};
}

}  // namespace

double hausdorff_95(const std::vector<std::vector<Vec2>>& first, const std::vector<std::vector<Vec2>>& second,
                    double step) {
  if (first.empty() || second.empty()) return not_known;
  return std::max(distances(first, second, step).at(0.95), distances(second, first, step).at(0.95));
}

namespace {

// Material that was not followed to the end is away in the outline at the end, wherever it has gone. How much that is, is measured
// where it is known: at the start.
ShapeMeasures::Lost lost_material(const DataSet& set, const MaterialMesh& start, double cell, double spacing) {
  ShapeMeasures::Lost lost;
  std::vector<Vec2> x;
  std::vector<double> apart;
  for (std::size_t p = 0; p < set.size(); ++p) {
    if (!set.state().followed[p]) continue;
    x.push_back(set.material_position()[p]);
    apart.push_back(set.spacing()[p]);
  }
  if (x.size() >= start.points().size() || x.size() < 3) return {};
  lost.area = double(start.points().size() - x.size()) * spacing * spacing;
  const MaterialMesh left(std::move(x), std::move(apart));
  const Lattice lattice = lattice_around(start, left, cell, spacing / 2, std::nullopt);
  const auto whole = outline(cover(start, spacing / 2, lattice)), rest = outline(cover(left, spacing / 2, lattice));
  if (whole.empty() || rest.empty()) return lost;
  const Quantile out = distances(whole, rest, lattice.cell), back = distances(rest, whole, lattice.cell);
  lost.usual = std::max(out.at(0.95), back.at(0.95));
  lost.greatest = std::max(out.at(1), back.at(1));
  return lost;
}

}  // namespace

ShapeMeasures measure_shapes(const ShapeSources& sources, const Differences& differences,
                             const CompareOptions& options) {
  ShapeMeasures out;
  const Tally& last = differences.last();
  const PerDataSet<const DataSet*> sets{&sources.first, &sources.second};
  const PerDataSet<const MaterialMesh*> start{&sources.start_first, &sources.start_second};
  const PerDataSet<MaterialMesh> end{present_mesh(sources.first, last.frame[0].motion),
                                     present_mesh(sources.second, last.frame[1].motion)};
  const PerDataSet<double> spacing{sets[0]->median_spacing(), sets[1]->median_spacing()}, sigma = last.known_sigma();
  const double cell = std::min(spacing[0], spacing[1]) / 4, grow = std::max(spacing[0], spacing[1]) / 2;
  const Lattice lattice = lattice_around(end[0], end[1], cell, grow, options.slope_base_m);
  const Cover first = cover(end[0], spacing[0] / 2, lattice), second = cover(end[1], spacing[1] / 2, lattice);
  out.outlines = {outline(first), outline(second)};
  out.mobilised = mobilised(sets, differences, options, sigma);
  for (std::size_t s = 0; s < 2; ++s) {
    out.lost[s] = lost_material(*sets[s], *start[s], cell, spacing[s]);
    out.place_uncertainty[s] = std::hypot(spacing[s] / std::sqrt(12.0), sigma[s], out.lost[s].usual);
    if (!out.mobilised || out.lost[s].area == 0) continue;
    double& u = out.mobilised->uncertainty[s];  // between none and all of what is lost is mobilised: rectangular, about none
    const double more = out.lost[s].area / std::sqrt(3.0);
    u = std::isfinite(u) ? std::hypot(u, more) : more;
    double& of_difference = out.mobilised->difference_uncertainty;
    if (std::isfinite(of_difference)) of_difference = std::hypot(of_difference, more);
  }
  if (out.outlines[0].empty() || out.outlines[1].empty()) return out;

  // An outline of length L that moves outwards by u everywhere changes either area by at most L u: so much is the share
  // in common uncertain by, to first order, if an outline's errors are one and the same all along it.
  const Overlap area = overlap(first, second);
  const PerDataSet<double>& known_to = out.place_uncertainty;
  ShapeMeasures::Outlines& between = out.between.emplace();
  between.cell = lattice.cell;
  between.iou_uncertainty =
      std::hypot(length_of(out.outlines[0]) * known_to[0], length_of(out.outlines[1]) * known_to[1]) / area.either;
  between.iou = area.common / area.either;
  between.hausdorff_95 = hausdorff_95(out.outlines[0], out.outlines[1], lattice.cell);
  between.hausdorff_uncertainty = std::hypot(known_to[0], known_to[1]);
  if (!options.slope_base_m) return out;

  const double base = *options.slope_base_m;
  const PerDataSet<SlopeShape> shape{slope_shape(first, base, spacing[0]), slope_shape(second, base, spacing[1])};
  out.nothing_above_base = shape[0].faces == 0 || shape[1].faces == 0;
  if (out.nothing_above_base) return out;
  const Lattice before = lattice_around(*start[0], *start[1], cell, grow, base);
  out.slope = slope({Covers{cover(*start[0], spacing[0] / 2, before), first},
                     Covers{cover(*start[1], spacing[1] / 2, before), second}},
                    shape, base);
  for (std::size_t s = 0; s < 2; ++s) {
    out.slope->toe_x[s] = toe(out.outlines[s], shape[s].faces);
    const TipErrors known = tip_errors(*sets[s], last.frame[s].motion, shape[s], base, sigma[s]);
    out.slope->drawn_uncertainty[s] = std::hypot(spacing[s] / std::sqrt(12.0), known.given, out.lost[s].greatest);
    out.slope->tip_uncertainty[s] = known.tip;
  }
  return out;
}

}  // namespace pivnp::compare
