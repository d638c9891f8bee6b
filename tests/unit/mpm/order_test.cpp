// Order in the step of what changes with time: runs that start in equilibrium, with steps of two lengths against one
// whose steps are a tenth of the shorter, on the same cells, with FLIP (APIC takes a little energy at each step,
// whatever its length).
//
// Velocities live in the middle between two states. Loads, densities and boundaries are those of the state at a step's
// start, strengths those of the state that its stress is updated to. Each criterion lies between what that leaves and
// what the same input leaves a step or half a step to the side, which is of first order: a ratio of 2.0 to 2.1. (Runs
// end on time, with a step of another length, and MUSL smooths once a step: ratios are 2.3 to 2.9, not 4.)
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr double end_s = 0.0102;  // no whole number of steps

// Mean displacement along an axis.
double moved(const Scene& s, MpmOptions o, double courant, std::size_t axis) {
  o.courant = courant;
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  solver.advance_to(end_s, silent);
  double sum = 0;
  for (const auto& u : solver.frame().u) sum += double(u[axis]);
  return sum / double(solver.particles().size());
}

struct Found {
  double coarse, ratio;  // relative error of the longer steps, and over that of the shorter
};
Found errors(const Scene& s, const MpmOptions& o, std::size_t axis = 1) {
  const double exact = moved(s, o, 0.02, axis), coarse = moved(s, o, 0.4, axis) - exact,
               fine = moved(s, o, 0.2, axis) - exact;
  const Found found{std::abs(coarse / exact), std::abs(coarse / fine)};
  std::printf("error %.2e with courant 0.4, %.2e with 0.2: ratio %.2f\n", found.coarse, std::abs(fine / exact),
              found.ratio);
  return found;
}

// A bar 0.1 high between rollers on a fixed base (waves cross it in .003 s).
Scene bar() { return column(0.1, elastic(1e6, 0.0, 1000)); }

TEST(Order, GravityThatRampsUp) {
  MpmOptions o = conservative({0, -20});
  o.gravity_from_m_s2 = Pair{0, 0};
  o.gravity_ramp_s = 0.012;
  const Found e = errors(bar(), o);
  EXPECT_LT(e.coarse, 3e-4);  // (to the side: 3.7e-3 in the middle of the step)
  EXPECT_GT(e.ratio, 2.25);
}

TEST(Order, TractionThatRises) {
  Scene s = bar();
  s.boundaries.push_back({"load", line({0, 0.1}, {0.1, 0.1}, "traction")});
  s.boundaries.back().second.traction_pa = Pair{0, -2000};
  s.boundaries.back().second.rise_s = 0.012;
  const Found e = errors(s, conservative());
  EXPECT_LT(e.coarse, 1e-4);  // (both are too small for a ratio)
}

TEST(Order, DensityThatRises) {
  MaterialOptions m = elastic(1e6, 0.0, 1000);
  m.density_end_kg_m3 = 2000;
  m.density_until_s = 0.012;
  const Found e = errors(column(0.1, m), conservative({0, -20}));
  EXPECT_LT(e.coarse, 8e-4);  // (to the side: 1.7e-2)
  EXPECT_GT(e.ratio, 2.25);
}

TEST(Order, BoundaryThatMoves) {
  Scene s = bar();
  s.boundaries[0].second.velocity_m_s = Pair{0, 0.05};
  const Found e = errors(s, conservative());
  EXPECT_LT(e.coarse, 8e-4);
  EXPECT_GT(e.ratio, 2.25);
}

Scene under_plate(double speed) {
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 11, 15}, {rectangle("soil", 0, 0, 0.1, 0.1)}, {elastic(1e6, 0.0, 1000)});
  s.boundaries = bar().boundaries;
  RigidOptions plate;
  plate.polygon_m = {{0, 0.1}, {0.1, 0.1}, {0.1, 0.13}, {0, 0.13}};
  plate.velocity_m_s = {0, -speed};
  s.bodies = {{"plate", plate}};
  return s;
}

TEST(Order, PlateThatMoves) {
  const Scene s = under_plate(0.05);
  const Found e = errors(s, conservative());
  EXPECT_LT(e.coarse, 2e-3);
  EXPECT_GT(e.ratio, 2.25);
}

TEST(Order, StrengthThatFalls) {
  MaterialOptions m = elastic(1e6, 0.0, 1000);
  m.model = "tresca";
  m.shear_strength_pa = 1500;
  m.reduction_factor = 5;
  m.reduction_until_s = 0.012;
  const Found e = errors(column(0.1, m), conservative({0, -20}));
  EXPECT_LT(e.coarse, 8e-4);  // (to the side: 2.8e-2)
  EXPECT_GT(e.ratio, 2.25);
}

