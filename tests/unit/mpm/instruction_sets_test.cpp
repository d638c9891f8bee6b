// The instruction sets that the kernels are compiled for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mpm/transfer/lanes.hpp"
#include "tests/support/instruction_sets.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using pivnp::test::choose_best_instruction_set, pivnp::test::choose_instruction_set, pivnp::test::instruction_sets;

// The names of the sets that kernels were compiled for.
std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const std::int64_t set : instruction_sets()) {
    choose_instruction_set(set);
    out.emplace_back(simd_target());
  }
  choose_best_instruction_set();
  return out;
}

TEST(InstructionSets, TheBaselineIsAmongThem) {
  const std::vector<std::string> all = names();
  EXPECT_EQ(all.front(), simd_target());  // chosen by itself
  EXPECT_EQ(std::count(all.begin(), all.end(), "SCALAR"), 0);
#if defined(__x86_64__) && !defined(__SSE3__)
  EXPECT_EQ(all.back(), "SSE2");
#endif
}

// Sums go by the lanes, products and sums are fused where the set has it: round-off apart, whole runs agree.
TEST(InstructionSets, AllGiveTheSameRun) {
  struct Setting {
    const char *shape, *transfer, *stress_update, *locking;
    bool smooth;
  };
  const Setting settings[] = {{"bspline", "apic", "usl", "fbar", false},
                              {"bspline", "apic", "usl", "none", true},
                              {"bilinear", "flip", "musl", "fbar", true},
                              {"bilinear", "flip", "musl", "selective", false},
                              {"gimp", "xpic", "usl", "fbar", false},
                              {"gimp", "flip", "usf", "none", false}};
  for (const Setting& s : settings) {
    std::vector<MotionFrame> ends;
    for (const std::int64_t set : instruction_sets()) {
      choose_instruction_set(set);
      MaterialOptions m = test::sand(38, 1e6);
      if (s.smooth) m.model = "mohr_coulomb_smooth";
      m.friction_residual_deg = 28;
      m.softening_shape = 10;
      m.dilatancy_deg = 8;
      m.dilatancy_fade = 0.1;
      MpmOptions o = test::options({2, -9.81});
      o.courant = 0.4;
      o.shape = value_named<ShapeKind>(s.shape);
      o.transfer = value_named<TransferKind>(s.transfer);
      o.stress_update = value_named<StressUpdate>(s.stress_update);
      o.locking = value_named<Locking>(s.locking);
      Scene scene = test::column(0.08, m);
      scene.boundaries.pop_back();  // it falls over
      scene.particles.x0[5] += Vec2(1e-3, -2e-3);
      Solver solver(o, std::move(scene), 1);
      SilentProgress silent;
      solver.advance_to(200 * solver.stable_step(), silent);
      ends.push_back(solver.frame());
      const MotionFrame &f = ends.back(), &best = ends.front();
      const FieldValues plastic_dev = f.field("plastic_dev");
      EXPECT_GT(*std::max_element(plastic_dev.values.begin(), plastic_dev.values.end()), 0) << s.shape << s.transfer;
      double most = 0, apart = 0;
      for (std::size_t k = 0; k < f.u.size(); ++k)
        for (std::size_t c = 0; c < 2; ++c) {
          most = std::max(most, std::abs(double(best.u[k][c])));
          apart = std::max(apart, std::abs(double(f.u[k][c]) - double(best.u[k][c])));
        }
      EXPECT_LT(apart, 1e-4 * most) << simd_target() << ' ' << s.shape << ' ' << s.transfer;  // (falling grains part quickly)
    }
    choose_best_instruction_set();
  }
}

}  // namespace
}  // namespace pivnp::mpm
