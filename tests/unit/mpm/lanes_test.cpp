// The kernels in lanes: pieces that are done together, in another order or one by one, on every instruction set. (Against plain
// loops: reference_test.cpp.)
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mpm/grid/sweeps.hpp"
#include "mpm/material/mohr_coulomb.hpp"
#include "mpm/material/smooth_mohr_coulomb.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/frames.hpp"
#include "mpm/transfer/finite_strain.hpp"
#include "mpm/transfer/lanes-inl.hpp"
#include "mpm/transfer/lanes.hpp"
#include "mpm/transfer/stress_update.hpp"
#include "mpm/transfer/transfer.hpp"
#include "tests/unit/mpm/disorder.hpp"
#include "tests/unit/mpm/every_target.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

// uGIMP's functions have three pieces; the lanes form them without asking which. (By the vectors every processor of this kind
// has; the other sets' are compared through the kernels.)
TEST(GimpLanes, AreTheShapesPiecesUpToTheirJoints) {
  namespace simd = mpm::HWY_NAMESPACE;
  double most = 0;
  for (const double half : {0.5, 0.4999, 0.25, 0.1, 1e-3, 1e-6})
    for (int n = -40; n <= 40; ++n)
      for (const double off : {-1e-13, 0.0, 1e-13}) {
        double xi = n % 4 == 0 ? (n / 4) * 0.05 : std::copysign(0.5 - half, n) + n * half / 39;  // along the cell; the joints
        xi = std::min(std::max(xi + off, -0.5), 0.5);
        const Line<double, 3> plain = GimpShape::line(xi, half);
        const auto lane = simd::GimpShape::line(simd::set(xi), simd::set(half));
        for (int a = 0; a < 3; ++a) {
          most = std::max(most, std::abs(simd::hn::GetLane(lane.w[a]) - plain.w[a]));
          most = std::max(most, half * std::abs(simd::hn::GetLane(lane.g[a]) - plain.g[a]));  // (their slope is 1/half)
          EXPECT_GE(simd::hn::GetLane(lane.w[a]), -1e-16) << xi << ' ' << half;
        }
        EXPECT_NEAR(simd::hn::GetLane(lane.w[0] + lane.w[1] + lane.w[2]), 1, 3e-16) << xi << ' ' << half;
        EXPECT_NEAR(simd::hn::GetLane(lane.g[0] + lane.g[1] + lane.g[2]), 0, 3e-16) << xi << ' ' << half;
      }
  EXPECT_LT(most, 4e-16);
}

// One sweep that moves the points and strains them does what two do, beside a node that strains them by a velocity of its own
// too.
TEST(Lanes, MovingAndStrainingTogetherIsOneAfterTheOther) {
  const double dt = 1e-3;
  const auto after = [&](ShapeKind shape, Locking locking, bool together, int threads, double own) {
    Case c(shape, TransferKind::apic, true);
    c.scheme.locking = locking;
    Particles& p = c.state.particles;
    average_mean_stress(p, c.g, c.scheme, threads);
    map_momentum(p, c.g, c.scheme, true, threads);
    std::mt19937_64 random(seed_of_all);
    std::uniform_real_distribution<double> u(-1, 1);
    for (const std::uint32_t n : c.g.active.nodes) {
      c.g.node[n].nx = u(random);
      c.g.node[n].ny = u(random);
    }
    const std::uint32_t apart = c.g.active.nodes[c.g.active.nodes.size() / 2];
    c.g.separate_strain_velocities(apart);
    c.g.strain_velocity(apart).x += own;
    GatherSums sums;
    EXPECT_TRUE(moves_with_strain(c.g, c.scheme));
    if (!together) sums = gather_velocity(p, c.g, c.scheme, dt, threads);
    strain_and_update_stress(c.materials, p, c.g, c.scheme, dt, threads, together ? &sums : nullptr);
    std::vector<double> all{sums.fastest2, sums.kinetic_loss, double(sums.good)};
    for (const Array* a : p.state()) all.insert(all.end(), a->begin(), a->end());
    return all;
  };
  on_every_target([&] {
    for (const ShapeKind shape : {ShapeKind::gimp, ShapeKind::bspline})
      for (const Locking locking : {Locking::none, Locking::fbar}) {
        const auto apart = after(shape, locking, false, 1, 0.5), together = after(shape, locking, true, 1, 0.5);
        ASSERT_EQ(apart.size(), together.size());
        EXPECT_EQ(together[2], 1);
        for (std::size_t i = 0; i < apart.size(); ++i) ASSERT_NEAR(apart[i], together[i], 1e-12 * (1 + std::abs(apart[i]))) << i;
        EXPECT_EQ(together, after(shape, locking, true, 3, 0.5));
        EXPECT_NE(together, after(shape, locking, true, 1, 0));
      }
  });
}

