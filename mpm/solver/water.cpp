// The water in the pores: where a step hands over to it, and what it refuses.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "mpm/grid/sweeps.hpp"
#include "mpm/solver/impl.hpp"
#include "mpm/step/time_step.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

constexpr std::size_t chunk = 1024;  // points
constexpr double closed_pores = 0.02;  // of those at the start

void check_boundaries(const Scene& scene) {
  for (const auto& [name, b] : scene.boundaries) {
    const std::string key = "boundary." + name;
    const char* given = b.pressure_pa ? ".pressure_pa" : b.water_level_m ? ".water_level_m" : b.drained ? ".drained" : b.flux_m_s ? ".flux_m_s" : nullptr;
    if (!scene.water && given) throw InputError(key + given + ": given without [water], expected both or neither");
    if (!scene.water) continue;
    if (b.type == BoundaryType::tied && (scene.water->level_m || !scene.water->level_history.empty()))
      throw InputError(key + ".type: found 'tied' beside a level of the water, expected one of them: the water's surface inside does not pass");
    if (b.type == BoundaryType::tied && given)
      throw InputError(key + given + ": given with type \"tied\", through which water passes to the other side; expected none");
  }
}

// Where pressure is projected nodes are solved for together; what they meet there is not in that system yet.
void check_projected(const Scene& scene) {
  const auto refuse = [](const std::string& key) {
    throw InputError(key + ": given beside mpm.pressure = \"projected\", expected \"explicit\"");
  };
  if (!scene.contacts.empty()) refuse("contact." + scene.contacts.front().first);
  if (!scene.bodies.empty()) refuse("body." + scene.bodies.front().first);
  for (const auto& [name, b] : scene.boundaries) {
    if (b.type == BoundaryType::tied) refuse("boundary." + name + ".type");
    if (b.water_level_m) refuse("boundary." + name + ".water_level_m");
  }
}

// Is the pressure of all pores given?
bool gives_pressures(const Scene& scene, const std::vector<PoreSoil>& soils) {
  if (scene.pressure0.size() != scene.particles.size()) return false;
  for (std::size_t k = 0; k < scene.pressure0.size(); ++k)
    if (const auto label = std::size_t(scene.particles.label[k]);
        std::isnan(scene.pressure0[k]) && label < soils.size() && soils[label].holds_water())
      return false;
  return true;
}

void check_gravity(const MpmOptions& o, const WaterOptions& water, bool given) {
  const auto upright = [](const Pair& g) { return std::abs(g[0]) <= 1e-3 * std::abs(g[1]) && g[1] <= 0; };
  const bool vertical = upright(o.gravity_m_s2) && (!o.gravity_from_m_s2 || upright(*o.gravity_from_m_s2));
  const bool level = water.level_m || !water.level_history.empty();
  if (level && !vertical)
    throw InputError(std::string("water.") + (water.level_m ? "level_m" : "level_history") + ": given where gravity is not downwards, expected vertical gravity or no level");
  const bool known = level || given || !water.surface_m.empty() || water.start == WaterStart::seepage;
  if (!known && o.initial_equilibrium && Vec2(o.gravity_m_s2[0], o.gravity_m_s2[1]).norm() > 0)
    throw InputError(
        "water.level_m: missing beside mpm.initial_equilibrium, expected a level, or pressures of all regions at the "
        "start (or initial_equilibrium = false)");
}

}  // namespace

std::vector<PoreSoil> take_pores(const MpmOptions& options, Scene& scene) {
  check_boundaries(scene);
  if (!scene.water && options.pressure) throw InputError("mpm.pressure: given without [water], expected both or neither");
  std::vector<PoreSoil> soils;
  for (std::size_t k = 0; k < scene.materials.size(); ++k) {
    const auto& names = scene.particles.label_names;
    const std::string name = k < names.size() ? names[k] : std::to_string(k);
    try {
      if (scene.materials[k].porosity) check_material(scene.materials[k]);
    } catch (const MaterialFault& fault) {
      throw InputError("material." + name + "." + fault.what());
    }
    soils.push_back(pore_soil(scene.materials[k], name, scene.water ? &*scene.water : nullptr));
    if (scene.water) scene.materials[k] = without_pores(scene.materials[k], *scene.water);
  }
  if (!scene.water) return soils;
  if (scene.water->inertia && options.geometry == Geometry::axisymmetric)
    throw InputError("water.inertia: found true beside mpm.geometry = \"axisymmetric\", expected false");
  if (scene.water->inertia && scene.heat) throw InputError("water.inertia: found true beside [heat], expected false");
  check_gravity(options, *scene.water, gives_pressures(scene, soils));
  if (options.pressure == PressureScheme::projected) check_projected(scene);
  if (options.sleep_below_m_s && scene.water->inertia)
    throw InputError("mpm.sleep_below_m_s: given beside water.inertia, expected none: the flow has a motion of its own");
  return soils;
}

