// Options that take one of a few values: an enum, and the names that a case uses for them, listed once beside it.
//
//   enum class Gradient { particle, element };
//   inline constexpr std::array gradient_names{NamedValue{"particle", Gradient::particle}, NamedValue{"element", Gradient::element}};
//   constexpr const auto& names_of(Gradient) { return gradient_names; }
//
// The reader of a case turns names into values; nothing below it compares texts.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace pivnp {

template <class E>
struct NamedValue {
  std::string_view name;
  E value;
};
template <class E>
NamedValue(const char*, E) -> NamedValue<E>;

template <class E>
concept Choice = std::is_enum_v<E> && requires(E e) { names_of(e).begin()->name; };

template <Choice E>
constexpr std::string_view name_of(E value) {
  for (const NamedValue<E>& named : names_of(E{}))
    if (named.value == value) return named.name;
  return "";
}

template <Choice E>
constexpr std::optional<E> value_named(std::string_view name) {
  for (const NamedValue<E>& named : names_of(E{}))
    if (named.name == name) return named.value;
  return std::nullopt;
}

/// The names in the order of their list.
template <Choice E>
std::vector<std::string> choice_names() {
  std::vector<std::string> names;
  for (const NamedValue<E>& named : names_of(E{})) names.emplace_back(named.name);
  return names;
}

}  // namespace pivnp
