// Contact between deformable bodies, gravity turned instead of the plane (30 degrees unless said otherwise). Criteria:
// block on a bed: path within 2 % of g (sin t - mu cos t) t^2/2, and at rest where mu > tan t; cylinder of 16 cells'
// radius: within 2 % of (2/3) g sin t without slip and of g (sin t - mu cos t) where mu < tan t/3, for a smooth outline
// (points in rings) and for points of the lattice, an outline of steps; sand on glass: within 2 %. In small, for every
// build: the block on cells twice as wide within the same 2 % (0.4 was found), a cylinder of 4 cells' radius within 5 %
// (2.7 when it rolls: where it touches is known to half a cell, an eighth of the radius).
#include <gtest/gtest.h>

#include <cmath>

#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
constexpr double g = 9.81, degree = M_PI / 180;

Pair turned_gravity(double slope_deg) { return {g * std::sin(slope_deg * degree), -g * std::cos(slope_deg * degree)}; }

ContactOptions meets(const std::string& region, double friction) {
  ContactOptions o;
  o.regions = {region};
  o.friction = friction;
  return o;
}

// Mean displacement along x of the points of label 1; `in_equilibrium`: first under its weight.
Vec2 path(const Scene& s, double slope_deg, double time, bool in_equilibrium) {
  MpmOptions o = options(turned_gravity(slope_deg));
  o.end_at_rest = false;
  Solver solver(o, s, 1);
  if (in_equilibrium) solver.find_initial_equilibrium(silent);
  solver.advance_to(time, silent);
  EXPECT_EQ(solver.ended(), 0u);
  const EnergyRow e = solver.energy();
  EXPECT_LT(std::abs(e.residual), 0.03 * e.external + 0.05 * e.elastic);
  const MotionFrame frame = solver.frame();
  Vec2 sum(0, 0);
  double n = 0;
  for (std::size_t k = 0; k < frame.u.size(); ++k)
    if (s.particles.label[k] == 1) {
      sum += Vec2(double(frame.u[k][0]), double(frame.u[k][1]));
      ++n;
    }
  return sum / n;
}

Scene block_on_bed(double slope_deg, double friction, double h = 0.01) {
  Scene s = scene(Grid{{0, 0}, {h, h}, int(std::lround(0.6 / h)) + 1, int(std::lround(0.11 / h)) + 1},
                  {rectangle("bed", 0, 0, 0.6, 0.04), rectangle("block", 0.05, 0.04, 0.15, 0.09)},
                  {elastic(2e7, 0.3, 2000), elastic(2e6, 0.2, 2000)});
  for (std::size_t k = 0; k < s.particles.size(); ++k) {  // with the stresses of its own weight it does not bounce
    const double across =
        s.particles.label[k] == 1 ? -2000 * g * std::cos(slope_deg * degree) * (0.09 - s.particles.x0[k].y()) : 0;
    s.stress0.push_back({0.25 * across, across, 0.25 * across, 0});
  }
  s.boundaries = {{"base", line({0, 0}, {0.6, 0}, "fixed")}};
  s.contacts = {{"face", meets("block", friction)}};
  return s;
}

TEST(MpmContact, ABlockSlidesOnABed) {
  const double time = 0.3;
  for (const double friction : {0.0, 0.2, 0.4}) {
    const double exact = 0.5 * g * (std::sin(30 * degree) - friction * std::cos(30 * degree)) * time * time;
    const double found = path(block_on_bed(30, friction), 30, time, false).x();
    pivnp::test::verification_row("deformable block on a deformable bed, friction " + number(friction),
                                  "path over that of g (sin t - mu cos t) within 2 %", number(found / exact, 4));
    EXPECT_NEAR(found, exact, 0.02 * exact);
  }
}

TEST(MpmContact, ABlockSticksWhereFrictionSuffices) {
  const double found = path(block_on_bed(30, 0.65), 30, 0.3, true).norm(), free = 0.25 * g * 0.09;
  pivnp::test::verification_row("deformable block on a deformable bed, friction 0.65", "path over a free block's below 0.1 %", number(found / free, 2));
  EXPECT_LT(found, 1e-3 * free);
}

// Cells twice as wide: the block is five wide and two and a half high, on a bed of two.
TEST(MpmContactSmall, ABlockSlidesAndSticks) {
  const double time = 0.2, friction = 0.2, slip = g * (std::sin(30 * degree) - friction * std::cos(30 * degree));
  const double exact = 0.5 * slip * time * time, found = path(block_on_bed(30, friction, 0.02), 30, time, false).x();
  std::printf("block, friction 0.2: %.4f of the rigid one's path\n", found / exact);
  EXPECT_NEAR(found, exact, 0.02 * exact);
  const double stuck = path(block_on_bed(30, 0.65, 0.02), 30, time, true).norm();
  std::printf("block, friction 0.65: %.2e of a free one's path\n", stuck / (0.25 * g * time * time));
  EXPECT_LT(stuck, 1e-3 * 0.25 * g * time * time);
}

