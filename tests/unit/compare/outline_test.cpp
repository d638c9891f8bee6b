// Outlines as closed rings around simple bodies; overlap of two.
#include "compare/shapes/outline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

MaterialMesh mesh_of(const std::vector<Vec2>& points, double spacing) {
  return MaterialMesh(points, std::vector<double>(points.size(), spacing));
}

double signed_area(const std::vector<Vec2>& ring) {
  double twice = 0;
  for (std::size_t k = 0; k + 1 < ring.size(); ++k)
    twice += ring[k].x() * ring[k + 1].y() - ring[k].y() * ring[k + 1].x();
  return twice / 2;
}

Cover cover_of(const MaterialMesh& mesh, double spacing) {
  return cover(mesh, spacing / 2, lattice_around(mesh, mesh, spacing / 4, spacing / 2, std::nullopt));
}

TEST(Outline, OfASquare) {
  const double h = 0.1;
  const MaterialMesh mesh = mesh_of(square_lattice(20, 10, h, Vec2(1, 2)), h);
  const auto rings = outline(cover_of(mesh, h));
  ASSERT_EQ(rings.size(), 1U);
  EXPECT_EQ(rings[0].front(), rings[0].back());
  Vec2 lower = rings[0][0], upper = lower;
  for (const Vec2& x : rings[0]) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  EXPECT_NEAR((lower - Vec2(1, 2)).norm(), 0, 1e-6);
  EXPECT_NEAR((upper - Vec2(3, 3)).norm(), 0, 1e-6);
  // Corners are rounded by half a spacing: each lacks (1 - pi/4) (h/2)^2, and a little more by the chords of the ring.
  EXPECT_NEAR(signed_area(rings[0]), 2 - 4 * (1 - M_PI / 4) * h * h / 4, 6e-4);
}

TEST(Outline, HolesRunTheOtherWayAndTwoBodiesAreTwoRings) {
  std::vector<Vec2> points;
  for (const Vec2& x : square_lattice(40, 20, 1)) {
    const bool hole = (x - Vec2(10, 10)).norm() < 4;
    const bool gap = x.x() > 22 && x.x() < 28;
    if (!hole && !gap) points.push_back(x);
  }
  auto rings = outline(cover_of(mesh_of(points, 1), 1));
  ASSERT_EQ(rings.size(), 3U);
  std::sort(rings.begin(), rings.end(), [](const auto& a, const auto& b) { return signed_area(a) < signed_area(b); });
  EXPECT_NEAR(signed_area(rings[0]), -M_PI * 16, 0.15 * M_PI * 16);
  EXPECT_NEAR(signed_area(rings[1]), 12 * 20, 1);
  EXPECT_NEAR(signed_area(rings[2]), 22 * 20, 1);
}

TEST(Outline, LoneParticlesCoverNothing) {
  std::vector<Vec2> points = square_lattice(5, 5, 1);
  points.emplace_back(20, 20);
  EXPECT_EQ(outline(cover_of(mesh_of(points, 1), 1)).size(), 1U);
}

TEST(Outline, ManyCellsAreMadeFewer) {
  std::vector<Vec2> points = square_lattice(5, 5, 1e-3);
  for (const Vec2& x : square_lattice(5, 5, 1e-3, Vec2(100, 100))) points.push_back(x);
  const MaterialMesh mesh = mesh_of(points, 1e-3);
  const Lattice lattice = lattice_around(mesh, mesh, 2.5e-4, 5e-4, std::nullopt);
  EXPECT_LE(double(lattice.nx) * lattice.ny, double(1 << 22));
}

TEST(Outline, IntersectionOverUnionOfShiftedSquares) {
  const double h = 0.1;
  const MaterialMesh a = mesh_of(square_lattice(20, 20, h), h);
  const MaterialMesh b = mesh_of(square_lattice(20, 20, h, Vec2(0.53, 0)), h);
  const Lattice lattice = lattice_around(a, b, h / 4, h / 2, std::nullopt);
  const Cover first = cover(a, h / 2, lattice), second = cover(b, h / 2, lattice);
  const Overlap area = overlap(first, second);
  EXPECT_NEAR(area.common / area.either, (2 - 0.53) / (2 + 0.53), 2e-3);
  EXPECT_EQ(overlap(first, first).common, overlap(first, first).either);
}

// Two motions that are the same: where one of them loses particles, its outline at the end is another, which is no difference of the
// motions. What is lost inside leaves a hole, what is lost at an end a shorter body.
TEST(Outline, WhatLostParticlesMoveIsNoDifference) {
  const ParticleSet set = particles_at(square_lattice(24, 12, 0.05), 0.05);
  const DisplacementLaw law = [](const Vec2& x, double t) -> Vec2 { return {0.04 * t * x.y(), -0.01 * t * x.y()}; };
  const auto seen = [&](const std::function<bool(const Vec2&)>& lost) {
    MotionMemory motion("np", "m", "s", set);
    for (const double t : {0.0, 1.0}) {
      MotionFrame frame = frame_of(set, t, law, rigid);
      frame.cov_u.assign(set.size(), {1e-8f, 1e-8f, 0});
      for (std::size_t p = 0; t > 0 && p < set.size(); ++p)
        if (lost(set.x0[p])) frame.status[p] = ParticleStatus::ended;
      motion.add(frame);
    }
    return motion;
  };
  CompareOptions options;
  options.slope_base_m = 0.0;
  const MotionMemory whole = seen([](const Vec2&) { return false; });
  const Metric before = metric(compared(whole, whole, options), "outline_hausdorff_95");
  EXPECT_EQ(before.value, 0);
  for (const auto& lost : {std::function<bool(const Vec2&)>([](const Vec2& x) { return x.x() > 1.2 - 0.16; }),
                           std::function<bool(const Vec2&)>([](const Vec2& x) { return (x - Vec2(0.6, 0.3)).norm() < 0.2; })}) {
    const MotionMemory part = seen(lost);
    for (const bool first : {true, false}) {
      const Comparison c = first ? compared(part, whole, options) : compared(whole, part, options);
      const Metric distance = metric(c, "outline_hausdorff_95");
      EXPECT_GT(distance.value, 0.05);  // more than ten times what the particles themselves are known by
      for (const char* name : {"outline_hausdorff_95", "run_out_x_difference", "toe_x_difference", "crest_height_difference", "mobilised_area_difference"})
        EXPECT_FALSE(metric(c, name).told_apart()) << name << " " << metric(c, name).value << " +- " << metric(c, name).uncertainty;
    }
  }
  // Nothing is lost: nothing is added.
  EXPECT_NEAR(before.uncertainty, std::sqrt(2.0) * std::hypot(0.05 / std::sqrt(12.0), std::sqrt(2e-8)), 1e-6);
}

}  // namespace
}  // namespace pivnp::compare
