#include "apps/study/pipeline/scene/sizes.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "apps/case/values.hpp"
#include "apps/study/pipeline/scene/simulation_scene.hpp"
#include "mpm/heat/heat_soil.hpp"
#include "mpm/material/model.hpp"
#include "mpm/scene/memory.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "mpm/step/time_step.hpp"
#include "mpm/water/pore_soil.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr double gigabyte = 1e9;
constexpr double bytes_a_node = 100, bytes_a_particle = 200;
constexpr double bytes_a_pixel = 32, bytes_once = 25e6;  // frames, their splines and gradients; what libraries take as they are used (measured)
constexpr double bytes_a_state = 53;  // of a point: u, F, status, v, stress, plastic_dev
constexpr double beside_points = 100, beside_nodes = 60;  // what lists of cells, the grid's particles and the states' copies take
constexpr double most_frame_bytes = 1e13;

// Particles that fill the regions, all or those of which `counts` is true.
template <class Counts>
double filled(const Setting& setting, const Grid& grid, int per_element, Counts&& counts) {
  double area = 0;
  for (const Region& region : setting.regions) {
    if (!counts(region)) continue;
    const Vec2 low = region.polygon.lower().cwiseMax(grid.origin), high = region.polygon.upper().cwiseMin(grid.upper());
    const Vec2 box = (high - low).cwiseMax(0.0);
    area += std::min(region.polygon.area(), box.prod());
  }
  return area / grid.spacing.prod() * per_element;
}
double filled(const Setting& setting, const Grid& grid, int per_element) {
  return filled(setting, grid, per_element, [](const Region&) { return true; });
}

// The case's materials, and what bounds the step in them: the fastest compression wave, m/s, and the water's diffusivity, m^2/s.
struct Laws {
  mpm::Materials laws;
  double fastest = 0, drained = 0, diffusivity = 0;  // drained: the skeleton's wave alone
  bool wet = false, printed = false;                 // printed: a band's exchange

  Laws(const Case& c, double cell_m) {
    for (const auto& [name, given] : c.materials) {
      const mpm::MaterialOptions material = c.water ? mpm::without_pores(given, *c.water) : given;
      laws.push_back(mpm::make_material(material, "material." + name, cell_m));
      const mpm::PoreSoil soil = mpm::pore_soil(given, name, c.water ? &*c.water : nullptr);
      const double water = soil.holds_water() ? c.water->bulk_modulus_pa / soil.porosity : 0;
      const double skeleton = laws.back()->elastic().p_wave_modulus(), modulus = skeleton + water;
      fastest = std::max(fastest, std::sqrt(modulus / material.density_kg_m3));
      drained = std::max(drained, std::sqrt(skeleton / material.density_kg_m3));
      diffusivity = std::max(diffusivity, soil.mobility * water);
      wet |= soil.has_pores();
      printed |= mpm::exchanges_as_printed(given);
    }
  }
};

mpm::SceneNeeds needs_of(const Case& c, bool wet) {
  mpm::SceneNeeds needs{.several = c.materials.size() > 1, .water = wet, .heat = c.heat.has_value()};
  needs.soils = wet && c.water && c.water->properties == mpm::WaterProperties::by_temperature;
  for (const auto& [name, material] : c.materials) {
    needs.collapses |= material.wetting_collapse > 0;
    needs.soils |= wet && material.permeability == mpm::PermeabilityLaw::kozeny_carman;
    needs.drains |= wet && material.drained;
    needs.bands |= c.heat && material.band_thickness_m;
  }
  for (const auto& [name, boundary] : c.boundaries) {
    needs.tied |= boundary.type == mpm::BoundaryType::tied;
    needs.loads |= boundary.type == mpm::BoundaryType::traction;
  }
  return needs;
}

bool may_have_bands(const Case& c, const Region& region) {
  return std::any_of(c.materials.begin(), c.materials.end(), [&](const auto& m) { return m.first == material_of(c, region) && m.second.band_thickness_m; });
}

