// Axial symmetry: measure, hoop stress and strain, books, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "mpm/material/model.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"
#include "tests/unit/mpm/material/soil_point.hpp"

namespace pivnp::mpm {
namespace {
namespace about_the_axis {

using namespace test;

MpmOptions round(ShapeKind shape = ShapeKind::bspline, TransferKind transfer = TransferKind::apic, Pair gravity = {0, 0}) {
  MpmOptions o = options(gravity);
  o.geometry = Geometry::axisymmetric;
  o.shape = shape;
  o.transfer = transfer;
  o.initial_equilibrium = false;
  return o;
}

struct Way {
  ShapeKind shape;
  TransferKind transfer;
  StressUpdate stress;
};
const Way ways[] = {{ShapeKind::bspline, TransferKind::apic, StressUpdate::usl},  {ShapeKind::bspline, TransferKind::flip, StressUpdate::usl},
                    {ShapeKind::bilinear, TransferKind::flip, StressUpdate::musl}, {ShapeKind::bilinear, TransferKind::apic, StressUpdate::musl},
                    {ShapeKind::gimp, TransferKind::flip, StressUpdate::musl},     {ShapeKind::bspline, TransferKind::xpic, StressUpdate::usl}};

// A thin ring breathes at sqrt(E/rho)/R, free along the axis.
TEST(Axisymmetric, AThinRingBreathes) {
  const double young = 1e6, rho = 1000, R = 1, h = 0.02, w = std::sqrt(young / rho) / R;
  for (const Way& way : ways) {
    for (const MaterialOptions& m : {elastic(young, 0.3, rho), [&] {
           MaterialOptions n = elastic(young, 0.3, rho);
           n.model = "neo_hookean";
           return n;
         }()}) {
      Scene s = scene(Grid{{0.8, -0.1}, {h, h}, 21, 11}, {rectangle("ring", R - h, -h, R + h, h)}, {m});
      s.v0.assign(s.particles.size(), Vec2(0.01, 0));
      MpmOptions o = round(way.shape, way.transfer);
      o.stress_update = way.stress;
      Solver solver(o, s, 1);
      const double mass = solver.energy().kinetic / (0.5 * 1e-4);
      EXPECT_NEAR(mass, rho * R * 4 * h * h, 1e-6 * mass) << "of a radian";
      // v = v0 cos wt: the mean radial displacement after a quarter and a half of the period.
      const auto mean = [&] {
        const MotionFrame f = solver.frame();
        double sum = 0;
        for (const auto& u : f.u) sum += double(u[0]);
        return sum / double(f.u.size());
      };
      solver.advance_to(M_PI / 2 / w, silent);
      EXPECT_NEAR(mean(), 0.01 / w, 0.02 * 0.01 / w) << name_of(way.shape) << " " << name_of(way.transfer) << " " << m.model;
      solver.advance_to(M_PI / w, silent);
      EXPECT_NEAR(mean(), 0, 0.03 * 0.01 / w) << name_of(way.shape) << " " << name_of(way.transfer) << " " << m.model;
      const EnergyRow e = solver.energy();
      EXPECT_LT(std::abs(e.residual), 0.01 * 0.5 * 1e-4 * mass) << name_of(way.shape) << " " << name_of(way.transfer) << " " << m.model;
    }
  }
}

// Far from the axis a block is a plane one, forces over the radius.
TEST(Axisymmetric, FarFromTheAxisItIsPlane) {
  const double R = 1e5;
  const auto end = [&](bool axial) {
    const double x = axial ? R : 0;
    Scene s = scene(Grid{{x, 0}, {0.1, 0.1}, 11, 9}, {rectangle("sand", x, 0, x + 0.5, 0.5)}, {sand(30)});
    s.boundaries = {{"base", line({x, 0}, {x + 1, 0}, "frictional", 0.3)}, {"wall", line({x, 0}, {x, 0.8}, "roller")}};
    MpmOptions o = round(ShapeKind::bspline, TransferKind::apic, {0, -9.81});
    if (!axial) o.geometry = Geometry::plane;
    o.courant = 0.4;  // left out, plane steps may be longer
    Solver solver(o, s, 1);
    solver.advance_to(0.1, silent);
    return std::pair{solver.frame(), solver.energy()};
  };
  const auto [plane, e] = end(false);
  const auto [axial, a] = end(true);
  for (std::size_t k = 0; k < plane.u.size(); ++k)
    for (std::size_t c = 0; c < 2; ++c) EXPECT_NEAR(double(axial.u[k][c]), double(plane.u[k][c]), 2e-4);
  EXPECT_NEAR(a.external / R, e.external, 0.01 * e.external);
}

// What flies free keeps the momentum along the axis to round-off; the books close.
TEST(Axisymmetric, MomentumAndEnergyOfAThrownBlock) {
  for (const Way& way : ways) {
    if (way.shape == ShapeKind::bilinear && way.transfer == TransferKind::apic) continue;  // no step is stable on noise, in the plane too
    Scene s = scene(Grid{{0, 0}, {0.1, 0.1}, 21, 21}, {rectangle("block", 0.5, 0.5, 1, 1)}, {elastic(1e5, 0.3, 1000)});
    for (std::size_t k = 0; k < s.particles.size(); ++k) s.v0.push_back({0.1 * std::sin(double(k)), 0.2 + 0.1 * std::cos(3.0 * double(k))});
    MpmOptions o = round(way.shape, way.transfer);
    o.stress_update = way.stress;
    Solver solver(o, s, 1);
    const double before = solver.momentum().y();
    solver.advance_to(0.3, silent);
    EXPECT_NEAR(solver.momentum().y(), before, 1e-11 * std::abs(before));
    const EnergyRow e = solver.energy();
    EXPECT_LT(std::abs(e.residual), 0.02 * (e.kinetic + e.elastic + e.damping)) << name_of(way.shape) << " " << name_of(way.transfer);
  }
}

// The weight of all on the base, N a radian: rho g R^2 H/2.
TEST(Axisymmetric, TheBaseCarriesTheWeightOfARadian) {
  const double R = 0.5, H = 0.3, weight = 1600 * 9.81 * H * R * R / 2;
  Scene s = scene(Grid{{0, 0}, {0.05, 0.05}, 15, 10}, {rectangle("soil", 0, 0, R, H)}, {elastic(1e6, 0.3, 1600)});
  s.boundaries = {{"base", line({0, 0}, {0.7, 0}, "roller")}};
  MpmOptions o = round(ShapeKind::bspline, TransferKind::apic, {0, -9.81});
  o.initial_equilibrium = true;
  o.equilibrium_tolerance = 1e-5;
  o.end_at_rest = false;
  Solver solver(o, s, 1);
  ASSERT_EQ(solver.reaction_names(), std::vector<std::string>{"boundary.base"}) << "the axis is no boundary of the case";
  solver.find_initial_equilibrium(silent);
  solver.advance_to(0.1, silent);
  EXPECT_NEAR(solver.reactions().of[0].impulse.y() / 0.1, weight, 1e-3 * weight);
  EXPECT_LT(std::abs(solver.reactions().of[0].impulse.x()), 1e-9 * weight);
}

// A traction on the top pushes a free disc with p R^2/2 a radian; one on the rim pushes along the axis too, with R times its height.
TEST(Axisymmetric, TractionsAreThoseOfARadian) {
  const double R = 0.5, H = 0.3, t = 50, time = 0.05;
  for (const bool on_rim : {false, true}) {
    Scene s = scene(Grid{{0, 0}, {0.05, 0.05}, 15, 13}, {rectangle("disc", 0, 0.1, R, 0.1 + H)}, {elastic(1e5, 0.3, 1600)});
    BoundaryOptions load = on_rim ? line({R, 0.1}, {R, 0.1 + H}, "traction") : line({0, 0.1 + H}, {R, 0.1 + H}, "traction");
    load.traction_pa = Pair{0.0, t};
    s.boundaries = {{"load", load}};
    Solver solver(round(), s, 1);
    solver.advance_to(time, silent);
    const double force = t * (on_rim ? R * H : R * R / 2);
    EXPECT_NEAR(solver.reactions().of[0].impulse.y(), force * time, 1e-6 * force * time);
    EXPECT_NEAR(solver.momentum().y(), force * time, (on_rim ? 2e-2 : 1e-3) * force * time);
  }
}

TEST(Axisymmetric, ACheckpointAndThreadsChangeNoBit) {
  const auto make = [](int threads) {
    Scene s = scene(Grid{{0, 0}, {0.05, 0.05}, 41, 20}, {rectangle("sand", 0, 0, 0.5, 0.6)}, {sand(30)});
    s.boundaries = {{"base", line({0, 0}, {2, 0}, "fixed")}};
    return std::make_unique<Solver>(round(ShapeKind::bspline, TransferKind::apic, {0, -9.81}), s, threads);
  };
  const auto one = make(1), three = make(3), resumed = make(2);
  one->advance_to(0.1, silent);
  resumed->load(one->save());
  three->advance_to(0.1, silent);
  for (Solver* s : {one.get(), three.get(), resumed.get()}) s->advance_to(0.2, silent);
  EXPECT_EQ(one->save(), three->save());
  EXPECT_EQ(one->save(), resumed->save());
}

// Laws know no plane: what strains yy and what strains zz may change places.
TEST(Axisymmetric, LawsTakeTheHoopAsAnyDirection) {
  MaterialOptions clay = elastic(1e7, 0.3, 1600);
  clay.shear_strength_pa = 5e3;
  for (const std::string model : {"linear_elastic", "von_mises", "tresca", "drucker_prager", "mohr_coulomb", "mohr_coulomb_smooth"}) {
    MaterialOptions m = model == "von_mises" || model == "tresca" || model == "linear_elastic" ? clay : soil(model, 30, 1e3);
    m.model = model;
    const auto law = make_material(m, "material.m", 0.1);
    SoilPoint a, b;
    for (int k = 0; k < 200; ++k) {
      const double xx = -4e-5, yy = 1e-5 * (k % 7), zz = -1e-5 * (k % 3) + 2e-5 * (k > 100);
      a.advance(*law, {xx, yy, zz, 0});
      b.advance(*law, {xx, zz, yy, 0});
    }
    const double size = std::abs(a.mean()) + 1;
    EXPECT_NEAR(a.stress[0], b.stress[0], 1e-5 * size) << model;
    EXPECT_NEAR(a.stress[1], b.stress[2], 1e-5 * size) << model;
    EXPECT_NEAR(a.stress[2], b.stress[1], 1e-5 * size) << model;
    EXPECT_NEAR(a.plastic_dev, b.plastic_dev, 1e-5 * (a.plastic_dev + 1e-6)) << model;
  }
}

// A rigid plate pushes the whole of a small specimen's top, however near the axis.
TEST(Axisymmetric, APlateMeetsTheMaterialBesideTheAxis) {
  constexpr double h = 0.0025, radius = 8 * h, height = 8 * h, travel = 0.5 * h;
  const MaterialOptions m = elastic(1e6, 0.3, 1600);
  Scene s = scene(Grid{{0, 0}, {h, h}, 13, 13}, {rectangle("sample", 0, 0, radius, height)}, {m});
  s.boundaries = {{"base", line({0, 0}, {12 * h, 0}, "roller")}};
  RigidOptions plate;
  const double v = 1e-3 * std::sqrt(m.young_pa / m.density_kg_m3);
  plate.polygon_m = {{0, height}, {10 * h, height}, {10 * h, height + 2 * h}, {0, height + 2 * h}};
  plate.velocity_m_s = {0, -v};
  plate.friction = 0;
  s.bodies = {{"plate", plate}};
  Solver solver(round(), s, 1);
  solver.advance_to(travel / v, silent);
  const MotionFrame f = solver.frame();
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const Vec2 x = solver.particles().x0[k];
    if (x.y() < height - 0.5 * h) continue;
    EXPECT_NEAR(double(f.u[k][1]), -travel * x.y() / height, 0.05 * h) << x.transpose();
  }
  EXPECT_NEAR(-solver.body_impulse(0).y() * v / travel, 0.5 * m.young_pa * travel / height / 2 * radius * radius,
              0.1 * 0.5 * m.young_pa * travel / height / 2 * radius * radius);  // of a radian; half of the last force on average
}

TEST(Axisymmetric, RefusesByName) {
  const auto says = [](const std::function<void(Scene&, MpmOptions&)>& change) {
    Scene s = scene(Grid{{0, 0}, {0.1, 0.1}, 11, 11}, {rectangle("soil", 0, 0, 0.5, 0.5)}, {elastic(1e6, 0.3, 1600)});
    MpmOptions o = round();
    change(s, o);
    return pivnp::test::refusal([&] { Solver(o, s, 1); });
  };
  const auto body = [](Scene& s) -> RigidOptions& {
    RigidOptions b;
    b.polygon_m = {{0, 0.5}, {0.3, 0.5}, {0.3, 0.8}, {0, 0.8}};
    s.bodies = {{"plate", b}};
    return s.bodies.back().second;
  };
  EXPECT_EQ(says([](Scene&, MpmOptions&) {}), "");
  EXPECT_EQ(says([&](Scene& s, MpmOptions&) { body(s).velocity_m_s = {0, -1}; }), "");
  const std::vector<std::pair<std::string, std::function<void(Scene&, MpmOptions&)>>> wrong = {
      {"mpm.gravity_m_s2", [](Scene&, MpmOptions& o) { o.gravity_m_s2 = {1, -9}; }},
      {"mpm.locking", [](Scene&, MpmOptions& o) { o.shape = ShapeKind::bilinear, o.locking = Locking::selective; }},
      {"mpm.sleep_below_m_s", [](Scene&, MpmOptions& o) { o.sleep_below_m_s = 1e-3; }},
      {"mpm.domain_m", [](Scene& s, MpmOptions&) { s.grid.origin.x() = -0.1; }},
      {"heat", [](Scene& s, MpmOptions&) { s.heat.emplace(); }},
      {"contact.c", [](Scene& s, MpmOptions&) { s.contacts = {{"c", {}}}; }},
      {"boundary.t.type", [](Scene& s, MpmOptions&) { s.boundaries = {{"t", line({0, 0}, {0, 1}, "tied")}}; }},
      {"body.plate.mass_kg_m", [&](Scene& s, MpmOptions&) { body(s).mass_kg_m = 1; }},
      {"body.plate.velocity_m_s", [&](Scene& s, MpmOptions&) { body(s).velocity_m_s = {1, 0}; }},
  };
  for (const auto& [key, change] : wrong) EXPECT_EQ(says(change).substr(0, key.size()), key);
}

}  // namespace about_the_axis
}  // namespace
}  // namespace pivnp::mpm