// K_w/n of each material, which waves that are long to the cells feel besides the skeleton's; 0 without water.
std::vector<double> Solver::Impl::undrained_stiffness() const {
  std::vector<double> stiffness;
  for (const PoreSoil& soil : pores) stiffness.push_back(soil.holds_water() ? scene.water->bulk_modulus_pa / soil.porosity : 0);
  return stiffness;
}

void Solver::Impl::fill_pores() {
  if (!scene.water) return;
  for (std::size_t k = 0; k < pores.size(); ++k) {
    const auto& names = scene.particles.label_names;
    pores[k].constrained_modulus = materials[k]->elastic().p_wave_modulus();
    if (!(pores[k].collapse > 0)) continue;
    if (materials[k]->from_deformation())
      throw InputError("material." + (k < names.size() ? names[k] : std::to_string(k)) + ".wetting_collapse: given beside " + materials[k]->name() +
                       ", whose stress follows the deformation alone; expected another model");
    const Elastic& elastic = materials[k]->elastic();
    pores[k].bulk_modulus = elastic.p_wave_modulus() - 4 * elastic.shear / 3;
  }
  water = std::make_unique<PoreWater>(*scene.water, pores, scene.particles, g,
                                      PoreBoundaries(scene.boundaries, restraints.walls(), g), restraints.tied(), bodies);
  if (options.pressure == PressureScheme::projected) water->project(g, foreseen_share);
  water->start(p, g, loading.tractions(), loading.gravity(0), scene.pressure0, most_threads);
  if (!options.pressure) {
    choose_pressure();
    if (options.pressure == PressureScheme::projected) water->project(g, foreseen_share);
  }
  for (std::size_t k = 0; k < density.size(); ++k)
    if (water->partly_dry(p, k)) density[k] = water->soil(k).dry_density();
}

// Water that has come or gone moved as its point does.
void Solver::Impl::carry_water(const Cycle& c) {
  std::vector<double> parts((p.size() + chunk - 1) / chunk, 0.0);
  const bool alike =
      pores.size() == 1 && pores.front().holds_water();  // of one soil: in lanes, without asking point by point
  const PointView points = p.view();
  for_each(parts.size(), c.threads, [&](std::size_t part) {
    double sum = 0;
    Range range{part * chunk, std::min(p.size(), (part + 1) * chunk)};
    if (alike) sum += water->carry_in_lanes(p, points, g.grid.spacing, c.gravity, range);
    for (std::size_t k = range.begin; k < range.end; ++k) {
      if (p.cell[k] == Particles::ended) continue;
      const double mass = water->mass(p, k), before = p.mass[k];
      if (mass == before) continue;
      p.mass[k] = mass;
      sum += (1 - before / mass) * stored_kinetic(p, g, k);
      if (!water_works_in_steps()) sum += water->brought(p, k, mass - before, c.gravity);
    }
    parts[part] = sum;
  });
  for (const double part : parts) state.balance.bodies += part;
}

// Of a point that ends: in the step's course, or between steps.
void Solver::Impl::end_water(std::size_t k) {
  const double potential = water->potential_energy(p, k, loading.gravity(state.time));
  potential_energy -= potential;
  state.balance.potential -= potential;
  state.balance.carried += water->stored(p, k, loading.gravity(state.time));
  state.balance.inflow -= water->flowing_mass(p, k);
}

void Solver::Impl::follow_level(const Cycle& c) {
  const PoreFlow came = water->follow_level(p, c.gravity, state.time, state.time + c.dt, c.threads);
  state.balance.inflow += scene.water->density_kg_m3 * came.inflow;
  state.balance.bodies += came.external;
}

int Solver::Impl::parts_of_flow(double dt) const {
  return std::max(
      1, int(std::ceil(dt / courant() * rate_of_flow(g.grid.spacing.x(), g.grid.spacing.y(), state.diffusivity))));
}

