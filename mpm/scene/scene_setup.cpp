#include "mpm/scene/scene_setup.hpp"

#include <cmath>

#include "mpm/material/model.hpp"
#include "mpm/state/scheme_rows.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

Scheme scheme_of(const MpmOptions& options) {
  Scheme scheme = row_of(options.scheme).choices;
  // Without gravity nothing sets AFLIP's rate.
  if (scheme.transfer == TransferKind::aflip && options.gravity_m_s2 == Pair{0, 0}) scheme.transfer = TransferKind::apic;
  const ShapeRow& shape = row_of(options.shape.value_or(scheme.shape));
  const TransferRow& transfer = row_of(options.transfer.value_or(scheme.transfer));
  const LockingRow& locking = row_of(options.locking.value_or(scheme.locking));
  scheme.shape = shape.runs();
  scheme.transfer = transfer.runs();
  scheme.stress = options.stress_update.value_or(scheme.stress);
  scheme.locking = locking.runs();
  scheme.axisymmetric = options.geometry == Geometry::axisymmetric;
  if (locking.of_elements && shape.nodes != 2) {
    if (options.locking)
      throw InputError("mpm.locking: found '" + std::string(locking.name) +
                       "' with three-node shapes, expected none or fbar (or shape = \"bilinear\")");
    scheme.locking = Locking::fbar;  // the scheme's own cure does not go with the shape asked for
  }
  if (scheme.axisymmetric && row_of(scheme.locking).of_elements) {
    if (options.locking)
      throw InputError("mpm.locking: found '" + std::string(name_of(scheme.locking)) + "' in an axisymmetric run, expected none or fbar");
    scheme.locking = Locking::fbar;
  }
  if (scheme.transfer == TransferKind::xpic && scheme.stress != StressUpdate::usl)
    throw InputError("mpm.stress_update: found '" + std::string(name_of(scheme.stress)) + "' with transfer = \"xpic\", which brings turning "
                     "bodies to rest, expected usl");
  scheme.xpic_order = options.xpic_order;
  if (options.damping) scheme.damping = *options.damping;
  if (options.pic_per_s) {
    if (!transfer.blends)
      throw InputError("mpm.pic_per_s: given with another transfer, expected transfer = \"flip\" or \"aflip\"");
    scheme.pic_per_s = *options.pic_per_s;
  }
  return scheme;
}

bool steps_by_arrangement(const Scheme& scheme, bool bodies_or_contact, bool water) {
  return scheme.shape == ShapeKind::bspline && scheme.strains_as_it_moves() && !scheme.axisymmetric && !(scheme.damping > 0) && !bodies_or_contact && !water;
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

std::array<double, 2> impedance_near(const Scene& scene, const Materials& materials, const std::vector<double>& more, const Vec2& x) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < scene.particles.size(); ++k)
    if ((scene.particles.x0[k] - x).squaredNorm() < (scene.particles.x0[best] - x).squaredNorm()) best = k;
  const auto label = std::size_t(scene.particles.label[best]);
  const double rho = scene.materials[label].density_kg_m3;
  const Elastic& elastic = materials[label]->elastic();
  return {std::sqrt(rho * (elastic.p_wave_modulus() + more[label])), std::sqrt(rho * elastic.shear)};
}

}  // namespace pivnp::mpm
