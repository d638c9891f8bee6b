#include "mpm/state/history.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

namespace pivnp::mpm {

MotionField HistoryVariable::field() const {
  return {.name = std::string(name),
          .unit = std::string(unit),
          .form = flag() ? FieldForm::scalar : form,
          .label = std::string(label.empty() ? name : label),
          .definition = std::string(definition)};
}

HistoryVariables::Places HistoryVariables::declare(const std::vector<HistoryVariable>& declared, std::size_t n) {
  Places places;
  for (const HistoryVariable& variable : declared) {
    auto at = std::find_if(variables.begin(), variables.end(), [&](const Variable& v) { return v.is.name == variable.name; });
    if (at == variables.end()) {
      Variable added{variable, variable.flag() ? flags.size() : numbers.size(), variable.field().components()};
      if (variable.flag())
        flags.emplace_back(n, std::uint8_t{0});
      else
        for (std::size_t c = 0; c < added.count; ++c) numbers.emplace_back(n, 0.0);
      at = variables.insert(variables.end(), added);
    } else if (at->is.form != variable.form) {
      throw std::logic_error("history: '" + std::string(variable.name) + "' is declared in two forms");
    }
    auto& to = variable.flag() ? places.flags : places.numbers;
    for (std::size_t c = 0; c < at->count; ++c) to.push_back(std::uint32_t(at->first + c));
  }
  return places;
}

Array* HistoryVariables::find(std::string_view name) {
  for (const Variable& v : variables)
    if (v.is.name == name && !v.is.flag()) return &numbers[v.first];
  return nullptr;
}

void HistoryVariables::reset() {
  for (const Variable& v : variables) {
    if (!v.is.reset) continue;
    if (v.is.flag()) {
      std::fill(flags[v.first].begin(), flags[v.first].end(), std::uint8_t{0});
      continue;
    }
    for (std::size_t c = 0; c < v.count; ++c) std::fill(numbers[v.first + c].begin(), numbers[v.first + c].end(), 0.0);
  }
}

}  // namespace pivnp::mpm
