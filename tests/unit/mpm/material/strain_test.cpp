// Strain of points in steps that turn far, on every instruction set.
#include <gtest/gtest.h>

#include <cmath>

#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/frames.hpp"
#include "mpm/transfer/transfer.hpp"
#include "tests/unit/mpm/every_target.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

// A step that turns a block by almost half a turn has a volume, a distortion and a ratio of its parts as one that
// hardly turns.
TEST(Strain, AlmostHalfATurnIsNotSmall) {
  MpmOptions o = options();
  o.shape = ShapeKind::bspline;
  o.transfer = TransferKind::apic;
  o.stress_update = StressUpdate::usl;
  o.locking = Locking::none;
  const Scheme scheme = scheme_of(o);
  const Scene s =
      scene(Grid{{0, 0}, {0.1, 0.1}, 11, 11}, {rectangle("block", 0.35, 0.35, 0.65, 0.65)}, {elastic(1e6, 0.3, 1000)});
  GridState g(s.grid, scheme.shape);
  SolverState state = initial_state(s, scheme, g, materials_of(s));
  Particles& p = state.particles;
  locate_all(p, g);
  const double angle = M_PI - 5e-6;
  const Vec2 centre(0.5, 0.5);
  Mat2 turn;
  turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  on_every_target([&] {
    for (int j = 0; j < g.grid.ny; ++j)
      for (int i = 0; i < g.grid.nx; ++i) {
        const Vec2 r = g.grid.position(i, j) - centre, v = turn * r - r;
        g.strain_velocity(g.grid.node(i, j)).x = v.x();
        g.strain_velocity(g.grid.node(i, j)).y = v.y();
      }
    strain_points(p, g, scheme, 1, false, 1);
    const double expected = 2 * std::tan(angle / 2);
    for (std::size_t k = 0; k < p.size(); ++k) ASSERT_NEAR(p.spin[k], expected, 1e-3 * expected);
  });
}

}  // namespace
}  // namespace pivnp::mpm
