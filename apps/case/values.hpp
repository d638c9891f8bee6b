// Option values to and from a case's text: one overload for every field type that options.hpp allows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/case/document.hpp"
#include "pivnp/core/choice.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::app {

/// A value about to be read: where it stands, and what is known of the option.
struct Place {
  const std::string& file;
  std::string key;  // as the message names it: piv.window_px
  int line = 0;
};

/// Each throws InputError of one line: place, found, expected. A whole number serves where a number is wanted, never
/// the reverse; nan and inf are refused; numbers are held to the option's range, strings to its choices.
void read_value(const Place& place, const Node& node, const OptionInfo& info, bool& value);
void read_value(const Place& place, const Node& node, const OptionInfo& info, int& value);
void read_value(const Place& place, const Node& node, const OptionInfo& info, double& value);
void read_value(const Place& place, const Node& node, const OptionInfo& info, std::string& value);
void read_value(const Place& place, const Node& node, const OptionInfo& info, Pair& value);
void read_value(const Place& place, const Node& node, const OptionInfo& info, Points& value);
void read_value(const Place& place, const Node& node, const OptionInfo& info, std::vector<double>& value);
void read_value(const Place& place, const Node& node, const OptionInfo& info, std::vector<std::string>& value);

/// One of `choices`, or InputError with the nearest.
std::string read_choice(const Place& place, const Node& node, const OptionInfo& info, const std::vector<std::string>& choices);
template <Choice E>
void read_value(const Place& place, const Node& node, const OptionInfo& info, E& value) {
  value = *value_named<E>(read_choice(place, node, info, choice_names<E>()));
}

template <class T>
void read_value(const Place& place, const Node& node, const OptionInfo& info, std::optional<T>& value) {
  T given{};
  read_value(place, node, info, given);
  value = given;
}

/// The value as TOML, on one line, that reads back to the same bits.
std::string toml_text(bool value);
std::string toml_text(int value);
std::string toml_text(double value);
std::string toml_text(const std::string& value);
std::string toml_text(const Pair& value);
std::string toml_text(const Points& value);
std::string toml_text(const std::vector<double>& value);
std::string toml_text(const std::vector<std::string>& value);
inline std::string toml_text(const char* value) { return toml_text(std::string(value)); }
template <Choice E>
std::string toml_text(const E& value) {
  return toml_text(std::string(name_of(value)));
}

/// Empty: not given.
template <class T>
std::string toml_text(const std::optional<T>& value) {
  return value ? toml_text(*value) : std::string();
}

/// A key as TOML writes it: bare where that is allowed, else quoted.
std::string toml_key(const std::string& key);

/// What a field takes, in words: "a whole number", "a list of points [[x, y], ...]" ...
inline std::string type_text(const bool&) { return "true or false"; }
inline std::string type_text(const int&) { return "a whole number"; }
inline std::string type_text(const double&) { return "a number"; }
inline std::string type_text(const std::string&) { return "a string"; }
inline std::string type_text(const Pair&) { return "two numbers [x, y]"; }
inline std::string type_text(const Points&) { return "a list of points [[x, y], ...]"; }
inline std::string type_text(const std::vector<double>&) { return "a list of numbers"; }
inline std::string type_text(const std::vector<std::string>&) { return "a list of strings"; }
template <Choice E>
std::string type_text(const E&) {
  return "a string";
}
template <class T>
std::string type_text(const std::optional<T>&) {
  return type_text(T{});
}

/// The values that a string or a choice may take; empty: any.
std::vector<std::string> choices_of(const OptionInfo& info);
template <class T>
std::vector<std::string> choices_of(const T&, const OptionInfo& info) {
  return choices_of(info);
}
template <Choice E>
std::vector<std::string> choices_of(const E&, const OptionInfo&) {
  return choice_names<E>();
}
template <Choice E>
std::vector<std::string> choices_of(const std::optional<E>&, const OptionInfo&) {
  return choice_names<E>();
}

/// False for a number outside its own range: the mark of "not given" where a default cannot be named.
inline bool writable(const OptionInfo& info, const int& value) { return in_range(info, value); }
inline bool writable(const OptionInfo& info, const double& value) { return in_range(info, value); }
template <class T>
bool writable(const OptionInfo&, const T&) {
  return true;
}

}  // namespace pivnp::app
