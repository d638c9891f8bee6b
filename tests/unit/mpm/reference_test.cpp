// The kernels in lanes against the plain loops of appendix A, on every instruction set: every shape, transfer and average.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <ostream>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "mpm/state/particle_fields.hpp"
#include "mpm/state/scheme_rows.hpp"
#include "mpm/transfer/reference.hpp"
#include "mpm/transfer/transfer.hpp"
#include "tests/unit/mpm/disorder.hpp"
#include "tests/unit/mpm/every_target.hpp"

namespace pivnp::mpm {

void PrintTo(ShapeKind value, std::ostream* out) { *out << name_of(value); }
void PrintTo(TransferKind value, std::ostream* out) { *out << name_of(value); }
void PrintTo(Locking value, std::ostream* out) { *out << name_of(value); }

namespace {

using namespace test;

using Choice = std::tuple<ShapeKind, TransferKind, Locking>;

std::vector<Choice> choices() {
  std::vector<Choice> all;
  for (const ShapeRow& shape : shape_rows)
    for (const TransferRow& transfer : transfers())
      for (const LockingRow& locking : lockings())
        if (!(shape.centred() && locking.of_elements)) all.emplace_back(shape.value, transfer.value, locking.value);
  return all;
}
std::string name_of_choice(const testing::TestParamInfo<Choice>& info) {
  const auto [shape, transfer, locking] = info.param;
  return std::string(name_of(shape)) + "_" + std::string(name_of(transfer)) + "_" + std::string(name_of(locking));
}

// Points in no order, some of which stand apart, and nodes that move anyhow.
struct Disorder : Case {
  std::mt19937_64 random{seed_of_all + 1};

