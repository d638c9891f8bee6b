// Every combination of shape, transfer, stress update and averaging: conservation, bits, restart; the kernels' invariants.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <ostream>
#include <random>

#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/frames.hpp"
#include "mpm/step/momentum.hpp"
#include "mpm/transfer/stress_update.hpp"
#include "mpm/transfer/transfer.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
struct Choice {
  const char *shape, *transfer, *stress, *locking;
};
void PrintTo(const Choice& c, std::ostream* out) {
  *out << c.shape << ' ' << c.transfer << ' ' << c.stress << ' ' << c.locking;
}

std::string name_of(const testing::TestParamInfo<Choice>& info) {
  return std::string(info.param.shape) + "_" + info.param.transfer + "_" + info.param.stress + "_" + info.param.locking;
}

MpmOptions options_of(const Choice& c, Pair gravity = {0, 0}) {
  MpmOptions o = options(gravity);
  o.shape = value_named<ShapeKind>(c.shape);
  o.transfer = value_named<TransferKind>(c.transfer);
  o.stress_update = value_named<StressUpdate>(c.stress);
  o.locking = value_named<Locking>(c.locking);
  return o;
}

class Schemes : public testing::TestWithParam<Choice> {};

TEST_P(Schemes, AFreeBodyKeepsItsMomentum) {
  Scene s = scene(Grid{{-0.03, 0.02}, {0.01, 0.01}, 41, 41}, {disc("disc", {0.12, 0.2}, 0.05)}, {elastic(1e5, 0.3, 1000)});
  for (const Vec2& x : s.particles.x0) s.v0.push_back(Vec2(0.7, 0.3) + 2 * Vec2(x.y() - 0.2, x.x() - 0.12));
  Solver solver(options_of(GetParam()), s, 1);
  const Vec2 before = solver.momentum();
  solver.advance_to(0.01, silent);
  EXPECT_LT((solver.momentum() - before).norm(), 1e-12 * before.norm());
  EXPECT_GT(solver.energy().elastic, 0);
  EXPECT_LT(std::abs(solver.energy().residual), 0.01 * solver.energy().kinetic);
}

Scene falling_sand() {
  Scene s = column(0.1, sand(30));
  s.grid.nx = 21;
  s.boundaries = {{"base", line({0, 0}, {0.2, 0}, "frictional", 0.5)}, {"left", line({0, 0}, {0, 0.14}, "roller")}};
  return s;
}

TEST_P(Schemes, ThreadsAndRestartsKeepTheBits) {
  const MpmOptions o = options_of(GetParam(), {0, -9.81});
  Solver whole(o, falling_sand(), 1), first(o, falling_sand(), 3), second(o, falling_sand(), 2);
  whole.advance_to(0.01, silent);
  first.advance_to(0.01, silent);
  EXPECT_TRUE(whole.save() == first.save());
  second.load(first.save());
  whole.advance_to(0.02, silent);
  second.advance_to(0.02, silent);
  EXPECT_TRUE(whole.save() == second.save());
  EXPECT_EQ(whole.energy().residual, second.energy().residual);
}

