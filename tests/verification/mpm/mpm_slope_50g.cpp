// datasets/slope_50g: the thesis' section 3.3. Published: 0.4 m of displacement (prototype) at failure, one band from the
// block's rear edge towards the toe; no load printed. Criteria: the slope carries its own weight and fails under a load
// that the case reaches, moving below the block toward the toe; model (50 g) and prototype agree to 1e-9 for lengths and
// times 64 times larger (exact in binary numbers; at 50 times the float32 areas of the particles differ by 1e-8, which
// yielding sand amplifies).
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <filesystem>

#include "apps/case/case.hpp"
#include "apps/study/scene.hpp"
#include "mpm/solver.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/verification.hpp"

namespace pivnp::app {
namespace {

SilentProgress silent;

struct Setup {
  double cell_m = 0.0032, speed = 1, scale = 1;  // times 50: the prototype
  int per_element = 9;
};

struct Loaded {
  double onset_kn = 0, end_kn = 0;  // prototype, kN/m: at 0.02 m of the block's settlement; at the end
  double most_m = 0;                // greatest displacement, prototype
  double band_x = 0;                // mean x of strongly sheared points, model
  MotionFrame frame;
  Vec2 block;
};

Case scaled(const Setup& setup) {
  Case c = read_case(std::filesystem::path(PIVNP_SOURCE_DIR) / "datasets" / "slope_50g" / "case.toml");
  c.grid.spacing_m = setup.cell_m * setup.scale;
  const auto lengths = [&](Points& points) {
    for (Pair& p : points) p = {p[0] * setup.scale, p[1] * setup.scale};
  };
  lengths(c.grid.area_m);
  for (auto& [name, region] : c.regions) lengths(region.polygon_m);
  for (auto& [name, boundary] : c.boundaries) lengths(boundary.line_m);
  for (auto& [name, body] : c.bodies) {
    lengths(body.polygon_m);
    body.mass_kg_m = *body.mass_kg_m * setup.scale * setup.scale;
    body.mass_end_kg_m = *body.mass_end_kg_m * setup.scale * setup.scale;
    body.mass_until_s = *body.mass_until_s * setup.scale / setup.speed;
  }
  c.mpm->per_element = setup.per_element;
  c.mpm->gravity_m_s2 = {0, c.mpm->gravity_m_s2[1] / setup.scale};
  c.mpm->end_s = *c.mpm->end_s * setup.scale / setup.speed;
  c.mpm->end_displacement_m = *c.mpm->end_displacement_m * setup.scale;
  return c;
}

Loaded load(const Setup& setup, double share_of_time = 1) {
  const Case c = scaled(setup);
  const Setting setting = make_setting(c, 0, 0);
  mpm::Solver solver(*c.mpm, make_scene(c, setting, *c.mpm, c.materials, "material."), 1);
  const std::clock_t before = std::clock();
  solver.settle(silent);
  Loaded out;
  const double to_prototype = 50 / setup.scale, end = *c.mpm->end_s * share_of_time;
  const auto force_kn = [&] {
    return solver.body_mass(0) * to_prototype * to_prototype * 9.81 / 1000;
  };
  for (int k = 1; k <= 200; ++k) {
    solver.advance_to(end * k / 200, silent);
    const double settled = -solver.body_displacement(0).y() * to_prototype;
    if (out.onset_kn == 0 && settled > 0.02) out.onset_kn = force_kn();
    out.most_m = 0;
    out.frame = solver.frame();
    for (const auto& u : out.frame.u)
      out.most_m = std::max(out.most_m, std::hypot(double(u[0]), double(u[1])) * to_prototype);
    out.most_m = std::max(out.most_m, solver.body_displacement(0).norm() * to_prototype);
    out.end_kn = force_kn();
    if (out.most_m >= 0.4) break;
  }
  out.block = solver.body_displacement(0) * to_prototype;
  double n = 0;
  for (std::size_t k = 0; k < out.frame.u.size(); ++k)
    if (out.frame.plastic_dev[k] > 0.1f) {
      out.band_x += solver.particles().x0[k].x() / setup.scale;
      ++n;
    }
  out.band_x = n > 0 ? out.band_x / n : 0;
  const EnergyRow e = solver.energy();
  std::printf("cells %.2g m, speed %g, scale %g: onset %.1f, end %.1f kN/m, most %.3f m, block (%.3f, %.3f) m turn, band x %.3f, "
              "residual %+.1f %%, steps %lld, %.0f s CPU\n",
              setup.cell_m, setup.speed, setup.scale, out.onset_kn, out.end_kn, out.most_m, out.block.x(), out.block.y(),
              out.band_x, 100 * e.residual / e.external, static_cast<long long>(solver.steps()),
              double(std::clock() - before) / CLOCKS_PER_SEC);
  std::fflush(stdout);
  return out;
}

TEST(MpmSlope50g, ModelAndPrototypeAgree) {
  const Loaded model = load({.cell_m = 0.0032, .scale = 1, .per_element = 4}, 0.02);
  for (const double scale : {50.0, 64.0}) {
    const Loaded prototype = load({.cell_m = 0.0032, .scale = scale, .per_element = 4}, 0.02);
    double worst = 0, most = 0;
    for (std::size_t k = 0; k < model.frame.u.size(); ++k)
      for (std::size_t q = 0; q < 2; ++q) {
        worst = std::max(worst, std::abs(double(model.frame.u[k][q]) - double(prototype.frame.u[k][q]) / scale));
        most = std::max(most, std::abs(double(model.frame.u[k][q])));
      }
    pivnp::test::verification_row("slope at 50 g, prototype " + number(scale) + " times larger",
                                  "displacement agrees, of the slope's length (1e-9 at 64; at 50 float32 areas differ)",
                                  number(worst / 0.17, 2));
    EXPECT_GT(most, 0);
    EXPECT_LT(worst, (scale == 64 ? 1e-9 : 1e-4) * 0.17);
  }
}

TEST(MpmSlope50g, FailsUnderTheBlock) {
  const Loaded slow = load({.cell_m = 0.0032});
  pivnp::test::verification_row("slope at 50 g, cells of 160 mm", "stated: load at onset and at 0.4 m, prototype kN/m",
                                number(slow.onset_kn, 3) + " and " + number(slow.end_kn, 3));
  EXPECT_GE(slow.most_m, 0.4 * (1 - 1e-3));
  EXPECT_GT(slow.onset_kn, 20);
  EXPECT_GT(slow.end_kn, slow.onset_kn);
  EXPECT_GT(slow.band_x, 0.04);  // below and in front of the block's rear edge
  EXPECT_GT(slow.block.x(), 0.1);
}

}  // namespace
}  // namespace pivnp::app
