// Consolidation beyond Terzaghi's column.
//
// 1. Mandel 1953 (Geotechnique 3:287): a block between smooth rigid plates, drained at its sides. In its middle pressure rises before it
//    falls. A block three times as high as it is wide, loaded evenly, has that in its middle plane (Saint-Venant), whatever pushes its ends.
//    Criterion: the rise at the centre within .01, and the times at which pressure falls to what it is at T .2 and 1 within 2 %.
// 2. A column compressed by a third: pressures at T .1, .3, .7 within 2 % of the load, and settlements within 2 %, of the one-dimensional
//    finite-strain solution (tests/support/finite_consolidation.hpp).
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "mpm/state/scheme_rows.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/finite_consolidation.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

/// Mandel's solution for grains that do not change their volume.
struct Mandel {
  double young, poisson, storage;  // n/K_w

  double shear() const { return young / 2 / (1 + poisson); }
  double bulk() const { return young / 3 / (1 - 2 * poisson); }
  double modulus() const { return bulk() + 4 * shear() / 3; }
  double undrained_poisson() const {
    const double k = bulk() + 1 / storage;
    return (3 * k - 2 * shear()) / (2 * (3 * k + shear()));
  }
  double undrained_share() const { return (1 + undrained_poisson()) / (3 * (1 + bulk() * storage)); }  // p0 over the mean load
  /// Pressure over p0 at a distance from the middle over the half width, T = c t/a^2.
  double pressure(double x, double T) const {
    const double ratio = (1 - poisson) / (undrained_poisson() - poisson);
    double sum = 0;
    for (int k = 0; k < 200; ++k) {
      double low = k * M_PI + 1e-9, high = k * M_PI + M_PI / 2 - 1e-12;
      for (int i = 0; i < 80; ++i) {
        const double middle = 0.5 * (low + high);
        (std::tan(middle) < ratio * middle ? low : high) = middle;
      }
      const double a = low;
      sum += 2 * std::sin(a) / (a - std::sin(a) * std::cos(a)) * (std::cos(a * x) - std::cos(a)) * std::exp(-a * a * T);
    }
    return sum;
  }
};

struct MandelFound {
  double rise, expected;  // of the pressure at the centre, over p0
  double late[2];         // times, over the exact ones
};

MandelFound mandel(ShapeKind shape, PressureScheme pressure, double young, double poisson, double permeability, double stiff, int cells) {
  WaterColumn c;
  c.young = young;
  c.poisson = poisson;
  c.porosity = 0.4;
  c.permeability = permeability;
  c.shape = shape;
  c.pressure = pressure;
  c.bulk = stiff * c.porosity * c.modulus();
  if (shape == ShapeKind::bilinear) c.transfer = TransferKind::flip, c.stress = StressUpdate::musl;
  const Mandel exact{young, poisson, c.porosity / c.bulk};
  const double half = std::max(400 * permeability * cells, 2000 * c.consolidation() / std::sqrt(c.modulus() / c.density()));
  const double h = half / cells, load = 1e-4 * c.modulus(), unit = half * half / c.consolidation();  // of T
  Scene s = scene(Grid{{0, 0}, {h, h}, cells + 3, 3 * cells + 3}, {rectangle("soil", 0, 0, half, 3 * half)},
                  {saturated(young, poisson, c.porosity, permeability)});
  s.water.emplace();
  s.water->bulk_modulus_pa = c.bulk;
  BoundaryOptions top = line({0, 3 * half}, {half, 3 * half}, "traction");
  top.traction_pa = {0, -load};
  top.rise_s = 0.02 * unit;
  s.boundaries = {{"base", line({0, 0}, {half + 2 * h, 0}, "roller")}, {"left", line({0, 0}, {0, 3 * half + 2 * h}, "roller")}, {"load", top}};
  Solver solver(options_of(c), s, 1);
  const auto centre = [&](double T) {
    solver.advance_to((T + 0.01) * unit, silent);
    const MotionFrame f = solver.frame();
    double sum = 0, n = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k)
      if (s.particles.x0[k].x() < 0.4 * h && s.particles.x0[k].y() < h) sum += double(f.field("pressure")(k, 0)), ++n;
    return sum / n / (exact.undrained_share() * load);
  };
  const double at = 0.25 / cells;  // of those points
  MandelFound found{0, 0, {0, 0}};
  double before = 0, T = 0;
  int passed = 0;
  for (int step = 1; passed < 2 && T < 1.3; ++step) {
    T = step < 50 ? 0.004 * step : 0.2 + 0.02 * (step - 50);
    const double p = centre(T), last = step < 51 ? T - 0.004 : T - 0.02;
    if (T > 0.04) found.rise = std::max(found.rise, p);  // (once the waves of the load have died out)
    found.expected = std::max(found.expected, exact.pressure(at, T));
    const double end = passed == 0 ? 0.2 : 1.0, value = exact.pressure(at, end);
    if (T > 0.08 && before >= value && p < value) found.late[passed++] = (last + (before - value) / (before - p) * (T - last)) / end;
    before = p;
  }
  return found;
}

void expect_mandel(const MandelFound& m) {
  EXPECT_NEAR(m.rise, m.expected, 0.01);
  for (const double late : m.late) EXPECT_NEAR(late, 1, 0.02);
}

TEST(MpmMandelSmall, RisesBeforeItFalls) {
  EXPECT_NEAR((Mandel{1e7, 0.2, 0.4 / 2.2e9}.pressure(0, 0.072)), 1.1067, 1e-4);
  EXPECT_NEAR((Mandel{1e7, 0.2, 0.4 / 2.2e9}.pressure(0, 1)), 0.2585, 1e-4);
  const MandelFound m = mandel(ShapeKind::bilinear, PressureScheme::projected, 1e7, 0.2, 1e-6, 100, 10);
  std::printf("Mandel, projected, 10 cells: rise %.4f (%.4f), times %.3f %.3f\n", m.rise, m.expected, m.late[0], m.late[1]);
  expect_mandel(m);
}

