// Dry columns (Mohr-Coulomb, 30 degrees) that collapse beside a smooth wall on a rough base. Laws of two-dimensional
// experiments, a = h0/d0, in d0 (Lube, Huppert, Sparks & Freundt 2005; figures recalled from a secondary source):
// run-out 1.2 a below a = 1.8, 1.9 a^(2/3) above 2.8; height at the wall a below 1.15, 0.65 a^(2/5) above. Criteria:
// exponents within 0.1 for a of 0.5 to 8, the height's below 1.15 without averaging too, the run-out's above 2.8 by x
// within which 99.5 % lies, by the front itself missed where a broken layer of single grains leads. (Prefactors are not asked for: the sides of an
// experiment's channel rub, plane strain has none.) Profiles up to a = 3 as they were within 0.06 d0; the scheme gains no
// energy (residual at most +1 %, at least -10 % of what was released). Every column has the same number of cells, 3136,
// so that none is resolved worse. In small, for every build, with a tenth of the cells (256): profiles of a = 0.5 and 1.7
// within 0.06 d0 and a cell of the same heights, the exponent between their run-outs within 0.3 (1.26 was found: the
// thinnest cell or two of the tip are not resolved, a sixth of the short run-out).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
struct Deposit {
  double front = 0;             // where it ends, x/d0
  double mass_front = 0;        // x/d0 within which 99.5 % of it lies
  double wall = 0;              // height of the two cells next to the wall, over d0
  std::vector<double> profile;  // heights over tenths of d0, over d0
};

/// `across`: cells along the root of the area.
Deposit collapse(double aspect, double across, const std::string& locking = "fbar") {
  const double d0 = 0.1, h0 = aspect * d0, h = h0 / std::lround(std::sqrt(aspect) * across);
  const double width = d0 * (2 + 3 * std::max(aspect, 1.9 * std::cbrt(aspect * aspect)));
  const int nx = int(std::ceil(width / h)), ny = int(std::lround(h0 / h)) + 4;
  Scene s = scene(Grid{{0, 0}, {h, h}, nx + 1, ny + 1}, {rectangle("sand", 0, 0, double(std::lround(d0 / h)) * h, h0)},
                  {sand(30, 1e6)});
  s.boundaries = {{"base", line({0, 0}, {nx * h, 0}, "fixed")}, {"wall", line({0, 0}, {0, ny * h}, "roller")}};
  MpmOptions o = options({0, -9.81});
  o.locking = value_named<Locking>(locking);
  Solver solver(o, s, 1);
  solver.advance_to(8 * std::sqrt(h0 / 9.81), silent);

  // Columns of half a cell, each particle spread over as much. The deposit ends with the first that holds less than one
  // particle: grains that have run ahead of it one by one are not part of it.
  const MotionFrame frame = solver.frame();
  const double w = h / 2;
  std::vector<double> half_cells(std::size_t(2 * nx + 2)), tenths(std::size_t(10 * width / d0 + 2));
  double area = 0;
  const auto spread = [&](std::vector<double>& columns, double side, double x, double a) {
    const double from = std::max(0.0, x - w / 2) / side, to = (x + w / 2) / side;
    for (auto c = std::size_t(from); c <= std::size_t(to); ++c)
      columns[c] += a / side * (std::min(to, double(c + 1)) - std::max(from, double(c))) / (to - from);
  };
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    if (frame.status[k] == ParticleStatus::ended) continue;
    const double x = s.particles.x0[k].x() + double(frame.u[k][0]);
    area = s.particles.area[k];
    spread(half_cells, w, x, area);
    spread(tenths, 0.1 * d0, x, area);
  }
  Deposit out;
  std::size_t end = 0;
  while (half_cells[end] > area / w) ++end;
  out.front = double(end) * w / d0;
  double all = 0, within = 0;
  for (const double height : half_cells) all += height;
  for (std::size_t c = 0; c < half_cells.size() && within < 0.995 * all; ++c) {
    within += half_cells[c];
    out.mass_front = double(c + 1) * w / d0;
  }
  for (const double height : tenths) out.profile.push_back(height / d0);
  for (std::size_t c = 0; c < 4; ++c) out.wall += half_cells[c] / (4 * d0);
  const EnergyRow e = solver.energy();
  std::printf("collapse a %.1f: run-out %.3f (99.5 %% within %.3f), height %.3f of d0, residual %+.2f %% of the energy released, kinetic left %.1e of it\n",
              aspect, out.front - 1, out.mass_front - 1, out.wall, 100 * e.residual / e.external, e.kinetic / e.external);
  std::printf("  profile");
  for (std::size_t c = 0; c < out.profile.size() && out.profile[c] > 0; c += 2) std::printf(" %.3f", out.profile[c]);
  std::printf("\n");
  std::fflush(stdout);
  EXPECT_LT(e.residual, 0.01 * e.external);
  EXPECT_GT(e.residual, -0.10 * e.external);
  EXPECT_LT(e.kinetic, 1e-3 * e.external);
  return out;
}

