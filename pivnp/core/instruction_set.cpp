#include "pivnp/core/instruction_set.hpp"

#include <hwy/targets.h>

#include <algorithm>
#include <cctype>
#include <cstdint>

#include "pivnp/core/error.hpp"

namespace pivnp {

namespace {

std::string name_of_set(std::int64_t set) {
  std::string name = hwy::TargetName(set);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return name == "scalar" ? "sse2" : name;  // what kernels make of the baseline of x86-64
}

// As Highway's bits, the best one first.
std::vector<std::int64_t> each_of(std::int64_t sets) {
  std::vector<std::int64_t> out;
  for (std::int64_t left = sets; left != 0; left &= left - 1) out.push_back(left & -left);
  return out;
}

// Asking Highway what the processor supports makes it choose the best set anew.
std::vector<std::int64_t> sets_here() { return each_of((hwy::SupportedTargets() & HWY_TARGETS) | HWY_STATIC_TARGET); }

std::string names_of(const std::vector<std::int64_t>& sets) {
  std::string names;
  for (const std::int64_t set : sets) names += (names.empty() ? "" : ", ") + name_of_set(set);
  return names;
}

}  // namespace

std::vector<std::string> instruction_sets() {
  std::vector<std::string> names;
  for (const std::int64_t set : sets_here()) names.push_back(name_of_set(set));
  return names;
}

std::string instruction_set() {
  const hwy::ChosenTarget& chosen = hwy::GetChosenTarget();
  if (!chosen.IsInitialized()) return name_of_set(sets_here().front());
  const std::int64_t entry = std::int64_t(1) << chosen.GetIndex();
  for (const std::int64_t set : each_of(HWY_TARGETS))
    if (HWY_CHOSEN_TARGET_SHIFT(set) == entry) return name_of_set(set);
  return name_of_set(HWY_STATIC_TARGET);  // the last entry, which all sets share
}

void use_instruction_set(const std::string& name, const std::string& key) {
  const std::vector<std::int64_t> here = sets_here(), all = each_of(HWY_TARGETS);
  if (name.empty()) return hwy::GetChosenTarget().DeInit();
  const auto named = [&](std::int64_t set) { return name_of_set(set) == name; };
  const auto found = std::find_if(here.begin(), here.end(), named);
  if (found != here.end()) return hwy::GetChosenTarget().Update(*found);
  if (std::none_of(all.begin(), all.end(), named))
    throw InputError(key + ": there is no instruction set '" + name + "', expected one of " + names_of(all));
  throw InputError(key + ": this processor has no " + name + ", only " + names_of(here));
}

}  // namespace pivnp