void size_simulation(const Case& c, const Setting& setting, std::size_t frames, double end_s, CaseSize& size) {
  const mpm::MpmOptions& o = *c.mpm;
  const Grid grid = simulation_grid(c, setting.grid, o);
  size.simulated_nodes = double(grid.nx) * double(grid.ny);
  size.points = filled(setting, grid, o.per_element);
  const GivenSpacing spacing = given_spacing(c);
  require_at_most(size.points, most_particles, "material points", spacing.key, spacing.value);
  const double end = o.end_s.value_or(end_s);
  size.states = o.output_rate_hz ? std::floor(end * *o.output_rate_hz) + 1 : double(frames);
  if (o.end_s && o.output_rate_hz && !(std::floor(end * *o.output_rate_hz + 1e-9) >= 1))
    throw InputError("mpm.end_s: found " + number(end) +
                     " s, expected 1/output_rate_hz = " + number(1 / *o.output_rate_hz) + " s at least");
  require_at_most(size.states, most_states, "states", "mpm.output_rate_hz", toml_text(o.output_rate_hz));
  const Laws materials(c, std::sqrt(grid.spacing.prod()));
  const bool longer = mpm::steps_by_arrangement(mpm::scheme_of(o), !c.bodies.empty() || !c.contacts.empty(), materials.wet);
  const double courant = o.courant.value_or(longer ? mpm::most_courant : mpm::least_courant);
  const auto step_of = [&](double diffusivity) {
    return mpm::stable_step_with_water(courant, grid.spacing.x(), grid.spacing.y(), materials.fastest, 0, diffusivity);
  };
  const bool in_parts = !o.pressure && mpm::flow_takes_parts(c.heat.has_value(), materials.printed, step_of(0),
                                                             step_of(materials.diffusivity));
  const double in_steps = end / step_of(in_parts ? 0 : materials.diffusivity);
  const double projected = end / mpm::stable_step(courant, grid.spacing.minCoeff(), materials.drained / mpm::projected_step_share(), 0);
  // Where the case leaves it open how pressure is stepped, the run decides as it starts.
  const bool open = materials.wet && !o.pressure, project = materials.wet && o.pressure == mpm::PressureScheme::projected;
  size.steps = project ? projected : in_steps;
  size.steps_at_most = open;
  const bool short_steps = o.courant.value_or(1) < 0.01;
  require_at_most(open ? std::min(in_steps, projected) : size.steps, most_steps, "steps", short_steps ? "mpm.courant" : "mpm.end_s",
                  toml_text(short_steps ? *o.courant : end));
  size.record_bytes = size.states * size.points * bytes_a_state;
  const mpm::Scheme scheme = mpm::scheme_of(o);
  const mpm::SceneNeeds needs = needs_of(c, materials.wet);
  const double a_point = mpm::bytes_a_point(mpm::particle_needs(scheme, materials.laws, needs), materials.laws);
  const double a_node = mpm::bytes_a_node(mpm::node_needs(scheme, materials.laws, needs));
  const mpm::BandBytes bands = mpm::band_bytes(needs);
  if (needs.bands)  // a band for each point that may yield
    size.memory_bytes += bands.a_point * size.points +
                         bands.a_band * filled(setting, grid, o.per_element, [&](const Region& region) { return may_have_bands(c, region); });
  size.memory_bytes += (a_point + beside_points) * size.points + (a_node + beside_nodes) * size.simulated_nodes;
}

}  // namespace

void require_at_most(double count, double most, const std::string& what, const std::string& key,
                     const std::string& value) {
  if (count <= most) return;  // not NaN either
  throw InputError(key + ": found " + value + ", which makes " + number(count, 3) + " " + what + ", expected at most " +
                   number(most, 3));
}

GivenSpacing given_spacing(const Case& c) {
  if (c.grid.spacing_m) return {"grid.spacing_m", toml_text(c.grid.spacing_m)};
  if (c.grid.spacing_px) return {"grid.spacing_px", toml_text(c.grid.spacing_px)};
  if (c.vectors) return {"vectors.path", toml_text(c.vectors->path)};
  return {"grid.spacing_px", "a quarter of the window"};
}

void require_drawable(const SynthOptions& synth, const image::TextureOptions& texture) {
  const double pixels = double(synth.width_px) * double(synth.height_px);
  require_at_most(pixels * texture.density_per_px, most_blobs, "blobs a frame", "synth.texture.density_per_px",
                  toml_text(texture.density_per_px));
  const double bytes = pixels * synth.frames * (texture.bits > 8 ? 2 : 1);
  require_at_most(bytes, most_frame_bytes, "bytes", "synth.frames", toml_text(synth.frames));
}

CaseSize size_of(const Case& c, const Setting& setting, std::size_t frames, double end_s) {
  CaseSize size;
  const GivenSpacing spacing = given_spacing(c);
  if (setting.width > 0 || setting.imported) {
    size.nodes = double(setting.grid.nx) * double(setting.grid.ny);
    size.particles = filled(setting, setting.grid, c.np.value_or(np::NpOptions{}).per_element);
    require_at_most(size.particles, most_particles, "numerical particles", spacing.key, spacing.value);
  }
  size.memory_bytes = bytes_once + bytes_a_node * size.nodes + bytes_a_particle * size.particles;
  if (!setting.imported) size.memory_bytes += bytes_a_pixel * double(setting.width) * double(setting.height);
  if (c.mpm) size_simulation(c, setting, frames, end_s, size);
  const double memory = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE));
  if (size.memory_bytes > memory)
    require_at_most(size.memory_bytes / gigabyte, memory / gigabyte, "gigabytes of memory", spacing.key, spacing.value);
  return size;
}

void require_room(const Case& c, const CaseSize& size, const std::filesystem::path& folder) {
  std::error_code failed;
  const auto space = std::filesystem::space(folder, failed);
  if (failed || !c.mpm) return;
  const bool by_rate = c.mpm->output_rate_hz.has_value();
  const GivenSpacing spacing = given_spacing(c);
  require_at_most(size.record_bytes / gigabyte, double(space.available) / gigabyte,
                  "gigabytes of states, more than the disk has left", by_rate ? "mpm.output_rate_hz" : spacing.key,
                  by_rate ? toml_text(c.mpm->output_rate_hz) : spacing.value);
}

std::string text_of(const CaseSize& size) {
  std::ostringstream text;
  text << "Size:";
  if (size.nodes > 0)
    text << " " << number(size.nodes, 12) << " nodes, about " << number(size.particles, 3) << " numerical particles";
  if (size.points > 0)
    text << (size.nodes > 0 ? ";" : "") << " simulation of " << number(size.simulated_nodes, 12) << " nodes, about "
         << number(size.points, 3) << " material points and " << (size.steps_at_most ? "at most " : "") << number(size.steps, 2) << " steps, "
         << number(size.states, 12) << " states (" << number(size.record_bytes / 1e6, 2) << " MB)";
  text << "; about " << number(size.memory_bytes / 1e6, 2) << " MB of memory beside the program.";
  return text.str();
}

}  // namespace pivnp::app
