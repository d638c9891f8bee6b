// Water about an axis of symmetry (docs/theory/mpm_axisymmetric.md#water).
//
// 1. Steady flow to a well that is as deep as the layer it drains, between radii a and b (Thiem 1906): pressures with ln r, discharge
//    2 pi K H dh/ln(b/a). Criterion: pressures at the points within 1 % of what drives the flow, with order 1.5 in h at least;
//    discharge within 1 %; and in time it stays as it is.
// 2. The same with a surface inside (Dupuit 1863; exact, as Charny 1951 shows for dams): pi K (H^2 - h^2)/ln(b/a). Criterion: 3 %.
// 3. de Leeuw 1965 (Proc. 6th Int. Conf. Soil Mech. 1:287): a solid cylinder between smooth plates, loaded and drained at its rim. In its middle
//    pressure rises before it falls, as in Cryer's sphere. Criterion: rise within .01 of p0, pressures within 1 % of p0, radius
//    within 1 % of what it changes by.
// 4. Terzaghi's column about the axis: pressures within 1 % of p0 at every point, the axis among them, and settlements within 1 %.
// 5. Rough circular footing, undrained: the bearing capacity of dry soil of nu .499 on the same cells within 3 %, checkerboard below 3 %.
// In small, for every build: coarse forms of 1 to 4.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "mpm/state/scheme_rows.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {
namespace wet_axis {

using namespace test;

constexpr ShapeKind shapes[] = {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline};

MpmOptions about_axis(ShapeKind shape, PressureScheme pressure, Pair gravity = {0, 0}) {
  WaterColumn c;
  c.about_axis = true;
  c.shape = shape;
  c.pressure = pressure;
  if (shape == ShapeKind::bilinear) c.transfer = TransferKind::flip, c.stress = StressUpdate::musl;
  MpmOptions o = options_of(c);
  o.gravity_m_s2 = gravity;
  return o;
}

struct Well {
  double inner = 0.25, outer = 1, permeability = 1e-3, low = 2e3, high = 9e3, bulk = 8e6;
  int cells = 12;  // between the radii
  ShapeKind shape = ShapeKind::bspline;
  PressureScheme pressure = PressureScheme::in_steps;
};

struct ToWell {
  double start, later, discharge, dissipated;  // largest error of pressure over what drives the flow; over the exact ones
};

ToWell flow_to(const Well& w) {
  const double h = (w.outer - w.inner) / w.cells, height = 2 * h;
  const MaterialOptions m = saturated(1e7, 0.25, 0.35, w.permeability);
  Scene s = scene(Grid{{w.inner, 0}, {h, h}, w.cells + 1, 3}, {rectangle("soil", w.inner, 0, w.outer, height)}, {m});
  s.water.emplace();
  s.water->bulk_modulus_pa = w.bulk;
  s.water->start = WaterStart::seepage;
  // (Held all around: the flow alone is looked at.)
  s.boundaries = {{"low", line({w.inner, 0}, {w.outer, 0}, "roller")},
                  {"high", line({w.inner, height}, {w.outer, height}, "roller")},
                  {"well", line({w.inner, 0}, {w.inner, height}, "roller")},
                  {"far", line({w.outer, 0}, {w.outer, height}, "roller")}};
  s.boundaries[2].second.pressure_pa = w.low;
  s.boundaries[3].second.pressure_pa = w.high;
  Solver solver(about_axis(w.shape, w.pressure), s, 1);
  const double head = (w.high - w.low) / std::log(w.outer / w.inner), through = w.permeability / 9810 * head;  // a radian, a metre
  const auto error = [&] {
    const MotionFrame f = solver.frame();
    double worst = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k)
      worst = std::max(worst, std::abs(double(f.field("pressure")(k, 0)) - w.low - head * std::log(s.particles.x0[k].x() / w.inner)));
    return worst / (w.high - w.low);
  };
  ToWell found{error(), 0, 0, 0};
  const double modulus = 1.2e7, c = w.permeability / 9810 / (0.35 / w.bulk + 1 / modulus), time = 2 * std::pow(w.outer - w.inner, 2) / c;
  solver.advance_to(time, silent);
  const EnergyRow before = solver.energy();
  solver.advance_to(1.5 * time, silent);
  const EnergyRow after = solver.energy();
  found.later = error();
  found.dissipated = (after.darcy - before.darcy) / (0.5 * time) / (through * height * (w.high - w.low));
  const MotionFrame f = solver.frame();
  for (std::size_t k = 0; k < f.u.size(); ++k)
    found.discharge -= s.particles.x0[k].x() * double(f.field("water_flow")(k, 0)) / double(f.u.size()) / through;
  EXPECT_LT(std::abs(after.water_inflow - before.water_inflow), 2e-3 * 1000 * through * height * 0.5 * time);
  return found;
}

