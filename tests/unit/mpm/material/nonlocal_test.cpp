// Non-local softening: the average's invariants, bits, restart, and what does not use it.
#include <gtest/gtest.h>

#include <random>

#include "mpm/material/model.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/frames.hpp"
#include "mpm/transfer/nonlocal.hpp"
#include "mpm/transfer/transfer.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/material/shear_band.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
MaterialOptions averaged(double length) {
  MaterialOptions m = softening_soil(20);
  m.softening_length_m = length;
  m.softening_average = SofteningAverage::nonlocal;
  return m;
}

// A block of 40 x 40 cells of 10 mm in a larger grid, its state and what averages it.
struct Block {
  Scene scene_;
  Scheme scheme;
  GridState g;
  Materials materials;
  Particles p;
  NonlocalSoftening nonlocal;

  explicit Block(ShapeKind shape, std::vector<MaterialOptions> soils)
      : scene_(scene(Grid{{0, 0}, {0.01, 0.01}, 61, 51}, {rectangle("a", 0.1, 0.05, 0.5, 0.45)}, soils)),
        g(scene_.grid, shape, 1, false, {.own_strain_velocity = true, .averages = true, .averaged = true}),
        materials(materials_of(scene_)),
        nonlocal(materials, g) {
    scheme.shape = shape;
    p = initial_state(scene_, scheme, g, materials).particles;
    locate_all(p, g);
  }
  Array& plastic_dev() { return *p.history.find(plastic_strain.name); }
  std::size_t nearest(const Vec2& x) const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < p.size(); ++k)
      if (std::hypot(p.x[k] - x.x(), p.y[k] - x.y()) < std::hypot(p.x[best] - x.x(), p.y[best] - x.y())) best = k;
    return best;
  }
};

class Nonlocal : public testing::TestWithParam<ShapeKind> {};

TEST_P(Nonlocal, AUniformStrainIsItsOwnAverage) {
  Block b(GetParam(), {averaged(0.03)});
  std::fill(b.plastic_dev().begin(), b.plastic_dev().end(), 0.3);
  b.nonlocal.average(b.p, b.g, 1);
  for (std::size_t k = 0; k < b.p.size(); ++k) ASSERT_NEAR(b.p.softened_by[k], 0.3, 1e-13) << k;
}

// 2 kbar - k of a linear strain is itself, away from the edges; of x^2 it is x^2 + 2 l^2/2.
TEST_P(Nonlocal, ItsSecondMomentIsHalfTheSquaredLength) {
  for (const double l : {0.011, 0.02, 0.045}) {
    Block b(GetParam(), {averaged(l)});
    for (const bool along_x : {true, false}) {
      for (std::size_t k = 0; k < b.p.size(); ++k) {
        const double x = (along_x ? b.p.x[k] : b.p.y[k]) - 0.02;
        b.plastic_dev()[k] = x * x;
      }
      b.nonlocal.average(b.p, b.g, 1);
      double sum = 0, n = 0;
      for (std::size_t k = 0; k < b.p.size(); ++k)
        if (std::abs(b.p.x[k] - 0.3) < 0.02 && std::abs(b.p.y[k] - 0.25) < 0.02) {
          sum += b.p.softened_by[k] - b.plastic_dev()[k];
          n += 1;
        }
      // (The two hats' share is h^2/3 for points anywhere in their cells, 3/8 h^2 a quarter of a cell from the nodes.)
      EXPECT_NEAR(sum / n, l * l + 2 * (3.0 / 8 - 1.0 / 3) * 1e-4, 1e-4 * l * l) << l;
    }
  }
}

TEST_P(Nonlocal, StaysWithinItsMaterial) {
  Block b(GetParam(), {averaged(0.03), softening_soil(20)});
  for (Particles::Body& body : b.p.bodies) body.end = b.p.size() / 2;
  b.p.bodies.push_back({b.p.size() / 2, b.p.size(), 1});
  std::fill(b.plastic_dev().begin(), b.plastic_dev().begin() + std::ptrdiff_t(b.p.size() / 2), 0.1);
  std::fill(b.plastic_dev().begin() + std::ptrdiff_t(b.p.size() / 2), b.plastic_dev().end(), 5.0);
  b.nonlocal.average(b.p, b.g, 1);
  for (std::size_t k = 0; k < b.p.size(); ++k) ASSERT_NEAR(b.p.softened_by[k], k < b.p.size() / 2 ? 0.1 : 0, 1e-13);
}

