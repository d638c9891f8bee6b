// Embedded bands: the deviation across a zone, and with the means of the zone the whole band, against one resolved by finite volumes
// and against Alvarado 2018's 4.24.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "mpm/heat/bands.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/frames.hpp"
#include "mpm/transfer/stress_update.hpp"
#include "tests/support/heated_band.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using pivnp::test::HeatedBand;
using pivnp::test::PlanarSlide;
using pivnp::test::ResolvedBand;

TEST(Bands, VolumesFillTheZone) {
  for (const double width : {0.011, 0.02, 0.5, 50.0}) {
    for (const double near : {0.75, 1.1, 3.0}) EXPECT_NEAR(growth_of(0.01, width, near), growth_of(0.01, width), 1e-12);
    const auto volume = volumes_of(0.01, width, growth_of(0.01, width));
    double sum = 0;
    for (const double v : volume) sum += v;
    EXPECT_NEAR(sum, 0.5 * width, 1e-12 * width);
    EXPECT_GT(volume.back(), 0);
  }
}

// The reference itself: reference figures of an earlier, independent solution, and 4.24.
TEST(Bands, TheResolvedBandIsThatOfTheTrial) {
  const struct {
    double thickness, at_1, at_5, at_30, hot;
  } rows[] = {{0.001, 399.6, 628.9, 822.4, 19.61}, {0.01, 137.0, 469.8, 830.9, 14.41}, {0.1, 15.9, 76.3, 368.4, 6.63}};
  for (const auto& row : rows) {
    HeatedBand of;
    of.thickness = row.thickness;
    ResolvedBand band(of);
    const double dt = 2e-3;
    for (int k = 1; k <= 30000; ++k) {
      band.slip(0.1, dt);
      const double expected = 1e3 * (k == 500 ? row.at_1 : k == 2500 ? row.at_5 : k == 15000 ? row.at_30 : 0);
      if (expected > 0) {
        EXPECT_NEAR(band.pressure(), expected, 1e-2 * expected);
      }
    }
    EXPECT_NEAR(band.temperature(), row.hot, 5e-3 * row.hot);
  }
  HeatedBand of;
  of.conductivity = of.permeability = 0;
  ResolvedBand sealed(of);
  for (int k = 0; k < 10000; ++k) sealed.slip(0.1, 1e-3);
  const double rate = of.beta * of.tan_friction() * 0.1 / (of.storage() * of.capacity * of.thickness);
  EXPECT_NEAR(sealed.pressure(), 1e6 * (1 - std::exp(-10 * rate)), 300);
}

// A zone of cells of a size, with means in a column of them, and its band.
class EmbeddedBand {
 public:
  EmbeddedBand(const HeatedBand& of, double cell) : of_(of), cell_(cell), hot_(std::size_t(of.depth / cell) + 1, 0.0), pressure_(hot_) {
    soil_.capacity = of.capacity;
    soil_.conductivity = of.conductivity;
    soil_.swelling = of.beta;
    soil_.band = of.thickness;
    soil_.storage = of.storage();
    soil_.mobility = of.mobility();
  }
  void slip(double speed, double dt) {
    const double work = dt * speed * shear_stress() / cell_;  // in the zone, the column's first half cell and its mirror
    const double each = dt / (cell_ * cell_);
    std::vector<double> old = hot_;
    const auto gain = [&](const std::vector<double>& x, std::size_t k) {
      return (k == 0 ? 2 * (x[1] - x[0]) : (k + 1 < x.size() ? x[k + 1] - x[k] : 0) + x[k - 1] - x[k]);
    };
    for (std::size_t k = 0; k < hot_.size(); ++k) hot_[k] += of_.conductivity / of_.capacity * each * gain(old, k) + (k == 0 ? work / of_.capacity : 0);
    const std::vector<double> was = pressure_;
    for (std::size_t k = 0; k < hot_.size(); ++k)
      pressure_[k] += of_.mobility() / of_.storage() * each * gain(was, k) + of_.beta / of_.storage() * (hot_[k] - old[k]);
    advance_band(band_, soil_, cell_, work, dt);
  }
  double shear_stress() const { return std::max(0.0, of_.stress - pressure()) * of_.tan_friction(); }
  double pressure() const { return pressure_[0] + band_.over_pressure(of_.thickness); }
  double temperature() const { return hot_[0] + band_.hotter(of_.thickness); }

