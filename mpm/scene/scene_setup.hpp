// From options and scene to what the solver works on.
#pragma once

#include <array>
#include <vector>

#include "mpm/scene/options.hpp"
#include "mpm/scene/scene.hpp"
#include "mpm/state/scheme.hpp"
#include "mpm/transfer/stress_update.hpp"

namespace pivnp::mpm {

/// The numerical choices a scheme's name stands for, with what the options say instead. Throws InputError naming the key.
Scheme scheme_of(const MpmOptions& options);
/// Whether steps, where mpm.courant is left out, follow how the points lie (time_step.hpp): B-splines with APIC and usl, plane, undamped, without
/// bodies and contact, whose impulses between few nodes ask for shorter ones. `water`: in the pores.
bool steps_by_arrangement(const Scheme& scheme, bool bodies_or_contact, bool water);

/// The laws of `materials` (the scene's, or as they are at a time), one a label. Throws InputError naming the material.
Materials materials_of(const Scene& scene, const std::vector<MaterialOptions>& materials);
inline Materials materials_of(const Scene& scene) { return materials_of(scene, scene.materials); }
Vec2 centroid(const ParticleSet& particles);
/// Densities of the materials.
std::vector<double> densities_of(const Scene& scene);
/// rho c_p and rho c_s of the material of the particle nearest to a point; `more`: of each material, what its water adds to the
/// stiffness against compression, Pa.
std::array<double, 2> impedance_near(const Scene& scene, const Materials& materials, const std::vector<double>& more, const Vec2& x);

}  // namespace pivnp::mpm
