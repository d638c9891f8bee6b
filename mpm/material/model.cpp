#include "mpm/material/model.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "mpm/material/cam_clay.hpp"
#include "mpm/material/drucker_prager.hpp"
#include "mpm/material/elastic.hpp"
#include "mpm/material/mohr_coulomb.hpp"
#include "mpm/material/smooth_mohr_coulomb.hpp"
#include "mpm/material/von_mises.hpp"
#include "mpm/material/water.hpp"
#include "mpm/state/stress_batch.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

// Calls visit(value, info) for the key of that name.
template <class Visit>
void with_key(const MaterialOptions& options, std::string_view key, Visit&& visit) {
  MaterialOptions::fields(options, [&](std::string_view name, const auto& value, const OptionInfo& info) {
    if (name == key) visit(value, info);
  });
}

// A key as it is given: what is known of it, and its value if it is a number.
struct Given {
  OptionInfo info;
  bool given = false;  // differs from what is there without it
  std::optional<double> value = {};
};

Given look_up(const MaterialOptions& options, std::string_view key) {
  static const MaterialOptions defaults;
  Given found;
  with_key(options, key, [&]<class T>(const T& value, const OptionInfo& info) {
    found.info = info;
    if constexpr (std::is_convertible_v<T, std::optional<double>>) found.value = value;
    with_key(defaults, key, [&]<class U>(const U& without, const OptionInfo&) {
      if constexpr (std::is_same_v<T, U>) found.given = value != without;
    });
  });
  return found;
}

std::string expected_of(const OptionInfo& info) {
  return range_text(info) + (info.unit.empty() ? "" : " (" + std::string(info.unit) + ")");
}

void check_key(const MaterialOptions& options, const MaterialKey& key) {
  const Given found = look_up(options, key.name);
  if (key.required && !(found.given && found.value && *found.value != 0)) {
    OptionInfo info = found.info;
    info.above_min = true;
    throw MaterialFault(key.name, "missing; expected " + expected_of(info));
  }
  if (found.given && found.value && !(std::isfinite(*found.value) && in_range(found.info, *found.value)))
    refuse(key.name, *found.value, expected_of(found.info));
}

bool takes(const MaterialModel& model, std::string_view key) {
  return std::any_of(model.keys.begin(), model.keys.end(), [&](const MaterialKey& k) { return k.name == key; });
}

void check_exclusive(const MaterialOptions& options, const MaterialModel& model) {
  const auto refuse_for = [&](std::string_view key, auto&& taken_by) {
    if (taken_by(model) || !look_up(options, key).given) return;
    std::string others;
    for (const MaterialModel& other : material_models())
      if (taken_by(other)) others += (others.empty() ? "" : " or ") + other.name;
    throw MaterialFault(key, "given with model \"" + options.model + "\", expected " + others);
  };
  for (const MaterialModel& other : material_models())
    for (const MaterialKey& key : other.keys)
      if (key.exclusive || key.own) refuse_for(key.name, [&](const MaterialModel& m) { return takes(m, key.name); });
  refuse_for("reduction_factor", [](const MaterialModel& m) { return m.reduce != nullptr; });
}

const std::vector<MaterialKey>& keys_of_all() {
  static const std::vector<MaterialKey> keys = {
      {"density_kg_m3"},    {"density_end_kg_m3"}, {"density_from_s"}, {"density_until_s"},  {"reduction_factor"},
      {"reduction_from_s"}, {"reduction_until_s"}, {"removed_s"},      {"permeability_m_s"}, {"grain_density_kg_m3"},
      {"grain_thermal_expansion_1_k"}, {"skeleton_thermal_expansion_1_k"}, {"grain_specific_heat_j_kg_k"},
      {"conductivity_w_m_k"}, {"band_thickness_m"}, {"band_compressibility_1_pa"}};
  return keys;
}

// What changes with time (loading.hpp).
void check_times(const MaterialOptions& o) {
  if (o.density_end_kg_m3) {
    if (!o.density_until_s) throw MaterialFault("density_until_s", "missing beside density_end_kg_m3");
    require(*o.density_until_s > o.density_from_s, "density_until_s", *o.density_until_s, "more than density_from_s");
  } else if (o.density_until_s) {
    refuse("density_until_s", *o.density_until_s, "density_end_kg_m3 beside it");
  }
  if (o.reduction_of == ReductionOf::cohesion)
    require(o.reduction_factor && o.cohesion_pa > 0, "reduction_of", o.reduction_factor.value_or(0), "a reduction_factor, and a cohesion to reduce");
  if (!o.reduction_until_s) return;
  require(o.reduction_factor.has_value(), "reduction_until_s", *o.reduction_until_s, "reduction_factor beside it");
  require(*o.reduction_until_s >= o.reduction_from_s, "reduction_until_s", *o.reduction_until_s, "reduction_from_s or more");
}

// What the pores hold (mpm/water).
void check_pores(const MaterialOptions& o) {
  if (!o.porosity) {
    if (o.permeability_m_s) refuse("permeability_m_s", *o.permeability_m_s, "porosity beside it");
    if (o.permeability != PermeabilityLaw::constant) throw MaterialFault("permeability", "given without porosity, expected both or neither");
    if (o.drained) throw MaterialFault("drained", "given without porosity, expected both or neither");
    if (o.wetting_collapse != 0) throw MaterialFault("wetting_collapse", "given without porosity, expected both or neither");
    return;
  }
  require(*o.porosity > 0 && *o.porosity < 1, "porosity", *o.porosity, "more than 0 and less than 1");
  if (o.density_kg_m3 != 0) refuse("density_kg_m3", o.density_kg_m3, "none beside porosity: the density follows from grain_density_kg_m3 and the water");
  if (o.density_end_kg_m3) refuse("density_end_kg_m3", *o.density_end_kg_m3, "none beside porosity");
  if (o.drained && o.wetting_collapse != 0) throw MaterialFault("wetting_collapse", "given beside drained = true, expected one of them");
  if (!o.drained && !o.permeability_m_s) throw MaterialFault("permeability_m_s", "missing beside porosity; expected 0 or more (m/s), or drained = true");
}

