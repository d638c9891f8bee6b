// Contact at the nodes: momentum and Coulomb's law in random states.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mpm/constraint/contact.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/frames.hpp"
#include "mpm/step/momentum.hpp"
#include "mpm/transfer/transfer.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/contact.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double most) { return std::uniform_real_distribution<double>(-most, most)(engine_); }

 private:
  std::mt19937_64 engine_;
};

Vec2 updated(const GridState& g, std::size_t n) { return {g.node[n].nx, g.node[n].ny}; }
Vec2 strain_velocity(const GridState& g, std::size_t n) { return g.strain_velocity(n); }

Vec2 momentum_of(const GridState& g, Vec2 velocity(const GridState&, std::size_t)) {
  Vec2 sum(0, 0);
  for (const std::uint32_t n : g.active.nodes) sum += g.node[n].mass * velocity(g, n);
  return sum;
}

TEST(Contact, RandomStatesKeepMomentumAndCoulombsLaw) {
  std::size_t pressed = 0, slipping = 0, rough = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const std::optional<double> friction = seed % 3 == 0 ? std::optional<double>() : 0.1 * (seed % 3);
    const Scene s = pile(friction);
    const Scheme scheme = scheme_of(seed % 2 ? options() : conservative());
    Contacts contacts(s.contacts, s.particles.label_names);
    ASSERT_EQ(contacts.velocity_fields(), 3);
    GridState g(s.grid, scheme.shape, contacts.velocity_fields());
    const Restraints none({}, g, Vec2(0, 0), {});
    SolverState state = initial_state(s, scheme, g, materials_of(s), contacts);
    Particles& p = state.particles;
    for (std::size_t k = 0; k < p.size(); ++k) {
      p.x[k] += random(0.002);
      p.y[k] += random(0.002);
      p.vx[k] = random(1);
      p.vy[k] = random(1);
    }
    locate_all(p, g);
    map_momentum(p, g, scheme, false, 1);
    for (const std::uint32_t n : g.active.nodes) {
      Node& node = g.node[n];
      g.strain_velocity(n).x = node.vx + random(1);
      g.strain_velocity(n).y = node.vy + random(1);
      node.nx = node.vx + random(1);
      node.ny = node.vy + random(1);
    }
    const double dt = 1e-4;
    contacts.find(p, g, densities_of(s), dt, 1);
    ASSERT_GT(contacts.nodes().size(), 30u);
    const Vec2 before = momentum_of(g, updated), u_before = momentum_of(g, strain_velocity);
    double kinetic = 0, mass = 0;
    for (const std::uint32_t n : g.active.nodes) {
      kinetic += 0.5 * g.node[n].mass * (std::pow(g.node[n].nx, 2) + std::pow(g.node[n].ny, 2));
      mass += g.node[n].mass;
    }
    std::vector<Reaction> reactions;
    contacts.apply(g, none, reactions);
    contacts.apply_to_strain_velocity(g);
    EXPECT_LT((momentum_of(g, updated) - before).norm(), 1e-13 * mass);
    EXPECT_LT((momentum_of(g, strain_velocity) - u_before).norm(), 1e-13 * mass);
    for (const std::uint32_t n : g.active.nodes)
      kinetic -= 0.5 * g.node[n].mass * (std::pow(g.node[n].nx, 2) + std::pow(g.node[n].ny, 2));
    EXPECT_GT(kinetic, -1e-12);
    Vec2 sum(0, 0);
    for (const Reaction& r : reactions) sum += Vec2(r.impulse_x, r.impulse_y);
    EXPECT_LT(sum.norm(), 1e-13 * mass);
    for (const auto& m : contacts.nodes()) {
      ASSERT_GE(m.normal_impulse, 0);
      ASSERT_NEAR(m.normal.norm(), 1, 1e-14);
      if (!(m.normal_impulse > 0)) {
        ASSERT_EQ(m.tangential_impulse, 0);
        continue;
      }
      ++pressed;
      ASSERT_LE(std::abs(m.tangential_impulse), m.friction * m.normal_impulse * (1 + 1e-14));
      slipping += !m.sticks;
      if (!std::isinf(m.friction)) continue;
      ++rough;
      ASSERT_TRUE(m.sticks);
    }
  }
  EXPECT_GT(rough, 30u);
  EXPECT_GT(pressed, 400u);
  EXPECT_GT(slipping, 100u);
}

// A block's edges have the bed's normal, and the gap is what lies between.
TEST(Contact, ABlocksEdgeDoesNotPlough) {
  for (const double gap : {0.0, 0.0025}) {
    const double y = 0.1 + gap;
    Scene s = scene(contact_box, {rectangle("bed", 0.05, 0.05, 0.35, 0.1), rectangle("block", 0.1, 0.1, 0.2, 0.2)},
                    {elastic(1e6, 0.3, 1500), elastic(2e5, 0.2, 700)});
    for (std::size_t k = 0; k < s.particles.size(); ++k)
      if (s.particles.label[k] == 1) s.particles.x0[k] += Vec2(0.0013, gap);
    s.contacts = {{"face", between({"block"}, 0.5)}};
    const Scheme scheme = scheme_of(options());
    Contacts contacts(s.contacts, s.particles.label_names);
    GridState g(s.grid, scheme.shape, contacts.velocity_fields());
    SolverState state = initial_state(s, scheme, g, materials_of(s), contacts);
    locate_all(state.particles, g);
    map_momentum(state.particles, g, scheme, false, 1);
    contacts.find(state.particles, g, densities_of(s), 1e-4, 1);
    EXPECT_GE(contacts.nodes().size(), 20u);
    for (const auto& m : contacts.nodes()) {
      EXPECT_NEAR(m.normal.x(), 0, 0.02) << g.position(m.node[0]).transpose() << ", block at " << y;
      EXPECT_GT(m.normal.y(), 0);
      EXPECT_NEAR(m.gap, gap, 1e-4);
    }
  }
}