 private:
  HeatedBand of_;
  HeatSoil soil_;
  double cell_;
  ShearBand band_;
  std::vector<double> hot_, pressure_;
};

TEST(Bands, ASealedBlockFollows424) {
  for (const double friction : {11.0, 28.0})
    for (const double speed : {0.1, 3.0})
      for (const double thickness : {0.001, 0.01, 0.1})
        for (const double skeleton : {0.0, 1.5e-9, 3.375e-8}) {
          HeatedBand of;
          of.friction_deg = friction, of.thickness = thickness, of.skeleton = skeleton;
          of.conductivity = of.permeability = 0;
          const double rate = of.beta * of.tan_friction() * speed / (of.storage() * of.capacity * thickness);
          EmbeddedBand band(of, 0.5);
          const int steps = 4000;
          for (int k = 1; k <= steps; ++k) {
            band.slip(speed, 2 / rate / steps);
            if (k % 1000 == 0) {
              EXPECT_NEAR(band.pressure(), 1e6 * (1 - std::exp(-2.0 * k / steps)), 1e3);
            }
          }
        }
}

// The block of figure 4.4 with diffusion: whatever the cell.
TEST(Bands, ABlockWithDiffusionIsTheResolvedOne) {
  for (const double permeability : {1e-11, 1e-9, 1e-7})
    for (const double cell : {0.5, 1.0, 2.0}) {
      HeatedBand of;
      of.permeability = permeability;
      ResolvedBand resolved(of);
      EmbeddedBand band(of, cell);
      double worst = 0;
      for (int k = 0; k < 15000; ++k) {
        resolved.slip(0.1, 2e-3);
        band.slip(0.1, 2e-3);
        worst = std::max(worst, std::abs(band.pressure() - resolved.pressure()));
      }
      EXPECT_LT(worst, 0.01e6) << permeability << ' ' << cell;
      EXPECT_NEAR(band.temperature(), resolved.temperature(), 0.05 * resolved.temperature()) << permeability << ' ' << cell;
    }
}

// Slip on a plane (Rice 2006): tau/tau_0 = exp(d/L*) erfc(sqrt(d/L*)). A band of less than a tenth of the length that water goes.
TEST(Bands, AThinBandIsRicesPlane) {
  for (const double permeability : {1e-11, 1e-10})
    for (const double cell : {0.25, 0.5}) {
      HeatedBand of;
      of.permeability = permeability;
      of.thickness = 2e-4;
      const double lambda = of.beta / of.storage(), speed = 0.1, along = std::sqrt(of.mobility() / of.storage()) + std::sqrt(of.conductivity / of.capacity);
      const double length = 4 * std::pow(of.capacity * along / (lambda * of.tan_friction()), 2) / speed;
      EmbeddedBand band(of, cell);
      const double dt = 1e-3 * length / speed;
      for (int k = 1; k <= 10000; ++k) {
        band.slip(speed, dt);
        const double x = 1e-3 * k, exact = std::exp(x) * std::erfc(std::sqrt(x));
        if (k == 1000 || k == 3000 || k == 10000) {
          EXPECT_NEAR(band.shear_stress() / (of.stress * of.tan_friction()), exact, 0.01) << permeability << ' ' << cell << " m, slip " << x << " L*";
        }
      }
    }
}