double order(double coarse, double fine) { return std::log2(coarse / fine); }

TEST(MpmWetAxisSmall, SteadyFlowToAWell) {
  Well w;
  w.cells = 6;
  const ToWell coarse = flow_to(w);
  w.cells = 12;
  const ToWell fine = flow_to(w);
  std::printf("well, 6 and 12 cells: %.2e, %.2e at the start, %.2e, %.2e later, discharge %.4f, dissipated %.4f\n", coarse.start, fine.start, coarse.later, fine.later,
              fine.discharge, fine.dissipated);
  EXPECT_GT(order(coarse.start, fine.start), 1.5);
  EXPECT_LT(fine.later, 0.01);
  EXPECT_NEAR(fine.discharge, 1, 0.01);
  EXPECT_NEAR(fine.dissipated, 1, 0.01);
}

TEST(MpmWetAxis, SteadyFlowToAWell) {
  for (const PressureScheme pressure : schemes)
    for (const ShapeKind shape : shapes) {
      Well w;
      w.shape = shape;
      w.pressure = pressure;
      w.inner = 0.1;
      w.permeability = 2e-3;
      w.cells = 12;
      const ToWell coarse = flow_to(w);
      w.cells = 24;
      const ToWell fine = flow_to(w);
      const double at_start = order(coarse.start, fine.start), later = order(coarse.later, fine.later);
      pivnp::test::verification_row("steady flow to a well, b = 10 a, " + std::string(name_of(pressure)) + ", " + std::string(name_of(shape)) + ", 24 cells",
                                    "p within 1 % of what drives it, order 1.5 in h; discharge within 1 % of 2 pi K H dh/ln(b/a)",
                                    number(100 * fine.start, 2) + " % at the start, " + number(100 * fine.later, 2) + " % in time, orders " + number(at_start, 3) + ", " +
                                        number(later, 3) + "; discharge " + number(fine.discharge, 5) + ", dissipated " + number(fine.dissipated, 5));
      EXPECT_GT(at_start, 1.5);
      EXPECT_LT(fine.start, 0.01);
      EXPECT_LT(fine.later, 0.01);
      EXPECT_NEAR(fine.discharge, 1, 0.01);
      EXPECT_NEAR(fine.dissipated, 1, 0.01);
    }
}

struct Unconfined {
  double discharge, balance, lowest;  // over Dupuit's; inflow less outflow over it; Pa
};

