#include "apps/study/methods/simulation/doubts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/study/pipeline/scene/simulation_scene.hpp"
#include "mpm/scene/centrifuge.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "mpm/water/pore_soil.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

// Share of the cells of material with friction that lie in layers, across gravity, of at most two cells.
double share_in_thin_layers(const mpm::MpmOptions& options, const mpm::Scene& scene) {
  const Grid& grid = scene.grid;
  std::vector<std::uint8_t> held(grid.element_count(), 0);  // 1: material, 2: with friction
  for (std::size_t p = 0; p < scene.particles.size(); ++p) {
    ElementPoint at;
    if (!locate(grid, scene.particles.x0[p], at)) continue;
    const std::size_t label = std::size_t(scene.particles.label[p]);
    const bool rubs = label < scene.materials.size() && scene.materials[label].friction_deg > 0;
    std::uint8_t& cell = held[grid.element(at.i, at.j)];
    cell = std::max<std::uint8_t>(cell, rubs ? 2 : 1);
  }
  const bool along_y = std::abs(options.gravity_m_s2[1]) >= std::abs(options.gravity_m_s2[0]);
  const int lines = (along_y ? grid.nx : grid.ny) - 1, length = (along_y ? grid.ny : grid.nx) - 1;
  double all = 0, thin = 0;
  for (int line = 0; line < lines; ++line)
    for (int from = 0, to = 0; from < length; from = to + 1) {
      double rubbing = 0;
      for (to = from; to < length; ++to) {
        const std::uint8_t cell = held[along_y ? grid.element(line, to) : grid.element(to, line)];
        if (cell == 0) break;
        rubbing += cell == 2;
      }
      all += rubbing;
      if (to - from <= 2) thin += rubbing;
    }
  return all > 0 ? thin / all : 0;
}

// Greatest acceleration that a scene's material has to bear, m/s^2.
double greatest_gravity(const mpm::MpmOptions& o, const mpm::Scene& scene) {
  double g = std::hypot(o.gravity_m_s2[0], o.gravity_m_s2[1]);
  if (scene.centrifuge) {
    const mpm::Centrifuge field(*scene.centrifuge, o.geometry == mpm::Geometry::axisymmetric);
    double most = 0;
    for (const Vec2& x : scene.particles.x0) most = std::max(most, field.greatest(x));
    g += most;
  }
  return g;
}

// What no soil has, by ratios: density to that of water, the speed of waves to that in diamond, the weight of a column over its stiffness.
void doubt_materials(const Case& c, const mpm::Scene& scene, std::vector<std::string>& all) {
  constexpr double water = 1000, lightest = 0.1, heaviest = 12, fastest = 1.2e4, squeezed = 0.1;
  const double g = greatest_gravity(*c.mpm, scene);
  for (const auto& [name, given] : c.materials) {
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (std::size_t p = 0; p < scene.particles.size(); ++p) {
      const std::string& region = scene.particles.label_names[std::size_t(scene.particles.label[p])];
      const auto of = std::find_if(c.regions.begin(), c.regions.end(), [&](const auto& r) { return r.first == region; });
      if ((of == c.regions.end() || of->second.material.empty() ? region : of->second.material) != name) continue;
      low = low.cwiseMin(scene.particles.x0[p]);
      high = high.cwiseMax(scene.particles.x0[p]);
    }
    if (!(high.y() >= low.y())) continue;
    const std::string key = "material." + name + ".";
    const double density = c.water ? mpm::without_pores(given, *c.water).density_kg_m3 : given.density_kg_m3;
    if (!given.porosity && (density < lightest * water || density > heaviest * water))
      all.push_back(key + "density_kg_m3: " + number(density, 3) + " kg/m^3 is no soil's (water has 1000).");
    const bool fluid = !(given.young_pa > 0);
    const double modulus = fluid ? given.bulk_pa : given.young_pa;
    if (!(modulus > 0)) continue;
    const std::string stiffness = key + (fluid ? "bulk_pa" : "young_pa") + ": " + number(modulus, 3) + " Pa";
    const Vec2 down(c.mpm->gravity_m_s2[0], c.mpm->gravity_m_s2[1]);
    const Vec2 size = high - low;
    const double height = down.norm() > 0 ? std::abs(down.dot(size)) / down.norm() : size.y(), weight = density * g * height;
    if (weight > squeezed * modulus)
      all.push_back(stiffness + " against a weight of " + number(weight, 3) + " Pa at the foot of " + number(height, 3) +
                    " m: the material is squeezed by " + number(100 * weight / modulus, 2) + " % under itself.");
    if (std::sqrt(modulus / density) > fastest)
      all.push_back(stiffness + ": waves of " + number(std::sqrt(modulus / density) / 1000, 3) + " km/s are faster than in any rock.");
  }
}

