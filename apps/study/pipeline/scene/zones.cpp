#include "apps/study/pipeline/scene/zones.hpp"

#include <array>
#include <utility>

#include "apps/study/pipeline/scene/simulation_scene.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::app {

void check_compared_zones(const Case& c, const Setting& setting) {
  const compare::CompareOptions& o = c.compare;
  const bool turns = !o.fixed_zone_m.empty();
  const Points& given = turns ? o.fixed_zone_m : o.reference_m;
  if (given.empty()) return;
  const std::string key = turns ? "compare.fixed_zone_m" : "compare.reference_m";
  const std::size_t least = turns ? 3 : 1;  // a shift, or a shift and a rotation
  std::vector<Vec2> vertices = positions_of(given);
  const Polygon zone(std::move(vertices), key);
  const auto demand = [&](const ParticleSet& set, const char* what) {
    std::size_t inside = 0;
    for (const Vec2& x : set.x0) inside += zone.contains(x);
    if (inside < least)
      throw InputError(key + ": found " + std::to_string(inside) + " " + what + " in it, expected at least " +
                       std::to_string(least));
  };
  demand(seed_particles(c, setting), "numerical particles");
  demand(make_scene(c, setting, *c.mpm, c.materials, "material.").particles, "material points");
}

}  // namespace pivnp::app
