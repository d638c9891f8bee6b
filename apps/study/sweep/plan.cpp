#include "apps/study/sweep/plan.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "pivnp/core/error.hpp"

namespace pivnp::app {

namespace {

// At `mark`, but not within brackets or quotation marks.
std::vector<std::string> split(const std::string& text, char mark) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = 0;
  for (const char ch : text) {
    if (quote) quote = ch == quote ? 0 : quote;
    else if (ch == '"' || ch == '\'') quote = ch;
    else if (ch == '[') ++depth;
    else if (ch == ']') --depth;
    if (ch == mark && depth == 0 && !quote) parts.emplace_back();
    else parts.back() += ch;
  }
  for (std::string& part : parts) {
    part.erase(0, part.find_first_not_of(' '));
    part.erase(part.find_last_not_of(' ') + 1);
  }
  return parts;
}

bool same_value(const std::string& a, const std::string& b) {
  if (a == b) return true;
  char *end_a = nullptr, *end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a), y = std::strtod(b.c_str(), &end_b);
  if (!a.empty() && !b.empty() && !*end_a && !*end_b) return x == y;
  const auto bare = [](const std::string& text) { return text.size() > 1 && text.front() == '"' ? text.substr(1, text.size() - 2) : text; };
  return bare(a) == bare(b);
}

}  // namespace

Variation parse_variation(const std::string& text) {
  const std::size_t equals = text.find('=');
  const auto refuse = [&](const std::string& why) -> InputError { return InputError("--vary " + text + ": " + why + ", expected KEY=VALUE,VALUE,..."); };
  if (equals == std::string::npos) throw refuse("found no '='");
  Variation v{split(text.substr(0, equals), '+'), split(text.substr(equals + 1), ','), ""};
  for (const std::string& key : v.keys)
    if (key.empty() || key.find('.') == std::string::npos) throw refuse("found '" + key + "', which is no key of a section");
  for (const std::string& value : v.values)
    if (value.empty()) throw refuse("found an empty value");
  return v;
}

std::string value_in(const Case& c, const std::string& key) {
  const std::size_t dot = key.rfind('.');
  std::istringstream lines(write_case(c));
  const std::string section = "[" + key.substr(0, dot) + "]", name = key.substr(dot + 1);
  bool here = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('[')) here = line == section;
    const std::size_t equals = line.find('=');
    if (!here || equals == std::string::npos) continue;
    std::string found = line.substr(0, equals);
    found.erase(found.find_last_not_of(' ') + 1);
    if (found != name) continue;
    std::string value = line.substr(equals + 1);
    value.erase(0, value.find_first_not_of(' '));
    return value;
  }
  return "";
}

std::vector<SweepRun> plan_sweep(const std::vector<Variation>& variations, bool grid) {
  std::vector<SweepRun> runs;
  const auto add = [&](std::vector<std::string> values) {
    SweepRun run;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (!values[k].empty()) run.label += (run.label.empty() ? "" : ", ") + variations[k].name() + " = " + values[k];
    if (run.label.empty()) run.label = "the case";
    run.values = std::move(values);
    runs.push_back(std::move(run));
  };
  std::vector<std::string> none(variations.size());
  if (!grid) {
    add(none);
    for (std::size_t k = 0; k < variations.size(); ++k)
      for (const std::string& value : variations[k].values) {
        if (same_value(value, variations[k].own)) continue;
        std::vector<std::string> values = none;
        values[k] = value;
        add(values);
      }
    return runs;
  }
  std::vector<std::size_t> at(variations.size(), 0);
  while (true) {
    std::vector<std::string> values;
    for (std::size_t k = 0; k < at.size(); ++k) values.push_back(variations[k].values[at[k]]);
    add(values);
    std::size_t k = at.size();
    while (k > 0 && ++at[k - 1] == variations[k - 1].values.size()) at[--k] = 0;
    if (k == 0) return runs;
  }
}

std::vector<std::string> keys_of(const SweepRun& run, const std::vector<Variation>& variations) {
  std::vector<std::string> keys;
  for (std::size_t k = 0; k < variations.size(); ++k)
    if (!run.values[k].empty())
      for (const std::string& key : variations[k].keys) keys.push_back(key + "=" + run.values[k]);
  return keys;
}

}  // namespace pivnp::app
