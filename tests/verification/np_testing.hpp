// What the tests of numerical particles share: particles to start from, and tracking through an analytic motion.
#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "pivnp/core/particles/seeding.hpp"
#include "pivnp/np/analytic.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::np::testing {

/// The elements of the thesis, which can be computed by hand.
inline NpOptions bilinear() {
  NpOptions options;
  options.shape = ShapeFunctions::bilinear;
  return options;
}

/// Particles at given places, ids in order.
inline ParticleSet particles_at(std::vector<Vec2> x0, double born = 0) {
  ParticleSet set;
  for (std::size_t p = 0; p < x0.size(); ++p) set.id.push_back(std::int64_t(p));
  set.label.assign(x0.size(), 0);
  set.area.assign(x0.size(), 1.0f);
  set.born.assign(x0.size(), born);
  set.end.assign(x0.size(), std::numeric_limits<double>::quiet_NaN());
  set.end_reason.assign(x0.size(), EndReason::none);
  set.label_names = {"all"};
  set.x0 = std::move(x0);
  return set;
}

/// A rectangular block seeded on the grid.
inline ParticleSet block(const Grid& grid, const Vec2& lower, const Vec2& upper, int per_element,
                         SeedPattern pattern = SeedPattern::even) {
  const Polygon outline({lower, {upper.x(), lower.y()}, upper, {lower.x(), upper.y()}}, "block");
  return seed(grid, {{"block", outline}}, per_element, pattern, 0, "per_element");
}

/// Steps from time `t0` to `t1`, sampled from `motion` with the anchor's own vectors.
inline void track(Tracker& tracker, const AnalyticMotion& motion, const Grid& grid, Anchor anchor, double t0, double t1,
                  int steps) {
  for (int k = 0; k < steps; ++k) {
    const double from = t0 + (t1 - t0) * k / steps, to = t0 + (t1 - t0) * (k + 1) / steps;
    tracker.step(sample_increments(motion, grid, anchor, from, to), to);
  }
}

inline double J(const Mat2& F) { return F(0, 0) * F(1, 1) - F(0, 1) * F(1, 0); }

}  // namespace pivnp::np::testing