// Slip that starts, stops and jumps between two zones, whose widths jump too as zones part and meet: what is left of the strength, and
// the mean of the deviation, have no kink. Asked for are 2 % of the stress.
TEST(Bands, NoKinkWhereSlipStartsStopsJumpsOrMeets) {
  for (const double permeability : {1e-11, 1e-9, 1e-7}) {
    HeatedBand of;
    of.permeability = permeability;
    HeatSoil soil;
    soil.capacity = of.capacity, soil.conductivity = of.conductivity, soil.swelling = of.beta;
    soil.band = of.thickness, soil.storage = of.storage(), soil.mobility = of.mobility();
    ShearBand band[2];
    const double dt = 1e-3, widths[] = {1.0, 2.0, 0.5, 1.0, 1.4, 0.7};
    double before[2] = {}, greatest[2] = {};
    for (int step = 0; step < 12000; ++step) {
      const int phase = step / 1000;  // a second each: zone 0, zone 1, both, none
      for (const int zone : {0, 1}) {
        const bool slips = phase % 4 == zone || phase % 4 == 2;
        const double width = widths[(phase + 3 * zone) % 6], strength = std::max(0.0, of.stress - band[zone].over_pressure(of.thickness)) * of.tan_friction();
        advance_band(band[zone], soil, width, slips ? dt * 0.3 * strength / width : 0, dt);
        const double now = band[zone].over_pressure(of.thickness);
        EXPECT_LT(std::abs(now - before[zone]), 0.02 * of.stress) << permeability << ' ' << step << ' ' << zone;
        before[zone] = now;
        greatest[zone] = std::max(greatest[zone], now);
        const auto volume = volumes_of(of.thickness, width, band[zone].growth);
        double water = 0;
        for (std::size_t v = 0; v < ShearBand::volumes; ++v) water += volume[v] * band[zone].pressure[v];
        EXPECT_NEAR(water, 0, 1e-7);
      }
    }
    for (const int zone : {0, 1}) EXPECT_GT(greatest[zone], 0.03 * of.stress);
  }
}

// Where nothing slips a deviation only evens out: a step of eight passes (of a slope on cells of 0.125 m) does that as
// eight do.
TEST(Bands, EvenOutAlikeInLongSteps) {
  for (const double permeability : {1e-11, 1e-9, 1e-7}) {
    HeatedBand of;
    HeatSoil soil;
    soil.capacity = of.capacity, soil.conductivity = of.conductivity, soil.swelling = of.beta;
    soil.band = of.thickness, soil.storage = of.storage(), soil.mobility = permeability / 9810;
    const double dt = 5e-4, width = 0.15;
    ShearBand band;
    for (int k = 0; k < 400; ++k) advance_band(band, soil, width, 500, dt);
    const double before = band.over_pressure(of.thickness), hot = band.hotter(of.thickness);
    ShearBand each = band, seldom = band;
    for (int k = 0; k < 80; ++k) advance_band(each, soil, width, 0, dt);
    for (int k = 0; k < 10; ++k) advance_band(seldom, soil, width, 0, 8 * dt);
    EXPECT_NEAR(seldom.over_pressure(of.thickness), each.over_pressure(of.thickness), 0.01 * before) << permeability;
    EXPECT_NEAR(seldom.hotter(of.thickness), each.hotter(of.thickness), 1e-4 * hot) << permeability;
  }
}

TEST(Bands, AZoneHardlyWiderThanItsBandStaysFinite) {
  HeatedBand of;
  HeatSoil soil;
  soil.capacity = of.capacity, soil.conductivity = of.conductivity, soil.swelling = of.beta;
  soil.band = of.thickness, soil.storage = of.storage(), soil.mobility = 1e-7 / 9810;
  ShearBand band;
  for (int k = 0; k < 1000; ++k) {
    advance_band(band, soil, of.thickness * (1 + std::pow(10, -12 + 0.0115 * k)), 1e3, 0.01);
    ASSERT_TRUE(std::isfinite(band.over_pressure(of.thickness)) && std::isfinite(band.hotter(of.thickness))) << k;
    ASSERT_LT(std::abs(band.over_pressure(of.thickness)), 1e6) << k;
  }
}

