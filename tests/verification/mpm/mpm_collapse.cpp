// Dry columns that collapse on a rough base: trend of the run-out, Lube et al. 2005 (two-dimensional):
// (d - d0)/d0 = 1.2 a below a = 1.8, 1.9 a^(2/3) above 2.8, a = h0/d0 (figures recalled from a secondary source).
// Criterion: run-out (99.5 % of the mass) within a factor of 0.5 to 1.5 of the law, growing with a; the scheme gains no
// energy (residual at most +1 %, at least -10 % of the energy released).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/mpm/scenes.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/verification.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
SilentProgress silent;

double run_out(double aspect) {
  const double d0 = 0.1, h0 = aspect * d0, h = 0.005;
  Scene s = scene(Grid{{0, 0}, {h, h}, 161, int(h0 / h) + 5}, {rectangle("sand", 0, 0, d0, h0)}, {sand(30)});
  s.boundaries = {{"base", line({0, 0}, {0.8, 0}, "fixed")}, {"wall", line({0, 0}, {0, h0 + 0.02}, "roller")}};
  Solver solver(options({0, -9.81}), s, 2);
  solver.advance_to(6 * std::sqrt(h0 / 9.81), silent);
  const MotionFrame frame = solver.frame();
  std::vector<double> x;
  for (std::size_t k = 0; k < frame.u.size(); ++k) x.push_back(s.particles.x0[k].x() + double(frame.u[k][0]));
  std::sort(x.begin(), x.end());
  const double front = x[std::size_t(0.995 * double(x.size()))];
  const EnergyRow e = solver.energy();
  std::printf("collapse a %.1f: (d - d0)/d0 %.2f, residual %+.2f %% of the energy released, kinetic left %.1e of it\n",
              aspect, (front - d0) / d0, 100 * e.residual / e.external, e.kinetic / e.external);
  EXPECT_LT(e.residual, 0.01 * e.external);
  EXPECT_GT(e.residual, -0.10 * e.external);
  EXPECT_LT(e.kinetic, 0.02 * e.external);
  return (front - d0) / d0;
}

TEST(MpmCollapse, RunOutFollowsTheTrend) {
  double last = 0;
  for (const double aspect : {0.6, 1.2, 3.0}) {
    const double law = aspect < 1.8 ? 1.2 * aspect : 1.9 * std::pow(aspect, 2.0 / 3);
    const double found = run_out(aspect);
    EXPECT_GT(found, 0.5 * law);
    EXPECT_LT(found, 1.5 * law);
    pivnp::test::verification_row("column collapse", "run-out over the law of Lube et al. (2005), 1/1.5 to 1.5", number(found / law, 3));
    EXPECT_GT(found, last);
    last = found;
  }
}

}  // namespace
}  // namespace pivnp::mpm
