// The lists of cells against what a plain look finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "mpm/grid/sweeps.hpp"
#include "tests/unit/mpm/disorder.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

// Rows with gaps, and rows that begin elsewhere.
TEST(Cells, AreFoundByTheirNumber) {
  const Scene s = scene(Grid{{0, 0}, {0.1, 0.1}, 12, 7},
                        {rectangle("a", 0, 0, 0.3, 0.4), rectangle("b", 0.6, 0.1, 0.8, 0.5), rectangle("c", 0.9, 0.2, 1.1, 0.3)},
                        {elastic(1e5, 0.3, 1000), elastic(1e5, 0.3, 1000), elastic(1e5, 0.3, 1000)});
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    GridState g(s.grid, shape);
    const Scheme scheme{.shape = shape};
    const SolverState state = initial_state(s, scheme, g, materials_of(s));
    g.rebuild(state.particles);
    std::size_t next = 0;
    for (std::int32_t cell = 0; cell < std::int32_t(g.grid.node_count()); ++cell) {
      const Range points = g.cells.points_in(cell);
      if (next < g.cells.size() && g.cells.index[next] == cell) {
        EXPECT_EQ(points.begin, g.cells.begin[next]);
        EXPECT_EQ(points.end, g.cells.begin[++next]);
      } else {
        EXPECT_EQ(points.begin, points.end);
      }
    }
    EXPECT_EQ(next, g.cells.size());
  }
}

TEST(Cells, FollowWhatABuildFromScratchFinds) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    Case c(shape, TransferKind::flip);
    Particles& p = c.state.particles;
    std::mt19937_64 random(seed_of_all);
    std::uniform_real_distribution<double> u(-1, 1);
    GridState other(c.scene.grid, shape);
    for (int step = 0; step < 200; ++step) {
      const double share = step % 3 == 0 ? 1 : step % 3 == 1 ? 0.01 : 0.1;
      for (std::size_t k = 0; k < p.size(); ++k) {
        if (p.cell[k] == Particles::ended || std::abs(u(random)) > share) continue;
        p.x[k] += 0.05 * u(random);
        p.y[k] += 0.05 * u(random);
      }
      std::vector<std::uint32_t> left;
      if (!locate_points(p, c.g, left, 1)) continue;
      c.g.follow(p, c.g.relocation.moves);
      if (step % 20 == 10) p.sort_as(c.g.cells.order, 1);
      other.rebuild(p);
      ASSERT_EQ(c.g.cells.order, other.cells.order);
      ASSERT_EQ(c.g.cells.begin, other.cells.begin);
      ASSERT_EQ(c.g.cells.index, other.cells.index);
      ASSERT_EQ(c.g.active.nodes, other.active.nodes);
      std::size_t next = 0;
      for (std::uint32_t n = 0; n < c.g.grid.node_count(); ++n) {
        if (next < c.g.active.nodes.size() && c.g.active.nodes[next] == n) {
          ++next;
          c.g.node[n].mass = c.g.node[n].nx = 1;
        } else {  // nothing is left of what it carried
          ASSERT_EQ(c.g.node[n].mass, 0);
          ASSERT_EQ(c.g.node[n].nx, 0);
        }
      }
      for (std::size_t s = 0; s < c.g.cells.size(); ++s)
        for (std::uint32_t q = c.g.cells.begin[s]; q < c.g.cells.begin[s + 1]; ++q)
          ASSERT_EQ(p.cell[c.g.cells.order[q]], c.g.cells.index[s]);
      for (std::size_t k = 0; k < p.size(); ++k) {
        if (p.cell[k] == Particles::ended) continue;
        std::int32_t cell = 0;
        double xi = 0, eta = 0;
        ASSERT_TRUE(c.g.find(p.x[k], p.y[k], cell, xi, eta)) << p.x[k] << ' ' << p.y[k];
        ASSERT_EQ(p.cell[k], cell);
        ASSERT_NEAR(c.g.natural(p, k).x(), xi, 1e-12);
        ASSERT_NEAR(c.g.natural(p, k).y(), eta, 1e-12);
      }
    }
    EXPECT_GT(std::count(p.cell.begin(), p.cell.end(), Particles::ended), 0);
  }
}

