// An option list as flags of a command: slope_base_m becomes --slope-base-m, with the same checks as in a case.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "apps/case/values.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

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

/// Sets one key of an option list that stands under `section` ("compare"); false: the key is of another section. Adds the
/// list's keys to `known`.
using KeySetter = std::function<bool(const std::string& key, const std::string& value, std::vector<std::string>& known)>;
template <class T>
KeySetter keys_of(const std::string& section, T& options) {
  return [section, &options](const std::string& key, const std::string& text, std::vector<std::string>& known) {
    bool set = false;
    T::fields(options, [&](std::string_view name, auto& value, const OptionInfo& info) {
      known.push_back(section + "." + std::string(name));
      if (key != known.back()) return;
      static const std::string where = "--set";
      read_value(Place{where, key, 0}, parse_value(as_list(text, value)), info, value);
      set = true;
    });
    return set;
  };
}

/// --set KEY=VALUE, as commands on a case have it, for the keys of `lists` alone.
inline void add_set(CLI::App& app, Setters& setters, std::vector<KeySetter> lists) {
  app.add_option_function<std::vector<std::string>>(
         "--set",
         [lists = std::move(lists), &setters](const std::vector<std::string>& given) {
           for (const std::string& text : given)
             setters.push_back([lists, text] {
               const std::size_t equals = text.find('=');
               if (equals == std::string::npos || equals == 0)
                 throw InputError("--set " + text + ": expected KEY=VALUE");
               const std::string key = text.substr(0, equals);
               std::vector<std::string> known;
               for (const KeySetter& list : lists)
                 if (list(key, text.substr(equals + 1), known)) return;
               throw InputError("--set " + text + ": this command takes no key '" + key + "'" + did_you_mean(key, known));
             });
         },
         "a key by its name in a case, as in --set compare.band_strain=0.1 (may be repeated)")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

}  // namespace pivnp::app
