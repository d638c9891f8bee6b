// The acceleration field of a centrifuge.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/refusal.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {
namespace spun {

using namespace test;

CentrifugeOptions spinning(double rpm, double radius = 2) {
  CentrifugeOptions o;
  o.radius_m = radius;
  o.rate_rpm = rpm;
  return o;
}

TEST(Centrifuge, FieldOfEachAxis) {
  CentrifugeOptions o = spinning(60, 2);
  o.at_m = {0.5, -1};
  const double w = 2 * M_PI;
  const Vec2 x(1, 0), at(0.5, 1);
  EXPECT_LT((Centrifuge(o, false).acceleration(x, 0) - w * w * (x - at)).norm(), 1e-12);
  o.axis = RotationAxis::along;
  EXPECT_LT((Centrifuge(o, false).acceleration(x, 0) - Vec2(0, -w * w)).norm(), 1e-12);
  EXPECT_FALSE(Centrifuge(o, false).coriolis());
  CentrifugeOptions about;
  about.axis = RotationAxis::symmetry;
  about.rate_rpm = 60;
  EXPECT_LT((Centrifuge(about, true).acceleration(x, 0) - Vec2(w * w, 0)).norm(), 1e-12);
}

TEST(Centrifuge, RateFollowsItsHistory) {
  CentrifugeOptions o = spinning(0);
  o.rate_rpm.reset();
  o.rate_history = {{1, 30}, {3, 90}};
  o.euler = true;
  const Centrifuge c(o, false);
  for (const auto& [time, rpm] : {std::pair{0.0, 30.0}, {1.0, 30.0}, {2.0, 60.0}, {3.0, 90.0}, {9.0, 90.0}})
    EXPECT_NEAR(c.rate(time), rpm * 2 * M_PI / 60, 1e-12);
  EXPECT_EQ(c.changes(), (std::vector<double>{1, 3}));
  // Across the radius, against the turn that speeds up.
  EXPECT_NEAR(c.acceleration({0, 0}, 2).x(), -2 * M_PI / 2 * 2, 1e-12);
  EXPECT_EQ(c.acceleration({0, 0}, 4).x(), 0);
}

TEST(Centrifuge, CoriolisTurnsAndDoesNoWork) {
  const Vec2 v(3, -1), n = Centrifuge::turned(v, v, 1e-4);
  EXPECT_NEAR(n.norm(), v.norm(), 1e-14);
  const Centrifuge c(spinning(60), false);
  EXPECT_LT(((n - v) / 1e-4 - c.coriolis(v, 0) / (2 * M_PI)).norm(), 1e-3);
}

// What rests in the laboratory goes round in the model's frame, the other way.
TEST(Centrifuge, ABlockAtRestInTheLaboratoryGoesRound) {
  for (const TransferKind transfer : {TransferKind::flip, TransferKind::apic}) {
    Scene s = scene(Grid{{-1, -1}, {0.05, 0.05}, 41, 41}, {rectangle("block", 0.4, -0.1, 0.6, 0.1)}, {elastic(1e5, 0.3, 1000)});
    CentrifugeOptions field = spinning(60, 1);
    field.at_m = {0, -1};
    s.centrifuge = field;
    const double w = 2 * M_PI;
    for (const Vec2& x : s.particles.x0) s.v0.push_back(w * Vec2(x.y(), -x.x()));
    MpmOptions o = options();
    o.transfer = transfer;
    o.courant = 0.1;
    o.initial_equilibrium = false;
    Solver solver(o, s, 1);
    for (const double turn : {0.1, 0.25}) {
      solver.advance_to(turn, silent);
      const MotionFrame frame = solver.frame();
      Vec2 centre(0.5, 0);
      for (const auto& u : frame.u) centre += Vec2(double(u[0]), double(u[1])) / double(frame.u.size());
      EXPECT_LT((centre - 0.5 * Vec2(std::cos(w * turn), -std::sin(w * turn))).norm(), 2e-3) << turn << " of a turn";
    }
    const EnergyRow e = solver.energy();
    EXPECT_LT(std::abs(e.residual), 3e-3 * e.kinetic);
  }
}

// A swinging basket far from the axis: gravity, growing with depth by 1/radius.
TEST(Centrifuge, AColumnWeighsWhatTheFieldSays) {
  const double radius = 5, w = 10 * M_PI / 3, height = 0.5;  // 100 rpm
  for (const RotationAxis axis : {RotationAxis::across, RotationAxis::along}) {
    Scene s = column(height, elastic(5e6, 0.3, 1600));
    CentrifugeOptions field = spinning(100, radius);
    field.axis = axis;
    s.centrifuge = field;
    MpmOptions o = options();
    o.equilibrium_tolerance = 1e-5;
    Solver solver(o, s, 1);
    solver.find_initial_equilibrium(silent);
    const double y = 0.005;  // middle of the lowest cells
    const double weight = 1600 * w * w * (radius * (height - y) - 0.5 * (height * height - y * y));
    EXPECT_NEAR(mean_stress(solver, 1, 0.01), -weight, 2e-3 * weight);
    solver.advance_to(0.01, silent);  // it is one
    EXPECT_LT(solver.energy().kinetic, 1e-6 * solver.energy().elastic);
  }
}

TEST(Centrifuge, RefusesByName) {
  const auto says = [](const std::function<void(CentrifugeOptions&)>& change, bool axisymmetric = false) {
    CentrifugeOptions o = spinning(60);
    change(o);
    return pivnp::test::refusal([&] { Centrifuge(o, axisymmetric); });
  };
  EXPECT_EQ(says([](CentrifugeOptions&) {}), "");
  EXPECT_NE(says([](CentrifugeOptions& o) { o.axis = RotationAxis::symmetry; }).find("centrifuge.axis"), std::string::npos);
  EXPECT_NE(says([](CentrifugeOptions&) {}, true).find("centrifuge.axis"), std::string::npos);
  EXPECT_NE(says([](CentrifugeOptions& o) { o.radius_m.reset(); }).find("centrifuge.radius_m"), std::string::npos);
  EXPECT_NE(says([](CentrifugeOptions& o) { o.rate_rpm.reset(); }).find("centrifuge.rate_rpm"), std::string::npos);
  EXPECT_NE(says([](CentrifugeOptions& o) { o.rate_history = {{0, 1}}; }).find("centrifuge.rate_rpm"), std::string::npos);
  EXPECT_NE(says([](CentrifugeOptions& o) { o.rate_rpm.reset(), o.rate_history = {{1, 1}, {1, 2}}; }).find("centrifuge.rate_history"), std::string::npos);
  EXPECT_NE(says([](CentrifugeOptions& o) { o.axis = RotationAxis::along, o.coriolis = true; }).find("centrifuge.coriolis"), std::string::npos);
  EXPECT_NE(says([](CentrifugeOptions& o) { o.axis = RotationAxis::along, o.euler = true; }).find("centrifuge.euler"), std::string::npos);
}

}  // namespace spun
}  // namespace
}  // namespace pivnp::mpm