// `times`: of the surface, n L^2/(K H).
Unconfined drained_by_a_well(double inner, int cells, double high, double low, double start, ShapeKind shape, double times) {
  const double outer = 1.2, height = 1, h = height / cells, permeability = 0.1;
  const int across = int(std::lround((outer - inner) / h));
  Scene s = scene(Grid{{inner, 0}, {h, h}, across + 1, cells + 3}, {rectangle("soil", inner, 0, inner + across * h, height)}, {saturated(1e6, 0.2, 0.3, permeability)});
  s.water.emplace();
  s.water->bulk_modulus_pa = 1e5;
  s.water->level_m = start;
  const double end = inner + across * h;
  s.boundaries = {{"base", line({inner, 0}, {end, 0}, "fixed")},
                  {"well", line({inner, 0}, {inner, height + 2 * h}, "roller")},
                  {"far", line({end, 0}, {end, height + 2 * h}, "roller")}};
  s.boundaries[1].second.water_level_m = low;
  s.boundaries[2].second.water_level_m = high;
  MpmOptions o = about_axis(shape, PressureScheme::in_steps, {0, -9.81});
  o.k0 = 0.5;
  o.courant = 0.4;
  Solver solver(o, s, 1);
  const EnergyRow first = solver.energy();
  const double time = 0.3 * (end - inner) * (end - inner) / (permeability * high);
  solver.advance_to((times - 0.2) * time, silent);
  const EnergyRow a = solver.energy();
  EXPECT_LT(std::abs(a.water_mass - first.water_mass - a.water_inflow), 1e-9 * first.water_mass);
  const MotionFrame f = solver.frame();
  double flow = 0, area = 0, lowest = 0;
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    lowest = std::min(lowest, double(f.field("pressure")(k, 0)));
    const double r = s.particles.x0[k].x(), at = (r - inner) / (end - inner);
    if (at < 0.3 || at > 0.7) continue;
    flow -= double(s.particles.area[k]) * r * double(f.field("water_flow")(k, 0));
    area += double(s.particles.area[k]);
  }
  const double dupuit = permeability * (high * high - low * low) / 2 / std::log(end / inner);
  solver.advance_to(times * time, silent);
  const double net = (solver.energy().water_inflow - a.water_inflow) / 1000 / (0.2 * time);
  return {flow / (area / height) / dupuit, net / dupuit, lowest};
}

TEST(MpmWetAxisSmall, AWellBelowTheWatersSurface) {
  const Unconfined u = drained_by_a_well(0.4, 12, 0.8, 0.4, 0.6, ShapeKind::bilinear, 2.6);
  std::printf("well below the surface, 12 cells, filled: discharge %.4f of Dupuit's, net %.4f, lowest %.3g\n", u.discharge, u.balance, u.lowest);
  EXPECT_NEAR(u.discharge, 1, 0.03);
  EXPECT_NEAR(u.balance, 0, 0.02);
  EXPECT_GE(u.lowest, 0);
}

TEST(MpmWetAxis, AWellBelowTheWatersSurface) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    double worst = 0;
    for (const double start : {0.35, 0.85}) {
      const Unconfined u = drained_by_a_well(0.3, 20, 0.85, 0.35, start, shape, 4);
      worst = std::max(worst, std::abs(u.discharge - 1));
      EXPECT_NEAR(u.balance, 0, 0.02);
      EXPECT_GE(u.lowest, 0);
    }
    pivnp::test::verification_row("well below the water's surface, b = 4 a, " + std::string(name_of(shape)) + ", 20 cells, filled and drained to the steady surface",
                                  "discharge within 3 % of pi K (H^2 - h^2)/ln(b/a)", number(100 * worst, 2) + " %");
    EXPECT_LT(worst, 0.03);
  }
}

/// de Leeuw's cylinder, grains that do not change their volume. With e the volumetric strain, M e = p + f(t) (u_r has no curl), and with the
/// mean stress q at the rim f (1 - G/M) = -q + (G/M) mean p; so p_t + m (mean p)_t = c lap p, whose modes J0(x r/a) - J0(x) with (1 + m) J0(x)
/// = 2 m J1(x)/x are orthogonal in 1 + m mean.
struct DeLeeuw {
  double young, poisson, storage;  // n/K_w
  std::vector<double> roots = {};

