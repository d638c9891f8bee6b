// The planar slide of Alvarado 2018's figure 4.6 on tied sides: a row of clay that yields between blocks that do not, seen along the
// slope. The seepage's pressure is left out and gravity with it, so that the clay's effective stress and the drive are the slide's.
#pragma once

#include <algorithm>
#include <cmath>

#include "tests/support/heated_band.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm::test {

using pivnp::test::HeatedBand;
using pivnp::test::PlanarSlide;

struct SlideOptions {
  double cell = 1, above = 18, below = 4;  // m
  int per_element = 4, rows = 3;           // rows of clay
  BandExchange exchange = BandExchange::deviation;
  bool bands = true;
  double young = 4.5e8;  // of which 1.5e-9 1/Pa is the compressibility
  std::optional<ShapeKind> shape = ShapeKind::gimp;
  std::optional<TransferKind> transfer = TransferKind::flip;
  double pic_per_s = 0, damping = 0, courant = 0.8;
  int threads = 1;
  int along = 2, up = 0;  // cells after which the slide repeats: its direction in the grid
};

/// Direction and normal of the slide in the grid, and the height over the floor, which begins at the left.
struct SlideFrame {
  Vec2 along, normal, floor;

  explicit SlideFrame(const SlideOptions& o) : along(Vec2(o.along, o.up).normalized()), normal(-along.y(), along.x()), floor(0, o.up > 0 ? 2 * o.cell : 0) {}
  double height(const Vec2& x) const { return (x - floor).dot(normal); }
};

struct SlideState {
  double time = 0, speed = 0, slip = 0, pressure = 0, temperature = 0, width = 0;
  double height = 0;  // over the floor, of the zone that slips
  double heat_lost = 0, water_lost = 0, residual = 0;
  std::int64_t steps = 0;
};

inline Scene slide_scene(const PlanarSlide& slide, const SlideOptions& o) {
  const HeatedBand& of = slide.band;
  const double h = o.cell, low = std::round(o.below / h) * h, clay = o.rows * h, high = low + clay + std::round(o.above / h) * h;
  MaterialOptions block = elastic(1, 0.33, 0);
  block.young_pa = o.young;
  block.porosity = 0.4;
  block.permeability_m_s = of.permeability;
  block.grain_density_kg_m3 = 2700;
  block.grain_specific_heat_j_kg_k = 837;
  block.conductivity_w_m_k = of.conductivity;
  block.grain_thermal_expansion_1_k = 3e-5;
  block.skeleton_thermal_expansion_1_k = 0;
  MaterialOptions soil = block;
  soil.model = "mohr_coulomb";
  // A layer that shears without dilatancy has the strength sin(phi) along itself.
  soil.friction_deg = std::asin(of.tan_friction()) * 180 / M_PI;
  if (o.bands) {
    soil.band_thickness_m = of.thickness;
    soil.band_compressibility_1_pa = of.skeleton;
    soil.band_exchange = o.exchange;
  }
  const SlideFrame frame(o);
  const double width = o.along * h, rise = o.up * h, upright = 1 / frame.along.x();
  const double top = std::ceil((frame.floor.y() + high * upright) / h - 1e-9) * h + 2 * h;
  const auto layer = [&](const std::string& name, double from, double to) {
    const double a = frame.floor.y() + from * upright, b = frame.floor.y() + to * upright;
    return Region{name, Polygon({{0, a}, {width, a + rise}, {width, b + rise}, {0, b}}, name)};
  };
  Scene s = scene(Grid{{0, 0}, {h, h}, o.along + 1, int(std::lround((top + rise) / h)) + 1},
                  {layer("base", 0, low), layer("clay", low, low + clay), layer("slide", low + clay, high)}, {block, soil, block}, o.per_element);
  s.water.emplace();
  s.heat.emplace();
  BoundaryOptions sides = line({0, 0}, {0, top}, "tied"), floor = line({0, 0}, {width, 0}, "fixed");
  sides.across_m = Pair{width, rise};
  if (o.up > 0) {
    floor.line_m.clear();
    floor.polygon_m = {{0, 0}, {width, 0}, {width, frame.floor.y() + rise}, {0, frame.floor.y()}};
  }
  s.boundaries = {{"floor", floor}, {"sides", sides}};
  // The stress that the slide would have above the middle of the clay.
  const double middle = low + 0.5 * clay, density = 2020;
  const double push = slide.drive / (density * (high - middle)), weight = of.stress / (density * (high - middle));
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    const double over = density * (high - frame.height(s.particles.x0[k])), normal = weight * over, shear = push * over;
    const Vec2 &t = frame.along, &n = frame.normal;
    s.stress0.push_back({-normal + 2 * shear * t.x() * n.x(), -normal + 2 * shear * t.y() * n.y(), -normal, shear * (t.x() * n.y() + t.y() * n.x())});
  }
  return s;
}

