// Motions written down by formula, for the tests.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "compare/compare.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::compare {

inline ParticleSet particles_at(const std::vector<Vec2>& x0, double spacing) {
  ParticleSet set;
  for (std::size_t p = 0; p < x0.size(); ++p) {
    set.id.push_back(std::int64_t(p));
    set.label.push_back(0);
    set.x0.push_back(x0[p]);
    set.area.push_back(float(spacing * spacing));
    set.born.push_back(0);
    set.end.push_back(std::numeric_limits<double>::quiet_NaN());
    set.end_reason.push_back(EndReason::none);
  }
  set.label_names = {"soil"};
  return set;
}

/// Centres of nx by ny squares of side `spacing`, the lower left one's corner at `corner`.
inline std::vector<Vec2> square_lattice(int nx, int ny, double spacing, const Vec2& corner = Vec2::Zero()) {
  std::vector<Vec2> x;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) x.push_back(corner + spacing * Vec2(i + 0.5, j + 0.5));
  return x;
}

using DisplacementLaw = std::function<Vec2(const Vec2& x0, double t)>;
using GradientLaw = std::function<Mat2(const Vec2& x0, double t)>;

/// A block of 6 by 5 particles that is sheared by 0.4 a unit of time while it moves, with its gradient.
inline const DisplacementLaw shear = [](const Vec2& x, double t) -> Vec2 {
  return t * Vec2(0.4 * x.y() + 0.1, -0.2);
};
inline const GradientLaw shear_F = [](const Vec2&, double t) -> Mat2 {
  Mat2 F = Mat2::Identity();
  F(0, 1) = 0.4 * t;
  return F;
};
inline ParticleSet block() { return particles_at(square_lattice(6, 5, 1), 1); }

inline const GradientLaw rigid = [](const Vec2&, double) { return Mat2(Mat2::Identity()); };

inline MotionFrame frame_of(const ParticleSet& set, double t, const DisplacementLaw& u, const GradientLaw& F) {
  MotionFrame frame;
  frame.time = t;
  for (const Vec2& x : set.x0) {
    const Vec2 d = u(x, t);
    const Mat2 f = F(x, t);
    frame.u.push_back({float(d.x()), float(d.y())});
    frame.F.push_back({float(f(0, 0)), float(f(0, 1)), float(f(1, 0)), float(f(1, 1))});
    frame.status.push_back(ParticleStatus::active);
  }
  return frame;
}

inline MotionMemory motion_of(const std::string& name, const ParticleSet& set, const std::vector<double>& times,
                              const DisplacementLaw& u, const GradientLaw& F = rigid) {
  MotionMemory motion(name, "m", "s", set);
  for (double t : times) motion.add(frame_of(set, t, u, F));
  return motion;
}

/// The metric of that name; a default one with a NaN value if there is none.
inline Metric metric(const Comparison& comparison, const std::string& name) {
  for (const Metric& m : comparison.metrics)
    if (m.name == name) return m;
  Metric none;
  none.value = none.uncertainty = std::numeric_limits<double>::quiet_NaN();
  return none;
}

inline bool has_metric(const Comparison& comparison, const std::string& name) {
  return std::any_of(comparison.metrics.begin(), comparison.metrics.end(),
                     [&](const Metric& m) { return m.name == name; });
}

inline const std::vector<double>& series(const Comparison& comparison, const std::string& name) {
  static const std::vector<double> none;
  const ComparisonTable* table = comparison.table(over_space_table);
  const ComparisonTable::Column* column = table == nullptr ? nullptr : find(*table, name);
  return column == nullptr ? none : column->values;
}

inline Comparison compared(const MotionSource& first, const MotionSource& second, const CompareOptions& options = {},
                           const LimitOptions& limits = {}) {
  SilentProgress progress;
  return compare(first, second, options, limits, progress);
}

}  // namespace pivnp::compare
