#include "mpm/solver/frames.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <tuple>
#include <type_traits>

#include "mpm/material/model.hpp"
#include "mpm/scene/memory.hpp"
#include "mpm/state/particle_fields.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

SolverState initial_state(const Scene& scene, const Scheme& scheme, const GridState& g, const Materials& materials,
                          const Contacts& contacts) {
  const ParticleSet& set = scene.particles;
  const std::size_t n = set.size();
  if (n == 0) throw InputError("mpm: the scene holds no particle");
  if (!scene.v0.empty() && scene.v0.size() != n) throw InputError("mpm: v0 needs one entry a particle, or none");
  if (!scene.grad_v0.empty() && scene.grad_v0.size() != n)
    throw InputError("mpm: grad_v0 needs one entry a particle, or none");
  if (!scene.stress0.empty() && scene.stress0.size() != n)
    throw InputError("mpm: stress0 needs one entry a particle, or none");
  if (!scene.pressure0.empty() && scene.pressure0.size() != n)
    throw InputError("mpm: pressure0 needs one entry a particle, or none");

  // Body after body; inside a body as given.
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return set.label[a] < set.label[b]; });
  SolverState state;
  Particles& p = state.particles;
  p.resize(n, particle_needs(scheme, materials, needs_of(scene)));
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t from = order[k];
    const std::int32_t label = set.label[from];
    if (label < 0 || std::size_t(label) >= scene.materials.size())
      throw InputError("mpm: particle " + std::to_string(from) + " has label " +
                       std::to_string(label) + ", expected a material for it");
    if (p.bodies.empty() || p.bodies.back().material != label)
      p.bodies.push_back({k, k, label, p.history.declare(materials[std::size_t(label)]->history(), n)});
    p.bodies.back().end = k + 1;
    const int field = contacts.empty() ? 0 : contacts.field_of(std::size_t(label));
    double xi = 0, eta = 0;
    if (!g.find(set.x0[from].x(), set.x0[from].y(), p.cell[k], xi, eta, field)) {
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
    if (!scene.grad_v0.empty() && !p.C_xx.empty())
      std::tie(p.C_xx[k], p.C_xy[k], p.C_yx[k], p.C_yy[k]) = std::tuple_cat(scene.grad_v0[from]);
    if (!scene.stress0.empty() && !std::isnan(scene.stress0[from][0])) {
      if (materials[std::size_t(label)]->from_deformation())
        throw InputError("mpm: " + materials[std::size_t(label)]->name() +
                         " takes no stress at the start, expected another model or none");
      p.tau_xx[k] = scene.stress0[from][0];
      p.tau_yy[k] = scene.stress0[from][1];
      p.tau_zz[k] = scene.stress0[from][2];
      p.tau_xy[k] = scene.stress0[from][3];
    }
    const double area = double(set.area[from]);
    if (scheme.axisymmetric && !(p.x[k] > 0)) {
      std::ostringstream text;
      text << "mpm.geometry: found axisymmetric, but particle " << from << " lies at x = " << p.x[k] << ", expected all at x > 0, beside the axis";
      throw InputError(text.str());
    }
    p.volume0[k] = scheme.axisymmetric ? p.x[k] * area : area;
    if (!p.F_zz.empty()) p.F_zz[k] = 1;
    p.density = scene.materials[std::size_t(label)].density_kg_m3;
    if (!p.mass.empty()) p.mass[k] = p.density * p.volume0[k];
    p.F_xx[k] = p.F_yy[k] = p.J[k] = 1;
    if (!p.half.empty()) p.half[k] = std::min(0.5, 0.5 * std::sqrt(area * g.per_hx * g.per_hy));
  }
  state.body_motion.assign(6 * scene.bodies.size(), 0.0);
  return state;
}

namespace {

// A component of a motion field: the points' values, divided by J where it is given, at their places in the ParticleSet.
void put(const Particles& p, const Array& values, const double* J, std::size_t component, std::size_t components, float* out) {
  for (std::size_t k = 0; k < p.size(); ++k) out[components * p.index[k] + component] = float(J ? values[k] * (1 / J[k]) : values[k]);
}

void put_history(const HistoryVariables::Variable& variable, const Particles& p, MotionFrame& frame) {
  const std::span<float> out = frame.add(variable.is.name, p.size());
  if (variable.is.flag()) {
    for (std::size_t k = 0; k < p.size(); ++k) out[p.index[k]] = float(p.history.flags[variable.first][k]);
    return;
  }
  for (std::size_t c = 0; c < variable.count; ++c)
    put(p, p.history.numbers[variable.first + c], nullptr, c, variable.count, out.data());
}

}  // namespace

MotionFrame frame_of(const SolverState& state, const ParticleSet& set) {
  const Particles& p = state.particles;
  const std::size_t n = p.size();
  MotionFrame frame;
  frame.time = state.time;
  frame.u.resize(n);
  frame.status.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t to = p.index[k];
    const Vec2 u = p.displacement(k, set.x0[to]);
    frame.u[to] = {float(u.x()), float(u.y())};
    frame.status[to] = p.cell[k] == Particles::ended ? ParticleStatus::ended : ParticleStatus::active;
  }
  for_each_particle_field([&](const ParticleField& field, const auto&... column) {
    if (field.recorded.empty() || (field.need && std::get<0>(std::tie(p.*column.values...)).empty())) return;
    auto* out = static_cast<float*>(make_room(frame, motion_fields().at(field.recorded, "motion"), n));
    std::size_t c = 0;
    const auto put_column = [&]<class T>(const T& values) {
      if constexpr (std::is_same_v<T, Array>) put(p, values, field.per_volume ? p.J.data() : nullptr, c++, sizeof...(column), out);
    };
    (put_column(p.*column.values), ...);
  });
  for (const MaterialModel& model : material_models())
    for (const HistoryVariable& variable : model.history)
      if (variable.recorded == Recorded::always) frame.add(variable.name, n);  // zeros
  for (const HistoryVariables::Variable& variable : p.history.variables)
    if (variable.is.recorded != Recorded::no) put_history(variable, p, frame);
  return frame;
}

}  // namespace pivnp::mpm
