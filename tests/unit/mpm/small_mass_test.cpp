// Nodes with hardly any mass: whose motion they follow.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "mpm/step/momentum.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

TEST(SmallMassNodes, MoveWithTheirHeaviestNeighbourAndKeepTheMomentum) {
  GridState g(Grid{{0, 0}, {1, 1}, 4, 4}, ShapeKind::bilinear);
  g.active.nodes = {0, 1, 4, 5};
  const auto set = [&](std::uint32_t n, double mass, double v, double f) {
    g.node[n].mass = mass;
    g.node[n].vx = v;
    g.node[n].fx = f;
  };
  set(0, 2, 1, 0.5);
  set(1, 1e-9, 3, -40);
  set(4, 1, 2, 1);
  set(5, 0, 0, 7);
  SmallMassNodes small;
  small.find(g, {1e-5, false});
  ASSERT_EQ(small.pairs.size(), 2u);
  update_momentum(g, {0, 0}, 0, 0.1, 1);
  small.join_momentum(g, 0, 0.1);
  EXPECT_EQ(g.node[1].nx, g.node[0].nx);
  EXPECT_EQ(g.node[5].nx, g.node[0].nx);
  double before = 0, after = 0;
  for (const std::uint32_t n : g.active.nodes) {
    before += g.node[n].mass * g.node[n].vx + 0.1 * g.node[n].fx;
    after += g.node[n].mass * g.node[n].nx;
  }
  EXPECT_NEAR(after, before, 1e-14);
  EXPECT_EQ(g.node[0].mass, 2);
}

// At loaded faces they go on as the two nodes next to them do: linear fields stay exact, momentum and its moment are
// kept, in whatever way small nodes share those that they follow.
TEST(SmallMassNodes, GoOnLinearlyAtLoadedFaces) {
  GridState g(Grid{{0, 0}, {1, 1}, 4, 4}, ShapeKind::bilinear);
  g.active.nodes = {0, 1, 2, 4, 5, 6, 9};  // 0 and 4 follow what lies to their right, 9 what lies below
  const std::vector<double> mass = {9e-3, 0.02, 0.015, 2e-3, 0.02, 0.015, 5e-3}, force = {-4, 1, 0.5, 3, -2, 1, 5};
  const auto step = [&](double forces) {
    for (std::size_t k = 0; k < mass.size(); ++k) {
      const std::uint32_t n = g.active.nodes[k];
      Node& node = g.node[n] = {};
      node.mass = mass[k];
      node.vx = 1 + 0.5 * (n % 4) - 2.0 * (n / 4);
      node.vy = 2 - 0.25 * (n % 4) + 3.0 * (n / 4);
      node.fx = forces * force[k];
      node.fy = -0.5 * forces * force[k];
    }
    SmallMassNodes small;
    small.find(g, {1e-2, true});
    EXPECT_EQ(small.pairs.size(), 3u);
    update_momentum(g, {0, 0}, 0, 0.1, 1);
    const auto sums = [&](bool moved) {
      Vec2 p(0, 0);
      double moment = 0;
      for (const std::uint32_t n : g.active.nodes) {
        const Node& node = g.node[n];
        const Vec2 of = moved ? Vec2(node.mass * Vec2(node.nx, node.ny))
                              : Vec2(node.mass * Vec2(node.vx, node.vy) + 0.1 * Vec2(node.fx, node.fy));
        p += of;
        moment += (n % 4) * of.y() - double(n / 4) * of.x();
      }
      return std::pair(p, moment);
    };
    const auto given = sums(false);
    small.join_momentum(g, 0, 0.1);
    const auto kept = sums(true);
    EXPECT_NEAR((kept.first - given.first).norm(), 0, 1e-12);
    EXPECT_NEAR(kept.second, given.second, 1e-12);
    for (const SmallMassNodes::Pair& p : small.pairs)
      EXPECT_NEAR(g.node[p.small].nx, 2 * g.node[p.heavy].nx - g.node[p.beyond].nx, 1e-15);
    for (std::size_t k = 0; k < mass.size(); ++k) EXPECT_EQ(g.node[g.active.nodes[k]].mass, mass[k]);
  };
  step(1);
  step(0);
  for (const std::uint32_t n : g.active.nodes) {
    EXPECT_NEAR(g.node[n].nx, g.node[n].vx, 1e-12);
    EXPECT_NEAR(g.node[n].ny, g.node[n].vy, 1e-12);
  }
}

}  // namespace
}  // namespace pivnp::mpm