// Lanes without a point read other cells' points, which another thread may have moved: whether it has must not show. The steps
// are so large that a tile goes now by the series, now point by point.
TEST(Lanes, TheOrderOfThePiecesDoesNotMatter) {
  SCOPED_TRACE(seed_of_all);
  const auto after = [](Locking locking, bool together, unsigned trial, bool reversed) {
    std::mt19937_64 random(seed_of_all + trial);
    std::uniform_real_distribution<double> u(-1, 1);
    const Scene s = scene(Grid{{0, 0}, {0.1, 0.1}, 41, 31}, {rectangle("a", 0.2, 0.2, 3.6, 2.6)}, {elastic(1e5, 0.3, 1000)});
    const Scheme scheme{.shape = ShapeKind::bspline, .transfer = TransferKind::apic, .stress = StressUpdate::usl, .locking = locking};
    GridState g(s.grid, scheme.shape, 1, true);
    const Materials materials = materials_of(s);
    SolverState state = initial_state(s, scheme, g, materials);
    Particles& p = state.particles;
    g.rebuild(p);
    p.sort_as(g.cells.order, 1);
    for (std::size_t k = 0; k < p.size(); ++k) {
      p.x[k] += 0.04 * u(random);
      p.y[k] += 0.04 * u(random);
    }
    locate_all(p, g);
    average_mean_stress(p, g, scheme, 1);
    map_momentum(p, g, scheme, true, 1);
    const double size = trial % 2 ? 0.5 : 1;
    for (const std::uint32_t n : g.active.nodes) {
      g.node[n].nx = 8 + size * u(random);
      g.node[n].ny = 8 + size * u(random);
    }
    EXPECT_GT(g.active.pieces.size(), 4u);
    if (reversed) {
      std::reverse(g.active.pieces.begin(), g.active.pieces.end());
      for (auto& parity : g.active.mapped.parity) std::reverse(parity.begin(), parity.end());
    }
    const double dt = 1e-3 * (1 + trial % 5);
    GatherSums sums;
    if (!together) sums = gather_velocity(p, g, scheme, dt, 1);
    strain_and_update_stress(materials, p, g, scheme, dt, 1, together ? &sums : nullptr);
    std::vector<double> all;
    for (const Array* a : p.state()) all.insert(all.end(), a->begin(), a->end());
    return all;
  };
  on_every_target([&] {
    for (const Locking locking : {Locking::none, Locking::fbar})
      for (const bool together : {true, false})
        for (unsigned trial = 0; trial < 20; ++trial)
          ASSERT_EQ(after(locking, together, trial, false), after(locking, together, trial, true)) << trial << together;
  });
}

// A changing strength point by point: what VariableMohrCoulomb does in lanes.
class InScalarCode final : public Material {
 public:
  explicit InScalarCode(const MaterialOptions& o)
      : Material(Elastic(o.young_pa, o.poisson)), strength_(o, 0.1), tension_(o.tension_pa) {}
  void update(const StressBatch& b) const override {
    for (std::size_t k = 0; k < b.size; ++k) {
      const double pressure = -(b.xx[k] + b.yy[k] + b.zz[k]) / (3 * b.J[k]);
      MohrCoulomb(elastic_, strength_.at(b.history[plastic::strain][k], pressure), tension_).update_point(b, k);
    }
  }

