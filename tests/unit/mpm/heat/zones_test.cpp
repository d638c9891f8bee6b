// Zones of slip beside one another: that cross, and between which slip starts, stops and jumps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mpm/constraint/wall.hpp"
#include "mpm/heat/zone_width.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/frames.hpp"
#include "mpm/transfer/transfer.hpp"
#include "tests/verification/mpm/planar_slide.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

// Points of a block of cells of 0.1 m within some distance of lines through its middle, at angles from the x axis.
struct Zones {
  Scene scene_ = scene(Grid{{0, 0}, {0.1, 0.1}, 61, 61}, {rectangle("a", 0.3, 0.3, 5.7, 5.7)}, {elastic(1e6, 0.3, 1000)});
  GridState g{scene_.grid, ShapeKind::bilinear};
  Particles p;
  std::vector<double> shear, sense;

  Zones() {
    p = initial_state(scene_, {.shape = ShapeKind::bilinear}, g, materials_of(scene_)).particles;
    p.band_width.assign(p.size(), 0.0);
    shear.assign(p.size(), 0.0);
    sense.assign(p.size(), 0.0);
    g.rebuild(p);
  }
  Vec2 at(std::size_t k) const { return Vec2(p.x[k], p.y[k]) - Vec2(3.02, 3.01); }
  void slip(double angle, double half_width, double turns) {
    const Vec2 across(-std::sin(angle), std::cos(angle));
    for (std::size_t k = 0; k < p.size(); ++k)
      if (std::abs(at(k).dot(across)) < half_width) shear[k] += 1, sense[k] += turns;
  }
  void look() {
    const TiedSides none;
    ZoneWidth(g, none).look(p, g, shear, sense, 0);
  }
  // Least and greatest width of the points along a line, `from` to `to` from the middle.
  std::pair<double, double> widths(double angle, double half_width, double from, double to) const {
    const Vec2 along(std::cos(angle), std::sin(angle)), across(-std::sin(angle), std::cos(angle));
    double least = 1e9, most = 0;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double s = std::abs(at(k).dot(along));
      if (std::abs(at(k).dot(across)) < half_width && s >= from && s <= to) least = std::min(least, p.band_width[k]), most = std::max(most, p.band_width[k]);
    }
    return {least, most};
  }
};

// The width of a zone does not see one that crosses it, but for the cells which both share.
TEST(ZoneWidth, OfZonesThatCrossIsThatOfEach) {
  const double half = 0.1, low = 0.5, high = 2.1;
  Zones alone, both, unsigned_ones;
  alone.slip(low, half, 1);
  both.slip(low, half, 1);
  both.slip(high, half, -1);
  unsigned_ones.slip(low, half, 0);
  unsigned_ones.slip(high, half, 0);
  alone.look(), both.look(), unsigned_ones.look();
  const auto [least, most] = alone.widths(low, half, 0.2, 1.2);
  EXPECT_NEAR(least, 0.2, 0.02);
  EXPECT_NEAR(most, 0.2, 0.02);
  for (const double angle : {low, high}) {
    const auto [narrow, wide] = both.widths(angle, half, 0.2, 1.2);
    EXPECT_NEAR(narrow, 0.2, 0.025) << angle;
    EXPECT_NEAR(wide, 0.2, 0.025) << angle;
  }
  EXPECT_GT(unsigned_ones.widths(low, half, 0.2, 1.2).second, 0.3);
}

// A zone that is inclined to the grid goes on through sides that are tied with a shift: its width is the same all along. (Beside sides that
// end it, it is as much as half too small.)
TEST(ZoneWidth, GoesOnThroughSidesTiedWithAShift) {
  const int along = 7, up = 4;
  const double h = 0.1, half = 0.1, width = along * h, rise = up * h, low = 1.5;
  const auto seen = [&](bool tied) {
    Scene s = scene(Grid{{0, 0}, {h, h}, along + 1, 40}, {{"a", Polygon({{0, 0.5}, {width, 0.5 + rise}, {width, 2.5 + rise}, {0, 2.5}}, "a")}}, {elastic(1e6, 0.3, 1000)});
    GridState g(s.grid, ShapeKind::bilinear);
    Particles p = initial_state(s, {.shape = ShapeKind::bilinear}, g, materials_of(s)).particles;
    p.band_width.assign(p.size(), 0.0);
    std::vector<double> shear(p.size(), 0.0);
    const Vec2 across = Vec2(-rise, width).normalized();
    for (std::size_t k = 0; k < p.size(); ++k)
      if (std::abs((Vec2(p.x[k], p.y[k]) - Vec2(0, low)).dot(across)) < half) shear[k] = 1;
    g.rebuild(p);
    BoundaryOptions sides = line({0, 0}, {0, 3}, "tied");
    sides.across_m = Pair{width, rise};
    TiedSides ties;
    const std::vector<Wall> walls = walls_of({{"sides", sides}}, g, Vec2(0.5 * width, low), [](const Vec2&) { return std::array<double, 2>{}; });
    if (tied) ties.tie(walls[0], walls[1], g);
    ZoneWidth(g, ties).look(p, g, shear, shear, 0);
    double least = 1e9, most = 0;
    for (std::size_t k = 0; k < p.size(); ++k)
      if (shear[k] > 0) least = std::min(least, p.band_width[k]), most = std::max(most, p.band_width[k]);
    return std::pair{least, most};
  };
  const auto [least, most] = seen(true);
  EXPECT_NEAR(least, 2 * half, 0.02);
  EXPECT_NEAR(most, 2 * half, 0.02);
  EXPECT_LT(seen(false).first, 1.6 * half);
}