// Force and strain are conjugate: the nodes' force times any velocity is minus the points' stress times the strain
// that this velocity makes.
TEST_P(Schemes, ForceAndStrainAreConjugate) {
  const MpmOptions o = options_of(GetParam());
  Scheme scheme = scheme_of(o);
  Scene s = scene(Grid{{0, 0}, {0.1, 0.08}, 8, 8}, {disc("disc", {0.33, 0.3}, 0.17)}, {elastic(1e5, 0.3, 1000)});
  GridState g(s.grid, scheme.shape);
  const Materials materials = materials_of(s);
  SolverState state = initial_state(s, scheme, g, materials);
  Particles& p = state.particles;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  p.history.declare({opening_strain}, p.size());
  Array& opening = *p.history.find(opening_strain.name);
  for (std::size_t k = 0; k < p.size(); ++k) {
    p.x[k] += 0.02 * u(random);
    p.y[k] += 0.02 * u(random);
    for (auto* a : {&p.tau_xx, &p.tau_yy, &p.tau_zz, &p.tau_xy}) (*a)[k] = u(random);
    opening[k] = k % 5 == 0 ? 0.1 : 0;
  }
  if (scheme.locking == Locking::full)  // one stress an element is what it is about
    for (auto* a : {&p.tau_xx, &p.tau_yy, &p.tau_zz, &p.tau_xy}) std::fill(a->begin(), a->end(), u(random));
  locate_all(p, g);
  average_mean_stress(p, g, scheme, 1);
  map_momentum(p, g, scheme, true, 1);
  const double tiny = 1e-7;  // so that log strains are small strains
  double work = 0;
  for (const std::uint32_t n : g.active.nodes) {
    g.strain_velocity(n).x = u(random);
    g.strain_velocity(n).y = u(random);
    work += g.node[n].fx * g.strain_velocity(n).x + g.node[n].fy * g.strain_velocity(n).y;
  }
  strain_points(p, g, scheme, tiny, false, 1);
  double stress_work = 0, scale = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double w = p.volume0[k] * (p.tau_xx[k] * p.de_xx[k] + p.tau_yy[k] * p.de_yy[k] + p.tau_zz[k] * p.de_zz[k] +
                                     2 * p.tau_xy[k] * p.de_xy[k]) / tiny;
    stress_work += w;
    scale += std::abs(w);
  }
  EXPECT_NEAR(work, -stress_work, 1e-5 * scale);
}

// A node that no point of a cell reaches may move in any way, and does not count, whatever lies beside the points in storage.
TEST(Averaging, WhatNoPointReachesDoesNotCount) {
  for (const char* shape : {"bilinear", "bspline"}) {
    const Scene s = scene(Grid{{0, 0}, {1, 1}, 12, 9}, {rectangle("block", 2, 2, 3, 3)}, {sand(30)});
    const Scheme scheme = scheme_of(options_of({shape, "flip", "musl", "fbar"}));
    GridState g(s.grid, scheme.shape);
    SolverState state = initial_state(s, scheme, g, materials_of(s));
    Particles& p = state.particles;
    const double corner = scheme.shape == ShapeKind::bilinear ? 3.0 : 2.5;  // of a cell: its last node has no weight there
    p.x[0] = p.y[0] = corner;
    for (std::size_t k = 1; k < p.size(); ++k) p.x[k] = 7.4, p.y[k] = 5.4;
    locate_all(p, g);
    std::size_t at[most_stencil_nodes];
    for (std::size_t cell = 0; cell < g.cells.size(); ++cell)
      if (g.cells.order[g.cells.begin[cell]] == 0) g.stencil_nodes(g.cells.index[cell], at);
    const GridState::StrainVelocity beyond = g.strain_velocity(at[g.stencil - 1]);
    beyond.x = beyond.y = -1e3;
    strain_points(p, g, scheme, 1.0, true, 1);
    for (std::size_t k = 0; k < p.size(); ++k)
      for (const Array* of : {&p.de_xx, &p.de_yy, &p.de_zz, &p.de_xy, &p.spin}) EXPECT_EQ((*of)[k], 0) << shape << ' ' << k;
  }
}

// What is averaged against locking is for the force: without it (usf maps momentum before the strain) nothing of it is read.
TEST(Averaging, MomentumAloneNeedsNone) {
  for (const char* shape : {"bilinear", "bspline"}) {
    const Scene s = scene(Grid{{0, 0}, {0.1, 0.1}, 61, 9}, {rectangle("bed", 0.2, 0.2, 5.6, 0.6)}, {sand(30)});
    const Scheme scheme = scheme_of(options_of({shape, "flip", "usf", "fbar"}));
    GridState g(s.grid, scheme.shape);
    SolverState state = initial_state(s, scheme, g, materials_of(s));
    Particles& p = state.particles;
    for (std::size_t k = 0; k < p.size(); ++k) p.tau_xx[k] = p.tau_yy[k] = -1e3, p.vx[k] = p.x[k];
    locate_all(p, g);
    map_momentum(p, g, scheme, false, 1);
    double mass = 0;
    for (const std::uint32_t n : g.active.nodes) {
      ASSERT_EQ(g.node[n].fx, 0);
      ASSERT_EQ(g.node[n].fy, 0);
      mass += g.node[n].mass;
    }
    double expected = 0;
    for (std::size_t k = 0; k < p.size(); ++k) expected += p.mass_of(k);
    EXPECT_NEAR(mass, expected, 1e-9 * mass);
  }
}

