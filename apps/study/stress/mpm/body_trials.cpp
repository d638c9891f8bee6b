#include <cmath>

#include "apps/study/stress/mpm/scenes.hpp"
#include "pivnp/core/particles/seeding.hpp"

namespace pivnp::app {

namespace {

// A bar along x, held at its left end, that swings in its first mode: at its free end it moves by `amplitude` times a cell.
Trial swinging_bar(double amplitude, std::size_t finer) {
  constexpr double length = 1, young = 1e5, density = 1000, wide_cell = 0.05;
  const double cell = wide_cell / double(finer), omega = M_PI / 2 * std::sqrt(young / density) / length;
  Trial t;
  t.options = bare_options();
  t.options.gravity_m_s2 = {0, 0};
  t.end_s = 2.75 * 2 * M_PI / omega;  // at its shortest
  t.scene.grid = cells_to({1.5, 2 * wide_cell}, cell);
  t.scene.particles = seed(t.scene.grid, {box_region("bar", 0, 0, length, 2 * wide_cell)}, t.options.per_element, SeedPattern::even, 0, "per_element");
  t.scene.materials = {elastic_soil(young, 0, density)};
  t.scene.boundaries = {{"left", line_boundary({0, 0}, {0, 2 * wide_cell}, mpm::BoundaryType::roller)},
                        {"below", line_boundary({0, 0}, {1.5, 0}, mpm::BoundaryType::roller)},
                        {"above", line_boundary({0, 2 * wide_cell}, {1.5, 2 * wide_cell}, mpm::BoundaryType::roller)}};
  const double wave = M_PI / 2 / length, speed = amplitude * wide_cell * omega;
  for (const Vec2& x : t.scene.particles.x0) {
    t.scene.v0.push_back({speed * std::sin(wave * x.x()), 0});
    t.scene.grad_v0.push_back({speed * wave * std::cos(wave * x.x()), 0, 0, 0});
  }
  return t;
}

// An elastic block dropped on its base; its outermost points hold only a sliver of the cells they lie in.
Trial sliver_block(double sliver, std::size_t finer) {
  constexpr double wide_cell = 0.05;
  const double cell = wide_cell / double(finer);
  Trial t;
  t.options = bare_options();
  t.end_s = 0.1;
  t.scene.grid = cells_to({0.5, 0.35}, cell);
  t.scene.particles = seed(t.scene.grid, {box_region("block", 0.1, 0, 0.3, 0.2)}, t.options.per_element, SeedPattern::even, 0, "per_element");
  for (Vec2& x : t.scene.particles.x0) x.x() += wide_cell * (0.25 + sliver);  // the last column of four points a cell comes to a cell's edge
  t.scene.materials = {elastic_soil(2e4, 0.3, 1600)};
  t.scene.boundaries = {{"base", line_boundary({0, 0}, {0.5, 0}, mpm::BoundaryType::roller)}};
  return t;
}

// A block that flies over 12 cells and turns meanwhile; nothing touches it.
constexpr double flight_s = 0.25, flight_speed = 2;
const Vec2 flight_from(0.3, 0.4);

Trial flying_block(double degrees) {
  const double rate = degrees * M_PI / 180 / flight_s;
  Trial t;
  t.options = bare_options();
  t.options.gravity_m_s2 = {0, 0};
  t.end_s = flight_s;
  t.scene.grid = cells_to({1.2, 0.8}, 0.04);
  t.scene.particles = seed(t.scene.grid, {box_region("block", 0.2, 0.3, 0.4, 0.5)}, t.options.per_element, SeedPattern::even, 0, "per_element");
  t.scene.materials = {elastic_soil(1e7, 0.3, 1600)};
  t.scene.boundaries = {{"base", line_boundary({0, 0}, {1.2, 0}, mpm::BoundaryType::roller)}};
  for (const Vec2& x : t.scene.particles.x0) {
    const Vec2 r = x - flight_from;
    t.scene.v0.push_back({flight_speed - rate * r.y(), rate * r.x()});
    t.scene.grad_v0.push_back({0, -rate, rate, 0});
  }
  return t;
}

Vec2 flown(double degrees, const Vec2& x0) {
  const double a = degrees * M_PI / 180;
  const Vec2 r = x0 - flight_from, turned(std::cos(a) * r.x() - std::sin(a) * r.y(), std::sin(a) * r.x() + std::cos(a) * r.y());
  return Vec2(flight_speed * flight_s, 0) + turned - r;
}

// A block that meets a wall at a share of its own wave speed.
Trial impact(double mach, std::size_t finer) {
  constexpr double young = 1e6, density = 1600, height = 0.2;
  const double wave = std::sqrt(young / density);
  Trial t;
  t.options = bare_options();
  t.options.gravity_m_s2 = {0, 0};
  t.end_s = 3 * height / wave;  // it has left again after 2 heights of a slow one's wave
  t.scene.grid = cells_to({0.6, 0.8}, 0.02 / double(finer));
  t.scene.particles = seed(t.scene.grid, {box_region("block", 0.2, 0, 0.4, height)}, t.options.per_element, SeedPattern::even, 0, "per_element");
  t.scene.materials = {elastic_soil(young, 0, density)};
  t.scene.boundaries = {{"base", line_boundary({0, 0}, {0.6, 0}, mpm::BoundaryType::frictional)}};
  t.scene.v0.assign(t.scene.particles.size(), Vec2(0, -mach * wave));
  return t;
}

// Two elastic layers under sudden gravity, the lower one so many times as stiff.
Trial two_layers(double ratio, std::size_t finer) {
  Trial t;
  t.options = bare_options();
  t.end_s = 0.1;
  t.scene.grid = cells_to({0.4, 0.6}, 0.05 / double(finer));
  t.scene.particles = seed(t.scene.grid, {box_region("lower", 0, 0, 0.2, 0.2), box_region("upper", 0, 0.2, 0.2, 0.4)}, t.options.per_element, SeedPattern::even, 0, "per_element");
  t.scene.materials = {elastic_soil(2e4 * ratio, 0.3, 1600), elastic_soil(2e4, 0.3, 1600)};
  t.scene.boundaries = {{"base", line_boundary({0, 0}, {0.4, 0}, mpm::BoundaryType::fixed)}, {"left", line_boundary({0, 0}, {0, 0.6}, mpm::BoundaryType::roller)}};
  return t;
}

TrialMap body_map(const char* name, const char* title, const char* words, const char* label, std::vector<double> levels, Trial (*trial)(double, std::size_t), double square) {
  TrialMap map;
  map.name = name;
  map.title = title;
  map.scene_words = words;
  map.x = {label, std::move(levels)};
  map.y = scheme_rows();
  map.square_m = square;
  map.trial = [=](double x, std::size_t row) {
    Trial t = trial(x, 1);
    take_scheme(t.options, row);
    return t;
  };
  map.reference = [=](double x, std::size_t) { return trial(x, 2); };
  return map;
}

}  // namespace

std::vector<TrialMap> body_trials() {
  std::vector<TrialMap> all = {
      body_map("mpm_crossing", "Cells that are crossed", "An elastic bar of 20 cells that swings in its first mode, after two and three quarters of its periods", "amplitude of its end (cells)",
               {0.05, 0.1, 0.25, 0.5, 1, 2}, &swinging_bar, 0.05),
      body_map("mpm_sliver", "Tiny nodal mass", "An elastic block under sudden gravity whose outermost points lie just beyond a cell's edge", "distance beyond the edge (cells)",
               {1e-9, 1e-6, 1e-3, 0.01, 0.1, 0.25}, &sliver_block, 0.05),
      body_map("mpm_impact", "Contact at speed", "An elastic block of ten cells that meets a smooth wall", "speed over that of its compression wave", {0.01, 0.03, 0.1, 0.2, 0.4, 0.8}, &impact, 0.04),
      body_map("mpm_contrast", "Stiffness contrast", "Two elastic layers of four cells each under sudden gravity", "stiffness of the lower over that of the upper", {1, 10, 100, 1e3, 1e4}, &two_layers,
               0.05)};
  TrialMap flight = body_map("mpm_flight", "Free flight", "An elastic block of five cells that flies over twelve cells and turns meanwhile", "turn (degrees)", {0, 30, 90, 180, 360}, nullptr, 0.04);
  flight.trial = [](double x, std::size_t row) {
    Trial t = flying_block(x);
    take_scheme(t.options, row);
    return t;
  };
  flight.reference = {};
  flight.truth = &flown;
  all.push_back(std::move(flight));
  return all;
}

}  // namespace pivnp::app