// Two layers of clay, each of two rows, in the planar slide. The lower one slips; then it has twice the strength, and the upper one, which
// had a tenth more, loses that: slip stops below and starts above. What is left of the strength, by the deviation of each layer, has no
// kink above 2 % of the stress; heat and water are kept.
TEST(HeatedZones, SlipThatStopsInOneAndStartsInAnotherHasNoKink) {
  for (const TransferKind transfer : {TransferKind::flip, TransferKind::apic}) {
    HeatedBand band;
    band.permeability = 1e-8;
    band.thickness = 0.005;
    PlanarSlide slide(band);
    SlideOptions o;
    o.rows = 2, o.above = 13, o.transfer = transfer;
    Scene s = slide_scene(slide, o);
    MaterialOptions lower = s.materials[1], upper = lower;
    lower.reduction_factor = 0.5;
    upper.friction_deg = std::asin(1.1 * band.tan_friction()) * 180 / M_PI;
    upper.reduction_factor = 1.12;
    lower.reduction_from_s = upper.reduction_from_s = 3;
    s.materials[1] = lower;
    s.materials.push_back(upper);
    s.particles.label_names.push_back("upper");
    const double low = o.below, again = low + 5;
    for (std::size_t k = 0; k < s.particles.size(); ++k)
      if (const double y = s.particles.x0[k].y(); y > again && y < again + 2) s.particles.label[k] = 3;
    Solver solver(slide_options(slide, o), s, 1);
    const EnergyRow start = solver.energy();
    double before[2] = {}, kink[2] = {}, slipped[2] = {}, at_jump[2] = {}, end[2] = {};
    for (double t = 0.01; t < 5; t += 0.01) {
      solver.advance_to(t, silent);
      const MotionFrame f = solver.frame();
      double over[2] = {}, sheared[2] = {};
      for (std::size_t k = 0; k < f.u.size(); ++k) {
        const int label = s.particles.label[k];
        if (label != 1 && label != 3) continue;
        const double g = double(f.field("plastic_dev")(k, 0));
        over[label == 3] += g * (double(f.field("band_pressure")(k, 0)) - double(f.field("pressure")(k, 0)));
        sheared[label == 3] += g;
      }
      for (const int zone : {0, 1}) {
        const double now = sheared[zone] > 0 ? over[zone] / sheared[zone] : 0;
        kink[zone] = std::max(kink[zone], std::abs(now - before[zone]));
        before[zone] = now;
        slipped[zone] = sheared[zone];
        if (t < 3) at_jump[zone] = sheared[zone];
        end[zone] = now;
      }
    }
    const EnergyRow e = solver.energy();
    EXPECT_LT(at_jump[1], 0.02 * at_jump[0]) << "first the lower one";
    EXPECT_LT(slipped[0], 1.2 * at_jump[0]) << "which stops";
    EXPECT_GT(slipped[1], at_jump[0]) << "then the upper one";
    for (const int zone : {0, 1}) {
      EXPECT_LT(kink[zone], 0.02 * slide.band.stress) << zone << " end " << end[zone];
      EXPECT_GT(end[zone], 0.02 * slide.band.stress) << zone;
    }
    EXPECT_LT(std::abs(e.heat - start.heat - e.heat_made - e.heat_inflow), 1e-9 * e.heat_made);
    EXPECT_LT(std::abs(e.water_mass - start.water_mass - e.water_inflow), 1e-12 * start.water_mass);
  }
}

// A block that is compressed between a smooth platen and base, cut by one layer of clay at 45 degrees or by two that
// cross: as wedges slide along both, each keeps the width that it has alone, but for the cells which both share.
struct Crossing {
  double width = 0, slip = 0;  // means over the arms: of the zone's width, by shear; of plastic shear
  double in_common = 0;        // the greatest width where they cross
  // Nothing leaves a band: it is warmer than its zone's mean by w/L; what it is off by, over the hottest.
  double wrong = 0;
  double heat_lost = 0, water_lost = 0;
};

