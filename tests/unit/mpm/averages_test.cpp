// The averages of F-bar with three-node shapes (averages.hpp).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "mpm/grid/sweeps.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/frames.hpp"
#include "mpm/solver/state.hpp"
#include "mpm/transfer/transfer.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr double h = 0.1;

// Points below a line at this angle through the middle of a box: a lattice of n x n in each cell, each moved by at most
// `scattered` of its distance to the next; some stand open.
struct Cut {
  Scheme scheme = scheme_of(options());
  Scene s;
  GridState g;
  SolverState state;
  Particles& p;

  Cut(double angle, int n, double scattered, std::mt19937_64& random)
      : s(scene(Grid{{0, 0}, {h, h}, 17, 17}, {rectangle("block", 0.3, 0.3, 1.3, 1.3)}, {elastic(1e5, 0.3, 1000)},
                n * n)),
        g(s.grid, scheme.shape),
        state(initial_state(s, scheme, g, materials_of(s))),
        p(state.particles) {
    std::uniform_real_distribution<double> u(-1, 1);
    const double shift_x = 0.05 * u(random), shift_y = 0.05 * u(random);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double x = p.x[k] + shift_x + scattered * h / n * u(random),
                   y = p.y[k] + shift_y + scattered * h / n * u(random);
      if ((x - 0.8) * std::sin(angle) + (y - 0.8) * std::cos(angle) > 0) {
        p.cell[k] = Particles::ended;
        continue;
      }
      ++kept;
      p.x[k] = x;
      p.y[k] = y;
      p.volume0[k] *= 1 + 0.5 * scattered * u(random);
    }
    EXPECT_GT(kept, 100u);
    locate_all(p, g);
  }

  std::vector<double> average(Averaging which, const std::vector<double>& a) {
    for (std::size_t k = 0; k < p.size(); ++k) p.tau_xx[k] = p.tau_yy[k] = p.tau_zz[k] = a[k];
    average_at_corners(g, which, true, 1, [&](Range range, std::size_t) { average_stress_lanes(p.view(), g.view(), range); });
    std::vector<double> out(p.size(), 0.0);
    const CornerSums* corners = g.averages().view().corners;
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (p.cell[k] == Particles::ended) continue;
      const Vec2 at = g.natural(p, k);
      const double s0 = 0.5 - at.x(), s1 = 0.5 + at.x(), t0 = 0.5 - at.y(), t1 = 0.5 + at.y();
      const CornerSums *low = corners + p.cell[k], *high = low + g.grid.nx;
      out[k] = t0 * (s0 * low[0].value + s1 * low[1].value) + t1 * (s0 * high[0].value + s1 * high[1].value);
    }
    return out;
  }
  template <class Field>
  std::vector<double> field(Field&& f) const {
    std::vector<double> a(p.size(), 0.0);
    for (std::size_t k = 0; k < p.size(); ++k)
      if (p.cell[k] != Particles::ended) a[k] = f(p.x[k], p.y[k]);
    return a;
  }
  double product(const std::vector<double>& a, const std::vector<double>& b) const {
    double sum = 0;
    for (std::size_t k = 0; k < p.size(); ++k)
      if (p.cell[k] != Particles::ended) sum += p.volume0[k] * a[k] * b[k];
    return sum;
  }
};

double worst(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

template <class Body>
void for_cuts(Body&& body) {
  const unsigned seed = 7;
  std::printf("seed %u\n", seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI);
  for (const double scattered : {0.0, 0.2, 1.0})
    for (const int n : {2, 3})
      for (int k = 0; k < 12; ++k) {
        Cut cut(k == 0 ? 0 : angle(random), n, scattered, random);
        body(cut, scattered);
      }
}

TEST(Averages, LinearFieldsAreKeptUpToAFreeSurfaceAtAnyAngle) {
  double most = 0, sum = 0, count = 0;
  for_cuts([&](Cut& cut, double scattered) {
    const auto one = cut.field([](double, double) { return 1.0; });
    for (const Averaging which : {Averaging::of_stress, Averaging::of_strain})
      EXPECT_LT(worst(cut.average(which, one), one), 1e-13);
    for (const auto& linear :
         {cut.field([](double x, double) { return x / h; }), cut.field([](double, double y) { return y / h; })}) {
      const auto found = cut.average(Averaging::of_stress, linear);
      const double apart = worst(found, linear);
      // The mean alone is 0.3 to 0.4 away everywhere. Where S has to be raised, at single points, a tenth of that is
      // left.
      EXPECT_LT(apart, scattered < 1 ? 0.05 : 0.1);
      most = std::max(most, apart);
      sum += apart < 1e-11;
      count += 1;
      EXPECT_NEAR(cut.product(found, one), cut.product(linear, one), 1e-12 * cut.product(linear, one));
    }
  });
  std::printf("greatest error %.1e of a cell's change; %.0f of %.0f exact\n", most, sum, count);
  EXPECT_GT(sum, 0.75 * count);
}

TEST(Averages, ThoseOfStrainAreTheAdjointOfThoseOfStress) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(-1, 1);
  for_cuts([&](Cut& cut, double) {
    const auto a = cut.field([&](double, double) { return u(random); }),
               b = cut.field([&](double, double) { return u(random); });
    const double left = cut.product(b, cut.average(Averaging::of_stress, a));
    const double right = cut.product(a, cut.average(Averaging::of_strain, b));
    EXPECT_NEAR(left, right, 1e-13 * cut.product(a, a));
  });
}