 private:
  StrengthLaw strength_;
  double tension_;
};

// Sloan's substeps point by point.
class SmoothInScalarCode final : public Material {
 public:
  explicit SmoothInScalarCode(const MaterialOptions& o) : Material(Elastic(o.young_pa, o.poisson)), law_(make_material(o, "m", 0.1)) {}
  void update(const StressBatch& b) const override {
    for (std::size_t k = 0; k < b.size; ++k) dynamic_cast<const SmoothMohrCoulomb&>(*law_).update_point(b, k);
  }

 private:
  std::unique_ptr<Material> law_;
};

// What points of the smooth law met in their steps.
struct Met {
  int crossed = 0;      // began to yield
  int had_opened = 0;   // yielded, closed again after they had been open
  int stood_open = 0;   // before and after
  int closed = 0;

  void count(const SmoothMohrCoulomb& law, const StressBatch& before, const std::vector<std::vector<double>>& after) {
    for (std::size_t k = 0; k < before.size; ++k) {
      const Tensor stress{before.xx[k], before.yy[k], before.zz[k], before.xy[k]};
      const double yield = law.relative_yield(stress, before.history[plastic::strain][k], before.J[k]);
      const bool flowed = after[10][k] > before.history[plastic::strain][k], open = before.history[plastic::opening][k] > 0;
      const bool opens = after[12][k] > 0;
      crossed += !open && !opens && flowed && yield < -1e-4;
      had_opened += !open && !opens && flowed && before.flags[plastic::separated][k];
      stood_open += open && opens;
      closed += open && !opens;
    }
  }
};

