// An option list as flags of a command: slope_base_m becomes --slope-base-m, with the same checks as in a case.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "apps/case/values.hpp"

namespace pivnp::app {

/// Settings given on the command line, to be made once the options they change have been read from elsewhere.
using Setters = std::vector<std::function<void()>>;

/// Adds one flag an option of `options`, which must outlive the setters.
template <class T>
void add_option_flags(CLI::App& app, T& options, Setters& setters) {
  T::fields(options, [&](std::string_view name, auto& value, const OptionInfo& info) {
    std::string flag = "--" + std::string(name);
    for (char& c : flag)
      if (c == '_') c = '-';
    const auto set = [flag, info, &value](const std::string& text) {
      static const std::string where = "command line";
      read_value(Place{where, flag, 0}, parse_value(text), info, value);
    };
    app.add_option_function<std::string>(
           flag, [set, &setters](const std::string& text) { setters.push_back([set, text] { set(text); }); },
           std::string(info.text))
        ->type_name(info.unit.empty() ? "VALUE" : "VALUE (" + std::string(info.unit) + ")");
  });
}

}  // namespace pivnp::app