// Figure 4.6: reference figures of the trial.
TEST(Bands, TheResolvedSlideIsThatOfTheTrial) {
  HeatedBand of;
  const PlanarSlide::State s = PlanarSlide(of).after(50);
  EXPECT_NEAR(s.time, 8.07, 0.02);
  EXPECT_NEAR(s.speed, 18.16, 0.05);
  EXPECT_NEAR(s.temperature, 2.97, 0.03);
}

// Whatever is done to its width, the deviation has no mean: no heat, no water.
TEST(Bands, TheDeviationHasNoMean) {
  HeatedBand of;
  HeatSoil soil;
  soil.capacity = of.capacity, soil.conductivity = of.conductivity, soil.swelling = of.beta;
  soil.band = of.thickness, soil.storage = of.storage(), soil.mobility = 1e-9 / 9810;
  ShearBand band;
  double hottest = 0;
  for (int k = 0; k < 400; ++k) {
    const double width = 0.5 * (1 + 0.3 * std::sin(0.1 * k));
    advance_band(band, soil, width, k < 300 ? 1e3 : 0, 0.01);
    const auto volume = volumes_of(of.thickness, width, band.growth);
    double heat = 0, water = 0;
    for (std::size_t v = 0; v < ShearBand::volumes; ++v) heat += volume[v] * band.temperature[v], water += volume[v] * band.pressure[v];
    hottest = std::max(hottest, band.hotter(of.thickness));
    EXPECT_NEAR(heat, 0, 1e-12 * (1 + hottest));
    EXPECT_NEAR(water, 0, 1e-7);
  }
  EXPECT_GT(hottest, 1);
  advance_band(band, soil, 0.005, 1e3, 0.01);
  EXPECT_EQ(band.hotter(of.thickness), 0) << "narrower than the band: no deviation";
}

// What the pores' smoothed strain leaves in a row of cells that swells, by that smoothing built for rows of points between nodes.
TEST(Bands, TheSmoothedStrainSpreadsAsMuchAsIsMadeUpFor) {
  constexpr int rows = 21, per_row = 2, points = rows * per_row, nodes = rows + 1, middle = rows / 2;
  const auto hat = [](int point, int node) {
    const double y = (point + 0.5) / per_row;
    return std::max(0.0, 1 - std::abs(y - node));
  };
  Eigen::MatrixXd from = Eigen::MatrixXd::Zero(points, nodes), smooth = Eigen::MatrixXd::Zero(nodes, nodes), over = Eigen::MatrixXd::Zero(points, points);
  for (int p = 0; p < points; ++p) {
    for (int n = 0; n < nodes; ++n) from(p, n) = hat(p, n);
    for (int q = 0; q < points; ++q) over(p, q) = p / per_row == q / per_row ? 1.0 / per_row : 0;  // strain is that of the cell
  }
  Eigen::MatrixXd to = from.transpose();
  for (int n = 0; n < nodes; ++n) {
    to.row(n) /= to.row(n).sum();
    for (int cell : {n - 1, n})
      if (cell >= 0 && cell < rows)
        for (int other : {cell, cell + 1}) smooth(n, other) += 0.5 / (n > 0 && n < rows ? 2 : 1);
  }
  const Eigen::MatrixXd two = 2 * Eigen::MatrixXd::Identity(nodes, nodes) - to * from * smooth, all = from * smooth * two * to;
  for (const double skeleton : {0.0, 1.5e-9, 3.375e-8}) {
    HeatedBand of;
    HeatSoil soil;
    soil.unloaded = of.of_water;
    soil.storage = skeleton + of.of_water;
    soil.take_cells(0.5);
    Eigen::VectorXd swells = Eigen::VectorXd::Zero(points);
    for (int p = middle * per_row; p < (middle + 1) * per_row; ++p) swells(p) = 1;
    const Eigen::MatrixXd gives_way = Eigen::MatrixXd::Identity(points, points) + skeleton / of.of_water * all * over;
    const Eigen::VectorXd pressure = soil.storage / of.of_water * gives_way.partialPivLu().solve(all * swells);
    EXPECT_NEAR(1 - soil.spread, pressure.segment(middle * per_row, per_row).mean(), 0.03) << skeleton;

    // The band of a zone one cell wide makes up for it, no more, and takes it from the cells beside.
    soil.capacity = of.capacity, soil.swelling = of.beta, soil.band = 0.01;
    ShearBand band;
    advance_band(band, soil, 0.5, 3e5, 1);
    const double rise = 3e5 / of.capacity * of.beta / soil.storage;
    EXPECT_NEAR(band.over_pressure(0.01), rise * (0.5 / 0.01 - 1 + soil.spread), 1e-9 * rise);
    EXPECT_NEAR(band.pressure.back(), -rise * soil.spread / 2, 1e-9 * rise);
  }
}

