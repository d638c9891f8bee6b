#include "mpm/material/material.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "mpm/material/drucker_prager.hpp"
#include "mpm/material/linear_elastic.hpp"
#include "mpm/material/mohr_coulomb.hpp"
#include "mpm/material/neo_hookean.hpp"
#include "mpm/material/smooth_mohr_coulomb.hpp"
#include "mpm/material/variable_mohr_coulomb.hpp"
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
  b.move_increments(begin);
  if (places) b.places += begin;
  else b.move_state(begin);
  return b;
}

StressBatch StressBatch::point(std::size_t k) const {
  StressBatch b = *this;
  b.size = 1;
  b.places = nullptr;
  b.move_increments(k);
  b.move_state(places ? places[k] : k);
  return b;
}

void StressBatch::move_increments(std::size_t by) {
  for (const double** array : {&de_xx, &de_yy, &de_zz, &de_xy, &spin})
    if (*array) *array += by;
}

void StressBatch::move_state(std::size_t by) {
  for (const double** array : {&J, &F_xx, &F_xy, &F_yx, &F_yy, &softened_by})
    if (*array) *array += by;
  for (double** array : {&xx, &yy, &zz, &xy, &plastic_dev, &gap, &dissipated})
    if (*array) *array += by;
  if (opened) opened += by;
}

double Material::stiffness(const StressBatch& batch) const {
  // A tension adds its own stiffness (geometric); the bound on the greatest principal stress is enough.
  constexpr std::size_t apart = 8;  // greatest values that do not wait for one another
  std::array<double, apart> greatest{};
  const auto take = [&](std::size_t k, double& most) {
    most = std::max(most, std::max(batch.xx[k], batch.yy[k]) + std::abs(batch.xy[k]));
  };
  const std::size_t whole = batch.size / apart * apart;
  for (std::size_t k = 0; k < whole; k += apart)
    for (std::size_t l = 0; l < apart; ++l) take(k + l, greatest[l]);
  for (std::size_t k = whole; k < batch.size; ++k) take(k, greatest[0]);
  return elastic_.p_wave_modulus() + *std::max_element(greatest.begin(), greatest.end());
}