// The cells that see one of the nodes, and no others; nodes in a row as one by one.
TEST(Cells, CellsThatSeeANodeAreStrainedApart) {
  std::mt19937_64 random(seed_of_all);
  SCOPED_TRACE(seed_of_all);
  const auto number = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  for (int trial = 0; trial < 300; ++trial) {
    const ShapeKind shape = trial % 2 ? ShapeKind::bilinear : ShapeKind::bspline;
    const Grid grid{{0, 0}, {0.1, 0.1}, number(2, 9), number(2, 12)};
    GridState row(grid, shape, 1, true), single(grid, shape, 1, true);
    Particles p;
    p.x.resize(std::size_t(number(1, 60)));
    p.cell.resize(p.x.size());
    for (std::int32_t& cell : p.cell)
      cell = std::int32_t(row.grid.node(number(0, row.grid.nx - row.width), number(0, row.grid.ny - row.width)));
    row.rebuild(p);
    single.rebuild(p);
    const auto first = std::uint32_t(number(0, int(row.grid.node_count()) - 1));
    const int count = number(1, row.grid.nx - int(first) % row.grid.nx);
    row.separate_strain_velocities(first, count);
    for (int k = 0; k < count; ++k) single.separate_strain_velocities(first + std::uint32_t(k));
    EXPECT_EQ(row.marks, single.marks);
    for (std::size_t n = 0; n < row.grid.node_count(); ++n) EXPECT_EQ(row.node[n].apart, single.node[n].apart);
    for (std::size_t s = 0; s < row.cells.size(); ++s) {
      std::size_t at[most_stencil_nodes];
      row.stencil_nodes(row.cells.index[s], at);
      const bool sees = std::any_of(at, at + row.stencil, [&](std::size_t n) { return n >= first && n < first + std::size_t(count); });
      EXPECT_EQ(sees, bool(row.marks[s] & strained_apart));
    }
  }
}

// Bands that hold no cells leave their neighbours' nodes to others.
TEST(Cells, ABandFindsItsNodesFreshOnceAndFinishesThemOnce) {
  std::mt19937_64 random(seed_of_all);
  SCOPED_TRACE(seed_of_all);
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline})
    for (int trial = 0; trial < 20; ++trial) {
      const Scene scene = test::scene(Grid{{0, 0}, {0.1, 0.1}, 9, 61}, {rectangle("a", 0.1, 0.0, 0.7, 6.0)}, {elastic(1e5, 0.3, 1000)});
      const Scheme scheme{.shape = shape, .transfer = TransferKind::flip, .stress = StressUpdate::usl, .locking = Locking::none};
      GridState g(scene.grid, shape);
      SolverState state = initial_state(scene, scheme, g, materials_of(scene));
      Particles& p = state.particles;
      std::vector<bool> empty(100);
      for (auto&& row : empty) row = random() % (trial % 2 ? 2 : 5) != 0;
      for (std::size_t k = 0; k < p.size(); ++k)
        if (empty[std::size_t(p.y[k] / (trial % 3 ? 0.1 : 0.4))]) p.cell[k] = Particles::ended;
      g.rebuild(p);
      if (g.cells.size() == 0) continue;
      std::vector<int> fresh(g.active.nodes.size(), 0), added(g.active.nodes.size(), 0), finished(g.active.nodes.size(), 0);
      const auto place = [&](std::size_t node) {
        return std::size_t(std::lower_bound(g.active.nodes.begin(), g.active.nodes.end(), std::uint32_t(node)) - g.active.nodes.begin());
      };
      for_bands(
          g.active.mapped, 1,
          [&](Range nodes, std::size_t) {
            for (std::size_t a = nodes.begin; a < nodes.end; ++a) {
              EXPECT_EQ(fresh[a]++, 0);
              EXPECT_EQ(added[a], 0);
            }
          },
          [&](Range range, std::size_t) {
            for (std::size_t s = range.begin; s < range.end; ++s) {
              std::size_t at[most_stencil_nodes];
              g.stencil_nodes(g.cells.index[s], at);
              for (int n = 0; n < g.stencil; ++n) {
                const std::size_t a = place(at[n]);
                EXPECT_EQ(fresh[a], 1);
                EXPECT_EQ(finished[a], 0);
                ++added[a];
              }
            }
          },
          [&](Range nodes, std::size_t) {
            for (std::size_t a = nodes.begin; a < nodes.end; ++a) EXPECT_EQ(finished[a]++, 0);
          });
      for (std::size_t a = 0; a < g.active.nodes.size(); ++a) {
        EXPECT_EQ(fresh[a], 1);
        EXPECT_EQ(finished[a], 1);
        EXPECT_GT(added[a], 0);
      }
    }
}

}  // namespace
}  // namespace pivnp::mpm