void Solver::Impl::flow_water(const Cycle& c) {
  if (!water) return;
  const auto projected = [&] {
    try {
      return water->flow_projected(p, g, loading.tractions(), c.gravity, state.time, c.dt, state.pressure_change, c.threads);
    } catch (const RunError& fault) {
      fail(fault.what());
    }
  };
  const auto explicitly = [&] {
    if (!flows_in_parts)
      return water->flow(p, g, loading.tractions(), c.gravity, state.time, c.dt, c.threads,
                         has_inertia() ? &state.water_inertia : nullptr);
    // Strain comes with the parts: given before the first it would flow away too fast.
    PoreFlow sum;
    const int parts = parts_of_flow(c.dt);
    const double dt = c.dt / parts;
    strained_to.assign(p.J.begin(), p.J.end());
    for (int part = 0; part < parts; ++part) {
      const double left = double(parts - 1 - part) / parts;
      for_each(p.size(), c.threads,
               [&](std::size_t k) { p.J[k] = strained_to[k] - left * (strained_to[k] - p.J_strained[k]); });
      sum.add(water->flow(p, g, loading.tractions(), c.gravity, state.time + part * dt, dt, c.threads));
    }
    p.J_strained = p.J;
    return sum;
  };
  const PoreFlow flow = water->projected() ? projected() : explicitly();
  state.balance.inflow += scene.water->density_kg_m3 * flow.inflow;
  state.balance.bodies += flow.external;
  state.balance.darcy += flow.darcy;
  state.balance.damping += flow.yielded + flow.collapsed;
  state.balance.moved += std::abs(flow.yielded);
  // (Projected, water is counted beside its pressure, and nothing else would hold it to what there is.)
  if (water->projected() && water->overdrawn(p))
    fail("a particle has lost more water than it held, expected less deformation or mpm.pressure = \"explicit\"");
}

// Walls and contacts are pressed by skeleton and water together; what rubs is the skeleton. Between two bodies it
// slides where the skeleton bears less: on the side of the greater pressure.
void Solver::Impl::press_faces(const Cycle& c, bool counted) {
  std::vector<std::uint32_t> rubbing = counted ? restraints.rubbing(state.time, g) : std::vector<std::uint32_t>();
  std::vector<Vec2> on_walls;
  for (const PoreWater::Thrust& t : water->thrust(p, g, c.gravity, state.time, rubbing, c.threads))
    on_walls.push_back(c.dt * t.force);
  restraints.press(rubbing, on_walls, g);
  if (contacts.empty()) return;
  std::vector<std::uint32_t> nodes;
  for (const Contacts::ContactNode& m : contacts.nodes()) nodes.insert(nodes.end(), {m.node[0], m.node[1]});
  if (!counted) nodes.clear();
  const std::vector<PoreWater::Thrust> thrusts = water->thrust(p, g, c.gravity, state.time, nodes, c.threads);
  std::vector<double> on_contacts;
  for (std::size_t k = 0; k < thrusts.size(); k += 2) {
    const PoreWater::Thrust &a = thrusts[k], &b = thrusts[k + 1];
    const Vec2& normal = contacts.nodes()[k / 2].normal;
    const bool first = a.pores && (!b.pores || a.pressure >= b.pressure);
    on_contacts.push_back(c.dt * (first ? a.force.dot(normal) : b.pores ? -b.force.dot(normal) : 0));
  }
  contacts.press(on_contacts);
}

void Solver::Impl::put_water(MotionFrame& frame) {
  const std::vector<Vec2> flow =
      water->flow_at_points(p, g, loading.tractions(), loading.gravity(state.time), state.time, most_threads,
                            has_inertia() ? &state.water_inertia : nullptr);
  const std::span<float> of_flow = frame.add("water_flow", p.size());
  for (std::size_t k = 0; k < p.size(); ++k)
    for (int c = 0; c < 2; ++c) of_flow[2 * p.index[k] + std::size_t(c)] = float(flow[k][c]);
  if (scene.water->level_m || !scene.water->level_history.empty()) {
    const std::span<float> excess = frame.add("excess_pressure", p.size());
    for (std::size_t k = 0; k < p.size(); ++k) excess[p.index[k]] = float(water->excess_pressure(p, k, loading.gravity(state.time)));
  }
  const std::span<float> porosity = frame.add("porosity", p.size());
  for (std::size_t k = 0; k < p.size(); ++k) porosity[p.index[k]] = float(water->porosity(p, k));
}

void Solver::Impl::take_wave_speed(int threads) {
  if (!water) {
    state.wave_speed = wave_speed(materials, density, p, threads);
    return;
  }
  const PoreWater::Rates rates = water->rates(p);
  if (rates.least_pores < closed_pores) {
    std::ostringstream text;
    text << "the pores of a particle have closed: " << rates.least_pores << " of them is left, expected more than " << closed_pores
         << " (grains do not give way, and steps would become ever shorter)";
    fail(text.str());
  }
  if (water->projected()) {
    state.wave_speed = wave_speed(materials, density, p, threads) / projected_step_share();
    return;
  }
  std::vector<double> stiffness = rates.stiffness;
  for (std::size_t k = 0; has_inertia() && k < stiffness.size(); ++k)
    stiffness[k] = water->inert_stiffness(k, materials[k]->elastic().p_wave_modulus(), density[k], stiffness[k]);
  state.wave_speed = wave_speed(materials, density, p, threads, stiffness);
  state.diffusivity = rates.diffusivity;
}

}  // namespace pivnp::mpm
