#include "mpm/scene_setup.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

Scheme scheme_of(const MpmOptions& options) {
  Scheme scheme{.damping = 0, .pic_share = 0.001};
  if (options.scheme == "geopart") scheme = {.damping = 0.05, .pic_share = 0};
  else if (options.scheme != "default")
    throw InputError("mpm.scheme: found '" + options.scheme + "', expected default or geopart" +
                     did_you_mean(options.scheme, {"default", "geopart"}));
  if (options.damping) scheme.damping = *options.damping;
  if (options.pic_share) scheme.pic_share = *options.pic_share;
  return scheme;
}

Materials materials_of(const Scene& scene) {
  Materials materials;
  for (std::size_t k = 0; k < scene.materials.size(); ++k) {
    const auto& names = scene.particles.label_names;
    const std::string name = k < names.size() ? names[k] : std::to_string(k);
    materials.push_back(make_material(scene.materials[k], "material." + name));
  }
  return materials;
}

Vec2 centroid(const ParticleSet& particles) {
  Vec2 sum = Vec2::Zero();
  double area = 0;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    sum += double(particles.area[k]) * particles.x0[k];
    area += double(particles.area[k]);
  }
  return area > 0 ? Vec2(sum / area) : sum;
}

double fastest_wave(const Scene& scene, const Materials& materials) {
  double fastest = 0;
  for (std::size_t k = 0; k < materials.size(); ++k)
    fastest = std::max(fastest, std::sqrt(materials[k]->elastic().p_wave_modulus() / scene.materials[k].density_kg_m3));
  return fastest;
}

SolverState initial_state(const Scene& scene) {
  const ParticleSet& set = scene.particles;
  const std::size_t n = set.size();
  if (n == 0) throw InputError("mpm: the scene holds no particle");
  if (!scene.v0.empty() && scene.v0.size() != n) throw InputError("mpm: v0 needs one entry a particle, or none");
  if (!scene.stress0.empty() && scene.stress0.size() != n)
    throw InputError("mpm: stress0 needs one entry a particle, or none");

  // Body after body; inside a body as given.
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return set.label[a] < set.label[b]; });
  SolverState state;
  Particles& p = state.particles;
  p.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t from = order[k];
    const std::int32_t label = set.label[from];
    if (label < 0 || std::size_t(label) >= scene.materials.size())
      throw InputError("mpm: particle " + std::to_string(from) + " has label " +
                       std::to_string(label) + ", expected a material for it");
    if (p.bodies.empty() || p.bodies.back().material != label) p.bodies.push_back({k, k, label});
    p.bodies.back().end = k + 1;
    ElementPoint at;
    if (!locate(scene.grid, set.x0[from], at)) {
      std::ostringstream text;
      text << "mpm.domain_m: particle " << from << " at (" << set.x0[from].x() << ", " << set.x0[from].y()
           << ") lies outside the simulation's grid";
      throw InputError(text.str());
    }
    p.index[k] = from;
    p.cell[k] = std::int32_t(scene.grid.element(at.i, at.j));
    p.x[k] = set.x0[from].x();
    p.y[k] = set.x0[from].y();
    if (!scene.v0.empty()) {
      p.vx[k] = scene.v0[from].x();
      p.vy[k] = scene.v0[from].y();
      state.fastest = std::max(state.fastest, scene.v0[from].norm());
    }
    if (!scene.stress0.empty()) {
      p.tau_xx[k] = scene.stress0[from][0];
      p.tau_yy[k] = scene.stress0[from][1];
      p.tau_zz[k] = scene.stress0[from][2];
      p.tau_xy[k] = scene.stress0[from][3];
    }
    p.volume0[k] = double(set.area[from]);
    p.mass[k] = p.volume0[k] * scene.materials[std::size_t(label)].density_kg_m3;
    p.F_xx[k] = p.F_yy[k] = p.J[k] = 1;
  }
  state.end = set.end;
  state.end_reason = set.end_reason;
  return state;
}

MotionFrame frame_of(const SolverState& state, const ParticleSet& set) {
  const Particles& p = state.particles;
  const std::size_t n = p.size();
  MotionFrame frame;
  frame.time = state.time;
  frame.u.resize(n);
  frame.F.resize(n);
  frame.status.resize(n);
  frame.v.resize(n);
  frame.stress.resize(n);
  frame.plastic_dev.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t to = p.index[k];
    const double per_J = 1 / p.J[k];
    frame.u[to] = {float(p.x[k] - set.x0[to].x()), float(p.y[k] - set.x0[to].y())};
    frame.F[to] = {float(p.F_xx[k]), float(p.F_xy[k]), float(p.F_yx[k]), float(p.F_yy[k])};
    frame.status[to] = p.cell[k] == Particles::ended ? ParticleStatus::ended : ParticleStatus::active;
    frame.v[to] = {float(p.vx[k]), float(p.vy[k])};
    frame.stress[to] = {float(p.tau_xx[k] * per_J), float(p.tau_yy[k] * per_J), float(p.tau_zz[k] * per_J),
                        float(p.tau_xy[k] * per_J)};
    frame.plastic_dev[to] = float(p.plastic_dev[k]);
  }
  return frame;
}

}  // namespace pivnp::mpm