inline Pair slide_gravity(const PlanarSlide& slide, const SlideOptions& o) {
  const double over = 2020 * (std::round(o.above / o.cell) + 0.5 * o.rows) * o.cell;
  const SlideFrame frame(o);
  const Vec2 g = (slide.drive * frame.along - slide.band.stress * frame.normal) / over;
  return {g.x(), g.y()};
}

inline MpmOptions slide_options(const PlanarSlide& slide, const SlideOptions& o) {
  MpmOptions options = test::options(slide_gravity(slide, o));
  options.initial_equilibrium = false;
  options.end_at_rest = false;
  options.shape = o.shape;
  options.transfer = o.transfer;
  if (o.pic_per_s > 0) options.pic_per_s = o.pic_per_s;
  if (o.damping > 0) options.damping = o.damping;
  options.courant = o.courant;
  options.energy_limit = 1e9;
  options.pressure = PressureScheme::in_steps;
  return options;
}

/// The slide over a plane at this height: the stress grows with what lies on it, and so do the drive and the mass.
inline PlanarSlide slide_over(PlanarSlide slide, const SlideOptions& o, double height) {
  const double low = std::round(o.below / o.cell) * o.cell, above = std::round(o.above / o.cell) * o.cell, clay = o.rows * o.cell;
  const double middle = above + 0.5 * clay, share = (low + clay + above - height) / middle;
  slide.mass = 2020 * middle * share;
  slide.drive *= share;
  slide.band.stress *= share;
  return slide;
}

/// Until the slide has moved `slip`. Its mass is that of the slide above the clay's middle only where the column is as high.
inline SlideState run_slide(const PlanarSlide& slide, const SlideOptions& o, double slip, double most_time) {
  Solver solver(slide_options(slide, o), slide_scene(slide, o), o.threads);
  const EnergyRow start = solver.energy();
  SlideState s;
  const SlideFrame frame(o);
  const std::vector<Vec2>& x0 = solver.particles().x0;
  std::size_t top = 0;
  for (std::size_t k = 0; k < x0.size(); ++k)
    if (frame.height(x0[k]) > frame.height(x0[top])) top = k;
  double before = 0, at = 0;
  const double every = most_time / 400;
  for (double t = every; t <= most_time; t += every) {
    solver.advance_to(t, silent);
    const MotionFrame f = solver.frame();
    const double now = frame.along.dot(Vec2(f.u[top][0], f.u[top][1]));
    s.speed = frame.along.dot(Vec2(f.v[top][0], f.v[top][1]));
    before = at, at = now;
    if (at < slip) continue;
    s.time = t - every * (at - slip) / (at - before);
    s.slip = now;
    const FieldValues &p = f.field(o.bands ? "band_pressure" : "pressure"), &hot = f.field(o.bands ? "band_temperature" : "temperature");
    double all = 0;  // means over the sheared points, by their shear
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double g = double(f.field("plastic_dev")(k, 0));
      all += g;
      s.pressure += g * double(p(k, 0));
      s.temperature += g * (double(hot(k, 0)) - 20);
      s.height += g * frame.height(x0[k]);
      if (o.bands) s.width += g * double(f.field("band_width")(k, 0));
    }
    for (double* value : {&s.pressure, &s.temperature, &s.width, &s.height}) *value /= all;
    break;
  }
  const EnergyRow e = solver.energy();
  s.heat_lost = (e.heat - start.heat - e.heat_made - e.heat_inflow) / e.heat_made;
  s.water_lost = (e.water_mass - start.water_mass - e.water_inflow) / start.water_mass;
  s.residual = e.residual / e.external;
  s.steps = solver.steps();
  return s;
}

}  // namespace pivnp::mpm::test
