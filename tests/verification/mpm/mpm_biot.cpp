// Biot's fast wave in a saturated column (Biot 1956), in which skeleton and water move together: undrained, a pulse
// runs at c_u = sqrt((M + K_w/n)/rho), within 1 %. And both waves together, where water flows: standing in a closed
// box, motion of a wave number k goes as exp(s t), with S = n/K_w and lambda = K/gamma,
//   (rho s^2 + M k^2)(S s + lambda k^2) + k^2 s = 0:
// a fast wave that is damped and a slow one that only decays. Criterion: speed and decay of the one, and decay of the
// other, within 1 %. With the water's own inertia, the theory in full (Biot 1956): the relative motion w of the water
// obeys
//   (rho s^2 + (M + Q) k^2) u + (rho_w s^2 + Q k^2) w = 0,  (rho_w s^2 + Q k^2) u + (rho_w s^2/n + s/lambda + Q k^2) w
//   = 0,  Q = K_w/n.
// Criterion: speed and decay of the fast wave, and the slower decay of the slow one, within 1 %, where water without
// inertia is far off. (In small, the same on fewer cells.)
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include <Eigen/Dense>

#include "mpm/state/scheme_rows.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

double speed_of_fast_wave(ShapeKind shape, int cells) {
  WaterColumn c;
  c.young = 1e7;
  c.bulk = 3e8;
  c.permeability = 1e-9;
  c.height = 1;
  c.cells = cells;
  c.load = 0;
  c.damping = 0;
  c.shape = shape;
  if (shape == ShapeKind::bilinear) c.transfer = TransferKind::flip, c.stress = StressUpdate::musl;
  Scene s = scene_of(c);
  const double undrained = c.modulus() + c.bulk / c.porosity, speed = std::sqrt(undrained / c.density());
  for (const Vec2& x : s.particles.x0) s.v0.emplace_back(0, 1e-4 * std::exp(-std::pow((x.y() - 0.5) / 0.08, 2)));
  Solver solver(options_of(c), s, 1);
  // Two halves leave the middle; the centre of the upper one, by energy.
  const auto centre = [&] {
    const MotionFrame f = solver.frame();
    double sum = 0, weight = 0;
    for (std::size_t k = 0; k < f.v.size(); ++k) {
      if (s.particles.x0[k].y() < 0.5) continue;
      const double w = std::pow(double(f.v[k][1]), 2);
      sum += w * s.particles.x0[k].y();
      weight += w;
    }
    return sum / weight;
  };
  const double early = 0.18 / speed, late = 0.3 / speed;
  solver.advance_to(early, silent);
  const double from = centre();
  solver.advance_to(late, silent);
  return (centre() - from) / (late - early) / speed;
}

TEST(MpmBiotSmall, FastWave) {
  const double fast = speed_of_fast_wave(ShapeKind::bspline, 100);
  std::printf("fast wave, 100 cells: %.4f\n", fast);
  EXPECT_NEAR(fast, 1, 0.01);
}

TEST(MpmBiot, FastWave) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline}) {
    const double fast = speed_of_fast_wave(shape, 100);
    pivnp::test::verification_row("Biot's fast wave in an undrained column, " + std::string(name_of(shape)) + ", pulse of 16 cells",
                                  "speed within 1 % of sqrt((M + K_w/n)/rho)", number(fast, 5));
    EXPECT_NEAR(fast, 1, 0.01);
  }
}

struct Waves {
  double speed, decay, slow;  // Im and -Re of the fast one's s, -Re of the slow one's, 1/s
};

// From the roots s of a real cubic, or of what a sampled history obeys.
Waves waves_of(const std::array<std::complex<double>, 3>& s) {
  Waves w{0, 0, 0};
  for (const auto& root : s)
    if (root.imag() > w.speed) w = {root.imag(), -root.real(), w.slow};
  for (const auto& root : s)
    if (std::abs(root.imag()) < 1e-6 * w.speed) w.slow = -root.real();
  return w;
}

// Roots of z^3 + c2 z^2 + c1 z + c0.
std::array<std::complex<double>, 3> roots(double c2, double c1, double c0) {
  Eigen::Matrix3d companion;
  companion << 0, 0, -c0, 1, 0, -c1, 0, 1, -c2;
  const Eigen::Vector3cd z = companion.eigenvalues();
  return {z[0], z[1], z[2]};
}

// Of height 1, without a load or losses of the scheme. `stiff`: K_w/n over M.
WaterColumn waving_column(ShapeKind shape, double young, double porosity, double stiff, int cells) {
  WaterColumn c;
  c.young = young;
  c.porosity = porosity;
  c.bulk = stiff * c.porosity * c.modulus();
  c.height = 1;
  c.cells = cells;
  c.load = 0;
  c.damping = 0;
  c.courant = 0.2;
  c.shape = shape;
  c.transfer = TransferKind::flip;
  if (shape == ShapeKind::bilinear) c.stress = StressUpdate::musl;
  return c;
}