Crossing compressed(bool both) {
  const double h = 0.1, side = 2, half = 0.1, thickness = 0.01, speed = 1;
  MaterialOptions block = elastic(1, 0.33, 0);
  block.young_pa = 4.5e8;
  block.porosity = 0.4;
  block.permeability_m_s = 1e-12;
  block.grain_density_kg_m3 = 2700;
  block.grain_specific_heat_j_kg_k = 837;
  block.conductivity_w_m_k = 0;
  MaterialOptions clay = block;
  clay.model = "von_mises";
  clay.shear_strength_pa = 1e5;
  clay.band_thickness_m = thickness;
  clay.band_compressibility_1_pa = 1.5e-9;
  Scene s = scene(Grid{{-0.5, 0}, {h, h}, 31, 24}, {rectangle("block", 0, 0, side, side)}, {block, clay});
  s.particles.label_names.push_back("clay");
  const auto across = [&](std::size_t k, bool other) {
    const Vec2 at = s.particles.x0[k] - Vec2(0.5 * side, 0.5 * side);
    return std::abs(other ? at.x() + at.y() : at.x() - at.y()) / std::sqrt(2.0);
  };
  for (std::size_t k = 0; k < s.particles.size(); ++k)
    if (across(k, false) < half || (both && across(k, true) < half)) s.particles.label[k] = 1;
  s.water.emplace();
  s.heat.emplace();
  s.boundaries = {{"base", line({-0.5, 0}, {2.5, 0}, "roller")}};
  RigidOptions platen;
  platen.polygon_m = {{-0.4, side}, {2.4, side}, {2.4, side + 0.2}, {-0.4, side + 0.2}};
  platen.velocity_m_s = {0, -speed};
  platen.friction = 0;
  s.bodies.emplace_back("platen", platen);
  MpmOptions o = options();
  o.initial_equilibrium = false;
  o.end_at_rest = false;
  o.shape = ShapeKind::gimp;
  o.pressure = PressureScheme::in_steps;
  Solver solver(o, s, 1);
  const EnergyRow start = solver.energy();
  solver.advance_to(0.03, silent);
  const MotionFrame f = solver.frame();
  const EnergyRow e = solver.energy();
  Crossing seen;
  double all = 0, n = 0, hottest = 0;
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const double from_middle = (s.particles.x0[k] - Vec2(0.5 * side, 0.5 * side)).norm(),
                 g = double(f.field("plastic_dev")(k, 0)), w = double(f.field("band_width")(k, 0));
    if (across(k, false) < half && across(k, true) < half) seen.in_common = std::max(seen.in_common, w);
    if (from_middle < 0.4 || from_middle > 0.9 || s.particles.label[k] == 0) continue;
    all += g, n += 1;
    seen.width += g * w;
    const double mean = double(f.field("temperature")(k, 0)) - 20,
                 band = double(f.field("band_temperature")(k, 0)) - 20;
    hottest = std::max(hottest, band);
    if (g > 0.01) seen.wrong = std::max(seen.wrong, std::abs(band - mean * w / thickness));
  }
  seen.width /= all;
  seen.slip = all / n;
  seen.wrong /= hottest;
  seen.heat_lost = (e.heat - start.heat - e.heat_made - e.heat_inflow) / e.heat_made;
  seen.water_lost = (e.water_mass - start.water_mass - e.water_inflow) / start.water_mass;
  return seen;
}

TEST(HeatedZones, ThatCrossKeepTheirWidths) {
  const Crossing alone = compressed(false), both = compressed(true);
  EXPECT_NEAR(both.width, alone.width, 0.05 * alone.width);
  EXPECT_GT(both.in_common, 1.2 * both.width);
  EXPECT_LT(both.in_common, 1.7 * both.width);
  for (const Crossing& seen : {alone, both}) {
    EXPECT_GT(seen.slip, 0.05);
    EXPECT_LT(seen.wrong, 0.1);
    EXPECT_LT(std::abs(seen.heat_lost), 1e-11);
    EXPECT_LT(std::abs(seen.water_lost), 1e-12);
  }
}

// A checkpoint holds bands, their widths and the senses of their points.
TEST(HeatedZones, ACheckpointGoesOnWithTheSameBits) {
  HeatedBand band;
  PlanarSlide slide(band);
  SlideOptions o;
  o.cell = 2, o.above = 12;
  Solver solver(slide_options(slide, o), slide_scene(slide, o), 1),
      other(slide_options(slide, o), slide_scene(slide, o), 2);
  solver.advance_to(3.01, silent);
  other.load(solver.save());
  solver.advance_to(5, silent);
  other.advance_to(5, silent);
  const MotionFrame last = solver.frame();
  const auto& widths = last.field("band_width").values;
  EXPECT_GT(*std::max_element(widths.begin(), widths.end()), 0);
  for (const char* name : {"band_pressure", "band_temperature", "band_width"}) EXPECT_EQ(solver.frame().field(name).values, other.frame().field(name).values) << name;
}

}  // namespace
}  // namespace pivnp::mpm