  double shear() const { return young / 2 / (1 + poisson); }
  double modulus() const { return young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson)); }
  double ratio() const { return shear() / modulus(); }
  double coupling() const { return ratio() / ((1 - ratio()) * (1 + storage * modulus())); }
  double undrained_share() const { return 1 / (1 + storage * modulus() * (1 - ratio())); }  // p0 over the load

  explicit DeLeeuw(double e, double nu, double s) : young(e), poisson(nu), storage(s) {
    const double m = coupling();
    const auto f = [m](double x) { return (1 + m) * std::cyl_bessel_j(0, x) - 2 * m * std::cyl_bessel_j(1, x) / x; };
    for (double low = 0.01; roots.size() < 60; low += 0.05) {
      if (f(low) * f(low + 0.05) > 0) continue;
      double a = low, b = low + 0.05;
      for (int i = 0; i < 60; ++i) (f(a) * f(0.5 * (a + b)) <= 0 ? b : a) = 0.5 * (a + b);
      roots.push_back(a);
    }
  }
  template <class Shape>
  double sum(double T, Shape&& shape) const {
    double all = 0;
    for (const double x : roots) {
      const double j0 = std::cyl_bessel_j(0, x), j1 = std::cyl_bessel_j(1, x);
      all += j1 / x / (0.5 * (j0 * j0 + j1 * j1) - j0 * j1 / x) * shape(x, j0, j1) * std::exp(-x * x * T);
    }
    return all;
  }
  /// Over p0; r over the radius, T = c t/a^2.
  double pressure(double r, double T) const {
    return sum(T, [r](double x, double j0, double) { return std::cyl_bessel_j(0, x * r) - j0; });
  }
  /// Of the rim, over load times radius over M.
  double displacement(double T) const {
    const double mean = undrained_share() * sum(T, [](double x, double j0, double j1) { return 2 * j1 / x - j0; });
    return 0.5 * (mean + (-1 + ratio() * mean) / (1 - ratio()));
  }
};

struct Cylinder {
  double rise, expected, pressure, displacement;  // over p0; over that at the end
};

Cylinder squeeze(ShapeKind shape, PressureScheme pressure, double young, double poisson, double permeability, double stiff, int cells, double until = 0.5) {
  const double porosity = 0.38;
  WaterColumn c;
  c.about_axis = true;
  c.young = young;
  c.poisson = poisson;
  c.porosity = porosity;
  c.permeability = permeability;
  c.shape = shape;
  c.pressure = pressure;
  c.bulk = stiff * porosity * c.modulus();
  if (shape == ShapeKind::bilinear) c.transfer = TransferKind::flip, c.stress = StressUpdate::musl;
  const DeLeeuw exact(young, poisson, porosity / c.bulk);
  const double radius = std::max(400 * permeability * cells, 2000 * c.consolidation() / std::sqrt(c.modulus() / c.density()));
  const double h = radius / cells, load = 1e-4 * c.modulus(), unit = radius * radius / c.consolidation(), height = 3 * h;
  Scene s = scene(Grid{{0, 0}, {h, h}, cells + 3, 4}, {rectangle("soil", 0, 0, radius, height)}, {saturated(young, poisson, porosity, permeability)});
  s.water.emplace();
  s.water->bulk_modulus_pa = c.bulk;
  BoundaryOptions rim = line({radius, 0}, {radius, height}, "traction");
  rim.traction_pa = Pair{-load, 0.0};
  rim.rise_s = 0.02 * unit;
  rim.drained = true;
  s.boundaries = {{"low", line({0, 0}, {radius + 2 * h, 0}, "roller")}, {"high", line({0, height}, {radius + 2 * h, height}, "roller")}, {"rim", rim}};
  Solver solver(options_of(c), s, 1);
  const EnergyRow start = solver.energy();
  Cylinder found{0, 0, 0, 0};
  const double p0 = exact.undrained_share() * load, end = load * radius / c.modulus() * exact.displacement(50);
  for (const double T : {0.03, 0.045, 0.06, 0.075, 0.1, 0.15, 0.2, 0.3, 0.5}) {
    if (T > until) break;
    solver.advance_to((T + 0.01) * unit, silent);
    const MotionFrame f = solver.frame();
    double centre = 0, n = 0, at_centre = 0, rim_u = 0, rims = 0, rim_r = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double r = s.particles.x0[k].x() / radius, p = double(f.field("pressure")(k, 0)) / p0;
      if (T >= 0.075) found.pressure = std::max(found.pressure, std::abs(p - exact.pressure(r, T)));
      if (r * cells < 0.5) centre += p, ++n, at_centre += r;
      if (r > 1 - 0.5 / cells) rim_u += double(f.u[k][0]), ++rims, rim_r += r;
    }
    found.rise = std::max(found.rise, centre / n);
    found.expected = std::max(found.expected, exact.pressure(at_centre / n, T));
    // u at the rim from its outermost points: du/dr there is e - u/a, little over so short a way.
    const double away = 1 - rim_r / rims, u = load * radius / c.modulus() * exact.displacement(T);
    const double mean_strain = 2 * u / radius, e_rim = load / c.modulus() * (-1 + exact.ratio() * mean_strain * c.modulus() / load);
    const double expected = u - away * radius * (e_rim - u / radius);
    if (T >= 0.075) found.displacement = std::max(found.displacement, std::abs(rim_u / rims - expected) / std::abs(end));
  }
  const EnergyRow e = solver.energy();
  EXPECT_LT(std::abs(e.water_mass - start.water_mass - e.water_inflow), 1e-12 * start.water_mass);
  EXPECT_LT(std::abs(e.residual), (pressure == PressureScheme::projected ? 0.25 : 0.03) * std::abs(e.external));
  return found;
}

