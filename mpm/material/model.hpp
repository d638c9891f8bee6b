// The constitutive laws, one row each. A law's row stands with the law (von_mises.cpp, say), the list in model.cpp;
// nothing else lists laws. What a law declares here is what the case reader, the solver, records and reports know of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mpm/material/material.hpp"
#include "mpm/material/options.hpp"
#include "mpm/state/history.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/registry.hpp"

namespace pivnp::mpm {

/// A key of [material.NAME] that a law takes.
struct MaterialKey {
  std::string_view name;
  bool required = false;   // to be given, with a value above 0
  bool exclusive = false;  // refused with models that do not take it: it would be a strength that silently is not there
  /// A key of the law's own, which MaterialOptions has no member for: a number, in MaterialOptions::own.
  std::optional<OptionInfo> own = {};
};

struct MaterialModel {
  std::string name;
  std::string text;                             // one line
  std::vector<MaterialKey> keys;                // beside those of every law, and the elastic ones
  std::vector<HistoryVariable> history = {};    // at most StressBatch::most_numbers components and most_flags flags
  bool elastic_keys = true;                     // takes young_pa and poisson, the first required
  /// Rules between keys; throws MaterialFault. Called once every key is there that has to be, and in its range.
  void (*check)(const MaterialOptions&) = nullptr;
  /// `cell_m`: side of the cells. Throws MaterialFault for what only the cells tell.
  std::unique_ptr<Material> (*make)(const MaterialOptions&, double cell_m);
  /// Divides the strength by a factor (reduction_factor); null: the law has none.
  void (*reduce)(MaterialOptions&, double factor) = nullptr;
};

/// Adding a law from outside: add_material_model(). (One that is added here directly is not recorded.)
Registry<MaterialModel>& material_models();
/// Lists a law; its recorded history joins motion_fields(), unless a field of that name is there.
const MaterialModel& add_material_model(MaterialModel model);

/// What is wrong with a material's constants; whoever knows where they were given adds the place.
struct MaterialFault : InputError {
  MaterialFault(std::string_view of_key, const std::string& fault)
      : InputError(std::string(of_key) + ": " + fault), key(of_key), text(fault) {}
  std::string key, text;  // "young_pa", "missing; expected more than 0 (Pa)"
};
/// Throws MaterialFault "found FOUND, expected EXPECTED".
[[noreturn]] void refuse(std::string_view key, double found, std::string_view expected);
inline void require(bool good, std::string_view key, double found, std::string_view expected) {
  if (!good) refuse(key, found, expected);
}
/// `lesser` is at most `greater`, if both are given.
void require_order(const MaterialOptions& options, std::string_view lesser, std::string_view greater);

/// The laws that take `key`; none where all do.
std::vector<std::string> models_with_key(std::string_view key);

/// All rules that need no cells. Throws MaterialFault.
void check_material(const MaterialOptions& options);

/// Throws InputError naming `key`.<constant> if a constant that the model needs is missing or out of range. `cell_m`:
/// side of the cells (softening_length_m).
std::unique_ptr<Material> make_material(const MaterialOptions& options, const std::string& key, double cell_m = 0);

/// The constants with the strength divided by a factor; as they are for a law without one.
MaterialOptions reduced(MaterialOptions options, double factor);

}  // namespace pivnp::mpm
