#include <algorithm>
#include <cmath>

#include "apps/study/stress/mpm/scenes.hpp"
#include "pivnp/core/particles/seeding.hpp"

namespace pivnp::app {

namespace {

constexpr double height = 0.4;

mpm::MaterialOptions saturated_soil(double permeability) {
  mpm::MaterialOptions m = elastic_soil(2e6, 0.2, 0);
  m.porosity = 0.4;
  m.permeability_m_s = permeability;
  return m;
}

// A saturated block between smooth sides, drained at its top, that is loaded there from 0 to `loaded`.
Trial loaded_block(double permeability, double width, double loaded, double cell) {
  Trial t;
  t.options = bare_options();
  t.options.gravity_m_s2 = {0, 0};
  t.options.damping = 0.3;
  t.end_s = 0.03;
  t.scene.grid = cells_to({width, height + 0.1}, cell);
  t.scene.particles = seed(t.scene.grid, {box_region("soil", 0, 0, width, height)}, t.options.per_element, SeedPattern::even, 0, "per_element");
  t.scene.materials = {saturated_soil(permeability)};
  t.scene.water.emplace();
  t.scene.water->bulk_modulus_pa = 2e8;  // some air in it: steps ten times as long
  mpm::BoundaryOptions load = line_boundary({0, height}, {loaded, height}, mpm::BoundaryType::traction);
  load.traction_pa = {0, -2e4};
  load.rise_s = 0.005;
  load.drained = true;
  t.scene.boundaries = {{"base", line_boundary({0, 0}, {width, 0}, mpm::BoundaryType::roller)},
                        {"left", line_boundary({0, 0}, {0, height + 0.1}, mpm::BoundaryType::roller)},
                        {"right", line_boundary({width, 0}, {width, height + 0.1}, mpm::BoundaryType::roller)},
                        {"load", load}};
  return t;
}

constexpr double permeabilities[] = {1e-6, 1e-4, 1e-3, 1e-2};
constexpr double column_cell = 0.04, block_cell = 0.05;

struct WetScheme {
  const char* name;
  mpm::ShapeKind shape;
  mpm::PressureScheme pressure;
};
constexpr WetScheme wet_schemes[] = {{"bilinear, explicit", mpm::ShapeKind::bilinear, mpm::PressureScheme::in_steps},
                                     {"bilinear, projected", mpm::ShapeKind::bilinear, mpm::PressureScheme::projected},
                                     {"bspline, explicit", mpm::ShapeKind::bspline, mpm::PressureScheme::in_steps},
                                     {"bspline, projected", mpm::ShapeKind::bspline, mpm::PressureScheme::projected}};

}  // namespace

std::vector<TrialMap> water_trials() {
  TrialMap step;
  step.name = "mpm_wet_step";
  step.title = "Wet: permeability and step";
  step.scene_words = "A saturated column of ten cells, drained at its top, 30 ms into a load there";
  step.x = {"time step over the critical one", {0.4, 0.7, 0.9, 1.05, 1.2, 1.5, 2}};
  step.y = {"permeability (m/s)", {std::begin(permeabilities), std::end(permeabilities)}};
  step.theory = {{"the critical step", {{1, permeabilities[0]}, {1, permeabilities[3]}}}};
  step.square_m = column_cell;
  step.reference_by_x = false;
  step.reference_by_row = true;
  step.trial = [](double x, std::size_t row) {
    Trial t = loaded_block(permeabilities[row], 2 * column_cell, 2 * column_cell, column_cell);
    t.options.courant = x;
    t.options.pressure = mpm::PressureScheme::in_steps;
    return t;
  };
  step.reference = [](double, std::size_t row) {
    Trial t = loaded_block(permeabilities[row], 2 * column_cell, 2 * column_cell, column_cell / 2);
    t.options.pressure = mpm::PressureScheme::in_steps;
    return t;
  };

  TrialMap undrained;
  undrained.name = "mpm_undrained";
  undrained.title = "Wet: undrained";
  undrained.scene_words = "A saturated block of 8 by 8 cells, loaded on half of its top, after 30 ms";
  undrained.x = {"permeability (m/s)", {1e-8, 1e-5, 1e-4, 1e-3, 1e-2}};
  undrained.y = {"shape functions, pressure", {}, {}};
  for (const WetScheme& s : wet_schemes) undrained.y.names.emplace_back(s.name);
  undrained.square_m = block_cell;
  undrained.trial = [](double x, std::size_t row) {
    Trial t = loaded_block(x, height, height / 2, block_cell);
    t.options.shape = wet_schemes[row].shape;
    t.options.pressure = wet_schemes[row].pressure;
    return t;
  };
  undrained.reference = [](double x, std::size_t) {
    Trial t = loaded_block(x, height, height / 2, block_cell / 2);
    t.options.pressure = mpm::PressureScheme::in_steps;
    return t;
  };
  return {std::move(step), std::move(undrained)};
}

}  // namespace pivnp::app
