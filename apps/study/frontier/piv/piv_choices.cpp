#include "apps/study/frontier/piv/piv_choices.hpp"

#include <type_traits>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/piv/methods.hpp"

namespace pivnp::app {

using piv::PivOptions;

namespace {

bool is_dense(const piv::PivMethod& method) { return method.family == piv::MethodFamily::gauss_newton && method.finest == 1; }

}  // namespace

std::string keys_of(const PivOptions& options, const PivOptions& base) {
  std::string keys;
  PivOptions::fields(options, [&](std::string_view name, const auto& value, const OptionInfo&) {
    PivOptions::fields(base, [&](std::string_view other, const auto& before, const OptionInfo&) {
      if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::decay_t<decltype(before)>>) {
        if (name != other || value == before) return;
        std::string text;
        if constexpr (Choice<std::decay_t<decltype(value)>>) text = name_of(value);
        else if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>) text = value;
        else if constexpr (std::is_same_v<std::decay_t<decltype(value)>, bool>) text = value ? "true" : "false";
        else text = number(double(value));
        keys += (keys.empty() ? "piv." : " piv.") + std::string(name) + "=" + text;
      }
    });
  });
  return keys.empty() ? "as it is" : keys;
}

bool same(const PivOptions& a, const PivOptions& b) { return keys_of(a, b) == "as it is"; }

PivOptions plainly(PivOptions o) {
  const PivOptions plain;
  const piv::PivMethod &recommended = *piv::piv_methods().begin(), &method = piv::piv_methods().at(o.method, "piv.method");
  if (method.make == recommended.make) o.method = recommended.name;
  if (!is_dense(method)) o.smoothing = plain.smoothing;
  if (o.smoothing != piv::Smoothing::window) o.order = plain.order;
  const bool dense = method.family == piv::MethodFamily::gauss_newton;
  if (o.passes == (dense ? 3 : 4) || (dense && method.finest > 1)) o.passes = 0;
  return o;
}

PivOptions with_defaults(const PivOptions& base) {
  PivOptions o = base;
  const PivOptions plain;
  o.method = plain.method, o.window_px = plain.window_px, o.smoothing = plain.smoothing, o.order = plain.order, o.passes = plain.passes;
  return o;
}

std::string plain_name(const PivOptions& o) {
  return o.method + ", " + std::to_string(o.window_px) + " px" + (o.smoothing == piv::Smoothing::window ? ", subsets" : "");
}

std::vector<PivChoice> piv_choices(const PivOptions& base) {
  std::vector<PivChoice> all;
  const piv::PivMethod& recommended = *piv::piv_methods().begin();
  for (const piv::PivMethod& method : piv::piv_methods()) {
    if (&method != &recommended && method.make == recommended.make) continue;  // the same by another name
    const bool dense = is_dense(method);
    const auto add = [&](int window, const std::string& more, const auto& change) {
      if (window < method.least_window_px) return;
      PivOptions o = base;
      o.method = method.name;
      o.window_px = window;
      o.smoothing = piv::Smoothing::adaptive;
      o.order = PivOptions().order;
      o.passes = 0;
      change(o);
      all.push_back({method.name + ", " + std::to_string(window) + " px" + more, o});
    };
    const auto nothing = [](PivOptions&) {};
    for (const int window : dense ? std::vector<int>{16, 24, 32, 48, 64} : std::vector<int>{16, 32, 64}) add(window, "", nothing);
    if (!dense) continue;
    for (const int passes : {2, 5}) add(32, ", " + std::to_string(passes) + " passes", [passes](PivOptions& o) { o.passes = passes; });
    for (const int window : {16, 32, 64})
      add(window, ", subsets", [](PivOptions& o) { o.smoothing = piv::Smoothing::window; });
    for (const int order : {0, 2})
      add(32, ", subsets of order " + std::to_string(order), [order](PivOptions& o) { o.smoothing = piv::Smoothing::window, o.order = order; });
  }
  return all;
}

}  // namespace pivnp::app
