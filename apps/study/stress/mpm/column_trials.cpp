#include <cmath>

#include "apps/study/stress/mpm/scenes.hpp"
#include "pivnp/core/particles/seeding.hpp"

namespace pivnp::app {

namespace {

constexpr double column_height = 0.4, column_width = 0.3, column_end = 0.35;  // m, m, s

// `put` says what is stressed.
template <class Put>
Trial column(int finer, const Put& put) {
  const double cell = column_height / 10 / finer;
  Trial t;
  t.end_s = column_end;
  t.options = bare_options();
  mpm::MaterialOptions sand = elastic_soil(1e6, 0.3, 1600);
  sand.model = "mohr_coulomb";
  sand.friction_deg = 30;
  put(t.options, sand);
  t.scene.grid = cells_to({1.4, 0.6}, cell);
  t.scene.particles = seed(t.scene.grid, {box_region("sand", 0, 0, column_width, column_height)}, t.options.per_element, SeedPattern::even, 0.0, "per_element");
  t.scene.materials = {sand};
  t.scene.boundaries = {{"base", line_boundary({0, 0}, {1.4, 0}, mpm::BoundaryType::fixed)}, {"left", line_boundary({0, 0}, {0, 0.6}, mpm::BoundaryType::roller)}};
  return t;
}

using PutOnColumn = void (*)(mpm::MpmOptions&, mpm::MaterialOptions&, double x);

// `of_material`: the reference has the level, too; it is part of what is simulated.
TrialMap column_map(const char* name, const char* title, const char* label, std::vector<double> levels, bool of_material, PutOnColumn put) {
  TrialMap map;
  map.name = name;
  map.title = title;
  map.scene_words = "A column of sand, 0.3 m wide and 0.4 m high on cells of 40 mm, 0.35 s into its collapse";
  map.x = {label, std::move(levels)};
  map.y = scheme_rows();
  map.reference_by_x = of_material;
  map.trial = [=](double x, std::size_t row) {
    return column(1, [&](mpm::MpmOptions& o, mpm::MaterialOptions& m) {
      take_scheme(o, row);
      put(o, m, x);
    });
  };
  map.reference = [=](double x, std::size_t) {
    return column(2, [&](mpm::MpmOptions& o, mpm::MaterialOptions& m) {
      if (of_material) put(o, m, x);
    });
  };
  return map;
}

}  // namespace

std::vector<TrialMap> column_trials() {
  std::vector<TrialMap> all = {
      column_map("mpm_step", "Time step", "time step over the critical one", {0.3, 0.5, 0.7, 0.9, 1, 1.1, 1.2, 1.35, 1.5}, false,
                 [](mpm::MpmOptions& o, mpm::MaterialOptions&, double x) { o.courant = x; }),
      column_map("mpm_points", "Material points", "material points per element", {1, 4, 9, 16}, false,
                 [](mpm::MpmOptions& o, mpm::MaterialOptions&, double x) { o.per_element = int(x); }),
      column_map("mpm_poisson", "Bulk stiffness", "Poisson's ratio", {0, 0.3, 0.45, 0.49, 0.499}, true,
                 [](mpm::MpmOptions&, mpm::MaterialOptions& m, double x) { m.poisson = x; }),
      column_map("mpm_stiffness", "Stiffness", "Young's modulus (Pa)", {2e4, 1e5, 1e6, 1e7}, true,
                 [](mpm::MpmOptions&, mpm::MaterialOptions& m, double x) { m.young_pa = x; })};
  const double top = double(all.front().y.size());
  all.front().theory = {{"the critical step", {{1, 0}, {1, top}}}};
  return all;
}

}  // namespace pivnp::app