// Of soil that drains less deep than a cell until the end: a sentence each.
void doubt_thin_drainage(const mpm::MpmOptions& options, const mpm::Scene& scene, std::vector<std::string>& all) {
  if (!scene.water || !options.end_s) return;
  const double cell = scene.grid.spacing.minCoeff();
  const bool opens = scene.water->level_m || std::any_of(scene.boundaries.begin(), scene.boundaries.end(), [](const auto& named) {
                       return named.second.drained || named.second.pressure_pa || named.second.water_level_m;
                     });
  for (std::size_t k = 0; k < scene.materials.size(); ++k) {
    const mpm::MaterialOptions& m = scene.materials[k];
    if (!m.porosity || m.drained || !(m.permeability_m_s.value_or(0) > 0) || !(m.young_pa > 0) || !(m.poisson < 0.5)) continue;
    const bool beside_pervious = std::any_of(scene.materials.begin(), scene.materials.end(), [&](const mpm::MaterialOptions& other) {
      return other.porosity && (other.drained || other.permeability_m_s.value_or(0) >= 10 * *m.permeability_m_s);
    });
    if (!opens && !beside_pervious) continue;
    const double modulus = m.young_pa * (1 - m.poisson) / ((1 + m.poisson) * (1 - 2 * m.poisson));
    const double storage = 1 / modulus + *m.porosity / scene.water->bulk_modulus_pa;
    const double depth = std::sqrt(*m.permeability_m_s / (scene.water->density_kg_m3 * mpm::laboratory_gravity * storage) * *options.end_s);
    if (depth >= cell) continue;
    const auto& names = scene.particles.label_names;
    all.push_back("Until the end material." + (k < names.size() ? names[k] : std::to_string(k)) + " drains to a depth of about " + number(depth, 2) +
                  " m (the root of c_v t), less than a cell of " + number(cell, 2) +
                  " m: in the first cell beside what drains it pressures are means over the cell (mpm.refine).");
  }
}

// Of walls along the grid that lie between lines of nodes, and whose nodes are not moved onto them
// (mpm/constraint/wall.hpp): nodes within half a cell hold the material in their place.
void doubt_walls(const mpm::MpmOptions& options, const mpm::Scene& scene, std::vector<std::string>& all) {
  constexpr double off = 0.02;  // cells
  const bool flows = scene.water && std::any_of(scene.materials.begin(), scene.materials.end(),
                                                [](const mpm::MaterialOptions& m) { return m.porosity && !m.drained; });
  const bool moves = mpm::row_of(mpm::scheme_of(options).shape).centred() && !scene.heat && !flows;
  for (const auto& [name, boundary] : scene.boundaries) {
    if (boundary.line_m.size() != 2 || boundary.type == mpm::BoundaryType::traction) continue;
    if (moves && boundary.type != mpm::BoundaryType::tied && boundary.type != mpm::BoundaryType::absorbing) continue;
    const Vec2 a(boundary.line_m[0][0], boundary.line_m[0][1]), b(boundary.line_m[1][0], boundary.line_m[1][1]);
    for (const int axis : {0, 1}) {
      if (a[axis] != b[axis]) continue;
      const double cells = (a[axis] - scene.grid.origin[axis]) / scene.grid.spacing[axis], beside = std::abs(cells - std::round(cells));
      if (beside > off)
        all.push_back("boundary." + name + " lies " + number(beside, 2) + " of a cell beside a line of nodes, which hold the material in its place: stress "
                      "in the row at the wall may be wrong by a factor of two, settlement by a part of a cell's (grid.area_m or grid.spacing_m that puts a line on it).");
    }
  }
}

}  // namespace

std::vector<std::string> doubts(const mpm::MpmOptions& options, const mpm::Scene& scene) {
  std::vector<std::string> all;
  if (options.per_element < 4)
    all.push_back("With " + std::to_string(options.per_element) + " material point" + (options.per_element == 1 ? "" : "s") +
                  " per element gaps open where material stretches: a column that collapses is wrong by more than a fifth (mpm.per_element; 4 is the least for large strain).");
  const std::vector<mpm::MaterialOptions>& materials = scene.materials;
  if (std::any_of(materials.begin(), materials.end(), [](const mpm::MaterialOptions& m) { return m.softening_shape > 0 && !m.softening_length_m; }))
    all.push_back("Soil softens without softening_length_m: a shear band is as wide as the cells let it be, and what fails depends on them.");
  double stiffest = 0, softest = std::numeric_limits<double>::infinity();
  for (const mpm::MaterialOptions& m : materials)
    if (m.young_pa > 0) stiffest = std::max(stiffest, m.young_pa), softest = std::min(softest, m.young_pa);
  if (stiffest >= 100 * softest)
    all.push_back("One material is " + number(stiffest / softest, 3) +
                  " times as stiff as another: within a cell or two of where they meet the soft one is held by the stiff one, and a soft layer of four cells moves up to half less (mpm.refine).");
  const bool turns = std::any_of(scene.grad_v0.begin(), scene.grad_v0.end(), [](const auto& L) { return std::abs(L[2] - L[1]) > 1e-3 * (std::abs(L[0]) + std::abs(L[3])); });
  if (turns && !mpm::row_of(mpm::scheme_of(options).transfer).affine)
    all.push_back("Material starts turning, and mpm.transfer carries no affine velocity: a body of five cells loses a quarter of its spin at once, one of ten cells 7 % (apic loses none).");
  if (share_in_thin_layers(options, scene) > 0.5)
    all.push_back("More than half of the material with friction lies in layers of one or two cells: sliding over a rough base they are wrong by a fifth and more, with three cells by a tenth (mpm.refine).");
  doubt_thin_drainage(options, scene, all);
  doubt_walls(options, scene, all);
  return all;
}

std::vector<std::string> doubts(const Case& c, const Setting& setting) {
  const mpm::Scene scene = make_scene(c, setting, *c.mpm, c.materials, "material.");
  std::vector<std::string> all = doubts(*c.mpm, scene);
  doubt_materials(c, scene, all);
  return all;
}

std::vector<std::string> doubts_of_scale(const Case& c) {
  constexpr double light = 1e-7;  // m: a quarter of its wavelength
  if (!c.camera.metres_per_pixel || *c.camera.metres_per_pixel >= light || c.camera.length_unit != "m") return {};
  return {"camera.metres_per_pixel: " + number(*c.camera.metres_per_pixel, 3) +
          " m a pixel is finer than light resolves; is it in another unit (camera.length_unit)?"};
}

}  // namespace pivnp::app