// Strength that a band takes from step to step, and gives back: what the stresses do on the strains is stored or
// dissipated, also with strains beyond the cone's tip and turns.
TEST(Bands, StrengthThatComesAndGoesLosesNoWork) {
  MaterialOptions clay = test::sand(11, 4.5e8);
  Scene s = test::scene(Grid{{0, 0}, {1, 1}, 3, 3}, {test::rectangle("clay", 0, 0, 2, 2)}, {clay});
  GridState g(s.grid, ShapeKind::gimp);
  const Materials materials = materials_of(s);
  SolverState state = initial_state(s, scheme_of(test::options()), g, materials);
  Particles& p = state.particles;
  p.shift.assign(p.size(), 0.0);
  p.resize_increments(p.size());
  const Elastic& elastic = materials[0]->elastic();
  const Array* dissipated = p.history.find(plastic_work.name);
  const auto stored = [&](std::size_t k) { return elastic.energy(p.tau_xx[k], p.tau_yy[k], p.tau_zz[k], p.tau_xy[k]); };
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<double> work(p.size(), 0.0), start(p.size());
  for (std::size_t k = 0; k < p.size(); ++k) {
    p.tau_xx[k] = p.tau_yy[k] = p.tau_zz[k] = -1e6;
    start[k] = stored(k);
  }
  for (int step = 0; step < 2000; ++step) {
    std::vector<Stress> before;
    for (std::size_t k = 0; k < p.size(); ++k) {
      p.shift[k] = 1e6 * std::max(0.0, any(random)) * (step % 3 > 0);
      p.de_xx[k] = 3e-4 * any(random), p.de_yy[k] = 3e-4 * any(random);
      p.de_xy[k] = 2e-3 * (1 + any(random));
      p.spin[k] = 1e-2 * any(random);
      before.push_back(turned_by(p.spin[k], {p.tau_xx[k], p.tau_yy[k], p.tau_zz[k], p.tau_xy[k]}));
    }
    update_stress(materials, p, 1, 1e-3);
    for (std::size_t k = 0; k < p.size(); ++k)
      work[k] += 0.5 * ((before[k].xx + p.tau_xx[k]) * p.de_xx[k] + (before[k].yy + p.tau_yy[k]) * p.de_yy[k]) +
                 (before[k].xy + p.tau_xy[k]) * p.de_xy[k];
  }
  for (std::size_t k = 0; k < p.size(); ++k) {
    EXPECT_GT((*dissipated)[k], 1e4);
    EXPECT_NEAR(stored(k) - start[k] + (*dissipated)[k], work[k], 1e-10 * (*dissipated)[k]);
  }
}

}  // namespace
}  // namespace pivnp::mpm