namespace {

bool positive(double v) { return std::isfinite(v) && v > 0; }
bool not_negative(double v) { return std::isfinite(v) && v >= 0; }

const std::vector<std::string> models{"linear_elastic", "neo_hookean",         "von_mises",      "tresca",
                                      "mohr_coulomb",   "mohr_coulomb_smooth", "drucker_prager", "mu_i",
                                      "water"};

// Almost shear-free elastic water: its bulk modulus, and a shear modulus close to zero (the thesis' chapter 5).
std::unique_ptr<Material> water(const MaterialOptions& o, const std::string& key) {
  require(positive(o.bulk_pa), key, "bulk_pa", o.bulk_pa, "a bulk modulus above 0 Pa");
  require(not_negative(o.shear_pa) && o.shear_pa < 0.1 * o.bulk_pa, key, "shear_pa", o.shear_pa,
          "0 to a tenth of bulk_pa");
  const double K = o.bulk_pa, G = o.shear_pa > 0 ? o.shear_pa : 1e-6 * K;
  return std::make_unique<LinearElastic>(Elastic(9 * K * G / (3 * K + G), (3 * K - 2 * G) / (2 * (3 * K + G))));
}

void check_frictional(const MaterialOptions& o, const std::string& key) {
  require(not_negative(o.friction_deg) && o.friction_deg <= 89, key, "friction_deg", o.friction_deg, "0 to 89");
  require(not_negative(o.dilatancy_deg) && o.dilatancy_deg <= o.friction_deg, key, "dilatancy_deg", o.dilatancy_deg,
          "0 to friction_deg");
  require(not_negative(o.cohesion_pa), key, "cohesion_pa", o.cohesion_pa, "0 Pa or more");
  require(not_negative(o.tension_pa), key, "tension_pa", o.tension_pa, "0 Pa or more");
  require(o.friction_deg > 0 || o.cohesion_pa > 0, key, "friction_deg", o.friction_deg,
          "an angle above 0 where cohesion_pa is 0");
}

std::unique_ptr<Material> mu_i(const MaterialOptions& o, const std::string& key, const Elastic& elastic) {
  const double flowing = o.friction_flow_deg.value_or(0);
  require(flowing >= o.friction_deg && flowing <= 89 && flowing > 0, key, "friction_flow_deg", flowing,
          "friction_deg to 89");
  require(o.cohesion_pa == 0, key, "cohesion_pa", o.cohesion_pa, "0 with mu_i");
  require(o.dilatancy_deg == 0, key, "dilatancy_deg", o.dilatancy_deg, "0 with mu_i");
  require(positive(o.inertial_number), key, "inertial_number", o.inertial_number, "a number above 0");
  require(positive(o.grain_diameter_m), key, "grain_diameter_m", o.grain_diameter_m, "a diameter above 0 m");
  require(positive(o.grain_density_kg_m3), key, "grain_density_kg_m3", o.grain_density_kg_m3, "a density above 0 kg/m^3");
  return std::make_unique<DruckerPrager>(
      elastic, o.friction_deg, 0, 0, 0,
      DruckerPrager::Flow{flowing, o.inertial_number, o.grain_diameter_m, o.grain_density_kg_m3});
}

std::unique_ptr<Material> mohr_coulomb(const MaterialOptions& o, const std::string& key, const Elastic& elastic,
                                       double cell_m) {
  const StrengthLaw strength(o, key, cell_m);
  if (o.model == "mohr_coulomb_smooth") {
    require(positive(o.apex_pa), key, "apex_pa", o.apex_pa, "a stress above 0 Pa");
    return std::make_unique<SmoothMohrCoulomb>(elastic, strength, o.tension_pa, o.apex_pa);
  }
  if (!strength.constant()) return std::make_unique<VariableMohrCoulomb>(elastic, strength, o.tension_pa);
  return std::make_unique<MohrCoulomb>(elastic, o.friction_deg, o.dilatancy_deg, o.cohesion_pa, o.tension_pa);
}

// A key that the model does not know would be a strength that silently is not there.
void refuse_unused(const MaterialOptions& o, const std::string& key) {
  const bool changes = o.model == "mohr_coulomb" || o.model == "mohr_coulomb_smooth";
  const auto unused = [&](bool given, const char* name, const char* where) {
    if (given) throw InputError(key + "." + name + ": given with model \"" + o.model + "\", expected " + where);
  };
  const char* soils = "mohr_coulomb or mohr_coulomb_smooth";
  unused(!changes && o.friction_residual_deg, "friction_residual_deg", soils);
  unused(!changes && o.cohesion_residual_pa, "cohesion_residual_pa", soils);
  unused(!changes && o.softening_shape != 0, "softening_shape", soils);
  unused(!changes && o.softening_length_m, "softening_length_m", soils);
  unused(!changes && o.softening_average != SofteningAverage::smeared, "softening_average", soils);
  unused(!changes && o.friction_low_stress_deg, "friction_low_stress_deg", soils);
  unused(!changes && o.friction_half_pa, "friction_half_pa", soils);
  unused(!changes && o.dilatancy_fade, "dilatancy_fade", soils);
  unused(o.model != "mu_i" && o.friction_flow_deg, "friction_flow_deg", "mu_i");
}

}  // namespace

std::unique_ptr<Material> make_material(const MaterialOptions& o, const std::string& key, double cell_m) {
  require(positive(o.density_kg_m3), key, "density_kg_m3", o.density_kg_m3, "a density above 0 kg/m^3");
  if (std::find(models.begin(), models.end(), o.model) == models.end())
    throw InputError(key + ".model: found '" + o.model + "', expected linear_elastic, neo_hookean, von_mises, tresca, "
                     "mohr_coulomb, mohr_coulomb_smooth, drucker_prager, mu_i or water" + did_you_mean(o.model, models));
  refuse_unused(o, key);
  if (o.model == "water") return water(o, key);
  require(positive(o.young_pa), key, "young_pa", o.young_pa, "a stiffness above 0 Pa");
  require(not_negative(o.poisson) && o.poisson <= 0.499, key, "poisson", o.poisson, "0 to 0.499");
  const Elastic elastic(o.young_pa, o.poisson);
  if (o.model == "linear_elastic") return std::make_unique<LinearElastic>(elastic);
  if (o.model == "neo_hookean") return std::make_unique<NeoHookean>(elastic);
  if (o.model == "von_mises" || o.model == "tresca")
    require(positive(o.shear_strength_pa), key, "shear_strength_pa", o.shear_strength_pa, "a strength above 0 Pa");
  if (o.model == "tresca")  // Mohr-Coulomb without friction and without a limit on tension
    return std::make_unique<MohrCoulomb>(elastic, 0, 0, o.shear_strength_pa, std::numeric_limits<double>::max());
  if (o.model == "von_mises") return std::make_unique<VonMises>(elastic, o.shear_strength_pa);
  check_frictional(o, key);
  if (o.model == "mu_i") return mu_i(o, key, elastic);
  if (o.model == "drucker_prager")
    return std::make_unique<DruckerPrager>(elastic, o.friction_deg, o.dilatancy_deg, o.cohesion_pa, o.tension_pa,
                                           DruckerPrager::Flow{});
  return mohr_coulomb(o, key, elastic, cell_m);
}

}  // namespace pivnp::mpm
