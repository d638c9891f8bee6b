// What figures draw is what was compared: the second minus the first, as drawn, is the comparison's own difference.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "compare/alignment/as_compared.hpp"
#include "pivnp/core/particles/strain.hpp"
#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

std::shared_ptr<const MotionSource> held(MotionMemory motion) { return std::make_shared<MotionMemory>(std::move(motion)); }

// A camera that drifts and turns over the first; a second that is slower and on another clock.
struct Pair {
  std::shared_ptr<const MotionSource> first, second;
};
Pair two_motions() {
  const ParticleSet set = particles_at(square_lattice(10, 8, 1), 1);
  const DisplacementLaw drift = [](const Vec2& x, double t) -> Vec2 {
    return shear(x, 0.1 * t) + t * Vec2(0.3 - 0.01 * x.y(), 0.2 + 0.01 * x.x());
  };
  const GradientLaw turned = [](const Vec2& x, double t) -> Mat2 {
    Mat2 F = shear_F(x, 0.1 * t);
    F(0, 1) -= 0.01 * t, F(1, 0) += 0.01 * t;
    return F;
  };
  const DisplacementLaw slow = [](const Vec2& x, double t) -> Vec2 { return shear(x, 0.08 * std::max(0.0, t)); };
  return {held(motion_of("np", set, {0, 1, 2, 3, 4}, drift, turned)),
          held(motion_of("mpm", set, {0, 0.7, 1.5, 2.25, 3, 3.75, 5}, slow,
                         [](const Vec2& x, double t) { return shear_F(x, 0.08 * t); }))};
}

void expect_what_was_compared(const Pair& pair, const CompareOptions& options, double tolerance) {
  const Comparison c = compared(*pair.first, *pair.second, options);
  const ComparedMotions seen = as_compared(pair.first, pair.second, options);
  const ComparisonField &x = *c.field("difference_x"), &y = *c.field("difference_y"), &dev = *c.field("difference_strain_dev");
  ASSERT_FALSE(x.time.empty());
  ASSERT_EQ(x.id.size(), seen.first->particles().size());
  for (std::size_t k = 0; k < x.time.size(); ++k) {
    ASSERT_NEAR(seen.first->times().at(k), x.time[k], 1e-9);
    ASSERT_NEAR(seen.second->times().at(k), x.time[k], 1e-9);
    const MotionFrame a = seen.first->frame(k), b = seen.second->frame(k);
    for (std::size_t p = 0; p < x.id.size(); ++p) {
      const std::size_t v = k * x.id.size() + p;
      EXPECT_NEAR(double(b.u[p][0]) - double(a.u[p][0]), double(x.values[v]), tolerance);
      EXPECT_NEAR(double(b.u[p][1]) - double(a.u[p][1]), double(y.values[v]), tolerance);
      EXPECT_NEAR(deviatoric(log_strain(matrix(b.F[p]))) - deviatoric(log_strain(matrix(a.F[p]))),
                  double(dev.values[v]), tolerance);
    }
  }
}

TEST(AsCompared, DrawsTheDifferenceOfEachAlignment) {
  const Pair pair = two_motions();
  const Points zone{{-1, -1}, {4, -1}, {4, 4}, {-1, 4}};
  struct Alignment {
    std::function<void(CompareOptions&)> set;
    bool same_places = true;  // else the second is read between its particles, and these are not quite where it is read
  };
  const Alignment alignments[] = {
      {[](CompareOptions&) {}},  // other times alone
      {[&](CompareOptions& o) { o.reference_m = zone; }},
      {[&](CompareOptions& o) { o.fixed_zone_m = zone; }},
      {[](CompareOptions& o) { o.time_offset_s = -0.4; }, false},  // under way at the common start
      {[](CompareOptions& o) { o.time_offset_s = 0.6; }, false},
      {[&](CompareOptions& o) { o.fixed_zone_m = zone, o.time_offset_s = 0.25, o.second_time_scale = 1.1; }, false}};
  for (std::size_t k = 0; k < std::size(alignments); ++k) {
    SCOPED_TRACE(k);
    CompareOptions options;
    alignments[k].set(options);
    expect_what_was_compared(pair, options, alignments[k].same_places ? 2e-6 : 0.02);
  }
}

TEST(AsCompared, WhatIsTakenAsItIsComesBackItself) {
  const Pair pair = two_motions();
  const ComparedMotions same = as_compared(pair.first, pair.first, {});
  EXPECT_EQ(same.first, pair.first);
  EXPECT_EQ(same.second, pair.first);
  const ComparedMotions other = as_compared(pair.first, pair.second, {});
  EXPECT_EQ(other.first, pair.first);
  EXPECT_EQ(other.second->times(), (std::vector<double>{0, 1, 2, 3, 4, 5}));  // 5: beyond the first's end, its own
}

}  // namespace
}  // namespace pivnp::compare
