// Whether an option differs from what it is when left out.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::compare {

inline bool stated(double v) { return v != 0; }
inline bool stated(const Pair& v) { return v != Pair{0.0, 0.0}; }
template <class T>
bool stated(const std::vector<T>& v) {
  return !v.empty();
}
template <class T>
bool stated(const std::optional<T>& v) {
  return v.has_value();
}
template <Choice E>
bool stated(E v) {
  return v != E{};
}

/// The option of that name; false where there is none.
template <class Options>
bool is_stated(const Options& options, std::string_view name) {
  bool found = false;
  Options::fields(options, [&](std::string_view key, const auto& value, const OptionInfo&) {
    if (key == name) found = stated(value);
  });
  return found;
}

/// Whether an option in one of these units is stated.
template <class Options>
bool states_any_in(const Options& options, std::string_view unit, std::string_view or_unit) {
  bool found = false;
  Options::fields(options, [&](std::string_view, const auto& value, const OptionInfo& info) {
    found = found || ((info.unit == unit || info.unit == or_unit) && stated(value));
  });
  return found;
}

}  // namespace pivnp::compare
