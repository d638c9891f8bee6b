#include "pivnp/core/particles/seeding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pivnp/core/error.hpp"

namespace pivnp {

namespace {

// Points of one axis in (0, 1).
std::vector<double> axis_points(int k, SeedPattern pattern) {
  std::vector<double> points(k);
  for (int a = 0; a < k; ++a) {
    if (pattern == SeedPattern::even) {
      points[a] = (a + 0.5) / k;
      continue;
    }
    // Root a of the Legendre polynomial P_k by Newton's method from the Chebyshev guess.
    double x = std::cos(std::numbers::pi * (a + 0.75) / (k + 0.5));
    for (int it = 0; it < 50; ++it) {
      double p0 = 1, p1 = x;
      for (int n = 2; n <= k; ++n) {
        const double p2 = ((2 * n - 1) * x * p1 - (n - 1) * p0) / n;
        p0 = p1;
        p1 = p2;
      }
      const double slope = k * (x * p1 - p0) / (x * x - 1);
      const double step = k == 1 ? x : p1 / slope;
      x -= step;
      if (std::abs(step) < 1e-15) break;
    }
    points[k - 1 - a] = (1 + x) / 2;
  }
  return points;
}

}  // namespace

ParticleSet seed(const Grid& grid, const std::vector<Region>& regions, int per_element, SeedPattern pattern,
                 double birth_time, const std::string& what) {
  const int k = static_cast<int>(std::lround(std::sqrt(double(per_element))));
  if (per_element < 1 || k * k != per_element)
    throw InputError(what + ": found " + std::to_string(per_element) + ", expected a square (1, 4, 9, 16 ...)");
  const std::vector<double> points = axis_points(k, pattern);

  ParticleSet set;
  std::vector<std::size_t> seeded(regions.size(), 0);
  for (const Region& r : regions) set.label_names.push_back(r.name);
  const double area = grid.spacing.x() * grid.spacing.y() / per_element;
  for (int j = 0; j + 1 < grid.ny; ++j)
    for (int i = 0; i + 1 < grid.nx; ++i)
      for (int b = 0; b < k; ++b)
        for (int a = 0; a < k; ++a) {
          const Vec2 x = grid.position(i, j) + grid.spacing.cwiseProduct(Vec2(points[a], points[b]));
          const auto home = std::find_if(regions.begin(), regions.end(),
                                         [&](const Region& r) { return r.polygon.contains(x); });
          if (home == regions.end()) continue;
          const auto label = home - regions.begin();
          ++seeded[std::size_t(label)];
          set.id.push_back(std::int64_t(grid.element(i, j)) * per_element + b * k + a);
          set.label.push_back(std::int32_t(label));
          set.x0.push_back(x);
          set.area.push_back(area);
        }
  for (std::size_t r = 0; r < regions.size(); ++r)
    if (seeded[r] == 0)
      throw InputError("region." + regions[r].name + ": no particle lies inside it: it occupies no element of the grid");
  set.born.assign(set.size(), birth_time);
  set.end.assign(set.size(), std::numeric_limits<double>::quiet_NaN());
  set.end_reason.assign(set.size(), EndReason::none);
  return set;
}

}  // namespace pivnp