// Points that stand open take no part in F-bar's averages: beside them the others carry what they would carry alone, and
// an open point strains by its own gradient.
TEST(OpenPoints, KeepTheirOwnVolume) {
  for (const char* shape : {"bilinear", "bspline"}) {
    const Scheme scheme = scheme_of(options_of({shape, "flip", "musl", "fbar"}));
    const Scene s = scene(Grid{{0, 0}, {0.1, 0.1}, 9, 9}, {rectangle("block", 0.2, 0.2, 0.6, 0.6)}, {sand(30)});
    std::vector<double> force[2];
    for (const bool without : {false, true}) {
      GridState g(s.grid, scheme.shape);
      SolverState state = initial_state(s, scheme, g, materials_of(s));
      Particles& p = state.particles;
      Array& opening = *p.history.find(opening_strain.name);
      for (std::size_t k = 0; k < p.size(); ++k) {
        const bool open = k % 3 == 0;
        p.tau_xx[k] = p.tau_yy[k] = p.tau_zz[k] = open ? 0 : -1000;
        opening[k] = open ? 0.01 : 0;
        if (open && without) p.volume0[k] = 0;
      }
      locate_all(p, g);
      average_mean_stress(p, g, scheme, 1);
      map_momentum(p, g, scheme, true, 1);
      for (const std::uint32_t n : g.active.nodes) force[without].push_back(g.node[n].fx);
      if (without) continue;
      for (const std::uint32_t n : g.active.nodes) g.strain_velocity(n).x = std::pow(0.1 * double(n % 11), 2);  // any motion
      strain_points(p, g, scheme, 1e-3, false, 1);
      for (std::size_t k = 0; k < p.size(); k += 3) EXPECT_NEAR(p.de_zz[k], 0, 1e-15) << shape;
    }
    for (std::size_t n = 0; n < force[0].size(); ++n) EXPECT_NEAR(force[0][n], force[1][n], 1e-9) << shape;
  }
}

