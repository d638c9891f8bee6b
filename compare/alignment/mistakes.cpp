#include "compare/alignment/mistakes.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "compare/shapes/outline.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

struct Body {
  double area = 0;
  Vec2 centre = Vec2::Zero();
  double direction = 0;  // of the greater principal axis, radians
};

Body body_of(const Cover& cover) {
  Body body;
  const Lattice& l = cover.lattice;
  Mat2 second = Mat2::Zero();
  const auto each = [&](const auto& visit) {
    for (int j = 0; j < l.ny; ++j)
      for (int i = 0; i < l.nx; ++i)
        if (const double share = cover.share(l.index(i, j)); share > 0) visit(share * l.cell * l.cell, l.centre(i, j));
  };
  each([&](double a, const Vec2& x) { body.area += a, body.centre += a * x; });
  if (!(body.area > 0)) return body;
  body.centre /= body.area;
  each([&](double a, const Vec2& x) { second += a * (x - body.centre) * (x - body.centre).transpose(); });
  body.direction = 0.5 * std::atan2(2 * second(0, 1), second(0, 0) - second(1, 1));
  return body;
}

// x = A x + b of the second, and what that means.
struct Change {
  Mat2 A = Mat2::Identity();
  Vec2 b = Vec2::Zero();
  std::string words;
};

MaterialMesh changed(const MaterialMesh& mesh, const Change& change, double spacing) {
  std::vector<Vec2> x;
  for (const Vec2& p : mesh.points()) x.push_back(change.A * p + change.b);
  return MaterialMesh(std::move(x), std::vector<double>(mesh.points().size(), spacing * std::sqrt(std::abs(change.A.determinant()))));
}

// Mean distance of the outlines.
double gap(const MaterialMesh& first, double spacing_first, const MaterialMesh& second, double spacing_second) {
  const double most = std::max(spacing_first, spacing_second);
  const Lattice lattice = lattice_around(first, second, most / 2, most / 2, {});
  const Cover a = cover(first, spacing_first / 2, lattice), b = cover(second, spacing_second / 2, lattice);
  const Overlap both = overlap(a, b);
  return (both.either - both.common) / length_of(outline(a));
}

Body body_alone(const MaterialMesh& mesh, double spacing) {
  return body_of(cover(mesh, spacing / 2, lattice_around(mesh, mesh, spacing / 2, spacing / 2, {})));
}

std::string vector_words(const Vec2& x) { return "(" + number(x.x(), 3) + ", " + number(x.y(), 3) + ")"; }

// The simplest first.
std::vector<Change> changes_between(const Body& one, const Body& two, double scale, const std::string& unit) {
  std::vector<Change> list;
  const auto add = [&](const Mat2& A, const Vec2& b, const std::string& words) { list.push_back({A, b, words}); };
  const auto about = [&](const Mat2& A) { return Vec2(one.centre - A * two.centre); };
  const Mat2 same = Mat2::Identity(), exchanged = (Mat2() << 0, 1, 1, 0).finished(), down = (Mat2() << 1, 0, 0, -1).finished();
  const Vec2 shift = one.centre - two.centre;
  add(same, shift, "moved by " + vector_words(shift) + " " + unit + ": have both the same origin (compare.second_shift_m)?");
  for (const Vec2& b : {Vec2(0, 0), about(exchanged)})
    add(exchanged, b, "given its axes in exchange: are its x and y in this order?");
  add(down, about(down), "turned upside down: does its y point upwards?");
  add(-down, about(-down), "mirrored from left to right: does its x point to the right?");
  const double turn = std::remainder(one.direction - two.direction, std::numbers::pi);
  // (With a shift as well, a part of a slope would pass for a smaller one.)
  add(scale * same, Vec2::Zero(), (scale > 2 || scale < 0.5 ? "made " + number(scale, 3) + " times as large: have both the same unit of length"
                                   : number(100 * std::abs(scale - 1), 2) + " % " + (scale > 1 ? "larger" : "smaller") + " in both directions: is the scale right") +
                             " (compare.second_scale)?");
  const Mat2 R = (Mat2() << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn)).finished();
  add(R, about(R), "turned by " + number(turn * 180 / std::numbers::pi, 2) + " degrees: is the camera level, and gravity vertical (compare.second_rotation_deg)?");
  return list;
}

}  // namespace

std::string likely_mistake(const MaterialMesh& first, double spacing_first, const MaterialMesh& second, double spacing_second,
                           const std::string& unit) {
  constexpr double apart = 0.75, together = 0.6;  // spacings
  if (first.triangles().empty() || second.triangles().empty() || !(std::min(spacing_first, spacing_second) > 0)) return "";
  const Body one = body_alone(first, spacing_first), two = body_alone(second, spacing_second);
  if (!(one.area > 0) || !(two.area > 0)) return "";
  const double ratio = std::sqrt(one.area / two.area);
  const double spacing = std::max(spacing_first, spacing_second * ratio);
  // Outlines far from each other, or of quite different size, need no lattice around both.
  const auto far = [&](const Change& change) {
    const double area = two.area * std::abs(change.A.determinant());
    return (change.A * two.centre + change.b - one.centre).norm() > 4 * std::sqrt(one.area) || std::abs(std::log(area / one.area)) > 2;
  };
  const double as_is = far({}) ? INFINITY : gap(first, spacing_first, second, spacing_second);
  if (!(as_is > apart * spacing)) return "";
  const auto gap_after = [&](const Change& change) {
    return far(change) ? INFINITY : gap(first, spacing_first, changed(second, change, spacing_second), spacing_second * std::sqrt(std::abs(change.A.determinant())));
  };
  // The areas give the scale but for a spacing at each edge.
  double scale = 1, least = INFINITY;
  for (const double k : {0.0, 0.5, -0.5, 1.0, -1.0, 1.5, -1.5, 2.0, -2.0}) {
    const double s = ratio * (1 + k * spacing / std::sqrt(one.area));
    if (const double g = gap_after({s * Mat2::Identity(), Vec2::Zero(), ""}); g < least || k == 0) least = g, scale = s;
  }
  const std::vector<Change> changes = changes_between(one, two, scale, unit);
  std::vector<double> left;
  for (const Change& change : changes) left.push_back(gap_after(change));
  const double best = *std::min_element(left.begin(), left.end());
  if (!(best < together * spacing) || !(best < together * as_is)) return "";
  for (std::size_t k = 0; k < changes.size(); ++k)
    if (left[k] <= 1.25 * best + 0.2 * spacing && left[k] < together * std::min(spacing, as_is))
      return "Before anything moves the outlines lie " +
             (std::isfinite(as_is) ? number(as_is, 2) + " " + unit + " apart on average" : std::string("far apart")) + "; they agree to " + number(left[k], 2) + " " + unit +
             " once the second is " + changes[k].words;
  return "";
}

}  // namespace pivnp::compare
