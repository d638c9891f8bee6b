// Steps that follow how the points lie: long where cells are full, short enough for any cloud.
#include "mpm/step/own_frequency.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "mpm/step/time_step.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm::test {
namespace {

namespace own_frequency {

constexpr double h = 0.01, young = 1e6, density = 1000;

double wave_speed(double poisson) { return std::sqrt(young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson)) / density); }

Scene of_points(const std::vector<Vec2>& x, double poisson) {
  Scene s;
  s.grid = Grid{{0, 0}, {h, h}, 41, 41};
  s.materials = {elastic(young, poisson, density)};
  s.particles.label_names = {"soil"};
  for (const Vec2& place : x) {
    ParticleSet& p = s.particles;
    p.id.push_back(std::int64_t(p.size()));
    p.label.push_back(0);
    p.x0.push_back(place);
    p.area.push_back(h * h);
    p.born.push_back(0);
    p.end.push_back(std::numeric_limits<double>::quiet_NaN());
    p.end_reason.push_back(EndReason::none);
  }
  return s;
}

MpmOptions free_of_gravity() {
  MpmOptions o = options();
  o.initial_equilibrium = false;
  o.end_at_rest = false;
  o.energy_limit = 1e30;
  return o;
}

// Points at random that start with stresses at random: the sum of v^2 after 120 and after 30 times h/c. Growth without bound ends
// in a failure.
bool grows(double poisson, std::optional<double> courant) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec2> x;
  for (int k = 0; k < 200; ++k) x.push_back({0.05 + 0.3 * uniform(random), 0.05 + 0.3 * uniform(random)});
  Scene s = of_points(x, poisson);
  for (std::size_t k = 0; k < x.size(); ++k)
    s.stress0.push_back({uniform(random) - 0.5, uniform(random) - 0.5, uniform(random) - 0.5, 0.5 * uniform(random) - 0.25});
  MpmOptions o = free_of_gravity();
  o.courant = courant;
  Solver solver(o, s, 1);
  const auto energy = [&](double times) {
    solver.advance_to(times * h / wave_speed(poisson), silent);
    double sum = 0;
    for (const auto& v : solver.frame().v) sum += double(v[0]) * double(v[0]) + double(v[1]) * double(v[1]);
    return sum;
  };
  try {
    const double first = energy(3), soon = energy(10), early = energy(30);
    if (std::max(soon, early) > 10 * first) return true;  // (what blows up may fly apart soon, and be calm after)
    return !(energy(120) < 1.5 * early);
  } catch (const RunError&) {
    return true;
  }
}

}  // namespace own_frequency

using namespace own_frequency;

// The limit of a lone point in the worst place, sqrt((1 - nu)/2), is .71, .59 and .50; of 200 points some lie near it.
TEST(OwnFrequency, ACloudIsStableByDefaultAndNotByLongSteps) {
  for (const double poisson : {0.0, 0.3, 0.49}) {
    EXPECT_FALSE(grows(poisson, {})) << poisson;
    EXPECT_TRUE(grows(poisson, poisson > 0 ? most_courant : 1.0)) << poisson;
  }
}

TEST(OwnFrequency, FullCellsTakeLongSteps) {
  Scene s = scene(Grid{{0, 0}, {h, h}, 41, 41}, {rectangle("block", 0.1, 0.1, 0.3, 0.3)}, {elastic(young, 0.3, density)});
  const Solver full(free_of_gravity(), s, 1);
  EXPECT_GT(full.stable_step(), 0.7 * h / wave_speed(0.3));
  MpmOptions given = free_of_gravity();
  given.courant = 0.3;
  EXPECT_NEAR(Solver(given, s, 1).stable_step(), 0.3 * h / wave_speed(0.3), 1e-12);
  MpmOptions flip = free_of_gravity();
  flip.transfer = TransferKind::flip;  // its limits are others
  EXPECT_NEAR(Solver(flip, s, 1).stable_step(), least_courant * h / wave_speed(0.3), 1e-12);
  s.bodies = {{"ball", {}}};
  s.bodies[0].second.circle_m = {0.2, 0.35, 0.02};
  EXPECT_NEAR(Solver(free_of_gravity(), s, 1).stable_step(), least_courant * h / wave_speed(0.3), 1e-12);
}

// By hand: against masses that are the point's own, sum slope^2/weight along an axis is 4 on a node (weights 1/8, 3/4, 1/8, slopes -1/2,
// 0, 1/2), 4 + 4 xi^2/(3/4 - xi^2) at xi from it, and 4 half-way to the next, where the third node takes no part any more.
TEST(OwnFrequency, OfALonePointByHand) {
  const auto of = [](const Vec2& x) {
    const Scene s = of_points({x}, 0.3);
    return Solver(free_of_gravity(), s, 1).stable_step() * wave_speed(0.3) / h;
  };
  EXPECT_NEAR(of({0.20, 0.20}), least_courant * std::sqrt(12 / 8.0), 1e-9);      // on a node: 4 + 4
  EXPECT_NEAR(of({0.205, 0.20}), least_courant * std::sqrt(12 / (4 + 4.0)), 1e-9);
  EXPECT_NEAR(of({0.2049, 0.2049}), least_courant * std::sqrt(12 / (2 * (4 + 4 * 0.49 * 0.49 / (0.75 - 0.49 * 0.49)))), 1e-9);
}

TEST(OwnFrequency, RisesAtOnceAndFallsSlowly) {
  EXPECT_EQ(held_frequency2(3, 8), 8);
  EXPECT_NEAR(held_frequency2(8, 3), 0.995 * 8, 1e-12);
  EXPECT_EQ(courant_of(100), least_courant);
  EXPECT_EQ(courant_of(1), most_courant);
}

}  // namespace
}  // namespace pivnp::mpm::test