void list_recorded(const MaterialModel& model) {
  std::size_t numbers = 0, flags = 0;
  for (const HistoryVariable& variable : model.history) {
    const MotionField field = variable.field();
    (variable.flag() ? flags : numbers) += field.components();
    if (variable.recorded != Recorded::no && !motion_fields().find(field.name)) motion_fields().add(field);
  }
  if (numbers > StressBatch::most_numbers || flags > StressBatch::most_flags)
    throw std::logic_error("material model '" + model.name + "' declares too long a history");
}

// From the start of the program, so that a record's history is known where no case is read.
[[maybe_unused]] const std::size_t listed = material_models().size();

}  // namespace

Registry<MaterialModel>& material_models() {
  static Registry<MaterialModel> models = [] {
    Registry<MaterialModel> all = {linear_elastic_model(),      neo_hookean_model(),    von_mises_model(),
                                   tresca_model(),              mohr_coulomb_model(),   smooth_mohr_coulomb_model(),
                                   drucker_prager_model(),      modified_cam_clay_model(), mu_i_model(),
                                   water_model()};
    for (const MaterialModel& model : all) list_recorded(model);
    return all;
  }();
  return models;
}

const MaterialModel& add_material_model(MaterialModel model) {
  list_recorded(model);
  return material_models().add(std::move(model));
}

const std::vector<HistoryVariable>& Material::history() const {
  static const std::vector<HistoryVariable> none;
  return model_ ? model_->history : none;
}

const std::string& Material::name() const {
  static const std::string none;
  return model_ ? model_->name : none;
}

std::vector<std::string> material_model_names() { return material_models().names(); }

std::vector<OwnMaterialKey> own_material_keys() {
  std::vector<OwnMaterialKey> own;
  for (const MaterialModel& model : material_models())
    for (const MaterialKey& key : model.keys)
      if (key.own && std::none_of(own.begin(), own.end(), [&](const auto& k) { return k.name == key.name; }))
        own.push_back({key.name, *key.own});
  return own;
}

std::vector<std::string> models_with_key(std::string_view key) {
  const bool elastic = key == "young_pa" || key == "poisson", strength = key == "reduction_factor";
  std::vector<std::string> names;
  const std::vector<MaterialKey>& all = keys_of_all();
  if (!strength && std::any_of(all.begin(), all.end(), [&](const MaterialKey& k) { return k.name == key; })) return names;
  for (const MaterialModel& model : material_models())
    if (takes(model, key) || (elastic && model.elastic_keys) || (strength && model.reduce)) names.push_back(model.name);
  return names;
}

void refuse(std::string_view key, double found, std::string_view expected) {
  throw MaterialFault(key, "found " + number(found) + ", expected " + std::string(expected));
}

void require_order(const MaterialOptions& options, std::string_view lesser, std::string_view greater) {
  const std::optional<double> a = look_up(options, lesser).value, b = look_up(options, greater).value;
  if (a && b && !(*a <= *b)) refuse(lesser, *a, "at most " + std::string(greater) + ", " + number(*b));
}

void check_material(const MaterialOptions& o) {
  const MaterialModel* model = material_models().find(o.model);
  if (!model) {
    std::string known;
    for (const std::string& name : material_models().names()) known += (known.empty() ? "" : ", ") + name;
    throw MaterialFault("model", "found '" + o.model + "', expected one of " + known +
                                     did_you_mean(o.model, material_models().names()));
  }
  if (!o.porosity) check_key(o, {"density_kg_m3", true});
  for (const MaterialKey& key : keys_of_all()) check_key(o, key);
  check_pores(o);
  check_exclusive(o, *model);
  if (model->elastic_keys)
    for (const MaterialKey& key : {MaterialKey{"young_pa", true}, MaterialKey{"poisson"}}) check_key(o, key);
  for (const MaterialKey& key : model->keys) check_key(o, key);
  for (const std::string_view key : {"young_pa", "poisson"})
    if (!model->elastic_keys && !takes(*model, key) && look_up(o, key).given)
      throw MaterialFault(key, "given with model \"" + o.model + "\", expected none: its stiffness is that of its other keys");
  if (model->check) model->check(o);
  check_times(o);
}

std::unique_ptr<Material> make_material(const MaterialOptions& o, const std::string& key, double cell_m) {
  try {
    check_material(o);
    const MaterialModel& model = *material_models().find(o.model);
    std::unique_ptr<Material> material = model.make(o, cell_m);
    material->made_as(model);
    return material;
  } catch (const MaterialFault& fault) {
    throw InputError(key + "." + fault.what());
  }
}

MaterialOptions reduced(MaterialOptions options, double factor) {
  const MaterialModel* model = material_models().find(options.model);
  if (!model || !model->reduce) return options;
  if (options.reduction_of == ReductionOf::strength) {
    model->reduce(options, factor);
    return options;
  }
  options.cohesion_pa /= factor;
  if (options.cohesion_residual_pa) *options.cohesion_residual_pa /= factor;
  return options;
}

}  // namespace pivnp::mpm