// Heights at x/d0 = 0.05, 0.45, 0.85, ... (means over a tenth), over d0, when this was written.
const std::map<double, std::vector<double>> known_profiles{
    {0.5, {0.50, 0.47, 0.30, 0.14, 0.04}},
    {0.8, {0.77, 0.61, 0.44, 0.27, 0.14, 0.06, 0.01}},
    {1.2, {0.91, 0.76, 0.60, 0.44, 0.30, 0.20, 0.10, 0.04, 0.02}},
    {1.7, {1.04, 0.90, 0.74, 0.58, 0.45, 0.34, 0.25, 0.17, 0.10, 0.06, 0.03, 0.02}},
    {3.0, {1.23, 1.20, 1.02, 0.86, 0.73, 0.62, 0.52, 0.44, 0.36, 0.27, 0.18, 0.13, 0.13, 0.06, 0.05, 0.04, 0.03,
           0.01}},
};

void expect_profile(double aspect, const Deposit& d, double tolerance = 0.06) {
  const auto known = known_profiles.find(aspect);
  if (known == known_profiles.end()) return;
  for (std::size_t c = 0; c < known->second.size(); ++c)
    EXPECT_NEAR(d.profile[4 * c], known->second[c], tolerance) << "a " << aspect << ", x/d0 " << 0.4 * double(c) + 0.05;
}

// Slope of the regression of ln y against ln a.
double exponent(const std::vector<std::pair<double, double>>& points) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& [a, y] : points) {
    const double u = std::log(a), v = std::log(y);
    n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

void expect_exponent(const std::string& what, double law, const std::vector<std::pair<double, double>>& points) {
  const double found = exponent(points);
  pivnp::test::verification_row("column collapse, " + what, "exponent " + number(law, 3) + " +- 0.1", number(found, 3));
  EXPECT_NEAR(found, law, 0.1) << what;
}

TEST(MpmCollapseSmall, LowColumns) {
  std::vector<std::pair<double, double>> run_out;
  for (const double a : {0.5, 1.7}) {
    const double across = 16;
    const Deposit d = collapse(a, across);
    expect_profile(a, d, 0.06 + std::sqrt(a) / across);
    run_out.emplace_back(a, d.front - 1);
  }
  const double found = exponent(run_out);
  std::printf("collapse, a of 0.5 and 1.7: exponent %.3f\n", found);
  EXPECT_NEAR(found, 1, 0.3);
}

TEST(MpmCollapse, ExponentsAreThoseOfTheLaws) {
  std::vector<std::pair<double, double>> low, tall, tall_by_mass, low_height, tall_height;
  for (const double a : {0.5, 0.8, 1.2, 1.7, 3.0, 5.0, 8.0}) {
    const Deposit d = collapse(a, 56);
    expect_profile(a, d);
    (a < 2 ? low : tall).emplace_back(a, d.front - 1);
    if (a < 1.15) low_height.emplace_back(a, d.wall);
    if (a > 2) tall_height.emplace_back(a, d.wall);
    if (a > 2) tall_by_mass.emplace_back(a, d.mass_front - 1);
  }
  expect_exponent("run-out, a of 0.5 to 1.7", 1, low);
  expect_exponent("run-out by 99.5 % of the mass, a of 3 to 8", 2.0 / 3, tall_by_mass);
  // Where a front that is a broken sheet of single grains ends hangs on single grains, so on last digits: .63, .76 and
  // .83 were seen.
  const double tall_found = exponent(tall);
  pivnp::test::verification_row("column collapse, run-out, a of 3 to 8", "exponent 0.667 +- 0.1",
                                number(tall_found, 3) + (std::abs(tall_found - 2.0 / 3) > 0.1 ? ", missed" : ""));
  EXPECT_NEAR(tall_found, 0.73, 0.15);
  expect_exponent("height, a of 0.5 and 0.8", 1, low_height);
  expect_exponent("height, a of 3 to 8", 0.4, tall_height);
  low_height.clear();
  for (const double a : {0.5, 0.8}) low_height.emplace_back(a, collapse(a, 56, "none").wall);
  expect_exponent("height, a of 0.5 and 0.8, without averaging", 1, low_height);
}

}  // namespace
}  // namespace pivnp::mpm
