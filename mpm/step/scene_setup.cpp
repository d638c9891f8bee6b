#include "mpm/step/scene_setup.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

// Sets `value` to the one of `names` that the option names, if it is given.
template <class Enum>
void choose(const std::string& key, const std::optional<std::string>& option, const std::vector<std::string>& names,
            Enum& value) {
  if (!option) return;
  const auto it = std::find(names.begin(), names.end(), *option);
  if (it == names.end()) {
    std::string all;
    for (const std::string& n : names) all += (all.empty() ? "" : ", ") + n;
    throw InputError(key + ": found '" + *option + "', expected one of " + all + did_you_mean(*option, names));
  }
  value = Enum(it - names.begin());
}

}  // namespace

Scheme scheme_of(const MpmOptions& options) {
  Scheme scheme;
  if (options.scheme == "geopart")
    scheme = {.shape = ShapeKind::bilinear,
              .transfer = TransferKind::flip,
              .stress = StressUpdate::musl,
              .locking = Locking::selective,
              .damping = 0.05};
  else if (options.scheme != "default")
    throw InputError("mpm.scheme: found '" + options.scheme + "', expected default or geopart" +
                     did_you_mean(options.scheme, {"default", "geopart"}));
  choose("mpm.shape", options.shape, {"bilinear", "gimp", "bspline"}, scheme.shape);
  choose("mpm.transfer", options.transfer, {"flip", "apic", "xpic"}, scheme.transfer);
  choose("mpm.stress_update", options.stress_update, {"musl", "usl", "usf"}, scheme.stress);
  choose("mpm.locking", options.locking, {"none", "selective", "full", "fbar"}, scheme.locking);
  if (options.shape && !options.locking && scheme.shape != ShapeKind::bilinear && scheme.locking == Locking::selective)
    scheme.locking = Locking::fbar;
  if (scheme.shape != ShapeKind::bilinear && (scheme.locking == Locking::selective || scheme.locking == Locking::full))
    throw InputError("mpm.locking: found '" + options.locking.value_or("selective") +
                     "' with three-node shapes, expected none or fbar (or shape = \"bilinear\")");
  scheme.xpic_order = options.xpic_order;
  if (options.damping) scheme.damping = *options.damping;
  if (options.pic_per_s) {
    if (scheme.transfer != TransferKind::flip)
      throw InputError("mpm.pic_per_s: given with another transfer, expected transfer = \"flip\"");
    scheme.pic_per_s = *options.pic_per_s;
  }
  return scheme;
}

Materials materials_of(const Scene& scene, const std::vector<MaterialOptions>& constants) {
  Materials materials;
  for (std::size_t k = 0; k < constants.size(); ++k) {
    const auto& names = scene.particles.label_names;
    const std::string name = k < names.size() ? names[k] : std::to_string(k);
    materials.push_back(make_material(constants[k], "material." + name, std::sqrt(scene.grid.spacing.prod())));
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

std::vector<double> densities_of(const Scene& scene) {
  std::vector<double> densities;
  for (const MaterialOptions& m : scene.materials) densities.push_back(m.density_kg_m3);
  return densities;
}

std::array<double, 2> impedance_near(const Scene& scene, const Materials& materials, const Vec2& x) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < scene.particles.size(); ++k)
    if ((scene.particles.x0[k] - x).squaredNorm() < (scene.particles.x0[best] - x).squaredNorm()) best = k;
  const auto label = std::size_t(scene.particles.label[best]);
  const double rho = scene.materials[label].density_kg_m3;
  const Elastic& elastic = materials[label]->elastic();
  return {std::sqrt(rho * elastic.p_wave_modulus()), std::sqrt(rho * elastic.shear)};
}

SolverState initial_state(const Scene& scene, const Scheme& scheme, const GridState& g, const Materials& materials,
                          const Contacts& contacts, bool tied) {
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
  const bool several = set.label[order.front()] != set.label[order.back()];
  p.resize(n, several, scheme.transfer == TransferKind::apic, scheme.shape == ShapeKind::gimp, tied,
           scheme.stress != StressUpdate::usf && !scheme.takes_updated());
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t from = order[k];
    const std::int32_t label = set.label[from];
    if (label < 0 || std::size_t(label) >= scene.materials.size())
      throw InputError("mpm: particle " + std::to_string(from) + " has label " +
                       std::to_string(label) + ", expected a material for it");
    if (p.bodies.empty() || p.bodies.back().material != label) p.bodies.push_back({k, k, label});
    p.bodies.back().end = k + 1;
    const int sheet = contacts.empty() ? 0 : contacts.sheet_of(std::size_t(label));
    double xi = 0, eta = 0;
    if (!g.find(set.x0[from].x(), set.x0[from].y(), p.cell[k], xi, eta, sheet)) {
      std::ostringstream text;
      text << "mpm.domain_m: particle " << from << " at (" << set.x0[from].x() << ", " << set.x0[from].y()
           << ") lies outside the simulation's grid";
      throw InputError(text.str());
    }
    p.index[k] = from;
    p.x[k] = set.x0[from].x();
    p.y[k] = set.x0[from].y();
    if (!scene.v0.empty()) {
      p.vx[k] = scene.v0[from].x();
      p.vy[k] = scene.v0[from].y();
      state.fastest = std::max(state.fastest, scene.v0[from].norm());
    }
    if (!scene.stress0.empty()) {
      if (materials[std::size_t(label)]->from_deformation())
        throw InputError("mpm: neo_hookean takes no stress at the start, expected another model or none");
      p.tau_xx[k] = scene.stress0[from][0];
      p.tau_yy[k] = scene.stress0[from][1];
      p.tau_zz[k] = scene.stress0[from][2];
      p.tau_xy[k] = scene.stress0[from][3];
    }
    p.volume0[k] = double(set.area[from]);
    p.density = scene.materials[std::size_t(label)].density_kg_m3;
    if (!p.mass.empty()) p.mass[k] = p.density * p.volume0[k];
    p.F_xx[k] = p.F_yy[k] = p.J[k] = 1;
    if (!p.half.empty()) p.half[k] = std::min(0.5, 0.5 * std::sqrt(p.volume0[k] * g.per_hx * g.per_hy));
  }
  state.body_motion.assign(6 * scene.bodies.size(), 0.0);
  state.body_impulse.assign(2 * scene.bodies.size(), 0.0);
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
  const std::span<float> stress = frame.add("stress", n), plastic_dev = frame.add("plastic_dev", n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t to = p.index[k];
    const double per_J = 1 / p.J[k];
    const Vec2 u = p.displacement(k, set.x0[to]);
    frame.u[to] = {float(u.x()), float(u.y())};
    frame.F[to] = {float(p.F_xx[k]), float(p.F_xy[k]), float(p.F_yx[k]), float(p.F_yy[k])};
    frame.status[to] = p.cell[k] == Particles::ended ? ParticleStatus::ended : ParticleStatus::active;
    frame.v[to] = {float(p.vx[k]), float(p.vy[k])};
    const std::array<double, 4> tau = {p.tau_xx[k], p.tau_yy[k], p.tau_zz[k], p.tau_xy[k]};
    for (std::size_t c = 0; c < 4; ++c) stress[4 * to + c] = float(tau[c] * per_J);
    plastic_dev[to] = float(p.plastic_dev[k]);
  }
  return frame;
}

}  // namespace pivnp::mpm