/// Found over exact. `flow`: lambda k over S times the undrained speed; `stiff`: K_w/n over M.
Waves standing_waves(ShapeKind shape, double young, double stiff, double flow, int cells) {
  WaterColumn c = waving_column(shape, young, WaterColumn().porosity, stiff, cells);
  const double k = M_PI / c.height, S = c.porosity / c.bulk, M = c.modulus(), fast = std::sqrt((M + 1 / S) / c.density());
  c.permeability = flow * fast * S / k * 9810;
  const double lambda = c.permeability / 9810, rho = c.density();
  const Waves exact = waves_of(roots(lambda * k * k / S, (M * S + 1) * k * k / (rho * S), M * lambda * std::pow(k, 4) / (rho * S)));
  Scene s = scene_of(c);
  s.boundaries.emplace_back("top", line({0, c.height}, {2 * c.spacing(), c.height}, "roller"));
  for (const Vec2& x : s.particles.x0) s.v0.emplace_back(0, 1e-6 * fast * std::sin(k * x.y()));
  Solver solver(options_of(c), s, 1);
  // Samples of three exponentials obey a_j+3 + c2 a_j+2 + c1 a_j+1 + c0 a_j = 0.
  const double every = 0.7 / exact.speed;
  std::vector<double> a;
  for (int j = 0; j < 24; ++j) {
    if (j > 0) solver.advance_to(j * every, silent);
    const MotionFrame f = solver.frame();
    double sum = 0;
    for (std::size_t p = 0; p < f.u.size(); ++p) sum += double(f.u[p][1]) * std::sin(k * s.particles.x0[p].y());
    a.push_back(sum);
  }
  Eigen::MatrixXd left(21, 3);
  Eigen::VectorXd right(21);
  for (int j = 0; j < 21; ++j) {
    for (int i = 0; i < 3; ++i) left(j, i) = a[std::size_t(j + i)];
    right[j] = -a[std::size_t(j) + 3];
  }
  const Eigen::Vector3d coefficient = left.colPivHouseholderQr().solve(right);
  auto z = roots(coefficient[2], coefficient[1], coefficient[0]);
  for (auto& root : z) root = std::log(root) / every;
  const Waves found = waves_of(z);
  return {found.speed / exact.speed, found.decay / exact.decay, found.slow / exact.slow};
}

void expect_waves(const Waves& w) {
  EXPECT_NEAR(w.speed, 1, 0.01);
  EXPECT_NEAR(w.decay, 1, 0.01);
  EXPECT_NEAR(w.slow, 1, 0.01);
}

TEST(MpmBiotSmall, StandingWaves) {
  const Waves w = standing_waves(ShapeKind::bspline, 1e7, 3, 0.3, 24);
  std::printf("standing waves, 24 cells: speed %.4f, decay %.4f, slow %.4f\n", w.speed, w.decay, w.slow);
  expect_waves(w);
}

TEST(MpmBiot, StandingWaves) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline})
    for (const auto& [young, stiff, flow] : {std::array{1e7, 3.0, 0.3}, {1e8, 1.5, 0.8}}) {
      const Waves w = standing_waves(shape, young, stiff, flow, 60);
      pivnp::test::verification_row("Biot's waves standing in a closed box, " + std::string(name_of(shape)) + ", K_w/n " + number(stiff, 2) + " M, flow " + number(flow, 2) + ", 60 cells",
                                    "fast: speed and decay, slow: decay, over the exact ones within 1 %",
                                    number(w.speed, 4) + ", " + number(w.decay, 4) + ", " + number(w.slow, 4));
      expect_waves(w);
    }
}

// Roots of c0 + c1 s + c2 s^2 + ...
std::vector<std::complex<double>> roots_of(const std::vector<double>& c) {
  const auto size = Eigen::Index(c.size()) - 1;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    if (i > 0) companion(i, i - 1) = 1;
    companion(i, size - 1) = -c[std::size_t(i)] / c.back();
  }
  const Eigen::VectorXcd z = companion.eigenvalues();
  return {z.begin(), z.end()};
}

// Im and -Re of the fast one, -Re of the slowest. (Of what is gone within a sample, a history tells no more than
// noise.)
Waves fast_and_slow(const std::vector<std::complex<double>>& s) {
  Waves w{0, 1e300, 1e300};
  for (const auto& root : s)
    if (root.imag() > 0 && -root.real() < w.decay) w = {root.imag(), -root.real(), w.slow};
  for (const auto& root : s) w.slow = std::min(w.slow, std::abs(root.imag()) < 1e-6 * w.speed ? -root.real() : 1e300);
  return w;
}