// A wall that lets go at once, of soil that leans on it.
TEST(Order, GateThatGoes) {
  Scene s = column(0.1, elastic(1e6, 0.3, 1000));
  s.boundaries[2].second.until_s = 0.004;
  const Found e = errors(s, conservative({0, -20}), 0);
  EXPECT_LT(e.coarse, 1e-3);  // (3.8e-3 where the push across the opening takes the forces after it for all of its time)
}

TEST(Order, TractionThatEnds) {
  Scene s = bar();
  s.boundaries.push_back({"load", line({0, 0.1}, {0.1, 0.1}, "traction")});
  s.boundaries.back().second.traction_pa = Pair{0, -2000};
  s.boundaries.back().second.rise_s = 0.004;
  s.boundaries.back().second.until_s = 0.006;
  const Found e = errors(s, conservative());
  EXPECT_LT(e.coarse, 0.1);  // (of a mean that has nearly returned to zero; 1.5 without)
}

// Loads that act from time 0 on, without an equilibrium before: displacements, and what is shown of velocities, energies and
// impulses at the state's time.
struct Shown {
  double u = 0, v = 0, kinetic = 0, impulse = 0;
};
Shown shown(const Scene& s, MpmOptions o, double courant) {
  o.courant = courant;
  Solver solver(o, s, 1);
  solver.advance_to(end_s, silent);
  const MotionFrame frame = solver.frame();
  Shown out{0, 0, solver.energy().kinetic, solver.reactions().of.at(0).impulse.y()};
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    out.u += double(frame.u[k][1]) / double(frame.u.size());
    out.v += double(frame.v[k][1]) / double(frame.u.size());
  }
  return out;
}
struct Errors {
  Shown coarse, fine;  // with courant 0.4 and 0.2
};
Errors errors_at_once(const Scene& s, const MpmOptions& o) {
  const Shown exact = shown(s, o, 0.02), coarse = shown(s, o, 0.4), fine = shown(s, o, 0.2);
  const auto off = [&](const Shown& x) {
    return Shown{std::abs(x.u / exact.u - 1), std::abs(x.v / exact.v - 1), std::abs(x.kinetic / exact.kinetic - 1), std::abs(x.impulse / exact.impulse - 1)};
  };
  const Errors e{off(coarse), off(fine)};
  std::printf("courant 0.4, 0.2: displacement %.2e %.2e, velocity %.2e %.2e, kinetic energy %.2e %.2e, impulse on the base %.2e %.2e\n", e.coarse.u,
              e.fine.u, e.coarse.v, e.fine.v, e.coarse.kinetic, e.fine.kinetic, e.coarse.impulse, e.fine.impulse);
  return e;
}

TEST(Order, GravityAtOnce) {
  const Errors e = errors_at_once(bar(), conservative({0, -20}));
  EXPECT_LT(e.coarse.u, 3e-3);  // (4.2e-2 where the first step pushes for all of its time)
  EXPECT_GT(e.coarse.u / e.fine.u, 2.25);
  EXPECT_LT(e.coarse.v, 4e-3);  // (velocities of half a step ago are shown otherwise)
  EXPECT_LT(e.coarse.kinetic, 3e-3);
  EXPECT_LT(e.coarse.impulse, 1e-3);
  EXPECT_LT(errors_at_once(bar(), options({0, -20})).coarse.u, 3e-3);  // APIC
}

TEST(Order, TractionAtOnce) {
  Scene s = bar();
  s.boundaries.push_back({"load", line({0, 0.1}, {0.1, 0.1}, "traction")});
  s.boundaries.back().second.traction_pa = Pair{0, -2000};
  const Errors e = errors_at_once(s, conservative());
  EXPECT_LT(e.coarse.u, 5e-3);  // (5.4e-2)
  EXPECT_GT(e.coarse.u / e.fine.u, 2.25);
  EXPECT_LT(e.coarse.v, 4e-3);
  EXPECT_LT(e.coarse.impulse, 1e-3);
}

