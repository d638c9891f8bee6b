#include "compare/shapes/slope_angles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "compare/data/statistics.hpp"

namespace pivnp::compare {

namespace {

double degrees(double tangent) { return std::atan(tangent) * 180 / std::numbers::pi; }

// Trapezoid with a vertical side of height h, base b and crest a: area A = h (a + b)/2, centroid yc = h (b + 2a)/(3 (a + b)),
// xc = (a^2 + ab + b^2)/(3 (a + b)). With q = 3 yc/h: a/(a + b) = q - 1, and 9 xc yc/(2 A) = 1 + (q - 1)^3.
double trapezoid_angle(double area, double xc, double yc) {
  const double q = 1 + std::cbrt(9 * xc * yc / (2 * area) - 1);
  const double h = 3 * yc / q, sum = 2 * area / h;
  return degrees(h / (sum * (3 - 2 * q)));
}

}  // namespace

SlopeAngles slope_angles(const ParticleSet& set, const MotionFrame& frame, double wall_x, double base_y, double column,
                         double spread) {
  SlopeAngles out{not_known, not_known, not_known, not_known, not_known};
  double area = 0, sx = 0, sy = 0;
  std::vector<double> height;
  for (std::size_t k = 0; k < set.size(); ++k) {
    if (frame.status[k] == ParticleStatus::ended) continue;
    const double x = set.x0[k].x() + double(frame.u[k][0]) - wall_x;
    const double y = set.x0[k].y() + double(frame.u[k][1]) - base_y, a = double(set.area[k]);
    area += a;
    sx += a * x;
    sy += a * y;
    const double from = std::max(0.0, (x - 0.5 * spread) / column), to = std::max(from, (x + 0.5 * spread) / column);
    if (height.size() <= std::size_t(to)) height.resize(std::size_t(to) + 1, 0.0);
    for (auto c = std::size_t(from); c <= std::size_t(to); ++c) {
      const double share = std::min(to, double(c + 1)) - std::max(from, double(c));
      height[c] += to > from ? a / column * share / (to - from) : a / column;
    }
  }
  if (!(area > 0)) return out;
  out.cen = trapezoid_angle(area, sx / area, sy / area);

  const Profile profile{wall_x + 0.5 * column, column, height};
  out.height = *std::max_element(height.begin(), height.end());
  SlopeShape shape;
  fit_slope(profile, out.height, spread, shape);
  out.fit = shape.angle_deg;

  double sum = 0;
  std::size_t toe = 0, crest = 0;
  while (toe + 1 < height.size() && (sum + height[toe]) * column < run_out_share * area) sum += height[toe++];
  const double into = height[toe] > 0 ? (run_out_share * area / column - sum) / height[toe] : 0;
  out.toe_x = wall_x + (double(toe) + std::clamp(into, 0.0, 1.0)) * column;
  for (std::size_t c = 0; c < height.size(); ++c)
    if (height[c] >= 0.9 * out.height) crest = c;
  const double run = out.toe_x - profile.x(crest);
  if (run > 0) out.tc = degrees((height[crest] - height[toe]) / run);
  return out;
}

}  // namespace pivnp::compare
