#include <cmath>

#include "apps/study/stress/mpm/scenes.hpp"
#include "pivnp/core/particles/seeding.hpp"

namespace pivnp::app {

namespace {

enum Softening : std::size_t { by_cells, smeared, nonlocal };

// A vertical cut in soil that loses nine tenths of its cohesion as it shears.
Trial softening_cut(int cells, std::size_t row) {
  constexpr double height = 0.4, width = 0.6;
  Trial t;
  t.options = bare_options();
  t.end_s = 0.3;
  t.scene.grid = cells_to({1.2, 0.6}, height / cells);
  t.scene.particles = seed(t.scene.grid, {box_region("soil", 0, 0, width, height)}, t.options.per_element, SeedPattern::even, 0, "per_element");
  mpm::MaterialOptions soil = elastic_soil(1e6, 0.3, 1600);
  soil.model = "mohr_coulomb";
  soil.friction_deg = 20;
  soil.cohesion_pa = 1200;
  soil.cohesion_residual_pa = 120;
  soil.softening_shape = 10;
  if (row != by_cells) soil.softening_length_m = 0.05;
  if (row == nonlocal) soil.softening_average = mpm::SofteningAverage::nonlocal;
  t.scene.materials = {soil};
  t.scene.boundaries = {{"base", line_boundary({0, 0}, {1.2, 0}, mpm::BoundaryType::fixed)}, {"left", line_boundary({0, 0}, {0, 0.6}, mpm::BoundaryType::roller)}};
  return t;
}

// A layer of dry sand that begins to slide down a rough base of 35 degrees.
Trial thin_layer(double cells) {
  constexpr double thickness = 0.06, angle = 35 * M_PI / 180;
  const double cell = thickness / cells;
  Trial t;
  t.options = bare_options();
  t.options.gravity_m_s2 = {9.81 * std::sin(angle), -9.81 * std::cos(angle)};
  t.end_s = 0.4;
  t.scene.grid = cells_to({1.8, 0.24}, cell);
  t.scene.particles = seed(t.scene.grid, {box_region("sand", 0.12, 0, 1.08, thickness)}, t.options.per_element, SeedPattern::even, 0, "per_element");
  mpm::MaterialOptions sand = elastic_soil(5e5, 0.3, 1600);
  sand.model = "mohr_coulomb";
  sand.friction_deg = 25;
  t.scene.materials = {sand};
  t.scene.boundaries = {{"base", line_boundary({0, 0}, {1.8, 0}, mpm::BoundaryType::fixed)}};
  return t;
}

}  // namespace

std::vector<TrialMap> soil_trials() {
  constexpr int fine_cells = 32;
  TrialMap cut;
  cut.name = "mpm_softening";
  cut.title = "Softening against the mesh";
  cut.scene_words = "A vertical cut, 0.4 m high, in soil that loses nine tenths of its cohesion, 0.3 s after it is cut; held against its own kind on 32 cells";
  cut.x = {"cells in its height", {6, 8, 12, 16, 24}};
  cut.y = {"softening", {}, {"by the cells", "smeared", "nonlocal"}};
  cut.theory = {{"softening_length_m is a cell", {{8, 0}, {8, 3}}}};
  cut.square_m = 0.05;
  cut.reference_by_x = false;
  cut.reference_by_row = true;
  cut.trial = [](double x, std::size_t row) { return softening_cut(int(x), row); };
  cut.reference = [](double, std::size_t row) { return softening_cut(fine_cells, row); };

  TrialMap layer;
  layer.name = "mpm_thin_layer";
  layer.title = "Thin layers without cohesion";
  layer.scene_words = "A layer of dry sand, 60 mm thick and 0.96 m long, 0.4 s after it begins to slide down a rough base of 35 degrees (friction angle 25)";
  layer.x = {"cells in its thickness", {1, 2, 3, 4, 6}};
  layer.y = scheme_rows();
  layer.square_m = 0.06;
  layer.reference_by_x = false;
  layer.trial = [](double x, std::size_t row) {
    Trial t = thin_layer(x);
    take_scheme(t.options, row);
    return t;
  };
  layer.reference = [](double, std::size_t) { return thin_layer(10); };
  return {std::move(cut), std::move(layer)};
}

}  // namespace pivnp::app
