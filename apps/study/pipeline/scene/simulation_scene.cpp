#include "apps/study/pipeline/scene/simulation_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "apps/case/values.hpp"
#include "apps/study/pipeline/scene/initial_state.hpp"
#include "apps/study/pipeline/scene/sizes.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/particles/seeding.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/imports/time_table.hpp"

namespace pivnp::app {

Grid simulation_grid(const Case& c, const Grid& measured, const mpm::MpmOptions& options) {
  const double finer = double(options.refine) * double(options.refine);
  require_at_most(finer * double(measured.nx) * double(measured.ny), most_nodes, "nodes", "mpm.refine",
                  std::to_string(options.refine));
  const Grid fine = refined(measured, options.refine);
  if (options.domain_m.empty()) return fine;
  const Extent box = corners(options.domain_m, of_file(c) + ": mpm.domain_m");
  const Vec2 first = (box.lower - fine.origin).cwiseQuotient(fine.spacing);
  const Vec2 last = (box.upper - fine.origin).cwiseQuotient(fine.spacing);
  const Vec2 counts = last - first;
  require_at_most(counts.prod(), most_nodes, "nodes (" + number(counts.x()) + " x " + number(counts.y()) + ")",
                  "mpm.domain_m", toml_text(options.domain_m));
  require_at_most(std::max(first.cwiseAbs().maxCoeff(), last.cwiseAbs().maxCoeff()), most_nodes,
                  "nodes from the measured grid on", "mpm.domain_m", toml_text(options.domain_m));
  const int i0 = int(std::floor(first.x() + round_off)), j0 = int(std::floor(first.y() + round_off));
  const int i1 = int(std::ceil(last.x() - round_off)), j1 = int(std::ceil(last.y() - round_off));
  const Grid grid{fine.position(i0, j0), fine.spacing, i1 - i0 + 1, j1 - j0 + 1};
  if (grid.nx < 2 || grid.ny < 2) throw InputError(of_file(c) + ": mpm.domain_m: it holds no cell of the grid");
  return grid;
}

namespace {

bool inside_body(const mpm::RigidOptions& body, const Vec2& x, const std::string& what) {
  if (body.circle_m.size() == 3)
    return (x - Vec2(body.circle_m[0], body.circle_m[1])).norm() < body.circle_m[2];
  std::vector<Vec2> vertices = positions_of(body.polygon_m);
  return Polygon(std::move(vertices), what).contains(x);
}

mpm::MotionTable motion_of(const std::filesystem::path& file) {
  constexpr std::array names = {"displacement_x", "velocity_x", "displacement_y", "velocity_y", "angle", "angular_velocity"};
  const io::TimeTable table = io::read_time_table(file, {names.begin(), names.end()});
  mpm::MotionTable motion;
  motion.time = table.time;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::vector<double>* rows = table.find(names[k]);
    if (!rows) continue;
    mpm::Course& course = motion.courses[k / 2];
    if (course.given()) throw InputError(file.string() + ": found " + names[k - 1] + " and " + names[k] + ", expected one of them");
    course = {*rows, k % 2 == 1, {}};
  }
  return motion;
}

mpm::ForceTable force_of(const std::filesystem::path& file) {
  const io::TimeTable table = io::read_time_table(file, {"force_x", "force_y"});
  mpm::ForceTable force;
  force.time = table.time;
  for (std::size_t a = 0; a < 2; ++a)
    if (const std::vector<double>* rows = table.find(a == 0 ? "force_x" : "force_y")) force.rows[a] = *rows;
  return force;
}

void read_tables(const Case& c, mpm::Scene& scene) {
  for (auto& [name, body] : scene.bodies) {
    if (!body.motion.empty()) body.motion_table = motion_of(c.folder / body.motion);
    if (!body.force.empty()) body.force_table = force_of(c.folder / body.force);
  }
  for (auto& [name, boundary] : scene.boundaries)
    if (!boundary.motion.empty()) boundary.motion_table = motion_of(c.folder / boundary.motion);
}

}  // namespace

std::string material_of(const Case& c, const Region& region) {
  for (const auto& [name, given] : c.regions)
    if (name == region.name && !given.material.empty()) return given.material;
  return region.name;
}

mpm::Scene make_scene(const Case& c, const Setting& setting, const mpm::MpmOptions& options,
                      const Named<mpm::MaterialOptions>& materials, const std::string& materials_table) {
  mpm::Scene scene;
  scene.grid = simulation_grid(c, setting.grid, options);
  scene.particles = seed(scene.grid, setting.regions, options.per_element, SeedPattern::even, 0.0,
                         of_file(c) + ": mpm.per_element");
  for (const Region& region : setting.regions) {
    const std::string wanted = material_of(c, region);
    const auto it = std::find_if(materials.begin(), materials.end(), [&](const auto& m) { return m.first == wanted; });
    if (it == materials.end()) {
      std::vector<std::string> known;
      for (const auto& m : materials) known.push_back(m.first);
      throw InputError(of_file(c) + ": region." + region.name + ": no [" + materials_table + wanted + "]" +
                       did_you_mean(wanted, known));
    }
    scene.materials.push_back(it->second);
    if (it->second.porosity) scene.water = c.water;
  }
  scene.heat = c.heat;
  scene.centrifuge = c.centrifuge;
  scene.boundaries = c.boundaries;
  scene.bodies = c.bodies;
  scene.contacts = c.contacts;
  read_tables(c, scene);
  std::vector<bool> keep(scene.particles.size(), true);
  for (const auto& [name, body] : c.bodies)
    for (std::size_t p = 0; p < keep.size(); ++p)
      if (inside_body(body, scene.particles.x0[p], of_file(c) + ": body." + name)) keep[p] = false;
  keep_only(scene.particles, keep);
  put_initial_state(c, scene);
  return scene;
}

mpm::Solver make_solver(const Case& c, const Setting& setting, int threads) {
  mpm::Scene scene = make_scene(c, setting, *c.mpm, c.materials, "material.");
  try {
    return mpm::Solver(*c.mpm, std::move(scene), threads);
  } catch (const InputError& error) {
    throw InputError(of_file(c) + ": " + error.what());
  }
}

}  // namespace pivnp::app