// A batch in lanes is what its points are one by one, whatever lanes they are in and wherever they are stored.
TEST(Lanes, ABatchIsItsPoints) {
  enum Way { together, by_places, singly };
  const auto advance = [](const Material& law, double strain, std::size_t n, Way way, std::vector<double>& out,
                          const SmoothMohrCoulomb* smooth = nullptr, Met* met = nullptr) {
    std::mt19937_64 random(seed_of_all);
    std::normal_distribution<double> normal(0, 1);
    std::vector<std::vector<double>> a(14, std::vector<double>(n));
    std::vector<std::uint8_t> separated(n, 0);
    for (double& J : a[5]) J = 1;
    StressBatch b;
    b.size = n;
    b.de_xx = a[0].data(), b.de_yy = a[1].data(), b.de_zz = a[2].data(), b.de_xy = a[3].data();
    b.spin = a[4].data(), b.J = a[5].data();
    b.xx = a[6].data(), b.yy = a[7].data(), b.zz = a[8].data(), b.xy = a[9].data();
    b.history = {a[10].data(), a[11].data(), a[12].data()}, b.flags = {separated.data()};
    std::vector<std::uint32_t> place(n);  // some tiles lie together, others do not
    for (std::size_t k = 0; k < n; ++k) place[k] = std::uint32_t(way == by_places && k >= 16 ? 16 + (k - 16) * 5 % (n - 16) : k);
    if (way == by_places) b.places = place.data();
    for (int step = 0; step < (smooth ? 200 : 300); ++step) {
      const double pressed = smooth ? (step / 4 % 2 ? 0.8 : -0.6) : 0.3;  // that it opens and closes
      for (std::size_t k = 0; k < n; ++k) {
        const double size = strain * std::pow(10, -5 + 0.1 * double(k % 20)) * (step % 7 == 0 ? 10 : 1);
        for (std::size_t c = 0; c < 5; ++c) a[c][k] = size * (normal(random) - (c < 2 ? pressed : 0));
        a[5][place[k]] = 1 + 0.01 * std::sin(double(step + int(k)));
      }
      auto before = a;
      auto had_separated = separated;
      if (way != singly) law.update(b);
      else
        for (std::size_t k = 0; k < n; ++k) law.update(b.part(k, 1));
      if (met) {
        StressBatch was = b;
        was.J = before[5].data(), was.xx = before[6].data(), was.yy = before[7].data(), was.zz = before[8].data();
        was.xy = before[9].data(), was.history = {before[10].data(), before[11].data(), before[12].data()};
        was.flags = {had_separated.data()};
        met->count(*smooth, was, a);
      }
    }
    out.clear();
    for (std::size_t c = 6; c < 13; ++c)
      for (const std::uint32_t k : place) out.push_back(a[c][k]);
    for (const std::uint32_t k : place) out.push_back(separated[k]);
  };
  const Elastic stiffness(1e7, 0.3);
  std::vector<std::unique_ptr<Material>> laws;
  laws.push_back(make_material(elastic(1e7, 0.3, 1000), "material.a"));
  laws.push_back(std::make_unique<MohrCoulomb>(stiffness, 30, 0, 0, 0));
  laws.push_back(std::make_unique<MohrCoulomb>(stiffness, 35, 10, 2000, 500));
  laws.push_back(std::make_unique<MohrCoulomb>(stiffness, 0, 0, 3000, 1e300));
  std::vector<std::unique_ptr<Material>> plain(laws.size());
  MaterialOptions soft = sand(40, 1e7);
  soft.friction_residual_deg = 25;
  soft.softening_shape = 20;
  laws.push_back(make_material(soft, "material.b", 0.1));
  plain.push_back(std::make_unique<InScalarCode>(soft));
  soft.cohesion_pa = 3000;
  soft.cohesion_residual_pa = 500;
  soft.tension_pa = 400;
  soft.dilatancy_deg = 12;
  soft.dilatancy_fade = 0.05;
  soft.friction_low_stress_deg = 48;
  soft.friction_half_pa = 5000;
  laws.push_back(make_material(soft, "material.c", 0.1));
  plain.push_back(std::make_unique<InScalarCode>(soft));
  const std::size_t exact = laws.size();  // from here on: to the substeps' tolerance of yielding
  for (MaterialOptions o : {sand(35, 1e7), soft}) {
    o.model = "mohr_coulomb_smooth";
    laws.push_back(make_material(o, "m", 0.1));
    plain.push_back(std::make_unique<SmoothInScalarCode>(o));
  }
  for (std::size_t l = exact; l < laws.size(); ++l) {
    Met met;
    std::vector<double> each;
    advance(*plain[l], 0.3, 37, singly, each, dynamic_cast<const SmoothMohrCoulomb*>(laws[l].get()), &met);
    EXPECT_GT(met.crossed, 150);
    EXPECT_GT(met.had_opened, 200);
    EXPECT_GT(met.stood_open, 600);
    EXPECT_GT(met.closed, 40);
  }
  for (std::size_t l = 0; l < laws.size(); ++l)
    on_every_target([&] {
      const double strain = l < exact ? 1 : 0.3;
      const auto* smooth = dynamic_cast<const SmoothMohrCoulomb*>(laws[l].get());
      std::vector<double> each;
      advance(plain[l] ? *plain[l] : *laws[l], strain, 37, singly, each, smooth);
      double scale = 0;
      for (std::size_t k = 0; k < 4 * 37; ++k) scale = std::max(scale, std::abs(each[k]));
      for (const Way way : {together, by_places}) {
        SCOPED_TRACE(way);
        std::vector<double> all;
        advance(*laws[l], strain, 37, way, all, smooth);
        for (std::size_t k = 0; k < all.size(); ++k) ASSERT_NEAR(all[k], each[k], (l < exact ? 1e-10 : 1e-7) * scale) << l << ' ' << k;
      }
    });
}

}  // namespace
}  // namespace pivnp::mpm