  Disorder(const Choice& choice, StressUpdate stress, bool axisymmetric = false)
      : Case(std::get<0>(choice), std::get<1>(choice), stress == StressUpdate::usl, stress, std::get<2>(choice), axisymmetric) {
    scheme.pic_per_s = row_of(scheme.transfer).blends ? 100 : 0;
    scheme.xpic_order = 3;
    Particles& p = state.particles;
    p.history.declare({opening_strain}, p.size());
    Array& opening = *p.history.find(opening_strain.name);
    for (std::size_t k = 0; k < p.size(); k += 5) opening[k] = 0.1;
    if (g.width == 3) add_walls_between_lines();
  }
  double u() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  void map() {
    average_mean_stress(state.particles, g, scheme, 1);
    map_momentum(state.particles, g, scheme, true, 1);
  }
  // At the base, the right and the top, each over part of its side.
  void add_walls_between_lines() {
    std::vector<std::uint8_t> walls = g.walls;
    std::vector<Vec2> shifts(walls.size(), Vec2::Zero());
    const int right = g.field_grid.nx - 2, top = g.field_grid.ny - 2;
    const auto wall = [&](int i, int j, WallSide side, const Vec2& cells) {
      walls[g.grid.node(i, j)] |= side;
      shifts[g.grid.node(i, j)] += cells.cwiseProduct(g.grid.spacing);
    };
    for (int i = 1; i <= right; ++i) wall(i, 2, wall_down, {0, 0.37});
    for (int i = right / 2; i <= right; ++i) wall(i, top, wall_up, {0, 0.26});
    for (int j = 2; j <= top - 2; ++j) wall(right - 1, j, wall_right, {-0.45, 0});
    g.set_walls(walls, walls, shifts);
  }
  // Updated velocities, up to `most` m/s.
  void move_nodes(double most) {
    for (const std::uint32_t n : g.active.nodes) {
      g.node[n].nx = most * u();
      g.node[n].ny = most * u();
    }
  }
};

// In the plane, and about the axis where the choice goes with it.
std::vector<bool> geometries(const Choice& choice) {
  return row_of(std::get<2>(choice)).of_elements ? std::vector<bool>{false} : std::vector<bool>{false, true};
}

class AgainstReference : public testing::TestWithParam<Choice> {};

TEST_P(AgainstReference, MassMomentumAndForceOfTheNodes) {
  on_every_target([&] {
    for (const bool axisymmetric : geometries(GetParam())) {
      Disorder d(GetParam(), StressUpdate::musl, axisymmetric);
      const auto sums = reference::map_points(d.state.particles, d.g, d.scheme);
      d.map();
      for (const std::uint32_t n : d.g.active.nodes) {
        const Node& node = d.g.node[n];
        ASSERT_NEAR(node.mass, sums[n].mass, 1e-13);
        ASSERT_NEAR(node.vx * node.mass, sums[n].momentum.x(), 1e-13);
        ASSERT_NEAR(node.vy * node.mass, sums[n].momentum.y(), 1e-13);
        ASSERT_NEAR(node.fx, sums[n].force.x(), 1e-11);
        ASSERT_NEAR(node.fy, sums[n].force.y(), 1e-11);
      }
    }
  });
}

TEST_P(AgainstReference, VelocityPlaceAndAffineFieldOfThePoints) {
  on_every_target([&] {
    for (const StressUpdate stress : {StressUpdate::musl, StressUpdate::usl}) {
      Disorder d(GetParam(), stress);
      Particles& p = d.state.particles;
      d.map();
      d.move_nodes(1);
      const double dt = 1e-3;
      const auto moved = reference::move_points(p, d.g, d.scheme, dt);
      const auto again = reference::map_again(p, d.g, moved);
      if (d.scheme.transfer == TransferKind::xpic) filtered_velocity(p, d.g, d.scheme.xpic_order, 1);
      EXPECT_TRUE(gather_velocity(p, d.g, d.scheme, dt, 1).good);
      for (std::size_t k = 0; k < p.size(); ++k) {
        if (p.cell[k] == Particles::ended) continue;
        ASSERT_NEAR(p.vx[k], moved[k].velocity.x(), 1e-13);
        ASSERT_NEAR(p.vy[k], moved[k].velocity.y(), 1e-13);
        ASSERT_NEAR(p.x[k], moved[k].place.x(), 1e-15);
        ASSERT_NEAR(p.y[k], moved[k].place.y(), 1e-15);
        if (!d.scheme.affine()) continue;
        const std::array<double, 4> affine{p.C_xx[k], p.C_xy[k], p.C_yx[k], p.C_yy[k]};
        for (int c = 0; c < 4; ++c) ASSERT_NEAR(affine[std::size_t(c)], moved[k].affine(c / 2, c % 2), 1e-11);
      }
      if (stress != StressUpdate::musl) continue;
      for (const std::uint32_t n : d.g.active.nodes) {
        if (!(d.g.node[n].mass > 0)) continue;
        const double scale = 1e-13 / d.g.node[n].mass;  // next to nothing may move in any way
        ASSERT_NEAR(d.g.strain_velocity(n).x, again[n].x(), 1e-13 + scale);
        ASSERT_NEAR(d.g.strain_velocity(n).y, again[n].y(), 1e-13 + scale);
      }
    }
  });
}

TEST_P(AgainstReference, StrainIncrementsOfThePoints) {
  on_every_target([&] {
    for (const StressUpdate stress : {StressUpdate::musl, StressUpdate::usl})
      for (const double size : {1e-5, 1e-3, 0.02, 0.1})
        for (const bool axisymmetric : geometries(GetParam())) {
          Disorder d(GetParam(), stress, axisymmetric);
          Particles& p = d.state.particles;
          d.move_nodes(0.1 * size);
          for (const std::uint32_t n : d.g.active.nodes) {
            if (d.g.by_updated && n % 7 != 0) continue;
            d.g.separate_strain_velocities(n);
            d.g.strain_velocity(n).x = 0.1 * size * d.u();
            d.g.strain_velocity(n).y = 0.1 * size * d.u();
          }
          const auto increments = reference::strain_points(p, d.g, d.scheme, 1);
          strain_points(p, d.g, d.scheme, 1, false, 1);
          for (std::size_t k = 0; k < p.size(); ++k) {
            const reference::StrainIncrement& e = increments[k];
            ASSERT_NEAR(p.de_xx[k], e.xx, 1e-12 * size);
            ASSERT_NEAR(p.de_yy[k], e.yy, 1e-12 * size);
            ASSERT_NEAR(p.de_zz[k], e.zz, 1e-12 * size);
            ASSERT_NEAR(p.de_xy[k], e.xy, 1e-12 * size);
            ASSERT_NEAR(p.spin[k], e.spin, 1e-12 * size);
          }
        }
  });
}

INSTANTIATE_TEST_SUITE_P(All, AgainstReference, testing::ValuesIn(choices()), name_of_choice);

}  // namespace
}  // namespace pivnp::mpm
