// Dry columns on a rough base: exponents of run-out and height against the aspect ratio a = h0/d0 (Lube et al. 2005,
// two-dimensional): (d - d0)/d0 ~ a below 1.8, ~ a^(2/3) above 2.8; h/d0 ~ a^(2/5) above 1.15. Criterion: each exponent
// within 0.1, from least squares of the logarithms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "pivnp/core/text.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
SilentProgress silent;

struct Heap {
  double run_out, height;  // over d0
};

Heap collapse(double aspect) {
  const double d0 = 0.1, h0 = aspect * d0, h = 0.01;
  Scene s = scene(Grid{{0, 0}, {h, h}, 121, int(std::lround(h0 / h)) + 5}, {rectangle("sand", 0, 0, d0, h0)}, {sand(30)});
  s.boundaries = {{"base", line({0, 0}, {1.2, 0}, "fixed")}, {"wall", line({0, 0}, {0, h0 + 0.02}, "roller")}};
  MpmOptions o = options({0, -9.81});
  o.locking = "none";  // F-bar lets sand that opens flow further (docs/limits.md)
  Solver solver(o, s, 1);
  solver.advance_to(6 * std::sqrt(h0 / 9.81), silent);
  const MotionFrame frame = solver.frame();
  std::vector<double> x, y;
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    x.push_back(s.particles.x0[k].x() + double(frame.u[k][0]));
    if (x.back() < h) y.push_back(s.particles.x0[k].y() + double(frame.u[k][1]));
  }
  std::sort(x.begin(), x.end());
  // Height: area in the column of cells at the wall over its width.
  const Heap heap{(x[std::size_t(0.995 * double(x.size()))] - d0) / d0, double(y.size()) * 0.25 * h / d0};
  std::printf("a %.1f: run-out %.2f, height %.2f\n", aspect, heap.run_out, heap.height);
  std::fflush(stdout);
  return heap;
}

double exponent(const std::map<double, double>& values, double from, double to) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& [a, v] : values) {
    if (a < from || a > to) continue;
    const double x = std::log(a), y = std::log(v);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

TEST(MpmCollapse, ExponentsOfRunOutAndHeight) {
  std::map<double, double> run_out, height;
  for (const double a : {0.5, 0.8, 1.2, 1.7, 3.0, 5.0, 8.0}) {
    const Heap heap = collapse(a);
    run_out[a] = heap.run_out;
    height[a] = heap.height;
  }
  const double flat = exponent(run_out, 0.5, 1.7), tall = exponent(run_out, 3, 8), top = exponent(height, 1.2, 8);
  pivnp::test::verification_row("column collapse", "exponent of run-out, a .5 to 1.7: 1 +- 0.1", number(flat, 3));
  pivnp::test::verification_row("column collapse", "exponent of run-out, a 3 to 8: 2/3 +- 0.1", number(tall, 3));
  pivnp::test::verification_row("column collapse", "exponent of height, a 1.2 to 8: 2/5 +- 0.1", number(top, 3));
  EXPECT_NEAR(flat, 1, 0.1);
  EXPECT_NEAR(tall, 2.0 / 3, 0.1);
  EXPECT_NEAR(top, 0.4, 0.1);
}

}  // namespace
}  // namespace pivnp::mpm
