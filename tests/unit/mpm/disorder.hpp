// Points and cells in no order, for tests of kernels and lists.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/frames.hpp"
#include "mpm/transfer/transfer.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm::test {

constexpr unsigned seed_of_all = 20260301;

struct Case {
  Scene scene;
  Scheme scheme;
  GridState g;
  Materials materials;
  SolverState state;

  Case(ShapeKind shape, TransferKind transfer, bool by_updated = false, StressUpdate stress = StressUpdate::usl,
       Locking locking = Locking::none, bool axisymmetric = false)
      : scene(test::scene(Grid{{0.1, -0.2}, {0.1, 0.08}, 9, 9},
                          {rectangle("a", 0.1, -0.2, 0.5, 0.2), rectangle("b", 0.5, -0.2, 0.7, 0.3)},
                          {elastic(1e5, 0.3, 1000), elastic(1e5, 0.2, 1300)})),
        scheme{.shape = shape, .transfer = transfer, .stress = stress, .locking = locking, .axisymmetric = axisymmetric},
        g(scene.grid, shape, 1, by_updated,
          {.own_strain_velocity = true, .averages = true, .filtered = transfer == TransferKind::xpic}, axisymmetric),
        materials(materials_of(scene)),
        state(initial_state(scene, scheme, g, materials)) {
    std::mt19937_64 random(seed_of_all);
    std::uniform_real_distribution<double> u(-1, 1);
    Particles& p = state.particles;
    for (std::size_t k = 0; k < p.size(); ++k) {
      p.x[k] = std::max(0.1, p.x[k] + 0.04 * u(random));
      p.y[k] = std::max(-0.2, p.y[k] + 0.04 * u(random));
      p.vx[k] = u(random);
      p.vy[k] = u(random);
      for (auto* a : {&p.tau_xx, &p.tau_yy, &p.tau_zz, &p.tau_xy}) (*a)[k] = 1e3 * u(random);
      for (auto* a : {&p.C_xx, &p.C_xy, &p.C_yx, &p.C_yy})
        if (!a->empty()) (*a)[k] = u(random);
    }
    locate_all(p, g);
    std::vector<std::uint8_t> walls(g.grid.node_count(), wall_none);
    if (g.width == 3)
      for (int j = 0; j < g.grid.ny; ++j) walls[g.grid.node(1, j)] = wall_left;
    g.set_walls(walls, walls);
  }
};

}  // namespace pivnp::mpm::test