// Velocities mapped again (MUSL) move as those of the step: by the same relative motion across the face, and along it
// by none where the bodies stick.
TEST(Contact, RemappedVelocitiesKeepTheSameRelativeMotion) {
  std::size_t sticking = 0, slipping = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Scene s = scene(contact_box, {rectangle("bed", 0.05, 0.05, 0.35, 0.1), rectangle("block", 0.1, 0.1, 0.2, 0.2)},
                    {elastic(1e6, 0.3, 1500), elastic(2e5, 0.2, 700)});
    s.contacts = {{"face", between({"block"}, 0.5)}};
    const Scheme scheme = scheme_of(options());
    Contacts contacts(s.contacts, s.particles.label_names);
    GridState g(s.grid, scheme.shape, contacts.velocity_fields());
    const Restraints none({}, g, Vec2(0, 0), {});
    SolverState state = initial_state(s, scheme, g, materials_of(s), contacts);
    locate_all(state.particles, g);
    map_momentum(state.particles, g, scheme, false, 1);
    for (const std::uint32_t n : g.active.nodes)
      for (double* v : {&g.node[n].nx, &g.node[n].ny, &g.strain_velocity(n).x, &g.strain_velocity(n).y}) *v = random(1);
    contacts.find(state.particles, g, densities_of(s), 1e-4, 1);
    std::vector<Reaction> reactions;
    contacts.apply(g, none, reactions);
    contacts.apply_to_strain_velocity(g);
    for (const auto& m : contacts.nodes()) {
      if (!(m.normal_impulse > 0)) continue;
      const Vec2 n = updated(g, m.node[0]) - updated(g, m.node[1]), u = strain_velocity(g, m.node[0]) - strain_velocity(g, m.node[1]);
      EXPECT_NEAR(u.dot(m.normal), n.dot(m.normal), 1e-12);
      (m.sticks ? sticking : slipping) += 1;
      if (m.sticks) {
        EXPECT_NEAR((u - n).norm(), 0, 1e-12);
      }
    }
  }
  EXPECT_GT(sticking, 20u);
  EXPECT_GT(slipping, 20u);
}

// Two bodies side by side on a floor: whatever they do to each other there, the floor holds.
TEST(Contact, WallsHoldAgainstIt) {
  for (const std::string type : {"roller", "fixed", "frictional"}) {
    Scene s = scene(contact_box, {rectangle("left", 0.1, 0.1, 0.2, 0.2), rectangle("right", 0.2, 0.1, 0.3, 0.2)},
                    {elastic(2e5, 0.2, 700), elastic(1e6, 0.3, 2500)});
    s.contacts = {{"sides", between({"left"}, 0.5)}};
    s.boundaries = {{"floor", line({0, 0.1}, {0.4, 0.1}, type, type == "frictional" ? 0.4 : 0.0)}};
    const Scheme scheme = scheme_of(options());
    Contacts contacts(s.contacts, s.particles.label_names);
    GridState g(s.grid, scheme.shape, contacts.velocity_fields());
    Restraints walls(s.boundaries, g, Vec2(0.2, 0.15), {});
    SolverState state = initial_state(s, scheme, g, materials_of(s), contacts);
    g.set_walls(walls.wall_sides(0, g.grid, false), walls.wall_sides(0, g.grid, true));
    locate_all(state.particles, g);
    map_momentum(state.particles, g, scheme, false, 1);
    Random random(5);
    for (const std::uint32_t n : g.active.nodes) {
      g.node[n].nx = random(1);
      g.node[n].ny = random(1) - 0.5;
    }
    contacts.find(state.particles, g, densities_of(s), 1e-4, 1);
    std::vector<Reaction> reactions;
    walls.apply(0, 1e-4, g, reactions);
    std::vector<Vec2> before;
    for (const auto& m : contacts.nodes())
      for (const std::uint32_t n : m.node) before.emplace_back(g.node[n].nx, g.node[n].ny);
    contacts.apply(g, walls, reactions);
    std::size_t held = 0, k = 0;
    for (const auto& m : contacts.nodes()) {
      for (const std::uint32_t n : m.node) {
        const Vec2 v(g.node[n].nx, g.node[n].ny), was = before[k++];
        if (std::abs(g.position(n).y() - 0.1) > 1e-9) continue;
        ++held;
        EXPECT_GT(std::abs(m.normal.x()), 0.99);
        if (type == "fixed") {
          EXPECT_EQ(v, Vec2(0, 0));
        } else if (type == "roller" || was.y() == 0) {
          EXPECT_NEAR(v.y(), 0, 1e-15);
        }
        if (type == "frictional" && was == Vec2(0, 0)) {
          EXPECT_EQ(v, was);  // it sticks
        }
      }
    }
    EXPECT_GE(held, 4u);
  }
}

}  // namespace
}  // namespace pivnp::mpm