// A line of slip counts less at its centre than at its sides: what keeps a band from narrowing.
TEST_P(Nonlocal, ANarrowBandSoftensItsSides) {
  Block b(GetParam(), {averaged(0.04)});
  for (std::size_t k = 0; k < b.p.size(); ++k) b.plastic_dev()[k] = std::abs(b.p.y[k] - 0.255) < 0.005 ? 1 : 0;
  b.nonlocal.average(b.p, b.g, 1);
  EXPECT_LT(b.p.softened_by[b.nearest({0.3, 0.255})], b.p.softened_by[b.nearest({0.3, 0.275})]);
  EXPECT_NEAR(b.p.softened_by[b.nearest({0.3, 0.44})], 0, 1e-6);
}

TEST_P(Nonlocal, BitsDoNotDependOnThreads) {
  constexpr unsigned seed = 5;
  SCOPED_TRACE(seed);
  Block one(GetParam(), {averaged(0.03)}), three(GetParam(), {averaged(0.03)});
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> strain(0, 1);
  for (std::size_t k = 0; k < one.p.size(); ++k) one.plastic_dev()[k] = three.plastic_dev()[k] = strain(random);
  one.nonlocal.average(one.p, one.g, 1);
  three.nonlocal.average(three.p, three.g, 3);
  EXPECT_TRUE(one.p.softened_by == three.p.softened_by);
}

TEST_P(Nonlocal, SleepingPointsCountAsTheOthersDo) {
  Block all(GetParam(), {averaged(0.03)}), some(GetParam(), {averaged(0.03)});
  std::vector<std::uint8_t> asleep(some.g.blocks.count(), 0);
  for (std::size_t b = 0; b < asleep.size(); b += 2) asleep[b] = 1;
  some.g.set_asleep(asleep);
  for (Block* block : {&all, &some}) {
    for (std::size_t k = 0; k < block->p.size(); ++k) block->plastic_dev()[k] = block->p.x[k] * block->p.y[k];
    block->nonlocal.average(block->p, block->g, 2);
  }
  std::size_t awake = 0;
  for (std::size_t k = 0; k < some.p.size(); ++k) {
    if (some.g.blocks.sleeps(some.p.cell[k])) continue;
    ++awake;
    ASSERT_NEAR(some.p.softened_by[k], all.p.softened_by[k], 1e-12) << k;
  }
  EXPECT_GT(awake, 100u);
  EXPECT_LT(awake, some.p.size() - 100);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Nonlocal, testing::Values(ShapeKind::bilinear, ShapeKind::bspline));

TEST(NonlocalSoftening, ARunGoesOnWithTheSameBitsAfterARestart) {
  for (const char* model : {"mohr_coulomb", "mohr_coulomb_smooth"}) {
    MaterialOptions m = averaged(0.01);
    m.model = model;
    const Scene s = compressed_specimen(0.008, m);
    Solver whole(shear_options(), s, 1), first(shear_options(), s, 3), second(shear_options(), s, 1);
    whole.advance_to(0.014, silent);
    first.advance_to(0.014, silent);
    EXPECT_TRUE(whole.save() == first.save());
    second.load(first.save());
    whole.advance_to(0.016, silent);
    second.advance_to(0.016, silent);
    EXPECT_TRUE(whole.save() == second.save());
    EXPECT_GT(whole.energy().plastic, 1);
  }
}

TEST(NonlocalSoftening, NeedsNothingWhereItIsNotUsed) {
  Block b(ShapeKind::bspline, {softening_soil(20)});
  b.nonlocal.average(b.p, b.g, 1);
  EXPECT_TRUE(b.p.softened_by.empty());
}

TEST(NonlocalSoftening, NonsenseNamesItsKey) {
  const auto expect = [](auto&& change, const std::string& key, const std::string& found) {
    MaterialOptions m = averaged(0.03);
    change(m);
    try {
      make_material(m, "material.sand", 0.02);
      FAIL() << key;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("material.sand." + key), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(found), std::string::npos) << e.what();
    }
  };
  expect([](auto& m) { m.softening_length_m.reset(); }, "softening_length_m", "missing");
  expect([](auto& m) { m.softening_length_m = 0.015; }, "softening_length_m", "0.015");
  expect([](auto& m) { m.model = "drucker_prager"; }, "", "drucker_prager");
}

}  // namespace
}  // namespace pivnp::mpm