// Points in rings, so that the outline is round.
void add_rings(Scene& s, const Vec2& centre, double radius, double side) {
  const int rings = int(std::lround(radius / side));
  const double w = radius / rings;
  ParticleSet& p = s.particles;
  for (int k = 0; k < rings; ++k) {
    const double r = (k + 0.5) * w;
    const int n = int(std::lround(2 * M_PI * r / w));
    for (int q = 0; q < n; ++q) {
      const double at = 2 * M_PI * (q + 0.5) / n;
      p.id.push_back(decltype(p.id)::value_type(p.id.size()));
      p.label.push_back(1);
      p.x0.push_back(centre + r * Vec2(std::sin(at), -std::cos(at)));
      p.area.push_back(float(M_PI * (2 * k + 1) * w * w / n));
      p.born.push_back(p.born.front());
      p.end.push_back(p.end.front());
      p.end_reason.push_back(p.end_reason.front());
    }
  }
  p.label_names.push_back("cylinder");
}

Scene cylinder_on_bed(bool round, double friction, double cells) {
  const double radius = 0.08, h = radius / cells, bed = 0.04;
  const Vec2 centre(0.12, bed + radius);
  std::vector<Region> regions = {rectangle("bed", 0, 0, 0.44, bed)};
  if (!round) regions.push_back(disc("cylinder", centre, radius));
  Scene s = scene(Grid{{0, 0}, {h, h}, int(std::lround(0.44 / h)) + 1, int(std::lround(0.23 / h)) + 1}, regions,
                  {elastic(2e6, 0.3, 2000), elastic(2e6, 0.3, 2000)});
  if (round) add_rings(s, centre, radius, 0.5 * h);
  s.boundaries = {{"base", line({0, 0}, {0.44, 0}, "fixed")}};
  s.contacts = {{"face", meets("cylinder", friction)}};
  return s;
}

void roll(double slope_deg, bool round, double friction, double cells, double tolerance, double time = 0.3) {
  const double t = slope_deg * degree, slip = g * (std::sin(t) - friction * std::cos(t));
  const double exact = 0.5 * time * time * std::max(slip, 2.0 / 3 * g * std::sin(t));
  const double found = path(cylinder_on_bed(round, friction, cells), slope_deg, time, false).x();
  pivnp::test::verification_row(
      "cylinder on a bed at " + number(slope_deg) + " deg, radius of " + number(cells) + " cells, points in " +
          (round ? "rings" : "a lattice") + ", friction " + number(friction),
      "path over the rigid one's within " + number(100 * tolerance) + " %", number(found / exact, 4));
  EXPECT_NEAR(found, exact, tolerance * exact);
}

TEST(MpmContact, ACylinderRolls) {
  roll(30, true, 0.6, 8, 0.02);
  roll(30, true, 0.6, 16, 0.02);
}
TEST(MpmContact, ACylinderOfLatticePointsRolls) { roll(30, false, 0.6, 16, 0.02); }
TEST(MpmContact, ACylinderSlips) {
  roll(30, true, 0.1, 8, 0.02);
  roll(30, true, 0.1, 16, 0.02);
}
TEST(MpmContactSmall, ACylinderRollsAndSlips) {
  roll(30, true, 0.6, 4, 0.05, 0.2);
  roll(30, true, 0.1, 4, 0.05, 0.2);
}
TEST(MpmContact, ACylinderRollsDownASteeperSlope) { roll(40, true, 0.6, 16, 0.02); }

// A heap of sand on a glass plate; with common nodes it would stay where it is.
TEST(MpmContact, SandSlidesOnGlass) {
  const double slope = 20, friction = 0.2, time = 0.3, t = slope * degree;
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 56, 15},
                  {rectangle("glass", 0, 0, 0.55, 0.02),
                   {"sand", Polygon({{0.05, 0.02}, {0.45, 0.02}, {0.35, 0.06}, {0.15, 0.06}}, "sand")}},
                  {elastic(1e8, 0.2, 2500), sand(40)});
  s.boundaries = {{"plate", line({0, 0}, {0.55, 0}, "fixed")}};
  s.contacts = {{"face", meets("sand", friction)}};
  const double exact = 0.5 * g * (std::sin(t) - friction * std::cos(t)) * time * time;
  const double found = path(s, slope, time, false).x();
  s.contacts.clear();
  const double sticky = path(s, slope, time, false).x();
  pivnp::test::verification_row("sand on glass at 20 deg, friction 0.2", "path over that of a rigid block within 2 %",
                                number(found / exact, 4) + " (by common nodes " + number(sticky / exact, 2) + ")");
  EXPECT_NEAR(found, exact, 0.02 * exact);
  EXPECT_LT(sticky, 0.2 * exact);
}

}  // namespace
}  // namespace pivnp::mpm