void expect_squeezed(const Cylinder& c, double within) {
  EXPECT_NEAR(c.rise, c.expected, within);
  EXPECT_LT(c.pressure, within);
  EXPECT_LT(c.displacement, 0.01);
}

TEST(MpmWetAxisSmall, DeLeeuwsCylinder) {
  const DeLeeuw exact(1e7, 0, 1e-12);
  EXPECT_NEAR(exact.undrained_share(), 1, 1e-4);
  EXPECT_NEAR(exact.pressure(0.3, 1e-3), 1, 0.05);
  EXPECT_NEAR(exact.displacement(20), -0.5 / (1 - 0.5), 1e-9);  // drained: -q a/(2 (K + G/3))
  for (const PressureScheme pressure : schemes) {
    const Cylinder c = squeeze(ShapeKind::bspline, pressure, 1e7, 0.2, 1e-6, 100, 10, 0.1);
    std::printf("de Leeuw, %s, 10 cells: rise %.4f (%.4f), pressure %.4f, rim %.4f\n", std::string(name_of(pressure)).c_str(), c.rise, c.expected, c.pressure, c.displacement);
    expect_squeezed(c, 0.02);
  }
}

TEST(MpmWetAxis, DeLeeuwsCylinder) {
  for (const PressureScheme pressure : schemes)
    for (const ShapeKind shape : shapes)
      for (const double poisson : {0.0, 0.33}) {
        const Cylinder c = squeeze(shape, pressure, poisson < 0.3 ? 2e7 : 3e6, poisson, poisson < 0.3 ? 1e-6 : 1e-8, 100, 16);
        pivnp::test::verification_row("de Leeuw's cylinder, " + std::string(name_of(pressure)) + ", " + std::string(name_of(shape)) + ", nu " + number(poisson, 2) + ", 16 cells",
                                      "rise in the middle within .01 of " + number(c.expected, 4) + ", pressure within 1 % of p0, rim within 1 %",
                                      number(c.rise, 4) + "; " + number(100 * c.pressure, 2) + " %, " + number(100 * c.displacement, 2) + " %");
        expect_squeezed(c, 0.01);
      }
}

TEST(MpmWetAxis, DeLeeuwsCylinderOrderInTheCell) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    double error[3];
    for (const int k : {0, 1, 2}) error[k] = squeeze(shape, PressureScheme::in_steps, 1e7, 0.2, 1e-6, 100, 8 << k).pressure;
    const double order = 0.5 * std::log2(error[0] / error[2]);
    pivnp::test::verification_row("de Leeuw's cylinder, explicit, " + std::string(name_of(shape)) + ", 8 to 32 cells", "pressure: order in h at least 1.5",
                                  number(order, 3) + ", " + number(100 * error[2], 2) + " % of p0 with 32 cells");
    EXPECT_GT(order, 1.5);
  }
}

struct Bearing {
  double capacity, checkerboard;  // over the strength; over the mean, of pressure or mean stress
};

