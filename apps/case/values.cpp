#include "apps/case/values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "pivnp/core/error.hpp"
#include "pivnp/core/printable.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

[[noreturn]] void refuse(const Place& place, int line, const std::string& found, const std::string& expected) {
  std::string at = place.file;
  if (line > 0) at.append(":").append(std::to_string(line));
  throw InputError(at + ": " + place.key + ": found " + found + ", expected " + expected);
}

std::string with_unit(const std::string& words, const OptionInfo& info) {
  return info.unit.empty() ? words : words + " (" + std::string(info.unit) + ")";
}

const char text_that_prints[] = "text without control characters";

// A finite number of either kind, in range; `expected` names what the whole option takes.
double number_in(const Place& place, const Node& node, const OptionInfo& info, const std::string& expected) {
  if (node.kind != Node::Kind::integer && node.kind != Node::Kind::number)
    refuse(place, node.line, describe(node), expected);
  const double value = node.kind == Node::Kind::integer ? double(node.integer) : node.number;
  if (!std::isfinite(value)) refuse(place, node.line, describe(node), with_unit("a finite number", info));
  if (!in_range(info, value)) refuse(place, node.line, describe(node), with_unit(range_text(info), info));
  return value;
}

const Node& list_in(const Place& place, const Node& node, const std::string& expected) {
  if (node.kind != Node::Kind::list) refuse(place, node.line, describe(node), expected);
  return node;
}

Pair pair_in(const Place& place, const Node& node, const OptionInfo& info, const std::string& expected) {
  list_in(place, node, expected);
  if (node.list.size() != 2) refuse(place, node.line, describe(node), expected);
  return {number_in(place, node.list[0], info, expected), number_in(place, node.list[1], info, expected)};
}

template <class List>
std::string joined(const List& list) {
  std::string text = "[";
  for (const auto& item : list) text.append(text.size() > 1 ? ", " : "").append(toml_text(item));
  return text.append("]");
}

}  // namespace

void read_value(const Place& place, const Node& node, const OptionInfo& info, bool& value) {
  if (node.kind != Node::Kind::boolean) refuse(place, place.line, describe(node), with_unit(type_text(value), info));
  value = node.boolean;
}

void read_value(const Place& place, const Node& node, const OptionInfo& info, int& value) {
  if (node.kind != Node::Kind::integer) refuse(place, place.line, describe(node), with_unit(type_text(value), info));
  if (!in_range(info, double(node.integer)))
    refuse(place, place.line, describe(node), with_unit(range_text(info), info));
  using Limits = std::numeric_limits<int>;
  if (node.integer < Limits::min() || node.integer > Limits::max())
    refuse(place, place.line, describe(node), "at most " + std::to_string(Limits::max()));
  value = int(node.integer);
}

void read_value(const Place& place, const Node& node, const OptionInfo& info, double& value) {
  value = number_in(place, node, info, with_unit(type_text(value), info));
}

std::string read_choice(const Place& place, const Node& node, const OptionInfo& info,
                        const std::vector<std::string>& choices) {
  if (node.kind != Node::Kind::string) refuse(place, place.line, describe(node), with_unit("a string", info));
  if (std::find(choices.begin(), choices.end(), node.text) != choices.end()) return node.text;
  std::string list;
  for (const std::string& choice : choices) list += (list.empty() ? "" : ", ") + choice;
  const std::string near = did_you_mean(node.text, choices);
  refuse(place, place.line, toml_text(shortened(node.text)),
         (choices.size() > 1 ? "one of " : "") + list + (near.starts_with("; did") ? near : ""));
}

void read_value(const Place& place, const Node& node, const OptionInfo& info, std::string& value) {
  if (const std::vector<std::string> choices = choices_of(info); !choices.empty()) {
    value = read_choice(place, node, info, choices);
    return;
  }
  if (node.kind != Node::Kind::string) refuse(place, place.line, describe(node), with_unit(type_text(value), info));
  if (!prints(node.text)) refuse(place, place.line, describe(node), text_that_prints);
  value = node.text;
}

void read_value(const Place& place, const Node& node, const OptionInfo& info, Pair& value) {
  value = pair_in(place, node, info, with_unit(type_text(value), info));
}

void read_value(const Place& place, const Node& node, const OptionInfo& info, Points& value) {
  const std::string expected = with_unit(type_text(value), info);
  Points given;
  for (const Node& item : list_in(place, node, expected).list) given.push_back(pair_in(place, item, info, expected));
  value = given;
}

void read_value(const Place& place, const Node& node, const OptionInfo& info, std::vector<double>& value) {
  const std::string expected = with_unit(type_text(value), info);
  std::vector<double> given;
  for (const Node& item : list_in(place, node, expected).list) given.push_back(number_in(place, item, info, expected));
  value = given;
}

void read_value(const Place& place, const Node& node, const OptionInfo& info, std::vector<std::string>& value) {
  const std::string expected = with_unit(type_text(value), info);
  std::vector<std::string> given;
  for (const Node& item : list_in(place, node, expected).list) {
    if (item.kind != Node::Kind::string) refuse(place, item.line, describe(item), expected);
    if (!prints(item.text)) refuse(place, item.line, describe(item), text_that_prints);
    given.push_back(item.text);
  }
  value = given;
}

std::string toml_text(bool value) { return value ? "true" : "false"; }

std::string toml_text(int value) { return std::to_string(value); }

std::string toml_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  char buffer[40];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;  // shortest that reads back
  const std::string text(buffer, end);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string toml_text(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text += std::string("\\") + c;
    } else if (byte < 0x20 || byte == 0x7f) {
      constexpr char hex[] = "0123456789abcdef";
      text += c == '\n' ? "\\n" : c == '\t' ? "\\t" : std::string("\\u00") + hex[byte >> 4] + hex[byte & 15];
    } else {
      text += c;
    }
  }
  return text + "\"";
}

std::string toml_text(const Pair& value) { return joined(value); }
std::string toml_text(const Points& value) { return joined(value); }
std::string toml_text(const std::vector<double>& value) { return joined(value); }
std::string toml_text(const std::vector<std::string>& value) { return joined(value); }

std::string toml_key(const std::string& key) {
  const bool bare = !key.empty() && key.find_first_not_of(
                                        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                        "0123456789_-") == std::string::npos;
  return bare ? key : toml_text(key);
}

std::vector<std::string> choices_of(const OptionInfo& info) {
  return info.names ? info.names() : std::vector<std::string>{};
}

}  // namespace pivnp::app