// Else the step would have to be shorter than without them.
TEST(Averages, AreNotGreaterThanOne) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(-1, 1);
  double most = 0;
  for_cuts([&](Cut& cut, double scattered) {
    auto a = cut.field([&](double, double) { return u(random); });
    double growth = 0;
    for (int k = 0; k < 60; ++k) {
      const double size = std::sqrt(cut.product(a, a));
      for (double& v : a) v /= size;
      a = cut.average(Averaging::of_strain, cut.average(Averaging::of_stress, a));
      growth = std::sqrt(std::sqrt(cut.product(a, a)));
    }
    EXPECT_LT(growth, scattered < 1 ? 1 + 1e-6 : 1.03);
    most = std::max(most, growth);
  });
  std::printf("greatest norm less one %.1e\n", most - 1);
}

// The force of a pressure that rises linearly from a face is that without averaging (to 3e-4 where S is raised at a
// point; the mean alone: 3 %).
TEST(Averages, ALinearPressureActsAsItDoesByItself) {
  std::mt19937_64 random(11);
  int exact = 0;
  for (const double angle : {0.0, 0.3, 0.56, 0.9, M_PI / 2, 2.5}) {
    Cut cut(angle, 2, 0, random);
    for (std::size_t k = 0; k < cut.p.size(); ++k)
      cut.p.tau_xx[k] = cut.p.tau_yy[k] = cut.p.tau_zz[k] =
          1e3 * ((cut.p.x[k] - 0.8) * std::sin(angle) + (cut.p.y[k] - 0.8) * std::cos(angle));
    std::vector<double> force[2];
    double most = 0;
    for (const bool averaged : {false, true}) {
      Scheme scheme = cut.scheme;
      if (!averaged) scheme.locking = Locking::none;
      average_mean_stress(cut.p, cut.g, scheme, 1);
      map_momentum(cut.p, cut.g, scheme, true, 1);
      for (const std::uint32_t n : cut.g.active.nodes)
        for (const double f : {cut.g.node[n].fx, cut.g.node[n].fy}) {
          force[averaged].push_back(f);
          most = std::max(most, std::abs(f));
        }
    }
    const double apart = worst(force[0], force[1]) / most;
    exact += apart < 1e-12;
    EXPECT_LT(apart, 1e-3) << angle;
  }
  EXPECT_GE(exact, 5);
}

// The weight of a point goes from cell to cell as it does; nothing else about it jumps.
TEST(Averages, AreContinuousWherePointsCrossCells) {
  std::mt19937_64 random(3);
  Cut cut(0.5, 3, 0.1, random);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto a = cut.field([&](double, double) { return u(random); });
  std::vector<double> found[2];
  const std::vector<double> x(cut.p.x.begin(), cut.p.x.end());
  for (const int side : {0, 1}) {
    for (std::size_t k = 0; k < cut.p.size(); ++k)  // every third to the edge between the two nearest nodes
      if (k % 3 == 0) cut.p.x[k] = (std::floor(x[k] / h) + 0.5 + (side == 0 ? -1e-9 : 1e-9)) * h;
    locate_all(cut.p, cut.g);
    found[side] = cut.average(Averaging::of_stress, a);
  }
  EXPECT_LT(worst(found[0], found[1]), 1e-6);
}

TEST(Averages, DoNotDependOnTheNumberOfThreads) {
  const Scheme scheme = scheme_of(options());
  const Scene s = scene(Grid{{0, 0}, {h, h}, 81, 61}, {disc("disc", {4, 3}, 2.5)}, {elastic(1e5, 0.3, 1000)});
  GridState g(s.grid, scheme.shape);
  SolverState state = initial_state(s, scheme, g, materials_of(s));
  Particles& p = state.particles;
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> u(-1, 1);
  for (std::size_t k = 0; k < p.size(); ++k) p.tau_xx[k] = p.tau_yy[k] = p.tau_zz[k] = u(random);
  locate_all(p, g);
  ASSERT_GT(g.active.nodes.size(), 2 * nodes_in_part);
  std::vector<double> found[2];
  for (const int threads : {1, 3}) {
    average_mean_stress(p, g, scheme, threads);
    for (const std::uint32_t n : g.active.nodes) found[threads == 3].push_back(g.averages().view().corners[n].value);
  }
  EXPECT_TRUE(found[0] == found[1]);
}

}  // namespace
}  // namespace pivnp::mpm