// `lag`: rho_w lambda/n times the fast wave's frequency. Found over exact; and of water without inertia by theory, over
// exact.
std::array<Waves, 2> waves_with_inertia(ShapeKind shape, double stiff, double lag, int cells, bool inertia = true) {
  WaterColumn c = waving_column(shape, 1e7, 0.4, stiff, cells);
  const double k = M_PI / c.height, Q = c.bulk / c.porosity, M = c.modulus(), rho = c.density(), water = 1000,
               fast = std::sqrt((M + Q) / rho);
  const double lambda = lag * c.porosity / (water * k * fast), k2 = k * k;
  c.permeability = lambda * 9810;
  const double own = water / c.porosity, stiffest = (M + Q) * k2, coupled = Q * k2;
  const auto exact = fast_and_slow(
      roots_of({stiffest * coupled - coupled * coupled, stiffest / lambda,
                stiffest * own + rho * coupled - 2 * water * coupled, rho / lambda, rho * own - water * water}));
  const auto without =
      fast_and_slow(roots_of({stiffest * coupled - coupled * coupled, stiffest / lambda, rho * coupled, rho / lambda}));
  Scene s = scene_of(c);
  s.water->inertia = inertia;
  s.boundaries.emplace_back("top", line({0, c.height}, {2 * c.spacing(), c.height}, "roller"));
  for (const Vec2& x : s.particles.x0) s.v0.emplace_back(0, 1e-6 * fast * std::sin(k * x.y()));
  Solver solver(options_of(c), s, 1);
  const EnergyRow start = solver.energy();
  const double every = 0.7 / exact.speed;
  const int order = inertia ? 4 : 3;
  std::vector<double> a;
  for (int j = 0; j < 20; ++j) {
    if (j > 0) solver.advance_to(j * every, silent);
    const MotionFrame f = solver.frame();
    double sum = 0;
    for (std::size_t p = 0; p < f.u.size(); ++p) sum += double(f.u[p][1]) * std::sin(k * s.particles.x0[p].y());
    a.push_back(sum);
  }
  EXPECT_LT(std::abs(solver.energy().residual), 0.02 * start.kinetic);
  Eigen::MatrixXd left(20 - order, order);
  Eigen::VectorXd right(20 - order);
  for (int j = 0; j < 20 - order; ++j) {
    for (int i = 0; i < order; ++i) left(j, i) = a[std::size_t(j + i)];
    right[j] = -a[std::size_t(j + order)];
  }
  const Eigen::VectorXd coefficient = left.colPivHouseholderQr().solve(right);
  std::vector<double> polynomial(coefficient.begin(), coefficient.end());
  polynomial.push_back(1);
  auto z = roots_of(polynomial);
  for (auto& root : z) root = std::log(root) / every;
  const Waves found = fast_and_slow(z);
  const auto over = [&](const Waves& w) {
    return Waves{w.speed / exact.speed, w.decay / exact.decay, w.slow / exact.slow};
  };
  return {over(found), over(without)};
}

TEST(MpmBiotSmall, TheWatersOwnInertia) {
  const auto [w, without] = waves_with_inertia(ShapeKind::bspline, 3, 0.3, 24);
  std::printf("waves with the water's inertia, 24 cells: speed %.4f, decay %.4f, slow %.4f; without %.4f, %.4f, %.4f\n",
              w.speed, w.decay, w.slow, without.speed, without.decay, without.slow);
  EXPECT_NEAR(w.speed, 1, 0.01);
  EXPECT_NEAR(w.decay, 1, 0.05);  // a ninth of what it is without; of second order in the cell
  EXPECT_NEAR(w.slow, 1, 0.01);
  EXPECT_GT(without.decay, 2);
}

TEST(MpmBiot, TheWatersOwnInertia) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline})
    for (const auto& [stiff, lag] : {std::array{3.0, 0.1}, {3.0, 0.5}, {10.0, 1.0}}) {
      const auto [w, without] = waves_with_inertia(shape, stiff, lag, 60);
      pivnp::test::verification_row(
          "Biot's waves with the water's inertia, " + std::string(name_of(shape)) + ", K_w/n " + number(stiff, 2) +
              " M, rho_w lambda omega/n " + number(lag, 2) + ", 60 cells",
          "fast: speed and decay, slow: decay, over Biot's in full within 1 % (theory without inertia)",
          number(w.speed, 4) + ", " + number(w.decay, 4) + ", " + number(w.slow, 4) + " (" + number(without.speed, 4) +
              ", " + number(without.decay, 4) + ", " + number(without.slow, 4) + ")");
      expect_waves(w);
    }
}

}  // namespace
}  // namespace pivnp::mpm