TEST(MpmMandel, RisesBeforeItFalls) {
  for (const PressureScheme pressure : schemes)
    for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline})
      for (const double poisson : {0.2, 0.35}) {
        const MandelFound m = mandel(shape, pressure, poisson < 0.3 ? 1e7 : 4e6, poisson, poisson < 0.3 ? 1e-6 : 1e-8, 100, 10);
        pivnp::test::verification_row("Mandel, " + std::string(name_of(pressure)) + ", " + std::string(name_of(shape)) + ", nu " + number(poisson, 2) + ", 10 cells",
                                      "rise at the centre within .01 of " + number(m.expected, 4) + ", ratio of p to the exact one at T .2 and 1 within 2 %",
                                      number(m.rise, 4) + "; " + number(m.late[0], 4) + ", " + number(m.late[1], 4));
        expect_mandel(m);
      }
}

struct LargeStrain {
  double pressure = 0, settlement = 0, third = 0;  // over the load, over the exact one; of the height at the end
};

LargeStrain large_strain(ShapeKind shape, PressureScheme pressure, double young, double poisson, double porosity, double permeability,
                         double stiff, int cells, const std::vector<double>& times) {
  WaterColumn c;
  c.young = young;
  c.poisson = poisson;
  c.porosity = porosity;
  c.permeability = permeability;
  c.cells = cells;
  c.shape = shape;
  c.locking = Locking::none;  // (a column does not lock)
  c.pressure = pressure;
  c.bulk = stiff * porosity * c.modulus();
  if (shape == ShapeKind::bilinear) c.transfer = TransferKind::flip, c.stress = StressUpdate::musl;
  if (shape == ShapeKind::gimp) c.locking = Locking::fbar, c.courant = 0.4;  // the default's averages and steps
  c.height = std::max(400 * permeability * cells, 2000 * c.consolidation() / std::sqrt(c.modulus() / c.density()));
  c.load = -std::log(2.0 / 3) * 1.5 * c.modulus();  // J tends to 2/3
  c.rise = 1e-3;
  const Scene s = scene_of(c);
  const pivnp::test::FiniteConsolidation exact{c.height, c.modulus(), porosity, c.bulk, c.load, permeability / 9810};
  Solver solver(options_of(c), s, 1);
  LargeStrain worst{0, 0, 1 - exact.end()};
  for (const double T : times) {
    solver.advance_to(c.at(T + 0.5 * c.rise), silent);
    const auto state = exact.at(c.at(T));
    const MotionFrame f = solver.frame();
    double sunk = 0, top = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double y = s.particles.x0[k].y() / c.height, place = y * double(state.pressure.size()) - 0.5;
      const auto i = std::min(state.pressure.size() - 2, std::size_t(std::max(0.0, place)));
      const double t = place - double(i), p = (1 - t) * state.pressure[i] + t * state.pressure[i + 1];
      worst.pressure = std::max(worst.pressure, std::abs(double(f.field("pressure")(k, 0)) - p) / c.load);
      if (y < top) continue;
      if (y > top) sunk = 0;
      top = y;
      sunk = -double(f.u[k][1]) / c.height;
    }
    // (The top of the column is a quarter of a cell above its uppermost points, compressed as the top is, to which pressure is zero.)
    sunk += (1 - top) * (1 - exact.end());
    worst.settlement = std::max(worst.settlement, std::abs(sunk - state.settlement / c.height) / (state.settlement / c.height));
  }
  return worst;
}

void expect_within(const LargeStrain& d) {
  EXPECT_NEAR(d.third, 1.0 / 3, 1e-9);
  EXPECT_LT(d.pressure, 0.02);
  EXPECT_LT(d.settlement, 0.02);
}

// (Projected, points that have lost a third of their volume run dry: docs/limits.md.)
TEST(MpmLargeConsolidationSmall, CompressedByAThird) {
  const LargeStrain d = large_strain(ShapeKind::bspline, PressureScheme::in_steps, 1e6, 0.3, 0.5, 1e-6, 10, 12, {0.1});
  std::printf("large-strain consolidation, 12 cells, T .1: pressure %.4f, settlement %.4f\n", d.pressure, d.settlement);
  expect_within(d);
}

TEST(MpmLargeConsolidation, CompressedByAThird) {
  for (const auto& [shape, name, cells] :
       {std::tuple{ShapeKind::bspline, "bspline without averages", 12}, {ShapeKind::gimp, "gimp with F-bar", 20}})
    for (const double porosity : {0.5, 0.65}) {
      const LargeStrain d = large_strain(shape, PressureScheme::in_steps, porosity < 0.6 ? 1e6 : 3e5, 0.3, porosity,
                                         porosity < 0.6 ? 1e-6 : 1e-8, 10, cells, {0.1, 0.3, 0.7});
      pivnp::test::verification_row("consolidation with compression by a third, " + std::string(name) + ", porosity " +
                                        number(porosity, 2) + ", " + std::to_string(cells) + " cells",
                                    "pressure within 2 % of the load, settlement within 2 % of the one-dimensional "
                                    "finite-strain solution at T .1, .3, .7",
                                    number(100 * d.pressure, 2) + " %, " + number(100 * d.settlement, 2) + " %");
      expect_within(d);
    }
}

}  // namespace
}  // namespace pivnp::mpm