// A block under stress is turned through 360 degrees, node by node, as a rigid body.
TEST_P(Schemes, ATurnedBlockKeepsItsObjectiveStress) {
  const Scheme scheme = scheme_of(options_of(GetParam()));
  for (const char* model : {"linear_elastic", "neo_hookean", "tresca"}) {
    MaterialOptions m = elastic(1e6, 0.3, 1000);
    m.model = model;
    m.shear_strength_pa = 1e5;
    const bool from_F = std::string(model) == "neo_hookean";
    Scene s = scene(Grid{{0, 0}, {0.1, 0.1}, 11, 11}, {rectangle("block", 0.35, 0.35, 0.65, 0.65)}, {m});
    if (!from_F) s.stress0.assign(s.particles.size(), {3000, -2000, 500, 1500});
    GridState g(s.grid, scheme.shape);
    const Materials materials = materials_of(s);
    SolverState state = initial_state(s, scheme, g, materials);
    Particles& p = state.particles;
    if (from_F)
      for (std::size_t k = 0; k < p.size(); ++k) {
        p.F_xx[k] = 1.02;
        p.F_xy[k] = 0.03;
        p.J[k] = 1.02;
      }
    Array start[4];
    update_stress(materials, p, 1);
    for (int c = 0; c < 4; ++c) start[c] = *std::array{&p.tau_xx, &p.tau_yy, &p.tau_zz, &p.tau_xy}[std::size_t(c)];
    const Vec2 centre(0.5, 0.5);
    const int steps = 60;
    const double angle = 2 * M_PI / steps, c = std::cos(angle), n = std::sin(angle);
    Mat2 turn;
    turn << c, -n, n, c;
    for (int k = 0; k < steps; ++k) {
      locate_all(p, g);
      for (int j = 0; j < g.grid.ny; ++j)
        for (int i = 0; i < g.grid.nx; ++i) {
          const Vec2 r = g.grid.position(i, j) - centre, v = turn * r - r;
          g.strain_velocity(g.grid.node(i, j)).x = v.x();
          g.strain_velocity(g.grid.node(i, j)).y = v.y();
        }
      strain_points(p, g, scheme, 1, true, 1);
      update_stress(materials, p, 1);
      for (std::size_t q = 0; q < p.size(); ++q) {
        const Vec2 x = centre + turn * (Vec2(p.x[q], p.y[q]) - centre);
        p.x[q] = x.x();
        p.y[q] = x.y();
      }
    }
    double worst = 0;
    for (std::size_t q = 0; q < p.size(); ++q)
      for (int k = 0; k < 4; ++k)
        worst = std::max(worst, std::abs((*std::array{&p.tau_xx, &p.tau_yy, &p.tau_zz, &p.tau_xy}[std::size_t(k)])[q] -
                                         start[k][q]));
    EXPECT_LT(worst, 1e-10 * 3e4) << model;
    EXPECT_NEAR(p.F_xx[0], from_F ? 1.02 : 1.0, 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, Schemes,
    testing::Values(Choice{"bilinear", "flip", "musl", "selective"}, Choice{"bilinear", "flip", "musl", "full"},
                    Choice{"bilinear", "flip", "musl", "fbar"}, Choice{"gimp", "xpic", "usl", "none"},
                    Choice{"gimp", "flip", "musl", "none"}, Choice{"gimp", "flip", "usf", "none"},
                    Choice{"gimp", "apic", "usl", "fbar"}, Choice{"bspline", "flip", "musl", "none"},
                    Choice{"bspline", "flip", "usf", "none"}, Choice{"bspline", "apic", "usl", "none"},
                    Choice{"bspline", "apic", "usl", "fbar"}, Choice{"bspline", "apic", "musl", "fbar"},
                    Choice{"bspline", "aflip", "usl", "none"}, Choice{"bspline", "aflip", "usl", "fbar"},
                    Choice{"gimp", "aflip", "usl", "fbar"},
                    Choice{"bspline", "xpic", "usl", "fbar"}),
    name_of);

// Weights sum to one, their gradients to zero, and both give back a linear field, with walls on any side.
template <class S>
void check_shape() {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> u(0, 1);
  for (int k = 0; k < 2000; ++k) {
    const bool low = k % 3 == 1, high = k % 3 == 2;
    double xi = S::width == 2 ? u(random) : u(random) - 0.5;
    if (S::width == 3 && low) xi = std::abs(xi);
    if (S::width == 3 && high) xi = -std::abs(xi);
    const double half = 0.05 + 0.45 * u(random);
    const auto line = line_of<S>(xi, half, low, high);
    double sum = 0, gradient = 0, place = 0, slope = 0;
    for (int a = 0; a < S::width; ++a) {
      sum += line.w[a];
      gradient += line.g[a];
      place += line.w[a] * (a + S::first);
      slope += line.g[a] * (a + S::first);
      EXPECT_GE(line.w[a], -1e-15);
    }
    ASSERT_NEAR(sum, 1, 1e-14);
    ASSERT_NEAR(gradient, 0, 1e-14);
    ASSERT_NEAR(place, xi, 1e-14);
    ASSERT_NEAR(slope, 1, 1e-13);
  }
}

TEST(Shapes, ReproduceLinearFields) {
  for (const ShapeRow& row : shape_rows) {
    SCOPED_TRACE(row.name);
    Shapes::with(row.value, []<class S>(S) { check_shape<S>(); });
  }
}

TEST(Motion, ARunEndsWhenMotionEnds) {
  MpmOptions o = options({0, -9.81});
  o.damping = 0.7;
  o.initial_equilibrium = false;
  Solver solver(o, column(0.05, elastic(1e6, 0.3, 2000)), 1);
  solver.advance_to(0.6, silent);
  EXPECT_TRUE(solver.at_rest());
  const auto steps = solver.steps();
  const float u = solver.frame().u.back()[1];
  solver.advance_to(1.0, silent);
  EXPECT_EQ(solver.steps(), steps);
  EXPECT_EQ(solver.time(), 1.0);
  EXPECT_LT(u, 0);
  o.end_at_rest = false;
  Solver on(o, column(0.05, elastic(1e6, 0.3, 2000)), 1);
  on.advance_to(0.6, silent);
  EXPECT_GT(on.steps(), steps);
  EXPECT_NEAR(double(on.frame().u.back()[1]), double(u), 1e-4 * std::abs(double(u)));  // nothing was missed
}

// What falls has a rate at which AFLIP lets velocities within a cell fade.
TEST(Options, TheDefaultTransferIsThatOfWhatFalls) {
  EXPECT_EQ(scheme_of(options({0, -9.81})).transfer, TransferKind::aflip);
  EXPECT_EQ(scheme_of(options({0, 0})).transfer, TransferKind::apic);
  MpmOptions given = options({0, 0});
  given.transfer = TransferKind::aflip;
  EXPECT_EQ(scheme_of(given).transfer, TransferKind::aflip);
  EXPECT_EQ(scheme_of(conservative({0, -9.81})).transfer, TransferKind::flip);
}

TEST(Options, WrongCombinationsNameTheirKey) {
  const auto message = [](MpmOptions o) -> std::string {
    try {
      scheme_of(o);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  MpmOptions o = options();
  EXPECT_EQ(message(o), "");
  o.locking = Locking::selective;
  EXPECT_NE(message(o).find("mpm.locking"), std::string::npos);
  o.shape = ShapeKind::bilinear;
  EXPECT_EQ(message(o), "");
  o.transfer = TransferKind::apic;
  o.pic_per_s = 1;
  EXPECT_NE(message(o).find("mpm.pic_per_s"), std::string::npos);
  o = conservative();
  o.transfer = TransferKind::xpic;
  EXPECT_EQ(message(o), "mpm.stress_update: found 'musl' with transfer = \"xpic\", which brings turning bodies to rest, expected usl");
  o.stress_update = StressUpdate::usl;
  EXPECT_EQ(message(o), "");
}

// The initial equilibrium knows no order of strain and motion: walls and bodies that slide must not make one.
TEST(InitialEquilibrium, FindsTheSameStateWhateverStrainsTheMaterialLater) {
  Scene slides = scene(Grid{{0, 0}, {0.01, 0.01}, 41, 16}, {rectangle("soil", 0.1, 0, 0.3, 0.1)}, {elastic(5e6, 0.3, 1600)});
  slides.boundaries = {{"base", line({0, 0}, {0.4, 0}, "frictional", 0.05)}};
  const double wide = 0.8, deep = 0.06, cut = 0.04;
  const Region soil{"soil", Polygon({{0, 0}, {wide, 0}, {wide, deep}, {0.06, deep}, {0.06, cut}, {0.02, cut}, {0.02, deep}, {0, deep}},
                                    "soil")};
  Scene beside = scene(Grid{{0, 0}, {0.01, 0.01}, 81, 12}, {soil}, {sand(35, 5e6)});
  beside.boundaries = {{"base", line({0, 0}, {wide, 0}, "fixed")},
                       {"left", line({0, 0}, {0, 0.11}, "roller")},
                       {"right", line({wide, 0}, {wide, 0.11}, "roller")}};
  RigidOptions block;
  block.polygon_m = {{0.02, cut}, {0.06, cut}, {0.06, 0.08}, {0.02, 0.08}};
  beside.bodies = {{"block", block}};
  for (const Scene& s : {slides, beside}) {
    MotionFrame found[2];
    for (int k = 0; k < 2; ++k) {
      MpmOptions o = options({0, -9.81});
      o.stress_update = k ? StressUpdate::musl : StressUpdate::usl;
      Solver solver(o, s, 1);
      solver.find_initial_equilibrium(silent);
      found[k] = solver.frame();
    }
    EXPECT_TRUE(found[0].field("stress").values == found[1].field("stress").values);
  }
}

// Damping that suits the search for an equilibrium is no part of a run unless the case says so.
TEST(SchemeRows, NoneDamps) {
  for (const SchemeRow& row : scheme_rows) EXPECT_EQ(row.choices.damping, 0) << row.name;
}

}  // namespace
}  // namespace pivnp::mpm
