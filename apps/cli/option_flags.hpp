// An option list as flags of a command: slope_base_m becomes --slope-base-m, with the same checks as in a case.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "apps/case/values.hpp"

namespace pivnp::app {

/// Settings given on the command line, to be made once the options they change have been read from elsewhere.
using Setters = std::vector<std::function<void()>>;

template <class V>
constexpr bool is_list = std::is_same_v<V, std::vector<std::string>> || std::is_same_v<V, std::vector<double>>;

/// A list may be given without its brackets, and names without quotes: 0.1,0.2 or strain_dev,velocity_x; on the command line with blanks between, too.
template <class V>
std::string as_list(const std::string& text, const V&) {
  constexpr bool names = std::is_same_v<V, std::vector<std::string>>;
  if (!is_list<V> || text.starts_with("[")) return text;
  std::string list = "[";
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string item = text.substr(at, end - at);
    list += (at > 0 ? ", " : "") + (names ? toml_text(item) : item);
    at = end + 1;
  }
  return list + "]";
}

/// Adds one flag an option of `options`, which must outlive the setters; `short_names`: also without the unit at the name's
/// end (--times for times_s).
template <class T>
void add_option_flags(CLI::App& app, T& options, Setters& setters, bool short_names = false) {
  T::fields(options, [&](std::string_view name, auto& value, const OptionInfo& info) {
    std::string flag = "--" + std::string(name);
    for (char& c : flag)
      if (c == '_') c = '-';
    const auto set = [flag, info, &value](const std::string& text) {
      static const std::string where = "command line";
      read_value(Place{where, flag, 0}, parse_value(as_list(text, value)), info, value);
    };
    std::string names = flag;
    if (const std::string ending = "-" + std::string(info.unit); short_names && flag.ends_with(ending) && ending.size() > 1)
      names += "," + flag.substr(0, flag.size() - ending.size());
    const auto later = [set, &setters](const std::string& text) { setters.push_back([set, text] { set(text); }); };
    const std::string unit = info.unit.empty() ? "" : " (" + std::string(info.unit) + ")";
    if constexpr (is_list<std::remove_cvref_t<decltype(value)>>)
      app.add_option_function<std::vector<std::string>>(
             names,
             [later](const std::vector<std::string>& parts) {
               std::string text;
               for (const std::string& part : parts) text += (text.empty() ? "" : ",") + part;
               later(text);
             },
             std::string(info.text))
          ->type_name("VALUES" + unit);
    else
      app.add_option_function<std::string>(names, later, std::string(info.text))->type_name("VALUE" + unit);
  });
}

}  // namespace pivnp::app
