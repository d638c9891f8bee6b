#include "mpm/material/material.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "mpm/material/linear_elastic.hpp"
#include "mpm/material/mohr_coulomb.hpp"
#include "mpm/material/neo_hookean.hpp"
#include "mpm/material/von_mises.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

void require(bool good, const std::string& key, const char* name, double found, const char* expected) {
  if (good) return;
  std::ostringstream text;
  text << key << '.' << name << ": found " << found << ", expected " << expected;
  throw InputError(text.str());
}

}  // namespace

StressBatch StressBatch::part(std::size_t begin, std::size_t n) const {
  StressBatch b = *this;
  b.size = n;
  const auto on = [&](auto*& array) {
    if (array) array += begin;
  };
  for (const double** array : {&b.de_xx, &b.de_yy, &b.de_zz, &b.de_xy, &b.spin, &b.J, &b.F_xx, &b.F_xy, &b.F_yx, &b.F_yy})
    on(*array);
  for (double** array : {&b.xx, &b.yy, &b.zz, &b.xy, &b.plastic_dev, &b.gap, &b.dissipated}) on(*array);
  on(b.opened);
  return b;
}

double Material::stiffness(const StressBatch& batch) const {
  // A tension adds its own stiffness (geometric); the bound on the greatest principal stress is enough.
  double greatest = 0;
  for (std::size_t k = 0; k < batch.size; ++k)
    greatest = std::max(greatest, std::max(batch.xx[k], batch.yy[k]) + std::abs(batch.xy[k]));
  return elastic_.p_wave_modulus() + greatest;
}

std::unique_ptr<Material> make_material(const MaterialOptions& o, const std::string& key) {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  const auto not_negative = [](double v) { return std::isfinite(v) && v >= 0; };
  require(positive(o.density_kg_m3), key, "density_kg_m3", o.density_kg_m3, "a density above 0 kg/m^3");
  require(positive(o.young_pa), key, "young_pa", o.young_pa, "a stiffness above 0 Pa");
  require(not_negative(o.poisson) && o.poisson <= 0.499, key, "poisson", o.poisson, "0 to 0.499");
  const Elastic elastic(o.young_pa, o.poisson);
  if (o.model == "linear_elastic") return std::make_unique<LinearElastic>(elastic);
  if (o.model == "neo_hookean") return std::make_unique<NeoHookean>(elastic);
  if (o.model == "von_mises" || o.model == "tresca")
    require(positive(o.shear_strength_pa), key, "shear_strength_pa", o.shear_strength_pa, "a strength above 0 Pa");
  if (o.model == "tresca")  // Mohr-Coulomb without friction and without a limit on tension
    return std::make_unique<MohrCoulomb>(elastic, 0, 0, o.shear_strength_pa, std::numeric_limits<double>::max());
  if (o.model == "von_mises") {
    return std::make_unique<VonMises>(elastic, o.shear_strength_pa);
  }
  if (o.model == "mohr_coulomb") {
    require(not_negative(o.friction_deg) && o.friction_deg <= 89, key, "friction_deg", o.friction_deg, "0 to 89");
    require(not_negative(o.dilatancy_deg) && o.dilatancy_deg <= o.friction_deg, key, "dilatancy_deg", o.dilatancy_deg,
            "0 to friction_deg");
    require(not_negative(o.cohesion_pa), key, "cohesion_pa", o.cohesion_pa, "0 Pa or more");
    require(not_negative(o.tension_pa), key, "tension_pa", o.tension_pa, "0 Pa or more");
    require(o.friction_deg > 0 || o.cohesion_pa > 0, key, "friction_deg", o.friction_deg,
            "an angle above 0 where cohesion_pa is 0");
    return std::make_unique<MohrCoulomb>(elastic, o.friction_deg, o.dilatancy_deg, o.cohesion_pa, o.tension_pa);
  }
  throw InputError(key + ".model: found '" + o.model + "', expected linear_elastic, neo_hookean, von_mises, tresca or mohr_coulomb" +
                   did_you_mean(o.model, {"linear_elastic", "neo_hookean", "von_mises", "tresca", "mohr_coulomb"}));
}

}  // namespace pivnp::mpm
