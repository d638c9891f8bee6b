#include "mpm/constraint/tractions.hpp"

#include <cmath>
#include <limits>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

Tractions::Tractions(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const ParticleSet& particles,
                     const std::vector<double>& density) {
  for (std::size_t b = 0; b < boundaries.size(); ++b)
    if (boundaries[b].second.type == BoundaryType::traction)
      add("boundary." + boundaries[b].first, boundaries[b].second, b, particles, density);
}

void Tractions::add(const std::string& key, const BoundaryOptions& o, std::size_t boundary, const ParticleSet& particles,
                    const std::vector<double>& density) {
  if (!o.traction_pa) throw InputError(key + ".traction_pa: missing beside type = \"traction\"");
  if (o.line_m.size() != 2) throw InputError(key + ".line_m: expected two end points of the loaded face");
  const Vec2 a(o.line_m[0][0], o.line_m[0][1]), b(o.line_m[1][0], o.line_m[1][1]);
  const double length = (b - a).norm();
  if (!(length > 0)) throw InputError(key + ".line_m: expected two different end points");
  const Vec2 along = (b - a) / length;
  const double rise = o.rise_s, until = o.until_s.value_or(std::numeric_limits<double>::infinity());
  if (!(rise >= 0)) throw InputError(key + ".rise_s: found " + number(rise) + ", expected 0 s or more");
  std::vector<std::size_t> loaded;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const Vec2 d = particles.x0[k] - a;
    const double side = std::sqrt(double(particles.area[k])), on = d.dot(along);
    if (on < 0 || on > length) continue;
    if (std::abs(d.x() * along.y() - d.y() * along.x()) < 0.75 * side) loaded.push_back(k);
  }
  if (loaded.empty()) throw InputError(key + ".line_m: no particle lies along it, expected a face of the material");
  const Vec2 force = Vec2((*o.traction_pa)[0], (*o.traction_pa)[1]) * length / double(loaded.size());
  at_.resize(particles.size(), -1);
  for (const std::size_t k : loaded) {
    if (at_[k] >= 0) throw InputError("boundary: two tractions load the same particle, expected faces apart");
    at_[k] = std::int32_t(loads_.size());
    const double mass = double(particles.area[k]) * density[std::size_t(particles.label[k])];
    loads_.push_back({force / mass, rise, until, length / double(loaded.size()), std::uint16_t(boundary)});
  }
  if (rise > 0) changes_.push_back(rise);
  if (std::isfinite(until)) changes_.push_back(until);
}

const Traction* Tractions::of(std::size_t particle) const {
  if (loads_.empty() || at_[particle] < 0) return nullptr;
  return &loads_[std::size_t(at_[particle])];
}

}  // namespace pivnp::mpm