// A rough circular footing of radius 1 on clay; its nodes sink at a speed.
Bearing footing(int cells, ShapeKind shape, bool wet) {
  const double h = 1.0 / cells, strength = 1200, poisson = wet ? 0.3 : 0.499, shear = 2.3e5, young = 2 * shear * (1 + poisson), wide = 3.5, deep = 2;
  MaterialOptions m = wet ? saturated(young, poisson, 0.4, 0, 2667) : elastic(young, poisson, 2000);
  m.model = "tresca";
  m.shear_strength_pa = strength;
  const int nx = int(std::lround(wide / h)), ny = int(std::lround(deep / h));
  Scene s = scene(Grid{{0, 0}, {h, h}, nx + 1, ny + cells / 2 + 1}, {rectangle("clay", 0, 0, wide, deep)}, {m});
  const double top = deep + cells / 2 * h;
  if (wet) {
    s.water.emplace();
    s.water->bulk_modulus_pa = 0.4 * 2 * shear * 1.4993 / (3 * (1 - 2 * 0.4993));  // the mixture's nu is 0.4993
  }
  const double v = 0.0006 * std::sqrt(shear * 50 / 2000);
  s.boundaries = {{"low", line({0, 0}, {wide, 0}, "roller")},
                  {"rim", line({wide, 0}, {wide, top}, "roller")},
                  {"footing", line({0, deep}, {1, deep}, "fixed")}};
  s.boundaries.back().second.velocity_m_s = Pair{0, -v};
  MpmOptions o = about_axis(shape, PressureScheme::in_steps);
  if (!wet) o.pressure = std::nullopt;
  o.damping = 0;
  o.courant = std::nullopt;
  Solver solver(o, s, 2);
  double external[2] = {0, 0}, alternating = 0, size = 0;
  for (const double time : {0.05, 0.06, 0.07, 0.08}) {
    solver.advance_to(time / v, silent);
    external[time > 0.05] = solver.energy().external;
    std::map<std::pair<int, int>, std::pair<double, int>> of_cell;
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      auto& [sum, n] = of_cell[{int(s.particles.x0[k].x() / h), int(s.particles.x0[k].y() / h)}];
      sum += wet ? double(f.field("pressure")(k, 0)) : -double(f.field("stress")(k, 0) + f.field("stress")(k, 1) + f.field("stress")(k, 2)) / 3;
      ++n;
    }
    const auto mean = [&](int i, int j) {
      const auto& [sum, n] = of_cell.at({i, j});
      return sum / n;
    };
    for (int j = ny - 2 - cells; j < ny - 2; ++j)
      for (int i = 1; i + 1 < cells; ++i) {
        double q = 0;
        for (int a = -1; a < 2; ++a)
          for (int b = -1; b < 2; ++b) q += (a ? 1 : -2) * (b ? 1 : -2) * mean(i + a, j + b) / 16;
        alternating += std::abs(q);
        size += std::abs(mean(i, j));
      }
  }
  return {(external[1] - external[0]) / 0.03 / (0.5 * strength), alternating / size};  // a radian of the circle: R^2/2
}

TEST(MpmWetAxis, UndrainedCircularFooting) {
  for (const ShapeKind shape : shapes) {
    const Bearing dry = footing(8, shape, false), wet = footing(8, shape, true);
    pivnp::test::verification_row("circular footing, undrained, explicit, " + std::string(name_of(shape)) + ", h = R/8",
                                  "bearing capacity within 3 % of the dry soil's with nu .499, checkerboard below 3 %",
                                  number(wet.capacity, 4) + " (dry " + number(dry.capacity, 4) + "), " + number(100 * wet.checkerboard, 2) + " % (dry " +
                                      number(100 * dry.checkerboard, 2) + " %)");
    EXPECT_NEAR(wet.capacity, dry.capacity, 0.03 * dry.capacity);
    EXPECT_LT(wet.checkerboard, 0.03);
  }
}

}  // namespace wet_axis
}  // namespace
}  // namespace pivnp::mpm