TEST(Order, FreeBodyAtOnce) {
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 11, 15}, {rectangle("soil", 0, 0, 0.1, 0.1)}, {elastic(1e6, 0.0, 1000)});
  s.boundaries = bar().boundaries;
  RigidOptions plate;
  plate.polygon_m = {{0, 0.1}, {0.1, 0.1}, {0.1, 0.13}, {0, 0.13}};
  plate.mass_kg_m = 10;
  plate.friction = 0;
  s.bodies = {{"plate", plate}};
  const Errors e = errors_at_once(s, conservative({0, -20}));
  EXPECT_LT(e.coarse.u, 4e-4);  // (1.9e-3)
  EXPECT_LT(e.coarse.impulse, 1e-3);
}

// Loads so small that points stay where they were laid, in motion along y alone. There uGIMP's functions are linear at
// each of them, and APIC gives back to the nodes what it took: what is left is the order of the inputs themselves.
// (Otherwise a transfer takes a share of each step, or is of first order: docs/theory/mpm_contact.md#loading-in-time.)
double order(const Scene& s, MpmOptions o) {
  o.shape = ShapeKind::gimp;
  std::vector<std::vector<double>> moved;
  for (const double courant : {0.4, 0.2, 0.1}) {
    o.courant = courant;
    Solver solver(o, s, 1);
    solver.find_initial_equilibrium(silent);
    solver.advance_to(end_s, silent);
    moved.emplace_back();
    for (const auto& u : solver.frame().u) moved.back().push_back(double(u[1]));
  }
  const auto rms = [&](std::size_t a) {
    double sum = 0;
    for (std::size_t k = 0; k < moved[a].size(); ++k) sum += std::pow(moved[a][k] - moved[a + 1][k], 2);
    return std::sqrt(sum / double(moved[a].size()));
  };
  const double found = std::log2(rms(0) / rms(1));
  std::printf("rms %.2e m between courant 0.4 and 0.2, %.2e between 0.2 and 0.1: order %.2f\n", rms(0), rms(1), found);
  return found;
}
MpmOptions light(double gravity) {
  MpmOptions o = options({0, gravity});
  o.equilibrium_tolerance = 1e-9;
  return o;
}
constexpr double second = 1.7;  // (half a step to the side: .9 to 1.1)

TEST(SecondOrder, GravityThatRampsUp) {
  MpmOptions o = light(-0.2);
  o.gravity_from_m_s2 = Pair{0, 0};
  o.gravity_ramp_s = 0.006;
  EXPECT_GT(order(bar(), o), second);
}

TEST(SecondOrder, TractionThatRises) {
  Scene s = bar();
  s.boundaries.push_back({"load", line({0, 0.1}, {0.1, 0.1}, "traction")});
  s.boundaries.back().second.traction_pa = Pair{0, -20};
  s.boundaries.back().second.rise_s = 0.006;
  EXPECT_GT(order(s, light(0)), second);
}

TEST(SecondOrder, DensityThatRises) {
  MaterialOptions m = elastic(1e6, 0.0, 1000);
  m.density_end_kg_m3 = 2000;
  m.density_until_s = 0.006;
  EXPECT_GT(order(column(0.1, m), light(-0.2)), second);
}

TEST(SecondOrder, StrengthThatFalls) {
  MaterialOptions m = elastic(1e6, 0.0, 1000);
  m.model = "tresca";
  m.shear_strength_pa = 15;
  m.reduction_factor = 5;
  m.reduction_until_s = 0.006;
  EXPECT_GT(order(column(0.1, m), light(-0.2)), second);
}

TEST(SecondOrder, BoundaryThatMoves) {
  Scene s = bar();
  s.boundaries[0].second.velocity_m_s = Pair{0, 0.001};
  EXPECT_GT(order(s, light(0)), second);
}

TEST(SecondOrder, PlateThatMoves) { EXPECT_GT(order(under_plate(0.001), light(0)), second); }

// A lid lets go of soil that leans on it.
TEST(SecondOrder, GateThatGoes) {
  Scene s = column(0.1, elastic(1e6, 0.0, 1000));
  s.boundaries.push_back({"lid", line({0, 0.1}, {0.1, 0.1}, "roller")});
  s.boundaries.back().second.until_s = 0.004;
  EXPECT_GT(order(s, light(0.2)), second);
}

TEST(SecondOrder, Excavation) {
  MaterialOptions stays = elastic(1e6, 0.3, 1000), goes = stays;
  goes.removed_s = 0.004;
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 11, 15},
                  {rectangle("soil", 0, 0, 0.1, 0.06), rectangle("cut", 0, 0.06, 0.1, 0.1)}, {stays, goes});
  s.boundaries = bar().boundaries;
  EXPECT_GT(order(s, light(-0.2)), second);
}

}  // namespace
}  // namespace pivnp::mpm
